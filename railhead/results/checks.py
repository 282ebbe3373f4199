"""Checks that a result must pass, each with its value, its limit, the limit's source, and advice.

The limits follow from physics or from the wanted accuracy. Two were set anew after right results
had been refused: that of the noise, and that of the flux with linear cells. The function of each
group yields its checks: of a solution by itself first, then those against a second method (Hertz,
boundary elements, rolling half-spaces), which compare what both have where it is known what the
second one leaves out. A new check has its name in words in `report.html`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from railhead.contact import closed_forms
from railhead.contact.solid import measured_bodies
from railhead.half_spaces.pressing import FINE
from railhead.meshing.bodies import BODY_NAMES
from railhead.planning import effects
from railhead.planning.error_envelopes import RANGE
from railhead.planning.forecast import LINEAR_REFINEMENT
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import Frame
from railhead.postprocess.pass_rows import STILL
from railhead.run.estimates import largest_bound, largest_error, resolved_values
from railhead.run.half_space_answer import HalfSpaceSolution, Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.scene.bodies import STEEL_MODULI
from railhead.scene.quantities import GROUPS, QUANTITIES, numeric_values

DEFAULT_TOLERANCE = 0.05  # relative difference allowed to a number without an estimate
ESTIMATE_FACTOR = 1.5  # difference allowed to a number with an estimate, over the estimate
FINER = "give a smaller mesh.patch_size, or an accuracy"
MORE = "ask for less; accuracy.reason says what is left, accuracy.would_cost what it takes"
BALANCE_TOLERANCE = 1e-6  # relative; forces balance to rounding, an approach to this
NOISE_LIMIT = 0.5  # relative L2: where half of the pressure is noise, none of it is an answer
READING_FORCE = 0.02  # relative; it is 0.011 on linear elements, else up to 0.007
YIELD_LOAD_LIMIT = 110.0  # times the load of first yield
SHEAR_OVER_PRESSURE = (0.2, 0.6)
"""Largest shear stress over largest pressure: 0.266 to 0.488 in Hertz's ellipses of any axis ratio
and Poisson's ratio (theory.elastic.subsurface), a quarter more room."""
RIM_LIMIT = 0.01  # of the largest plastic increment of a pass
ENERGY_LIMIT = 0.03  # relative: what a coarse block may miss
AXLE_TORQUE = 1e-3  # over mu N R: it moves forces by as much of mu N
STRAIN_LIMIT = 0.2
"""p0/E*, which of a circle is 2/pi a/R and of a line a/(2 R): a sphere's patch then has 0.31 of its
radius, and Tabor's representative strain 0.2 a/R (from memory) is 6 %. The limit is a choice."""
STEEL_PRESSURE = {True: 4000.0, False: 4200.0}
"""MPa, largest elastic pressure that leaves 1e-4 of the diameter in hardened bearing steel (ISO
76:2006, 3.1 to 3.3)."""
LAW = "give another force or creepage, or change the law or the layer"
BODIES = "simulate finite bodies: leave out --fast, --without finite_bodies"
SOLVER = (
    "try solver.gamma_factor=1, solver.method=nitsche with solver.theta=1, a smaller "
    "mesh.patch_size, or solver.linear=direct"
)
USELESS = 0.25  # relative: an estimate beyond says that the number says little; a choice
COMPARED = [each.key for each in QUANTITIES if each.compared]
"""Quantities held against a second method, as far as it has them and knows what it leaves out."""
SECOND = "second_opinion"  # begins the names of those checks
NOT_ASKED = "not among the quantities that were asked for"
FORECAST = "stresses were not asked for; judged by those of the plan, without friction"
SHIFT_UNKNOWN = "the shift of bodies that end depends on where they are held"


