"""Checks that a result must pass, each with its value, its limit, the limit's source, and advice.

The limits follow from physics or from the wanted accuracy. Two were set anew after right results
had been refused: that of the noise, and that of the flux with linear cells. A new check is a
function that yields a `Check`, in the tuple of its group, and its name in words in `report.labels`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from railhead.meshing.tags import BODY_NAMES
from railhead.planning import effects
from railhead.planning.accuracy.error_envelopes import RANGE
from railhead.planning.sizing import LINEAR_REFINEMENT
from railhead.postprocess.findings import Findings, Frame
from railhead.run.estimates import Estimate, largest_error, resolved_values
from railhead.run.mesh_solution import MeshSolution
from railhead.run.quantities import QUANTITIES, numeric_values
from railhead.scene import steels

DEFAULT_TOLERANCE = 0.05  # relative: of a number without an estimate
ESTIMATE_FACTOR = 1.5  # times an estimate: what a number with one may be off by
BALANCE_TOLERANCE = 1e-6  # relative: what equations solved to 1e-8 leave
NOISE_LIMIT = 0.5  # relative L2: where half of the pressure is noise, none of it is an answer
YIELD_LOAD_LIMIT = 110.0  # times the load of first yield
SHEAR_OVER_PRESSURE = (0.2, 0.6)
"""Largest shear stress over largest pressure: 0.266 to 0.488 in Hertz's ellipses of any axis ratio
and Poisson's ratio (theory.elastic.subsurface), a quarter more room."""
MISES_READING = 0.01  # relative: what reading two largest values apart from each other may cost
STRAIN_LIMIT = 0.2
"""p0/E*, which of a circle is 2/pi a/R and of a line a/(2 R): a sphere's patch then has 0.31 of its
radius, and Tabor's representative strain 0.2 a/R (from memory) is 6 %. The limit is a choice."""
STEEL_PRESSURE = {"line": 4000.0, "point": 4200.0}
"""MPa, largest elastic pressure that leaves 1e-4 of the diameter in hardened bearing steel (ISO
76:2006, 3.1 to 3.3)."""
SHAPE_SENSITIVITY = 5.25
"""What a fourth power in p^2 changes of the largest over the mean pressure, over the shape error,
to first order: p^2 = (1 - r^2)(1 + c r^2) has c/5 and 4 c/105; a strip has c/8 and c/16."""
COMPARED = [each.key for each in QUANTITIES if each.compared]
"""Quantities held against a second method, as far as it has them and knows what it leaves out."""
SECOND = "second_opinion"  # begins the names of those checks
SHIFT_UNKNOWN = "the shift of bodies that end depends on where they are held"
FINER = "give a smaller mesh.patch_size, or an accuracy"
SOLVER = (
    "try solver.gamma_factor=1, solver.method=nitsche with solver.theta=1, a smaller "
    "mesh.patch_size, or solver.linear=direct"
)


@dataclass(frozen=True, kw_only=True)
class Check:
    """A value that must not exceed a limit; a value that is not a number fails.

    name: key in "checks" of summary.json.
    value: the number.
    limit: largest allowed value; with at_least the smallest.
    source: reason of the limit.
    advice: what to change where the check fails.
    at_least: whether the limit is a lower bound.
    """

    name: str
    value: float
    limit: float
    source: str
    advice: str
    at_least: bool = False

    @property
    def passed(self) -> bool:
        """Whether the value is within the limit."""
        return self.value >= self.limit if self.at_least else self.value <= self.limit


def run(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Any],
    *,
    reached: bool | None,
) -> list[Check]:
    """All checks of a solved mesh but those of friction (rank 0).

    estimates: error estimates by key.
    second: quantities of another method, nested as "result" of summary.json, with "allowance" and
        "grid_error", or {"reason": ...} where there are none.
    reached: whether the wanted accuracy was met; None without one.
    """
    checks = [each for check in SOLUTION for each in check(solved)]
    if solved.result is not None and solved.findings is not None:
        checks += [each for check in (*MESH, *PHYSICS) for each in check(solved)]
        elastic = solved.elastic_reference or solved
        checks += pressure_over_mean(elastic, estimates)
        checks += second_method(elastic, estimates, second)
    if reached is not None:
        checks += accuracy(solved, estimates, reached)
    return checks


