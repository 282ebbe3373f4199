"""Half-spaces answer in the place of finite bodies: exact Hertz, or boundary elements."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from railhead.planning import effects
from railhead.planning.context import PostSolveVerdict
from railhead.planning.effects import assumptions, shape
from railhead.planning.effects.interface import unlike
from railhead.planning.plan import Plan
from railhead.planning.references import boundary_elements
from railhead.planning.references.allowance import added_stress
from railhead.postprocess import compare, friction, half_space
from railhead.postprocess.findings import Findings
from railhead.run.mesh_solution import MeshSolution
from railhead.run.progress import Progress
from railhead.run.quantities import numeric_values
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.elastic.contacts import Hertz

if TYPE_CHECKING:
    from railhead.solver.solution import FrictionSolution

CELLS = 128
TURNS, BALANCE = 12, 1e-6  # between pressing and shearing; of the load
CURVED = 0.3  # relative error of stresses over half width times curvature of a body: 0.26 measured
FORCES = "force_along_N", "force_across_N"
STRESSES = "tau_max_MPa", "von_mises_max_MPa"

Parts = dict[str, dict[str, float]]
"""Relative error of quantities by their keys in summary.json, in parts that add up."""


@dataclass(frozen=True, kw_only=True)
class HalfSpaceSolution:
    """A scene solved between half-spaces, and the quantities read from the solution.

    plan: the plan that was solved.
    ellipse: exact Hertz under the load of the solution, an ellipse or a line contact.
    reason: why there is no solution; empty where there is one.
    findings: patch, pressure and stresses; None without a solution.
    result: "result" of summary.json; None without a solution.
    error_parts: error estimates: what finite bodies would change, and the error of the grid.
    friction: tractions; None without friction.
    other_friction: quantities of friction by other methods, as "half_space_friction" of
        summary.json.
    elastic_reference: the same scene without friction; None where it has none.
    seconds: of the solution and of its reading.
    """

    plan: Plan
    ellipse: Hertz
    reason: str = ""
    findings: Findings | None = None
    result: dict[str, Any] | None = None
    error_parts: Parts = field(default_factory=dict)
    friction: FrictionSolution | None = None
    other_friction: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    elastic_reference: HalfSpaceSolution | None = None
    seconds: float = 0.0
    fields: ClassVar[None] = None
    residual_state: ClassVar[None] = None

    @property
    def load(self) -> float:
        """Vertical load, N; 0 without a solution."""
        return 0.0 if self.result is None else float(self.result["load_N"])

    @property
    def after(self) -> dict[str, PostSolveVerdict]:
        """Verdict of the solution on each effect of the plan by name; empty without a solution."""
        if self.findings is None:
            return {}
        return effects.check(self.plan.context, self.plan.effects, self.findings)


Solved = MeshSolution | HalfSpaceSolution


def solve(plan: Plan, progress: Progress) -> HalfSpaceSolution:
    """Solve a plan without finite bodies; every MPI process does all of it. Where boundary elements
    fail, the solution has no result but a reason.
    """
    start = time.perf_counter()
    progress.stage("solving half-spaces")
    try:
        found = _solve(plan)
    except ValueError as error:
        found = HalfSpaceSolution(
            plan=plan, ellipse=plan.estimate, reason=f"boundary elements: {error}"
        )
    return replace(found, seconds=time.perf_counter() - start)


def _solve(plan: Plan) -> HalfSpaceSolution:
    """The solution of a plan. With friction the pressure carries what the tractions leave of the
    load: both are solved in turn until the load is met to BALANCE of it. Raises ValueError where
    boundary elements fail, or where pressure and tractions find no balance.
    """
    load = plan.scene.load
    plain, profiles = _pressed(plan, load)
    frictionless = plain
    if not plan.effects["friction"].on:
        return plain
    _, _, across = plan.scene.tangential_forces
    if load is not None and across:  # what a prescribed force carries is known
        angle = plan.contact.touch.angle
        plain, profiles = _pressed(plan, load + across * math.sin(angle))
    for _ in range(TURNS):
        found = _rubbed(plain, profiles)
        if load is None or abs(found.load - load) <= BALANCE * load:
            return replace(found, elastic_reference=frictionless)
        if found.load <= 0:
            break
        plain, profiles = _pressed(plan, plain.load * load / found.load)
    raise ValueError("no pressure balances the load beside the tractions")


def _pressed(plan: Plan, load: float | None) -> tuple[HalfSpaceSolution, Solution | None]:
    """The frictionless solution under a vertical load (N), None for the approach of the scene, with
    the boundary elements of its profiles. Raises ValueError where these fail.
    """
    contact, hertz = plan.contact, plan.estimate
    cosine = math.cos(contact.touch.angle)
    poisson = plan.poisson_ratios
    if contact.half_space:
        profiles, grid = None, {}
        found = half_space.of_hertz(hertz, contact.frame, poisson, section=plan.section)
        pressed, approach = hertz.load * cosine, hertz.approach / cosine
    else:
        profiles = boundary_elements.solve(contact, hertz, load, CELLS)
        points = boundary_elements.develop(contact).points
        values = compare.from_half_space(profiles, points, contact.touch.angle)
        found = half_space.of_boundary_elements(profiles, values, points, contact.frame, poisson)
        found = replace(found, edge_distance=_edge_distance(plan, found))
        pressed, approach, grid = profiles.load, profiles.approach, values.get("grid_error", {})
    result = compare.from_findings(found, pressed, approach)
    plain = HalfSpaceSolution(
        plan=plan,
        ellipse=hertz,
        findings=found,
        result=result,
        error_parts=_error_parts(plan, result, grid, profiles, hertzian=found.hertzian),
    )
    return plain, profiles


def _edge_distance(plan: Plan, found: Findings) -> float:
    """Distance across of the patches from the nearest edge of a profile, over the smaller half
    length of the most loaded one.
    """
    patch, frame = found.patch, found.frame
    across = [frame.place(float(x), float(s))[1] for line in patch.outlines for x, s in line]
    room = [abs(end - y) for end in assumptions.edges(plan.context) for y in across]
    return min(room) / min(patch.a, patch.b)


def _error_parts(
    plan: Plan,
    result: Mapping[str, Any],
    grid: Mapping[str, float],
    profiles: Solution | None,
    *,
    hertzian: bool,
) -> Parts:
    """Error estimates of all quantities that have one. Exact Hertz between half-spaces has no
    error; the approach of bodies that end, and depths, have no estimate.

    grid: errors of the grid by key. profiles: boundary elements; None between half-spaces.
    hertzian: whether the patch is nearly an ellipse.
    """
    if profiles is None:
        exact = numeric_values(result)
        exact.pop(plan.contact.prescribed_length or "", None)
        return {key: {"exact": 0.0} for key in exact}
    expected = shape.half_space_errors(plan.context)
    like = dict.fromkeys(STRESSES, "max_MPa") | {"max_MPa": "max_MPa", "area_mm2": "area_mm2"}
    if hertzian:
        like |= {"a_mm": "area_mm2", "b_mm": "area_mm2"}
    parts = {}
    for key, other in like.items():
        own = key if key in grid else other
        parts[key] = {**expected[other], "grid": grid.get(own, 0.0)}
        del parts[key]["total"]
        if plan.profile_error:
            parts[key]["profile"] = plan.profile_error
    more, touch = added_stress(plan.contact, plan.deformable, profiles), plan.contact.touch
    curvature = max(abs(touch.rail_curvature), abs(touch.wheel_curvatures[1]))
    for key in STRESSES:
        parts[key]["faces"] = more / result["stress"][key]
        parts[key]["curvature"] = CURVED * curvature * result["patch"]["b_mm"]
    return parts


def _rubbed(plain: HalfSpaceSolution, profiles: Solution | None) -> HalfSpaceSolution:
    """A solution with the friction of its plan; its load is what pressure and tractions carry.
    Raises ValueError where tractions are not found.
    """
    from railhead.run import half_space_friction

    plan, scene = plain.plan, plain.plan.scene
    assert plain.findings is not None and plain.result is not None
    found, result = plain.findings, plain.result
    solved = half_space_friction.solve(plan, profiles, result["load_N"])
    tractions = friction.quantities(
        solved.solution,
        rolling=scene.rolling.prescribed,
        like=not unlike(scene),
        speed=scene.rolling.speed,
        cycle=False,
        patches=np.array([each.centre for each in found.patch.each] or [found.frame.origin]),
    )
    found = half_space.with_tractions(
        found,
        solved.windows,
        partial(half_space_friction.surface, plan),
        plan.poisson_ratios,
        solved.tractions,
        solved.solution,
    )
    upwards = solved.solution.weights @ solved.solution.traction[:, 2]
    found = replace(found, dissipated=tractions.get("t_gamma_N", math.nan))
    parts = dict(plain.error_parts)
    for key in STRESSES:
        parts[key] = {**parts[key], "border of stick": found.unread_peak}
    # Tractions of several patches may cancel out, what bodies change of each does not.
    size = np.linalg.norm(solved.solution.traction, axis=1)
    share = float(solved.solution.weights @ size) / solved.solution.friction_limit
    area = sum(parts["area_mm2"].values())
    for key, force in zip(FORCES, solved.solution.force, strict=True):
        if force and scene.rolling.prescribed:
            parts[key] = {"bodies": area * share, "grid": solved.grid_error}
    return replace(
        plain,
        findings=found,
        result={
            **compare.from_findings(found, result["load_N"] - upwards, result["approach_mm"]),
            "friction": tractions,
        },
        error_parts=parts,
        friction=solved.solution,
        other_friction={"FASTSIM (equal ellipses)": solved.fastsim} if solved.fastsim else {},
    )