@dataclass(frozen=True, kw_only=True)
class Check:
    """A value that must not exceed a limit, or with `at_least` not be below it; NaN fails.

    name: key in "checks" of summary.json.
    value: a ratio, a relative error or a count, without dimension; MPa of "pressure_of_steel".
        Infinite for a state that fails in any case.
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


def deviation(value: float, target: float) -> float:
    """Absolute value of the relative deviation from a target; infinite for a target of 0."""
    return abs(value / target - 1) if target else math.inf


def run(
    solved: MeshSolution,
    estimates: Mapping[str, float],
    second: Mapping[str, Any],
) -> list[Check]:
    """All checks of a solved mesh but those of friction (rank 0). Bodies with yield or friction are
    compared with Hertz and half-spaces in their elastic, frictionless reference.

    estimates: error estimates by key.
    second: quantities of another method, nested as "result" of summary.json, with "allowance" and
        "grid_error", or {"reason": ...} where there are none.
    """
    checks = [*equations(solved)]
    if solved.findings is None:
        return checks
    checks += resolution(solved)
    checks += physics(solved)
    checks += second_method(solved.elastic_reference or solved, estimates, second)
    unread = solved.forces.get("below_resolution", ())
    read = {key: estimates[key] for key in estimates.keys() - {*unread}}
    more = FINER if solved.plan.scene.accuracy is None else MORE
    checks += useful(solved.plan, read, more)
    checks += accuracy(solved.plan, largest_error(estimates, solved), more)
    return checks


def friction(
    solved: MeshSolution,
    estimates: Mapping[str, float],
    second: Mapping[str, Mapping[str, Any]] | None,
) -> list[Check]:
    """Checks of a solution with friction; empty without friction, and where nothing touches.

    second: quantities of half-spaces by method, as "half_space_friction" of summary.json.
    """
    if solved.solution.friction is None or solved.findings is None:
        return []
    other = (second or {}).get("boundary elements") or (second or {}).get("Carter") or {}
    return [
        *tangential_flux(solved),
        *forces(solved, estimates, other),
        *shift(solved, other),
    ]


def passes(solved: Solved) -> Iterator[Check]:
    """Checks of the passes of a wheel over a rail that yields: each met the tolerance of its fixed
    point, and nothing yields at the rim of the region where yield is followed. Where the pressure
    follows from the rail, the resistance to rolling is what yield takes: plastic work, and the
    elastic energy that residual stresses keep. Where many wheels are asked for, the passes are
    steady. None without passes.
    """
    found = solved.passes
    if found is None:
        return
    yield Check(
        name="passes_converged",
        value=0.0 if found.converged else 1.0,
        limit=0.0,
        source=found.reason or "the fixed point of every pass, to 1e-4 of the yield stress",
        advice="give a smaller load, or rail.hardening_modulus",
    )
    if found.reason:
        return
    yield Check(
        name="passes_rim",
        value=max(each.rim for each in (found, *found.beside)),
        limit=RIM_LIMIT,
        source="strain at the rim of the region where yield is followed, over the largest",
        advice="give a smaller load",
    )
    if found.energy_error is not None:
        yield Check(
            name="passes_energy",
            value=found.energy_error,
            limit=ENERGY_LIMIT,
            source="resistance of the leaning pressure, over plastic work and elastic energy kept",
            advice="give a smaller mesh.patch_size",
        )
    if found.extrapolated:
        unsteady = [
            each.verdict not in STILL and "reason" in (each.extrapolated or ())
            for each in (found, *found.beside)
        ]
        yield Check(
            name="passes_steady",
            value=float(sum(unsteady)),
            limit=0.0,
            source="bodies whose passes are not steady enough for rolling.wheels",
            advice="give more rolling.passes, or leave rolling.wheels out",
        )


def summary(checks: list[Check], missing: Mapping[str, str]) -> dict[str, Any]:
    """Entry "checks" of summary.json: value by name (but of "converged", which the caller adds as a
    truth value), "limits" with sources, "advice", "not_made" (missing), "failed" and "passed".
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


def equations(solved: MeshSolution) -> Iterator[Check]:
    """Checks that what is called for was solved, and that the equations are fulfilled: effects,
    Newton's method, balance of contact force, reaction and given load along the vertical, the given
    approach, a mesh that is fine where the patch is, and unloading.
    """
    solution, load = solved.solution, solved.plan.scene.load
    yield left_out(solved)
    yield Check(
        name="converged",
        value=0.0 if solution.newton.converged and solved.result is not None else math.inf,
        limit=0.0,
        source=f"Newton's method: {solution.newton.reason}",
        advice=SOLVER,
    )
    target = load if load is not None else solution.reaction
    yield Check(
        name="force_balance",
        value=max(deviation(solution.load, target), deviation(solution.reaction, solution.load)),
        limit=BALANCE_TOLERANCE,
        source="the rigid motions' equations solved to rounding",
        advice=SOLVER,
    )
    yield Check(
        name="approach_reached",
        value=solved.approach_error,
        limit=BALANCE_TOLERANCE,
        source="the given approach",
        advice="give the load in the place of the approach",
    )
    yield Check(
        name="patch_settled",
        value=0.0 if solved.mesh_fits_patch else 1.0,
        limit=0.0,
        source="the mesh is around the patch that was found",
        advice="give mesh.patch_size, or a scene whose patch is not at an edge",
    )
    plastic = solution.plasticity
    if plastic is not None and plastic.residual_state is not None:
        last = plastic.newton_results[-1]
        yield Check(
            name="unloaded",
            value=0.0 if last.converged else 1.0,
            limit=0.0,
            source=f"Newton's method without the load: {last.reason}",
            advice=SOLVER,
        )