def friction(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Mapping[str, Any]] | None,
) -> list[Check]:
    """Checks of a solution with friction; empty without friction.

    second: quantities of half-spaces by method, as "half_space_friction" of summary.json.
    """
    if solved.solution.friction is None or solved.result is None:
        return []
    other = (second or {}).get("boundary elements") or (second or {}).get("Carter") or {}
    return [
        *tangential_flux(solved),
        *second_method_forces(solved, estimates, other),
        *second_method_shift(solved, other),
    ]


def effects_left_out(solved: MeshSolution) -> Iterator[Check]:
    """Check of the number of effects that are called for, not simulated and not overruled: none."""
    missing = effects.left_out(solved.plan.effects, solved.after)
    why = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
    overrule = " ".join(f"--without {name}" for name in missing)
    yield Check(
        name="effects_left_out",
        value=float(len(missing)),
        limit=0.0,
        source=why or "none that is called for",
        advice=f"{overrule} accepts the answer without",
    )


def converged(solved: MeshSolution) -> Iterator[Check]:
    """Check that Newton's method converged and the bodies touch."""
    newton = solved.solution.newton
    yield Check(
        name="converged",
        value=0.0 if newton.converged and solved.result is not None else math.inf,
        limit=0.0,
        source=f"Newton's method: {newton.reason}",
        advice=SOLVER,
    )


def force_balance(solved: MeshSolution) -> Iterator[Check]:
    """Check that contact force, reaction and given load are equal, relative."""
    solution, load = solved.solution, solved.plan.scene.load
    target = load if load is not None else solution.reaction
    yield Check(
        name="force_balance",
        value=max(_off(solution.load, target), _off(solution.reaction, solution.load)),
        limit=BALANCE_TOLERANCE,
        source="equations solved to 1e-8",
        advice=SOLVER,
    )


def approach_reached(solved: MeshSolution) -> Iterator[Check]:
    """Check of the relative deviation from the given approach."""
    yield Check(
        name="approach_reached",
        value=solved.approach_error,
        limit=BALANCE_TOLERANCE,
        source="the given approach",
        advice="give the load in the place of the approach",
    )


def patch_settled(solved: MeshSolution) -> Iterator[Check]:
    """Check that the mesh is fine where the patch is."""
    yield Check(
        name="patch_settled",
        value=0.0 if solved.mesh_fits_patch else 1.0,
        limit=0.0,
        source="the mesh is around the patch that was found",
        advice="give mesh.patch_size, or a scene whose patch is not at an edge",
    )


def unloaded(solved: MeshSolution) -> Iterator[Check]:
    """Check that Newton's method also converged after unloading, where bodies yield."""
    plastic = solved.solution.plasticity
    if plastic is None or plastic.residual_state is None:
        return
    last = plastic.newton_results[-1]
    yield Check(
        name="unloaded",
        value=0.0 if last.converged else 1.0,
        limit=0.0,
        source=f"Newton's method without the load: {last.reason}",
        advice=SOLVER,
    )


SOLUTION = (
    effects_left_out,
    converged,
    force_balance,
    approach_reached,
    patch_settled,
    unloaded,
)


def elements_across(solved: MeshSolution) -> Iterator[Check]:
    """Check of the number of elements across the patch, in the direction that has fewer."""
    coarsest = RANGE[0] * (LINEAR_REFINEMENT if solved.plan.order == 1 else 1.0)
    yield Check(
        name="elements_across",
        value=_fewest_elements(solved),
        limit=2 * coarsest,
        source="with a third fewer the largest shear stress was 8 % off, "
        "with linear cells the area",
        advice=FINER,
        at_least=True,
    )


