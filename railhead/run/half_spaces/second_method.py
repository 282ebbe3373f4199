"""Half-spaces beside finite elements: the same contact by boundary elements, without friction and
with it, by FASTSIM, linear theory and closed forms.

Boundary elements find pressure and tractions on the real profiles. FASTSIM and the linear theory
know ellipses alone: each connected patch rolls as the ellipse that has its second moments and its
force.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from railhead.contact import closed_forms
from railhead.half_spaces import shearing
from railhead.half_spaces.pressing import FINE, HalfSpacePair, Pressed
from railhead.half_spaces.shearing import PressedPatch
from railhead.planning.effects import interface, shape
from railhead.planning.simulation_plan import Plan
from railhead.postprocess import friction
from railhead.postprocess.findings import Findings
from railhead.postprocess.friction import AT_BORDER, LOADS
from railhead.postprocess.patch import compare
from railhead.postprocess.patch import half_space as findings
from railhead.run.mesh_solution import MeshSolution
from railhead.scene.quantities import SCATTER
from railhead.theory.array_types import Array
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import kalker, partial_slip
from railhead.theory.friction.kalker import Coefficients
from railhead.theory.friction.rolling import CELLS, Creepage
from railhead.theory.friction.solution import FrictionSolution
from railhead.theory.friction.tangential import MaterialPair

SLENDER = 20.0  # largest axis ratio in the tables of the linear theory
GROWING_PATCH = "unlike bodies slip while the patch grows, which is not followed there"
STRIP_ACROSS = "a strip of unlike bodies across the rail"
UNEVEN = "the formula has one coefficient of friction"

Numbers = dict[str, float]
"""Keys of "friction" in summary.json with their values."""
NumbersByMethod = dict[str, dict[str, Any]]
"""The same, or a "reason", by the name of a method."""


def solve(solved: MeshSolution) -> BoundaryElementSolution | str | None:
    """Contact of the real profiles as half-spaces under the vertical load of the solution,
    frictionless, or the reason why boundary elements failed. None where exact Hertz is the
    half-space solution (half-spaces and line contacts), where nothing touches, and off rank 0.
    """
    contact = solved.plan.contact
    if contact.half_space or contact.line or solved.findings is None:
        return None
    try:
        pair, load = solved.plan.context.half_spaces, solved.plan.scene.load
        return pair.pressed(load or solved.solution.load, FINE)
    except ValueError as error:
        return f"boundary elements: {error}"


def half_space(
    solved: MeshSolution, solution: BoundaryElementSolution | str | None
) -> dict[str, Any] | None:
    """Entry "half_space" of summary.json: quantities of the half-space `solution`, and by quantity
    the "allowance" for what half-spaces leave out, as the plan has it; or {"reason": ...}. None
    where `solution` is None.
    """
    found = solved.findings
    if solution is None or found is None:
        return None
    if isinstance(solution, str):
        return {"reason": solution}
    pair = solved.plan.context.half_spaces
    quantities = frictionless(pair, solution)
    try:
        allowed = shape.half_space_errors(solved.plan.context)
    except ValueError as error:
        return {**quantities, "allowance": {"reason": str(error)}}
    if found.hertzian:  # half lengths are those of ellipses
        allowed |= dict.fromkeys(("a_mm", "b_mm"), allowed["area_mm2"])
    return {**quantities, "allowance": allowed}


def frictionless(pair: HalfSpacePair, solution: BoundaryElementSolution) -> dict[str, Any]:
    """Quantities of boundary elements, without stresses, nested and named as under "result" in
    summary.json, and as "grid_error" their `grid_errors`.
    """
    found = findings.of_boundary_elements(solution, pair.points, pair.contact.frame, {})
    values = compare.from_findings(found, solution.load, solution.approach)
    return {**values, "grid_error": grid_errors(found)}


def grid_errors(found: Findings) -> dict[str, float]:
    """Relative change from the coarser grids of a solution, by key; empty where it has none."""
    return {key: found.patch.scatter[name] for key, name in SCATTER.items() if found.patch.scatter}


def half_space_friction(
    solved: MeshSolution, profiles: BoundaryElementSolution | str | None
) -> NumbersByMethod | None:
    """Entry "half_space_friction" of summary.json: by method, the quantities of friction under the
    motion (rolling) or the forces (a shift) of finite elements, or {"reason": ...}. None without
    friction, where nothing touches, and off rank 0. As for the pressure, both half-spaces have the
    scene's moduli, also where a body is rigid by choice.

    profiles: half-space solution of the profiles, or the reason why it failed; None: exact Hertz is
        the pressure.
    """
    found, findings = solved.solution.friction, solved.findings
    if found is None or findings is None:
        return None
    plan, pair = solved.plan, closed_forms.tangential_pair(solved.plan.scene)
    rolling = plan.scene.rolling.prescribed

    if isinstance(profiles, str):
        return {"boundary elements": {"reason": profiles}}
    pressed = profiles or solved.ellipse
    if not (pair.like or rolling):
        return {"boundary elements": {"reason": GROWING_PATCH}}
    if isinstance(solved.ellipse, LineContact):
        return _strip(plan, found, solved.ellipse)
    out: NumbersByMethod = {
        "boundary elements": or_reason(lambda: solve_by_boundary_elements(plan, found, pressed))
    }
    if not pair.like or not closed_forms.coulomb(plan.scene):
        return out
    if rolling:
        name = "FASTSIM" if findings.hertzian else "FASTSIM (equal ellipses)"
        patches = shearing.patches(plan.context.half_spaces, pressed, CELLS[1])
        out[name] = or_reason(
            lambda: fastsim(patches, found.friction_limit, pair, found.rigid_motion)
        )
    elif findings.hertzian and plan.scene.friction.uneven:
        out["Cattaneo, Mindlin"] = {"reason": UNEVEN}
    elif findings.hertzian:
        out["Cattaneo, Mindlin"] = _mindlin(plan, found, solved.ellipse)
    return out


def _strip(plan: Plan, found: FrictionSolution, line: LineContact) -> NumbersByMethod:
    """Quantities by method for a line contact: Carter (rolling) or Cattaneo (a shift), of unlike
    materials, or under another law than Coulomb's, boundary elements. Empty in rolling of like
    materials where the width of the strip runs across the rail.
    """
    if not (closed_forms.tangential_pair(plan.scene).like and closed_forms.coulomb(plan.scene)):
        if line.across:
            return {"boundary elements": {"reason": STRIP_ACROSS}}
        numbers = or_reason(lambda: solve_by_boundary_elements(plan, found, line))
        return {"boundary elements": numbers}
    if not plan.scene.rolling.prescribed:
        if plan.scene.friction.uneven and line.across:
            return {"Cattaneo": {"reason": UNEVEN}}
        share = float(np.hypot(*found.force) / found.friction_limit)
        return {"Cattaneo": {"stick_share": partial_slip.strip_stick_ratio(min(share, 1.0))}}
    if line.across:
        return {}
    coefficient = interface.friction_coefficient(plan.context)
    share = partial_slip.carter_share(line, coefficient, found.rigid_motion[0])
    stick, force = partial_slip.strip_stick_ratio(abs(share)), share * found.friction_limit
    wear = force * found.rigid_motion[0]
    return {"Carter": {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}}


def or_reason(method: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Result of a method, or {"reason": text} where it raises ValueError."""
    try:
        return method()
    except ValueError as error:
        return {"reason": str(error)}


