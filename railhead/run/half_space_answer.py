"""Half-spaces answer in the place of finite bodies, or beside them: exact Hertz, or boundary
elements.

Friction is Kalker's exact theory at the scene's own creepages or forces; beside finite bodies under
the motion that finite elements found, and by closed forms.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from railhead.contact import closed_forms, placed_bodies
from railhead.half_spaces import shearing
from railhead.half_spaces.allowance import added_stress
from railhead.half_spaces.pressing import FINE, HalfSpacePair, Pressed
from railhead.half_spaces.shearing import Motion, Sheared
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import Findings
from railhead.postprocess.friction import AT_BORDER, LOADS, MOTION, quantities
from railhead.postprocess.patch import compare, half_space
from railhead.run.estimates import FRICTION_SHARES, Parts, friction_errors, of_strain
from railhead.run.mesh_solution import Answered, MeshSolution, read_friction
from railhead.run.progress import Progress
from railhead.scene.quantities import SCATTER, numeric_values
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction import partial_slip
from railhead.theory.friction.rolling import CELLS, Creepage
from railhead.theory.friction.solution import FrictionSolution

DRAWN = 0.5  # mm from the end of a drawn section: its corner lies between two points
# Relative error of stresses over half width times curvature of a body, where the pressure is
# largest: 0.26 measured.
CURVED = 0.3
# Error that the curvature of bodies adds to that of the area in forces, over half length times sum
# of the curvatures: of 33 crowned pairs 98 % of forces, moments and T-gamma are then within the
# estimates of both methods. Where b < a/4 it is up to 0.1.
CURVED_SHEAR = 0.03
# Error of pressure and area of unlike bodies over what tractions change of the peak, by whether the
# contact is a line, whose pressure stays Hertz's. From 64 to 256 cells 0.5 to 1.6 % were measured.
COUPLED = {False: 0.05, True: 1.25}
STRESSES = {"tau_max_MPa": "tau", "von_mises_max_MPa": "von_mises"}
GROWING_PATCH = "unlike bodies slip while the patch grows, which is not followed there"
STRIP_ACROSS = "a strip of unlike bodies across the rail"
UNEVEN = "the formula has one coefficient of friction"

Numbers = dict[str, float]
"""Keys of "friction" in summary.json with their values."""
NumbersByMethod = dict[str, dict[str, Any]]
"""The same, or a "reason", by the name of a method."""


@dataclass(frozen=True, kw_only=True)
class HalfSpaceSolution(Answered):
    """A scene solved between half-spaces, and the quantities read from the solution; all of it on
    every rank.

    ellipse: exact Hertz for the curvatures at the first contact, an ellipse or a line contact,
        under the load or approach of the scene.
    load: vertical load that pressure and tractions carry, N; 0 without a solution.
    approach: of distant points, along the vertical, mm; 0 without a solution.
    reason: why there is no solution; empty where there is one.
    error_parts: relative error estimates by key of summary.json, in parts that add up: what finite
        bodies would change, and the error of the grid. Empty without a solution.
    pressed: the pressure; None without a solution.
    sheared: the tractions on it; None without friction.
    elastic_reference: the same scene without friction; None where it has none.
    seconds: of the solution and of its reading, s.
    fields, unloaded_fields, residual_state, mirrors: None or empty; there is no mesh, no yield is
        simulated, and nothing is cut.
    """

    ellipse: Hertz
    load: float = 0.0
    approach: float = 0.0
    reason: str = ""
    error_parts: Parts = field(default_factory=dict)
    pressed: Pressed | None = None
    sheared: Sheared | None = None
    elastic_reference: HalfSpaceSolution | None = None
    seconds: float = 0.0
    fields: ClassVar[None] = None
    unloaded_fields: ClassVar[None] = None
    residual_state: ClassVar[None] = None
    mirrors: ClassVar[tuple[Any, ...]] = ()

    @property
    def friction(self) -> FrictionSolution | None:
        """Tractions at the cells that touch; None without friction."""
        return None if self.sheared is None else self.sheared.solution


Solved = MeshSolution | HalfSpaceSolution
"""A solution by finite elements, or by half-spaces in their place."""


def solve(plan: Plan, progress: Progress) -> HalfSpaceSolution:
    """Solve a plan without finite bodies; every MPI process does all of it. Yield is not simulated.
    Where boundary elements fail, the solution has no result but a reason.
    """
    start = time.perf_counter()
    progress.stage("solving half-spaces")
    try:
        found = _solve(plan)
    except ValueError as error:
        found = HalfSpaceSolution(
            plan=plan, ellipse=plan.hertz, reason=f"boundary elements: {error}"
        )
    return replace(found, seconds=time.perf_counter() - start)


def _solve(plan: Plan) -> HalfSpaceSolution:
    """The solution of a plan; its elastic reference is solved, too, where there is friction. Raises
    ValueError where boundary elements fail, or where pressure and tractions find no balance.
    """
    scene, pair = plan.scene, plan.context.half_spaces
    alone = pair.pressure(scene.load)
    found = _read(plan, alone)
    if plan.effects["friction"].on:
        pressed, sheared = shearing.answer(pair, alone)
        if not (pair.materials.like or plan.contact.line):
            pressed = sheared.pressure
        found = replace(_read(plan, pressed, sheared), elastic_reference=found)
    return replace(found, error_parts=_with_tractions(found, _error_parts(found)))


def _read(plan: Plan, pressed: Pressed, sheared: Sheared | None = None) -> HalfSpaceSolution:
    """The solution of a pressure, with tractions or without, and the quantities read from it; its
    load is what both carry. Load and approach are those along the vertical.
    """
    frame, hertz, points = plan.contact.frame, plan.hertz, plan.context.half_spaces.surface.points
    asked = plan.scene.asks("stresses" if sheared is None else "friction_stresses")
    stressed = plan.poisson_ratios if asked else {}
    poisson = stressed if sheared is None else {}
    if isinstance(pressed, BoundaryElementSolution):
        found = half_space.of_boundary_elements(pressed, points, frame, poisson)
        found = replace(found, edge_distance=_edge_distance(plan, pressed))
    else:
        found = half_space.of_hertz(hertz, frame, poisson, section=plan.plane_model)
    load, forces = pressed.load, dict[str, Any]()
    if sheared is not None and sheared.coarse is not None:
        if stressed:
            grids = sheared.stressed, sheared.coarse.stressed
            found = half_space.with_tractions(found, *grids, points, stressed)
        found, forces = read_friction(plan, found, sheared.solution)
        load -= sheared.upwards
    return HalfSpaceSolution(
        plan=plan,
        ellipse=hertz,
        load=load,
        approach=pressed.approach,
        findings=found,
        forces=forces,
        pressed=pressed,
        sheared=sheared,
    )


def _edge_distance(plan: Plan, pressed: BoundaryElementSolution) -> float:
    """Smallest distance of a patch, along the developed surface, from an end of the tread or of the
    section below it, over the smaller half length of the most loaded patch; infinite for half-
    spaces. Ends of drawn sections count from where they may be (DRAWN).
    """
    if plan.context.half_spaces.exact:
        return math.inf
    developed, room = plan.context.half_spaces.developed, math.inf
    inside = (DRAWN if plan.scene.rail.sections else 0.0) * np.array([1, -1])
    for patch in pressed.patches:
        below = developed.at(patch.centroid[1])
        tread = placed_bodies.tread(plan.contact, below.touch)
        low, high = np.clip(tread, *(np.array(below.ends) + inside)) + below.middle
        s = patch.s[patch.pressure.any(axis=0)]
        room = min(room, s[0] - low, high - s[-1])
    return float(room) / min(max(pressed.patches, key=lambda each: each.force).half_extents)


def _error_parts(solved: HalfSpaceSolution) -> Parts:
    """Error estimates of all quantities of a solution that have one. Exact Hertz between half-
    spaces has no error; the approach by boundary elements, and depths, have no estimate. A patch
    that is no ellipse has none of its half lengths.
    """
    plan, pressed, found = solved.plan, solved.pressed, solved.findings
    assert found is not None
    if not isinstance(pressed, BoundaryElementSolution):
        exact = numeric_values(solved.result)
        exact.pop(plan.contact.prescribed_length or "", None)
        return {key: {"exact": 0.0} for key in exact}
    grid = grid_errors(found)
    ends = not plan.contact.half_space
    expected = plan.context.half_space_errors if ends else {}
    like = dict.fromkeys(STRESSES if found.largest else (), "max_MPa")
    like |= {"max_MPa": "max_MPa", "area_mm2": "area_mm2"}
    if found.hertzian:
        like |= {"a_mm": "area_mm2", "b_mm": "area_mm2"}
    parts = {}
    for key, other in like.items():
        own = key if key in grid else other
        parts[key] = {**expected.get(other, {}), "grid": grid.get(own, 0.0)}
        parts[key].pop("total", None)
        if ends and (moved := plan.context.sideways_change):
            parts[key]["sideways"] = moved
        if plan.profile_error:
            parts[key]["profile"] = plan.profile_error
    if not (ends and found.largest):
        return parts
    more = added_stress(plan.context.half_spaces, plan.deformable, pressed)
    top = max(found.patch.each, key=lambda each: each.max_pressure)
    half = top.b * math.cos(top.angle) / 2
    y = top.centre[1] + half * np.array([-1.0, 0.0, 1.0])
    profiles = plan.contact.cross_profiles
    curvatures = [np.abs(each.curvature(y - shift)) for _, each, shift in profiles]
    for key, name in STRESSES.items():
        highest = max(getattr(each, name).value for each in found.largest.values())
        parts[key]["faces"] = more / highest
        parts[key]["curvature"] = CURVED * float(np.nanmax(curvatures)) * top.b
    return parts


def _with_tractions(solved: HalfSpaceSolution, parts: Parts) -> Parts:
    """Error estimates of a solution: those of its pressure, and where there are tractions what they
    add, and those of friction.
    """
    sheared, found = solved.sheared, solved.findings
    if sheared is None or found is None:
        return parts
    for key in STRESSES if found.largest else ():
        parts[key] = {**parts[key], "tractions": found.surface_error[key]}
    # Tractions of several patches may cancel out, what bodies change of each does not.
    area, pressure = (sum(parts[key].values()) for key in ("area_mm2", "max_MPa"))
    area = max(area, pressure)  # a small patch may carry most of the load
    plan, rubs, strain = solved.plan, sheared.solution, dict[str, float]()
    if plan.contact.curved_solid:
        area += CURVED_SHEAR * _half_over_radius(plan, found)
        if sheared.rolling and sheared.pair.materials.like:
            strain = of_strain(plan, rubs, found, solved.ellipse.approach)
    for key, (bodies, grid) in friction_errors(solved, rubs, area, pressure).items():
        parts[key] = {"bodies": bodies, "grid": grid}
        if key in strain:
            over = solved.forces[key]
            over = rubs.friction_limit if key in FRICTION_SHARES else abs(over)
            parts[key]["strain"] = strain[key] / over
    if not sheared.pair.materials.like:
        before = max(each.pressed.max_pressure for each in sheared.patches)
        change = abs(max(each.max_pressure for each, _ in sheared.stressed) / before - 1)
        for key in parts.keys() & {"max_MPa", "mean_MPa", "area_mm2", "a_mm", "b_mm"}:
            parts[key] = {**parts[key], "tractions": COUPLED[solved.plan.contact.line] * change}
    return parts


def _half_over_radius(plan: Plan, found: Findings) -> float:
    """Larger half length of the most loaded patch times the sum of the curvatures of both surfaces,
    along and across, in magnitude.
    """
    top = max(found.patch.each, key=lambda each: each.max_pressure)
    y, radius = top.centre[1], plan.scene.wheel.rolling_radius
    across = [
        abs(float(each.curvature(y - shift))) for _, each, shift in plan.contact.cross_profiles
    ]
    return max(top.a, top.b) * (sum(across) + 1 / radius)


def beside(solved: MeshSolution) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Entries "half_space" and "half_space_friction" of summary.json: what half-spaces have under
    the load of finite elements, and under their motion or tangential forces. Each is None where
    there is nothing to compare: where nothing touches, and off rank 0; the first between half-
    spaces and of a line, whose pressure is exact Hertz; the second without friction. {"reason":
    ...} where boundary elements fail.
    """
    plan, findings, rubbed = solved.plan, solved.findings, solved.solution.friction
    if findings is None:
        return None, None
    pair, profiles = plan.context.half_spaces, None
    pressed: Pressed = solved.ellipse
    if not pair.exact:
        try:
            pressed = found = pair.pressed(plan.scene.load or solved.solution.load, FINE)
        except ValueError as error:
            reason = {"reason": f"boundary elements: {error}"}
            return reason, None if rubbed is None else {"boundary elements": reason}
        profiles = {**frictionless(pair, found), "allowance": _allowed(plan, findings)}
    if rubbed is None:
        return profiles, None
    return profiles, friction_beside(
        pair, rubbed, pressed, solved.ellipse, hertzian=findings.hertzian
    )