def pressure_noise(solved: MeshSolution) -> Iterator[Check]:
    """Check of the noise of the pressure: deviation from a smooth fit, relative."""
    nodes = _touching_nodes(solved)
    fitted = _tolerance(solved) * math.sqrt(nodes)
    noisy = (
        f"a fit over {nodes} nodes leaves one over their square root of it"
        if fitted < NOISE_LIMIT
        else "where half of the pressure is noise, none of it is an answer"
    )
    yield Check(
        name="pressure_noise",
        value=_findings(solved).noise,
        limit=min(fitted, NOISE_LIMIT),
        source=noisy,
        advice=FINER,
    )


def penetration(solved: MeshSolution) -> Iterator[Check]:
    """Check of the overlap of the bodies over the approach."""
    yield Check(
        name="penetration",
        value=solved.solution.penetration / abs(solved.solution.approach),
        limit=_tolerance(solved),
        source="overlap over approach: it enters pressure and area in proportion",
        advice="give a larger solver.gamma_factor, or solver.method=nitsche",
    )


MESH = (elements_across, pressure_noise, penetration)


def flux(solved: MeshSolution) -> Iterator[Check]:
    """Check for each body that its stresses around the patch carry the load, relative."""
    from railhead.postprocess.stress.flux import contact_force

    assert solved.fields is not None
    for body in solved.plan.deformable:
        yield Check(
            name=f"flux_{BODY_NAMES[body]}",
            value=_off(-contact_force(solved.fields, body)[2], solved.solution.load),
            limit=_stress_tolerance(solved),
            source="the load; the elements' stresses are integrated around the patch",
            advice=FINER,
        )


def stress_misfit(solved: MeshSolution) -> Iterator[Check]:
    """Check of the smoothed stresses against those of the elements, relative."""
    yield Check(
        name="stress_misfit",
        value=_findings(solved).misfit,
        limit=_stress_tolerance(solved),
        source="the elements' own stresses around the largest smooth ones, on the average",
        advice=FINER,
    )


def shear_over_pressure(solved: MeshSolution) -> Iterator[Check]:
    """Check of the largest shear stress over the largest pressure, without yield."""
    elastic = _elastic_result(solved)
    yield from _between(
        "shear_over_pressure",
        elastic["stress"]["tau_max_MPa"] / elastic["pressure"]["max_MPa"],
        SHEAR_OVER_PRESSURE,
        "0.266 to 0.488 in Hertz's ellipses, and a quarter more room",
    )


def mises_over_shear(solved: MeshSolution) -> Iterator[Check]:
    """Check of the largest von Mises stress over the largest shear stress, without yield."""
    stress = _elastic_result(solved)["stress"]
    yield from _between(
        "mises_over_shear",
        stress["von_mises_max_MPa"] / stress["tau_max_MPa"],
        (math.sqrt(3.0) * (1 - MISES_READING), 2.0 * (1 + MISES_READING)),
        "von Mises stress over shear stress, sqrt(3) to 2 in any state, and what reading costs",
    )


def load_over_first_yield(solved: MeshSolution) -> Iterator[Check]:
    """Check of the load over the load of first yield, where bodies yield."""
    if solved.residual_state is None:
        return
    yield Check(
        name="load_over_first_yield",
        value=solved.residual_state.load_over_first_yield,
        limit=YIELD_LOAD_LIMIT,
        source="as far as spheres of others go; strains are no longer small beyond",
        advice="give a smaller load",
    )


def small_strain(solved: MeshSolution) -> Iterator[Check]:
    """Check of the largest pressure over the contact modulus: small strains."""
    yield Check(
        name="small_strain",
        value=_result(solved)["pressure"]["max_MPa"] / solved.plan.estimate.contact_modulus,
        limit=STRAIN_LIMIT,
        source="p0/E*: a sphere's representative strain is 6 % there",
        advice="give a smaller load",
    )


