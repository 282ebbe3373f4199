"""Half-spaces with friction beside a solution: boundary elements, FASTSIM, closed forms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from railhead.planning.references import closed_forms
from railhead.run.mesh_solution import MeshSolution
from railhead.run.references import equal_ellipses, rolling_patches
from railhead.run.references.rolling_patches import Patch
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import partial_slip, rolling
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    solve_for_forces,
)
from railhead.theory.friction.tangential import Pair

if TYPE_CHECKING:
    from railhead.solver.solution import FrictionSolution

Array = NDArray[np.float64]
CELLS, STRIP_CELLS = (32, 64), (128, 256)  # of boundary elements, coarse and fine
STRIP_KEYS = ("force_along_N", "stick_share", "traction_max_MPa", "t_gamma_N", "grid_error")
LIKE = 1e-9  # |K/G| that is rounding
GROWING_PATCH = "unlike bodies slip while the patch grows, which is not followed there"
STRIP_ACROSS = "a strip of unlike bodies across the rail"
SEVERAL = "how several patches share a force depends on the compliance of the bodies"

Numbers = dict[str, float]
"""Keys of "friction" in summary.json with their values."""
NumbersByMethod = dict[str, dict[str, Any]]
"""The same, or a "reason", by the name of a method."""


@dataclass(frozen=True, kw_only=True)
class FrictionCase:
    """A solution with friction, as input of other methods.

    solution: forces and rigid motion (creepages and spin, or shifts and turn) of finite elements.
    coefficient: coefficient of friction.
    pair: materials of both bodies.
    rolling: whether the bodies roll; otherwise they are shifted.
    half_space_shift: whether the shift is that of half-spaces; the shift of other bodies depends on
        their supports.
    """

    solution: FrictionSolution
    coefficient: float
    pair: Pair
    rolling: bool
    half_space_shift: bool

    @property
    def like(self) -> bool:
        """Whether both materials have no mismatch, so that tractions do not change the pressure."""
        return abs(self.pair.mismatch) < LIKE


def half_space_friction(
    solved: MeshSolution, profiles: Solution | str | None
) -> NumbersByMethod | None:
    """Entry "half_space_friction" of summary.json: by method, the quantities of friction under the
    motion (rolling) or the forces (a shift) of finite elements, or {"reason": ...}. None without
    friction.

    profiles: half-space solution of the profiles, or the reason why it failed, or None.
    """
    found = solved.solution.friction
    if found is None or solved.findings is None:
        return None
    scene, contact = solved.plan.scene, solved.plan.contact
    case = FrictionCase(
        solution=found,
        coefficient=scene.friction.coefficient,
        pair=closed_forms.tangential_pair(scene),
        rolling=scene.rolling.prescribed,
        half_space_shift=contact.half_space and not solved.plan.section,
    )
    if not (case.like or case.rolling):
        return {"boundary elements": {"reason": GROWING_PATCH}}
    if isinstance(solved.ellipse, LineContact):
        return _strip(case, solved.ellipse)
    return _solid(case, solved, solved.ellipse, profiles)


def _strip(case: FrictionCase, line: LineContact) -> NumbersByMethod:
    """Quantities by method for a line contact: Carter, Cattaneo or boundary elements."""
    found, strip = case.solution, line.strip
    if not case.like and line.across:
        return {"boundary elements": {"reason": STRIP_ACROSS}}
    if not case.like:
        numbers = solve_by_boundary_elements(
            case, lambda cells: rolling_patches.strip(strip, cells), STRIP_CELLS
        )
        return {"boundary elements": {key: numbers[key] for key in STRIP_KEYS if key in numbers}}
    if not case.rolling:
        share = float(np.hypot(*found.force) / found.friction_limit)
        return {"Cattaneo": {"stick_share": partial_slip.strip_stick_ratio(min(share, 1.0))}}
    if line.across:
        return {}
    rolled = partial_slip.Carter.from_creepage(strip, case.coefficient, found.rigid_motion[0])
    stick, force = rolled.stick_half_width / strip.b, rolled.share * found.friction_limit
    wear = force * found.rigid_motion[0]
    return {"Carter": {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}}


def _solid(
    case: FrictionCase, solved: MeshSolution, ellipse: Ellipse, profiles: Solution | str | None
) -> NumbersByMethod:
    """Quantities by method for a point contact: boundary elements, and FASTSIM or Cattaneo and
    Mindlin.
    """
    assert solved.findings is not None
    hertzian, load = solved.findings.hertzian, solved.solution.load

    def patches(cells: int) -> Sequence[Patch]:
        """The patches on a grid of `cells` cells along each axis."""
        return rolling_patches.patches(
            solved.plan.contact,
            ellipse,
            hertzian=hertzian,
            load=load,
            cells=cells,
            profiles=profiles,
        )

    out: NumbersByMethod = {
        "boundary elements": _or_reason(lambda: solve_by_boundary_elements(case, patches, CELLS))
    }
    if case.like and case.rolling:
        name = "FASTSIM" if hertzian else "FASTSIM (equal ellipses)"
        out[name] = _or_reason(lambda: _fastsim(case, patches(CELLS[1])))
    elif case.like and hertzian:
        out["Cattaneo, Mindlin"] = _mindlin(case, ellipse)
    return out


def _or_reason(method: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Result of a method, or {"reason": text} where it raises ValueError."""
    try:
        return method()
    except ValueError as error:
        return {"reason": str(error)}