def _allowed(plan: Plan, findings: Findings) -> dict[str, Any]:
    """By quantity of a patch, what half-spaces leave out, relative, in parts; or {"reason": ...}.
    Half lengths are those of ellipses.
    """
    try:
        allowed = plan.context.half_space_errors
    except ValueError as error:
        return {"reason": str(error)}
    more = ("a_mm", "b_mm") if findings.hertzian else ()
    return {**allowed, **dict.fromkeys(more, allowed["area_mm2"])}


def friction_beside(
    pair: HalfSpacePair,
    found: FrictionSolution,
    pressed: Pressed,
    ellipse: Hertz,
    *,
    hertzian: bool,
) -> NumbersByMethod:
    """By method, the quantities of friction under the motion (rolling) or the forces (a shift) of
    finite elements, or {"reason": ...}. As for the pressure, both half-spaces have the scene's
    moduli, also where a body is rigid by choice.

    found: solution by finite elements. pressed: the pressure between half-spaces.
    ellipse: exact Hertz under the load of finite elements. hertzian: whether their patch is its.
    """
    scene, materials = pair.contact.scene, pair.materials
    rolling = scene.rolling.prescribed
    if not (materials.like or rolling):
        return {"boundary elements": {"reason": GROWING_PATCH}}
    simple = materials.like and closed_forms.coulomb(scene)
    uneven = {"reason": UNEVEN} if scene.friction.uneven else None
    if isinstance(ellipse, LineContact):
        if simple and rolling:
            return {} if ellipse.across else {"Carter": _carter(pair, found, ellipse)}
        if simple:
            return {"Cattaneo": (ellipse.across and uneven) or _mindlin(pair, found, ellipse)}
        if ellipse.across:
            return {"boundary elements": {"reason": STRIP_ACROSS}}
    numbers: dict[str, Any]
    try:
        numbers = boundary_elements(pair, found, pressed)
    except ValueError as error:
        numbers = {"reason": str(error)}
    out: NumbersByMethod = {"boundary elements": numbers}
    if simple and hertzian and not rolling:
        out["Cattaneo, Mindlin"] = uneven or _mindlin(pair, found, ellipse)
    return out