def pressure_of_steel(solved: MeshSolution) -> Iterator[Check]:
    """Check of the largest pressure (MPa) against that which hardened bearing steel bears, for
    bodies of which the softer one has at most the modulus of steel.
    """
    plan = solved.plan
    bodies = {"rail": plan.scene.rail, "wheel": plan.scene.wheel}
    moduli = [bodies[BODY_NAMES[body]].young_modulus for body in plan.deformable]
    if min(moduli) > steels.STEEL_MODULI[1]:
        return
    yield Check(
        name="pressure_of_steel",
        value=_result(solved)["pressure"]["max_MPa"],
        limit=STEEL_PRESSURE["line" if plan.contact.line else "point"],
        source="ISO 76: hardened bearing steel yields beyond",
        advice="give a smaller load, or a yield_stress",
    )


def edge_distance(solved: MeshSolution) -> Iterator[Check]:
    """Check of the distance of the patch from the edge of a body, over the smaller half length."""
    yield Check(
        name="edge_distance",
        value=_findings(solved).edge_distance,
        limit=2 / _fewest_elements(solved),
        source="one element, over the smaller half length: at an edge the pressure has no bound",
        advice="move the wheel, or give wider bodies",
        at_least=True,
    )


PHYSICS = (
    flux,
    stress_misfit,
    shear_over_pressure,
    mises_over_shear,
    load_over_first_yield,
    small_strain,
    pressure_of_steel,
    edge_distance,
)


def pressure_over_mean(solved: MeshSolution, estimates: Mapping[str, Estimate]) -> Iterator[Check]:
    """Check of largest pressure, area and load against each other, where the pressure is a semi-
    ellipsoid (3/2 of the mean) or a semi-ellipse (4/pi).
    """
    found, result = _findings(solved), _result(solved)
    if not found.hertzian:
        return
    line = solved.plan.setting.shape == "plane strain"
    normal = solved.solution.load / math.cos(solved.plan.contact.touch.angle)
    mean = normal / result["patch"]["area_mm2"]
    peak = (4 / math.pi if line else 1.5) * mean
    tolerance = sum(_allowed(estimates, key) for key in ("max_MPa", "area_mm2"))
    sensitivity = 1.0 if solved.plan.contact.half_space else 2.0 if line else SHAPE_SENSITIVITY
    yield Check(
        name="pressure_over_mean",
        value=_off(result["pressure"]["max_MPa"], peak),
        limit=tolerance + sensitivity * found.shape_error,
        source=f"{'4/pi' if line else '3/2'} of load over area; both estimates "
        f"({tolerance:.2g}) and how far the pressure is from that shape",
        advice=FINER,
    )


def second_method(
    solved: MeshSolution, estimates: Mapping[str, Estimate], second: Mapping[str, Any]
) -> Iterator[Check]:
    """Checks of the compared quantities against another method, within the errors of both and the
    allowance. second: as in `run`.
    """
    if _unknown(second):
        return  # `not_made` has the reason
    own, other = resolved_values(solved), numeric_values(second)
    for key in COMPARED:
        if key not in own or key not in other:
            continue
        if second["allowance"] and key not in second["allowance"]:
            continue  # nobody has computed what the method leaves out of it
        mine = _allowed(estimates, key)
        allowance = second["allowance"].get(key, {}).get("total", 0.0)
        allowance += second.get("grid_error", {}).get(key, 0.0)
        yield Check(
            name=f"{SECOND}_{key}",
            value=_off(own[key], other[key]),
            limit=mine + allowance,
            source=f"{mine:.2g} ({ESTIMATE_FACTOR:g} times the estimate, or without one "
            f"{DEFAULT_TOLERANCE:g}), and {allowance:.2g} for what it cannot know",
            advice="ask for an accuracy, and look at the profiles",
        )


def accuracy(
    solved: MeshSolution, estimates: Mapping[str, Estimate], reached: bool
) -> Iterator[Check]:
    """Check of the largest error estimate against the wanted accuracy."""
    error, wanted = largest_error(estimates, solved), float(solved.plan.scene.accuracy or 0.0)
    yield Check(
        name="accuracy",
        value=error if reached else max(error, math.nextafter(wanted, math.inf)),
        limit=wanted,
        source="asked",
        advice="ask for less, or give a larger budget; see accuracy.would_cost",
    )