def _narrower(plan: Plan, error: float, advice: str) -> str:
    """Advice for a number with a relative error that is too large: the given one, or how to measure
    the profiles better where these make half of the error or more.
    """
    if not plan.profile_error or plan.profile_error < error / 2:
        return advice
    keys = " and ".join(f"{body}.smoothing" for body in measured_bodies(plan.scene))
    text = "the measured profile is too uncertain: measure with less noise or closer points"
    return f"{text}, or give the length of its noise in {keys}"


def accuracy(plan: Plan, error: float, advice: str) -> Iterator[Check]:
    """Check of the largest error against the wanted accuracy; none where none is wanted."""
    if plan.scene.accuracy is not None:
        yield Check(
            name="accuracy",
            value=error,
            limit=plan.scene.accuracy,
            source="asked",
            advice=_narrower(plan, error, advice),
        )


def useful(plan: Plan, bound: Mapping[str, float], advice: str) -> Iterator[Check]:
    """Check of the largest estimate, by key of summary.json, against a quarter (USELESS); none
    without estimates.
    """
    if bound:
        key = max(bound, key=lambda each: bound[each])
        yield Check(
            name="estimates",
            value=bound[key],
            limit=USELESS,
            source=f"that of {key}; a number that may be a quarter off says little",
            advice=_narrower(plan, bound[key], advice),
        )


def left_out(solved: Solved) -> Check:
    """Check of the number of effects that are called for by the plan or the solution, not simulated
    and not overruled: none.
    """
    missing = effects.left_out(solved.plan.effects, solved.after)
    why = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
    overrule = " ".join(f"--without {name}" for name in missing)
    chosen = ", ".join(effects.overruled(solved.plan.effects))
    none = f"none but what a person overruled: {chosen}" if chosen else "none that is called for"
    return Check(
        name="effects_left_out",
        value=float(len(missing)),
        limit=0.0,
        source=why or none,
        advice=f"{overrule} accepts the answer without",
    )


def resolution(solved: MeshSolution) -> Iterator[Check]:
    """Checks of a solution in which the bodies touch: elements across the patch (of a solid in the
    direction that has fewer), noise and force of the pressure that is shown, and overlap of the
    bodies. Then the vertical force that the elements' stresses carry in each body, smooth stresses
    against those of the elements, and distance of the patch from edges.
    """
    from railhead.postprocess.stress.flux import contact_force

    found, fields, solution = solved.findings, solved.fields, solved.solution
    assert found is not None and fields is not None
    linear = LINEAR_REFINEMENT if solved.plan.order == 1 else 1.0
    tolerance = max(DEFAULT_TOLERANCE, solved.plan.scene.accuracy or 0.0)
    across = min(found.elements_across[axis] for axis in fields.kinematics.varying)
    yield Check(
        name="elements_across",
        value=across,
        limit=2 * RANGE[0] * linear,
        source="with a third fewer the largest shear stress was 8 % off, "
        "with linear cells the area",
        advice=FINER,
        at_least=True,
    )
    contact = fields.contact
    touching = contact.facet_nodes[np.unique(contact.facet[contact.pressure > 0])]
    nodes = int(np.unique(touching).size * 2 ** len(fields.mirrors))
    fitted = tolerance * math.sqrt(nodes)
    noisy = (
        f"a fit over {nodes} nodes leaves one over their square root of it"
        if fitted < NOISE_LIMIT
        else "where half of the pressure is noise, none of it is an answer"
    )
    yield Check(
        name="pressure_noise",
        value=found.noise,
        limit=min(fitted, NOISE_LIMIT),
        source=noisy,
        advice=FINER,
    )
    yield Check(
        name="pressure_force",
        value=found.patch.unbalance,
        limit=READING_FORCE,
        source="the contact force; the pressure that is shown is integrated over the patch",
        advice=f"{FINER}; the pressure has a peak or an end that is not read",
    )
    yield Check(
        name="penetration",
        value=solution.penetration / abs(solution.approach),
        limit=tolerance,
        source="overlap over approach: it enters pressure and area in proportion",
        advice="give a larger solver.gamma_factor, or solver.method=nitsche",
    )
    for body in solved.plan.deformable:
        yield Check(
            name=f"flux_{BODY_NAMES[body]}",
            value=deviation(-contact_force(fields, body)[2], solution.load),
            limit=tolerance * linear,
            source="the load; the elements' stresses are integrated around the patch",
            advice=FINER,
        )
    if found.largest:
        yield Check(
            name="stress_misfit",
            value=found.misfit,
            limit=tolerance * linear,
            source="the elements' own stresses around the largest smooth ones, on the average",
            advice=FINER,
        )
    yield Check(
        name="edge_distance",
        value=found.edge_distance,
        limit=2 / across,
        source="one element, over the smaller half length: at an edge the pressure has no bound",
        advice="move the wheel, or give wider bodies",
        at_least=True,
    )