def _mindlin(plan: Plan, found: FrictionSolution, ellipse: Ellipse) -> dict[str, Any]:
    """Stick share (of the area) and, of solid half-spaces under a force, shifts (mm) by Cattaneo
    and Mindlin, by the keys of summary.json.
    """
    pair = closed_forms.tangential_pair(plan.scene)
    force = min(float(np.hypot(*found.force)), found.friction_limit)
    compliances = partial_slip.initial_compliance(
        ellipse.a, ellipse.b, pair.shear_modulus, pair.poisson
    )
    share = force / found.friction_limit
    out = {"stick_share": partial_slip.ellipse_stick_ratio(share) ** 2}
    if plan.contact.solid_half_space and force:
        ways = zip(("along", "across"), found.force, compliances, strict=True)
        for way, part, compliance in ways:
            shift = partial_slip.ellipse_shift(compliance, found.friction_limit, share)
            out[f"shift_{way}_mm"] = shift * part / force
    return out


def solve_by_boundary_elements(
    plan: Plan, found: FrictionSolution, pressed: Pressed, cells: Sequence[int] = CELLS
) -> Numbers:
    """Friction quantities of half-spaces by boundary elements, by their keys in summary.json, of
    rolling scaled to the limit mu N of `found`. Raises ValueError as `shearing.on_grids`.

    plan: coefficient of friction, materials, and whether the bodies roll.
    found: solution by finite elements, of which the friction limit and the motion (rolling:
        creepages and spin) or the forces (a shift) count.
    pressed: the pressure.
    cells: numbers along each axis, the coarsest first. Numbers are extrapolated from them as those
        of finite elements; "grid_error" is the larger error of the forces by that, over mu N.
    """
    scene, pair = plan.scene, closed_forms.tangential_pair(plan.scene)
    rolling, contact = scene.rolling.prescribed, plan.contact
    sheared = shearing.on_grids(
        plan.context.half_spaces,
        pressed,
        cells,
        pair,
        Creepage(*found.rigid_motion) if rolling else Creepage(),
        (None, None) if rolling else found.force,
        rolling=rolling,
        interface=closed_forms.interface(scene),
    )
    points = plan.context.half_spaces.points
    like = rolling and pair.like
    solution = sheared.solution(points, centred=like, line=contact.line)
    numbers = friction.quantities(solution, rolling=rolling, like=pair.like, speed=None)
    keys = [LOADS[0], *AT_BORDER] if contact.line else [*LOADS, *AT_BORDER]
    keys += ["t_gamma_N"] * like
    if not rolling and contact.solid_half_space:
        keys += friction.MOTION[False][:2]
    scale = found.friction_limit / sheared.limit if rolling else 1.0  # finite bodies' normal force
    out = {key: numbers[key] * (1.0 if key in AT_BORDER else scale) for key in keys}
    error = max(numbers["grid_error"][way] for way in LOADS[:2])
    return {**out, "grid_error": error / sheared.limit}