def _carter(pair: HalfSpacePair, found: FrictionSolution, line: LineContact) -> Numbers:
    """Force along the rail, stick share and dissipation of a line contact that rolls, by Carter, by
    the keys of summary.json.
    """
    coefficient = float(pair.surface.friction_coefficient(np.zeros(1))[0])
    share = partial_slip.carter_share(line, coefficient, found.rigid_motion[0])
    stick, force = partial_slip.strip_stick_ratio(abs(share)), share * found.friction_limit
    wear = force * found.rigid_motion[0]
    return {"force_along_N": force, "stick_share": stick, "t_gamma_N": wear}


def _mindlin(pair: HalfSpacePair, found: FrictionSolution, hertz: Hertz) -> Numbers:
    """Stick share (of the area) and, of solid half-spaces under a force, shifts (mm) by Cattaneo
    and Mindlin, by the keys of summary.json.
    """
    limit = found.friction_limit
    force = min(float(np.hypot(*found.force)), limit)
    if not isinstance(hertz, Ellipse):
        return {"stick_share": partial_slip.strip_stick_ratio(force / limit)}
    out = {"stick_share": partial_slip.ellipse_stick_ratio(force / limit) ** 2}
    if pair.contact.solid_half_space and force:
        materials = pair.materials
        compliances = partial_slip.initial_compliance(
            hertz.a, hertz.b, materials.shear_modulus, materials.poisson
        )
        ways = zip(("along", "across"), found.force, compliances, strict=True)
        for way, part, compliance in ways:
            shift = partial_slip.ellipse_shift(compliance, limit, force / limit)
            out[f"shift_{way}_mm"] = shift * part / force
    return out