def physics(solved: Solved) -> Iterator[Check]:
    """Checks of a solution in which the bodies touch: largest shear stress over largest pressure
    without yield and friction, load over that of first yield, small strains, a pressure that steel
    bears, and the torque on an axle that turns without one. The pressure is looked at where the
    softer body has at most the modulus of steel.
    """
    plan, found = solved.plan, solved.findings
    assert found is not None
    elastic = (solved.elastic_reference or solved).findings or found
    largest = found.patch.max_pressure
    if elastic.largest:
        low, high = SHEAR_OVER_PRESSURE
        shear = max(each.tau.value for each in elastic.largest.values())
        ratio = shear / elastic.patch.max_pressure
        source = "0.266 to 0.488 in Hertz's ellipses, and a quarter more room"
        yield Check(
            name="shear_over_pressure", value=ratio, limit=high, source=source, advice=FINER
        )
        yield Check(
            name="shear_over_pressure_least",
            value=ratio,
            limit=low,
            source=source,
            advice=FINER,
            at_least=True,
        )
    if solved.residual_state is not None:
        yield Check(
            name="load_over_first_yield",
            value=solved.residual_state.load_over_first_yield,
            limit=YIELD_LOAD_LIMIT,
            source="as far as spheres of others go; strains are no longer small beyond",
            advice="give a smaller load",
        )
    yield Check(
        name="small_strain",
        value=largest / plan.hertz.contact_modulus,
        limit=STRAIN_LIMIT,
        source="p0/E*: a sphere's representative strain is 6 % there",
        advice="give a smaller load",
    )
    moduli = [plan.scene.bodies[BODY_NAMES[body]].young_modulus for body in plan.deformable]
    if min(moduli) <= STEEL_MODULI[1]:
        yield Check(
            name="pressure_of_steel",
            value=largest,
            limit=STEEL_PRESSURE[plan.contact.line],
            source="ISO 76: hardened bearing steel yields beyond",
            advice="give a smaller load, or a yield_stress",
        )
    if axle := plan.contact.axle:
        yield Check(
            name="axle_torque",
            value=axle.torque,
            limit=AXLE_TORQUE,
            source=axle.reason or "both wheels' moments about the axle, over mu N R",
            advice="give rolling.axle free or nominal",
        )


def half_spaces(solved: HalfSpaceSolution, bound: dict[str, float]) -> Iterator[Check]:
    """All checks of a solution by half-spaces, passes excepted. bound: error estimates by key of
    summary.json.
    """
    yield left_out(solved)
    yield Check(
        name="converged",
        value=math.inf if solved.findings is None else 0.0,
        limit=0.0,
        source=solved.reason or "boundary elements to 1e-5 of the displacement",
        advice=BODIES if closed_forms.coulomb(solved.plan.scene) else LAW,
    )
    if solved.findings is None:
        return
    yield from physics(solved)
    load = solved.plan.scene.load or solved.load
    yield Check(
        name="force_balance",
        value=deviation(solved.load, load),
        limit=BALANCE_TOLERANCE,
        source="the load that the pressure carries",
        advice=BODIES,
    )
    flats = (part.surface for part in solved.plan.scene.bodies.values() if part.surface is not None)
    sharp = any(each.kind == "flat" and each.depth is None for each in flats)
    advice = solved.after["surface_shape"].why if sharp and solved.findings else BODIES
    yield from useful(solved.plan, bound, advice)
    yield from accuracy(solved.plan, largest_bound(bound), advice)
    if solved.findings is None or solved.plan.contact.half_space:
        return
    yield Check(
        name="edge_distance",
        value=solved.findings.edge_distance,
        limit=2 / FINE,
        source="one cell, over the smaller half length: at an edge the pressure has no bound",
        advice="move the wheel",
        at_least=True,
    )
    yield Check(
        name="grid_error",
        value=largest_bound({key: solved.error_parts[key].get("grid", 0.0) for key in bound}),
        limit=DEFAULT_TOLERANCE,
        source="the change from a grid of half as many cells each way",
        advice=advice,
    )