def fastsim(
    patches: Sequence[PressedPatch], limit: float, pair: MaterialPair, motion: Sequence[float]
) -> Numbers:
    """Forces of the wheel on the rail, stick share and T-gamma of rolling patches by FASTSIM on
    ellipses with equal second moments and forces, by the keys of summary.json.

    limit: largest tangential force that friction allows, of all patches, N.
    pair: materials.
    motion: creepage along, across and spin (1/mm), at the first contact.
    Raises ValueError for an ellipse too slender.
    """
    sticks, touches = 0.0, 0.0
    total: Array = np.zeros(4)
    whole = sum(each.limit for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.limit / whole
        *forces, stick = kalker.fastsim(a, b, carried, pair.shear_modulus, linear, local)
        total = total + _work(patch, forces)
        sticks, touches = sticks + stick * a * b, touches + a * b
    known = *total[:3], sticks / touches, total @ [*motion, 1.0]
    return dict(zip((*LOADS, AT_BORDER[0], "t_gamma_N"), map(float, known), strict=True))


def linear(patches: Sequence[PressedPatch], pair: MaterialPair, motion: Sequence[float]) -> Array:
    """Forces of the wheel on the rail along, across (N) and moment about the normal at the first
    contact (N mm), (3,), of patches, by Kalker's linear theory. Each connected patch is the ellipse
    with its second moments and its force. Forces are the work of each patch's forces on the modes
    of rigid slip, summed. motion: creepage along, across and spin (1/mm). Raises ValueError for an
    ellipse too slender.
    """
    return np.sum(
        [
            _work(patch, known.forces(a, b, pair.shear_modulus, local))[:3]
            for patch, a, b, known, local in _ellipses(patches, pair, motion)
        ],
        axis=0,
    )


def _ellipses(
    patches: Sequence[PressedPatch], pair: MaterialPair, motion: Sequence[float]
) -> Iterator[tuple[PressedPatch, float, float, Coefficients, Creepage]]:
    """For each connected patch: the patch, its semi-axes a and b (mm), Kalker's coefficients, and
    the mean creepage and the spin in its own tangent plane. Raises ValueError for an axis ratio
    above 20 (SLENDER) or below 1/20.
    """
    moved = np.array([*motion, 1.0])
    for patch in (part for each in patches for part in each.parts()):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        along, across = moved @ patch.mean_modes
        local = Creepage(along, across, float(moved @ patch.spin))
        yield patch, a, b, kalker.coefficients(a / b, pair.poisson), local


def _work(patch: PressedPatch, forces: Sequence[float]) -> Array:
    """Work (4,) of a patch's forces along, across (N) and moment about its own normal (N mm) on
    each mode of rigid slip: N, N, N mm for the spin, and N for the wheel's own rotation.
    """
    along, across, moment = forces
    return np.asarray(patch.mean_modes @ [along, across] + moment * patch.spin)