def boundary_elements(
    pair: HalfSpacePair, found: FrictionSolution, pressed: Pressed, cells: Sequence[int] = CELLS
) -> Numbers:
    """Friction quantities of half-spaces by boundary elements, by their keys in summary.json, of
    rolling scaled to the limit mu N of `found`. Raises ValueError as `shearing.sheared`.

    found: solution by finite elements, of which the friction limit and the motion (rolling:
        creepages and spin) or the forces (a shift) count.
    pressed: the pressure.
    cells: numbers along each axis, the coarsest first. Numbers are extrapolated from them as those
        of finite elements; "grid_error" is the larger error of the forces by that, over mu N.
    """
    contact, rolling = pair.contact, pair.contact.scene.rolling.prescribed
    along, across = found.force
    moves = Motion(along=along, across=across, rolling=False)
    if rolling:
        moves = Motion(creepage=Creepage(*found.rigid_motion))
    sheared = shearing.sheared(pair, pressed, moves, cells)
    like = pair.materials.like
    numbers = quantities(sheared.solution, rolling=rolling, like=like, speed=None)
    keys = [LOADS[0], *AT_BORDER] if contact.line else [*LOADS, *AT_BORDER]
    keys += ["t_gamma_N"] * (rolling and like)
    if not rolling and contact.solid_half_space:
        keys += MOTION[False][:2]
    scale = found.friction_limit / sheared.limit if rolling else 1.0  # finite bodies' normal force
    out = {key: numbers[key] * (1.0 if key in AT_BORDER else scale) for key in keys}
    error = max(numbers["grid_error"][way] for way in LOADS[:2])
    return {**out, "grid_error": error / sheared.limit}


def frictionless(pair: HalfSpacePair, solution: BoundaryElementSolution) -> dict[str, Any]:
    """Quantities of boundary elements, without stresses, nested and named as under "result" in
    summary.json, and as "grid_error" their `grid_errors`.
    """
    found = half_space.of_boundary_elements(solution, pair.surface.points, pair.contact.frame, {})
    values = compare.from_findings(found, solution.load, solution.approach)
    return {**values, "grid_error": grid_errors(found)}


def grid_errors(found: Findings) -> dict[str, float]:
    """Relative change from the coarser grids of a solution, by key; empty where it has none."""
    return {key: found.patch.scatter[name] for key, name in SCATTER.items() if found.patch.scatter}