def second_method(
    solved: MeshSolution, estimates: Mapping[str, float], second: Mapping[str, Any]
) -> Iterator[Check]:
    """Checks of the compared quantities of an elastic, frictionless solution against another
    method, within the errors of both and the allowance. second: quantities of the other method,
    nested as "result" of summary.json, with "allowance" and "grid_error", or {"reason": ...} where
    there are none.
    """
    if _unknown(second):
        return  # `not_made` has the reason
    own, other = resolved_values(solved), numeric_values(second)
    for key in COMPARED:
        if key not in own or key not in other:
            continue
        if second["allowance"] and key not in second["allowance"]:
            continue  # nobody has computed what the method leaves out of it
        mine = ESTIMATE_FACTOR * estimates[key] if key in estimates else DEFAULT_TOLERANCE
        allowance = second["allowance"].get(key, {}).get("total", 0.0)
        allowance += second.get("grid_error", {}).get(key, 0.0)
        yield Check(
            name=f"{SECOND}_{key}",
            value=deviation(own[key], other[key]),
            limit=mine + allowance,
            source=f"{mine:.2g} ({ESTIMATE_FACTOR:g} times the estimate, or without one "
            f"{DEFAULT_TOLERANCE:g}), and {allowance:.2g} for what it cannot know",
            advice="ask for an accuracy, and look at the profiles",
        )


def tangential_flux(solved: MeshSolution) -> Iterator[Check]:
    """Check for each deformable body that its stresses around the patch carry the prescribed
    tangential force, or the one found where none is prescribed, over mu N.
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


def forces(
    solved: MeshSolution, estimates: Mapping[str, float], other: Mapping[str, Any]
) -> Iterator[Check]:
    """Check of the tangential forces of the wheel on the rail in rolling against half-spaces, over
    mu N; none of a shift, and where the other method has no forces. other: quantities of one
    method, by the keys of "friction" in summary.json.
    """
    found = solved.solution.friction
    assert found is not None
    keys = [key for key in ("force_along_N", "force_across_N") if key in other]
    if not keys or not solved.plan.scene.rolling.prescribed:
        return
    force = dict(zip(("force_along_N", "force_across_N"), found.force, strict=True))
    tolerance = DEFAULT_TOLERANCE
    if still := solved.forces.get("without_creepage"):
        estimated = [ESTIMATE_FACTOR * estimates[key] for key in force if key in estimates]
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


def shift(solved: MeshSolution, other: Mapping[str, Any]) -> Iterator[Check]:
    """Check of the shift of half-spaces under tangential forces against another method, relative;
    none where the other method has no shift.
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
        limit=DEFAULT_TOLERANCE,
        source="half-spaces with friction, over their shift",
        advice=FINER,
    )


def not_made(
    solved: MeshSolution,
    made: Sequence[Check],
    second: Mapping[str, Any],
    second_friction: Mapping[str, Mapping[str, Any]] | None,
) -> dict[str, str]:
    """Reasons by name of the check for the comparisons with a second method that were not made;
    empty where nothing touches.

    made: the checks that were made.
    second: quantities of the second method, or {"reason": ...}.
    second_friction: quantities with friction by method; None without friction.
    """
    elastic = solved.elastic_reference or solved
    if elastic.findings is None:
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


def not_asked(plan: Plan) -> dict[str, str]:
    """A reason by name of each group of quantities that the scene of a plan does not ask for,
    although it has them; with "plasticity" where a body has a yield stress, and only the plan's
    stresses tell whether it yields.
    """
    rubs = plan.effects["friction"].called_for
    known = plan.stresses_asked or any(plan.effects[each].on for each in ("plasticity", "passes"))
    yields = any(part.yields for part in plan.context.stressed.values())
    return {
        name: NOT_ASKED
        for name in GROUPS
        if not plan.scene.asks(name) and (rubs or name not in ("forces", "friction_stresses"))
    } | ({"plasticity": FORECAST} if yields and not known else {})


def _unknown(second: Mapping[str, Any]) -> str:
    """Reason why a second method as a whole cannot be compared; empty where it can. second: as of
    `second_method`: the reason stands under "reason", or under that key of its "allowance".
    """
    return str(second.get("reason") or second["allowance"].get("reason") or "")