def tangential_flux(solved: MeshSolution) -> Iterator[Check]:
    """Check for each body that its stresses around the patch carry the tangential forces, over mu
    N.
    """
    from railhead.postprocess.stress.flux import contact_force, pressure_force

    plan, found, fields = solved.plan, solved.solution.friction, solved.fields
    assert found is not None and fields is not None
    axes = Frame(plan.contact.origin, plan.contact.touch.angle).axes[:2]
    _, *given = plan.scene.tangential_forces
    wanted = [one or force for one, force in zip(given, found.force, strict=True)]
    pressed = pressure_force(fields)
    for body in plan.deformable:
        off = axes @ (contact_force(fields, body) - pressed) - wanted
        yield Check(
            name=f"tangential_flux_{BODY_NAMES[body]}",
            value=float(np.linalg.norm(off)) / found.friction_limit,
            limit=DEFAULT_TOLERANCE,
            source="the tangential force, over mu N; as for the load",
            advice=FINER,
        )


def second_method_forces(
    solved: MeshSolution, estimates: Mapping[str, Estimate], other: Mapping[str, Any]
) -> Iterator[Check]:
    """Check of the tangential forces in rolling against half-spaces, over mu N. other: quantities
    of one method, by the keys of "friction" in summary.json.
    """
    found = solved.solution.friction
    assert found is not None and solved.result is not None
    keys = [key for key in ("force_along_N", "force_across_N") if key in other]
    if not keys or not solved.plan.scene.rolling.prescribed:
        return
    force = dict(zip(("force_along_N", "force_across_N"), found.force, strict=True))
    tolerance = DEFAULT_TOLERANCE
    if still := solved.result.get("friction", {}).get("resolution"):
        estimated = [ESTIMATE_FACTOR * estimates[key].total for key in force if key in estimates]
        tolerance *= math.hypot(*found.force) / found.friction_limit
        tolerance = max(estimated, default=tolerance)
        unresolved = math.hypot(*(still[key] for key in force)) / found.friction_limit
        tolerance += ESTIMATE_FACTOR * unresolved
    yield Check(
        name=f"{SECOND}_friction",
        value=max(abs(force[key] - other[key]) / found.friction_limit for key in keys),
        limit=tolerance + other.get("grid_error", 0.0),
        source=f"half-spaces with friction, over mu N; {ESTIMATE_FACTOR:g} times the estimate, or "
        f"without one {DEFAULT_TOLERANCE:g} of the force (unlike bodies: of mu N); "
        f"{ESTIMATE_FACTOR:g} times what is found without creepage; the error of their grid",
        advice=FINER,
    )


def second_method_shift(solved: MeshSolution, other: Mapping[str, Any]) -> Iterator[Check]:
    """Check of the shift of half-spaces under tangential forces against another method, relative.
    other: quantities of that method, by the keys of "friction" in summary.json.
    """
    found = solved.solution.friction
    assert found is not None
    if "shift_along_mm" not in other:
        return
    pairs = [
        (shift, other[f"shift_{way}_mm"])
        for way, shift in zip(("along", "across"), found.rigid_motion, strict=False)
    ]
    whole = math.hypot(*(shift for _, shift in pairs))
    yield Check(
        name=f"{SECOND}_shift",
        value=max(abs(one - two) for one, two in pairs) / whole,
        limit=DEFAULT_TOLERANCE + other.get("grid_error", 0.0),
        source="half-spaces with friction, over their shift, and the error of their grid",
        advice=FINER,
    )