def _fastsim(case: FrictionCase, patches: Sequence[Patch]) -> dict[str, Any]:
    """Forces, stick share and T-gamma by FASTSIM, by the keys of summary.json."""
    found = case.solution
    rolled = equal_ellipses.fastsim(patches, found.friction_limit, case.pair, found.rigid_motion)
    return {**by_key(rolled.forces, rolled.stick_share), "t_gamma_N": rolled.t_gamma}


def _mindlin(case: FrictionCase, ellipse: Ellipse) -> dict[str, Any]:
    """Stick share and, of half-spaces, shifts (mm) by Cattaneo and Mindlin, by the keys of
    summary.json.
    """
    found, pair = case.solution, case.pair
    force = min(float(np.hypot(*found.force)), found.friction_limit)
    compliances = partial_slip.initial_compliance(
        ellipse.a, ellipse.b, pair.shear_modulus, pair.poisson
    )
    ways = [partial_slip.CattaneoMindlin(found.friction_limit, each) for each in compliances]
    out = {"stick_share": ways[0].stick_ratio(force) ** 2}
    if case.half_space_shift and force:
        for way, part, known in zip(("along", "across"), found.force, ways, strict=True):
            out[f"shift_{way}_mm"] = known.approach(force) * part / force
    return out


def solve_by_boundary_elements(
    case: FrictionCase, patches: Callable[[int], Sequence[Patch]], cells: tuple[int, int]
) -> Numbers:
    """Friction quantities of half-spaces by boundary elements, by their names in summary.json.

    patches: maps a number n to the pressed patches on grids of n cells along each axis. cells:
        coarse and fine n. Bodies of the same material are solved on the fine grid alone. For others
        both grids are solved and extrapolated; "grid_error" is the change from fine to
        extrapolated, of forces over mu N, of a shift over its length.
    """
    coarse, fine = cells
    found = _on_grid(case, patches(fine))
    if case.like:
        return found
    other = _on_grid(case, patches(coarse))
    better = {name: 2 * value - other[name] for name, value in found.items()}
    better["stick_share"] = min(max(better["stick_share"], 0.0), 1.0)
    ways = ("shift_along_mm", "shift_across_mm")
    size = float(np.linalg.norm([better.get(way, 0.0) for way in ways]))
    if case.rolling:
        ways, size = ("force_along_N", "force_across_N"), case.solution.friction_limit
    changes = [abs(better[way] - found[way]) for way in ways if way in found]
    return {**better, "grid_error": max(changes, default=0.0) / (size or 1.0)}


def by_key(forces: Array, stick: float) -> Numbers:
    """Forces along, across (N) and moment (N mm), (3,), and stick share by the keys of "friction"
    in summary.json.
    """
    along, across, moment = forces
    return {
        "force_along_N": float(along),
        "force_across_N": float(across),
        "moment_Nmm": float(moment),
        "stick_share": float(stick),
    }


def _on_grid(case: FrictionCase, patches: Sequence[Patch]) -> Numbers:
    """Quantities of friction by boundary elements on given patches, by the keys of summary.json.
    Raises ValueError for several patches under a shift.
    """
    if len(patches) > 1 and not case.rolling:
        raise ValueError(SEVERAL)
    found, limit = case.solution, case.coefficient * sum(each.pressed.force for each in patches)
    scale = found.friction_limit / limit  # the normal forces differ by what the finite bodies do
    along, across = (force / scale for force in found.force)

    def shear(body: HalfSpaceFriction) -> TangentialSolution:
        """Tractions of one patch at the creepage or under the forces of the solution."""
        if case.rolling:
            return body.solve(Creepage(*found.rigid_motion))
        return solve_for_forces([body], Creepage(), along=along, across=across)[0]

    sheared = [
        rolling.solve_dissimilar(
            each.pressed,
            case.pair,
            case.coefficient,
            shear,
            rolling=case.rolling,
            modes=each.modes,
        )
        for each in patches
    ]
    forces = scale * np.sum([each.forces for each in sheared], axis=0)
    sticks, touches = np.sum([each.areas for each in sheared], axis=0)
    largest = max(float(np.linalg.norm(each.traction, axis=0).max()) for each in sheared)
    out = by_key(forces, sticks / touches) | {"traction_max_MPa": largest}
    if case.rolling and case.like:
        out["t_gamma_N"] = scale * sum(each.t_gamma for each in sheared)
    elif case.half_space_shift:
        shift = sheared[0].creepage
        out |= {"shift_along_mm": scale * shift.along, "shift_across_mm": scale * shift.across}
    return out