def not_made(
    solved: MeshSolution,
    made: Sequence[Check],
    second: Mapping[str, Any],
    second_friction: Mapping[str, Mapping[str, Any]] | None,
) -> dict[str, str]:
    """Reasons by name for the comparisons with a second method that were not made.

    made: the checks that were made.
    second: quantities of the second method, or {"reason": ...}.
    second_friction: quantities with friction by method; None without friction.
    """
    elastic = solved.elastic_reference or solved
    if elastic.result is None:
        return {}
    names, missing = {each.name for each in made}, {}
    if reason := _unknown(second):
        missing[SECOND] = reason
    else:
        other, own = numeric_values(second), resolved_values(elastic)
        missing = {
            f"{SECOND}_{key}": "what half-spaces leave out of it is not known"
            if key in other
            else "the second method does not give it"
            for key in COMPARED
            if key in own and f"{SECOND}_{key}" not in names
        }
    if solved.solution.friction is not None:
        name = f"{SECOND}_{'friction' if solved.plan.scene.rolling.prescribed else 'shift'}"
        reasons = [each["reason"] for each in (second_friction or {}).values() if "reason" in each]
        if name not in names:
            missing[name] = next(iter(reasons), SHIFT_UNKNOWN)
    return missing


def summary(checks: list[Check], missing: Mapping[str, str]) -> dict[str, Any]:
    """Entry "checks" of summary.json: value by name, "limits" with sources, "advice", "not_made"
    (missing), "failed" and "passed".
    """
    failed = [each.name for each in checks if not each.passed]
    return {
        **{each.name: each.value for each in checks if each.name != "converged"},
        "limits": {each.name: [each.limit, each.source] for each in checks},
        "advice": {each.name: each.advice for each in checks if not each.passed},
        "not_made": dict(missing),
        "failed": failed,
        "passed": not failed,
    }


def _between(name: str, value: float, bounds: tuple[float, float], source: str) -> Iterator[Check]:
    """Two checks of a value, for the upper and the lower bound; the name of the second one ends in
    "_least".
    """
    low, high = bounds
    yield Check(name=name, value=value, limit=high, source=source, advice=FINER)
    yield Check(
        name=f"{name}_least", value=value, limit=low, source=source, advice=FINER, at_least=True
    )


def _tolerance(solved: MeshSolution) -> float:
    """Relative tolerance: the default, or the wanted accuracy where that is coarser."""
    return max(DEFAULT_TOLERANCE, solved.plan.scene.accuracy or 0.0)


def _stress_tolerance(solved: MeshSolution) -> float:
    """Relative tolerance of stresses, larger for linear cells, in which stresses are constant."""
    return _tolerance(solved) * (LINEAR_REFINEMENT if solved.plan.order == 1 else 1.0)


def _fewest_elements(solved: MeshSolution) -> float:
    """Elements across the patch in the direction with fewer; in a section in its only direction."""
    across = _findings(solved).elements_across
    return max(across) if solved.plan.section else min(across)


def _touching_nodes(solved: MeshSolution) -> int:
    """Number of nodes of facets with pressure, mirrored parts included."""
    assert solved.fields is not None
    contact = solved.fields.contact
    touching = contact.facet_nodes[np.unique(contact.facet[contact.pressure > 0])]
    return int(np.unique(touching).size * 2 ** len(solved.fields.mirrors))


def _findings(solved: MeshSolution) -> Findings:
    """Findings of a solution in which the bodies touch."""
    assert solved.findings is not None
    return solved.findings


def _result(solved: MeshSolution) -> dict[str, Any]:
    """Entry "result" of summary.json of a solution in which the bodies touch."""
    assert solved.result is not None
    return solved.result


def _elastic_result(solved: MeshSolution) -> dict[str, Any]:
    """Entry "result" of the solution without yield and friction."""
    return (solved.elastic_reference or solved).result or _result(solved)


def _unknown(second: Mapping[str, Any]) -> str:
    """Reason why a second method cannot be compared; empty where it can."""
    return str(second.get("reason") or second["allowance"].get("reason") or "")


def _allowed(estimates: Mapping[str, Estimate], key: str) -> float:
    """Relative error allowed for a quantity: a multiple of its estimate, or the default."""
    return ESTIMATE_FACTOR * estimates[key].total if key in estimates else DEFAULT_TOLERANCE


def _off(value: float, target: float) -> float:
    """Relative deviation of a value from a target; infinite for a target of 0."""
    return abs(value / target - 1) if target else math.inf
