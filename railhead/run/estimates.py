"""How large the error of a number is, after the solve.

The estimate of a quantity is the sum of

    mesh          the envelope at n; outside all families the scatter of several meshes
    reading       what two ways of reading the same solution differ by
    contact_law   the overlap that the law lets through, over the approach, times its effect
    left_out      what effects left out by the plan add
    geometry      contact points off the exact surface, over the smaller semi-axis
    load_steps    what more load steps would change where bodies yield
    algebraic     the residual of Newton's method, with what it moves a quantity by at most
    grid          of friction: the changes from grid to grid of the tractions
    strain        of like bodies that roll: a creepage of second order (STRAIN)
    profile       what the noise of measured profiles hides (`planning.error_envelopes`)

Estimates are relative to the value, those of forces by friction to mu N. An accuracy that a scene
wants is one of sizes and values (`PROMISED`). Places, as the depth of the largest shear stress,
have no estimate: the stress changes little near its largest value.
"""

import math
from collections.abc import Mapping, Sequence, Set
from typing import Any

from railhead.geometry.outlines import head_depth
from railhead.planning.error_envelopes import STEP, Family
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import Findings
from railhead.postprocess.friction import MOTION, RISE
from railhead.run.mesh_solution import Answered, MeshSolution
from railhead.scene.quantities import ESTIMATED, QUANTITIES, SCATTER, numeric_values
from railhead.theory.friction import kalker
from railhead.theory.friction.solution import FrictionSolution

# Error over the change between two meshes a step apart; first order leaves 1/(STEP - 1) = 1.67.
SCATTER_FACTOR = 2.0
APART = 1 + 1 / SCATTER_FACTOR  # ratio of two meshes whose change times that factor is first order
# Relative error of any quantity over the residual of Newton's method: 1.13 at most, measured at a
# tolerance of 1e-3 (tests/rooms/solver/algebra/test_tolerance.py).
RESIDUAL_FACTOR = 2.0
RIDGE_STRESS_FACTOR = 2.0
"""Uncertainty of the largest stresses in the bodies under a ridge of the pressure, over that of the
ridge: chosen on the scenes of seed 1, of which one alone makes three quarters of the law if it is
1."""
ALWAYS = "mesh", "reading", "contact_law", "left_out", "geometry", "algebraic"
"""Parts of all estimates."""
# Of the approach over the rolling radius: creepage in which half-spaces with the hoop strain of
# pressing, which is half of that ratio, and finite elements differ. Both leave out terms of the
# order (a/R)^2. Of eight crowned pairs the median was 0.03, the largest 0.045.
STRAIN = 0.03
STRESSED_WEB = 0.1  # ab over the squared depth of a head, above which the web may be stressed most


Parts = dict[str, dict[str, float]]
"""Relative error of quantities by their keys in summary.json, in parts that add up (see above).
Those that are not in `ALWAYS` are there only where they are not zero."""


def totals(parts: Parts) -> dict[str, float]:
    """Relative errors by key: the sums of their parts."""
    return {key: sum(each.values()) for key, each in parts.items()}


def largest_error(bound: Mapping[str, float], solved: MeshSolution) -> float:
    """Largest of the estimates by key, which is compared with a wanted accuracy; infinite off rank
    0, where nothing touches, and where a quantity that the mesh resolves has no estimate.
    """
    wanted = set() if solved.findings is None else resolved_values(solved).keys()
    if not wanted or not wanted <= bound.keys():
        return math.inf
    return max(bound[key] for key in wanted)


def largest_bound(bound: Mapping[str, float]) -> float:
    """Largest error, by key of summary.json, of what is compared with a wanted accuracy
    (`PROMISED`).
    """
    return max((bound[key] for key in bound.keys() & PROMISED), default=0.0)


def not_asked(plan: Plan, keys: Set[str], known: Set[str]) -> str:
    """Words that follow the reason why meshes ended: that errors of forces count over mu N, and
    those of the keys of summary.json that a wanted accuracy does not count: what is not `PROMISED`,
    or has no estimate (is not `known`). Empty where none is wanted.
    """
    if not plan.scene.accuracy:
        return ""
    forces = "; forces are counted over mu N" if keys & FRICTION_SHARES else ""
    rest = sorted(keys - (PROMISED & known))
    return forces + (f"; not asked of {', '.join(rest)}" if rest else "")


def of_grids(solved: Answered) -> float:
    """Largest relative error that the grids of tractions leave, on any mesh, of what is compared
    with a wanted accuracy: the largest stresses, forces over mu N, the motion; 0 without findings.
    """
    if solved.findings is None:
        return 0.0
    grids = {key: grid for key, (_, grid) in friction_errors(solved, None, 0.0, 0.0).items()}
    return largest_bound({**solved.findings.surface_error, **grids})


def resolved_values(solved: MeshSolution) -> dict[str, float]:
    """Values of the estimated quantities that the mesh resolves, by key of summary.json.

    Forces of rolling are over mu N, and a creepage or shift is there where its force is prescribed
    (`friction_values`). Left out is the length of a line contact, which is given, and the largest
    stresses of a patch so large that they may be in the web of a rail (STRESSED_WEB), whose
    elements no law was measured with.
    """
    plan, values = solved.plan, numeric_values(solved.result) | friction_values(solved)
    values.pop(plan.contact.prescribed_length or "", None)
    if plan.with_foot:
        share = math.prod(plan.zone) / head_depth(plan.scene.rail.profile) ** 2
        for each in QUANTITIES if share > STRESSED_WEB else ():
            if each.ridge_stress:
                values.pop(each.key, None)
    return values


def friction_values(solved: MeshSolution) -> dict[str, float]:
    """Values of friction that are not prescribed, by key of summary.json: in each direction the
    creepage or shift where the force is prescribed, else the force of the wheel on the rail in
    rolling, over mu N. Empty without friction; forces of 0 are left out.
    """
    friction, scene = solved.solution.friction, solved.plan.scene
    if friction is None:
        return {}
    rolling, values = scene.rolling.prescribed, {}
    pairs = zip(scene.tangential_forces[1:], friction.force, strict=True)
    for index, (prescribed, force) in enumerate(pairs):
        if prescribed:
            values[MOTION[rolling][index]] = friction.rigid_motion[index]
        elif rolling and force:
            values[f"force_{('along', 'across')[index]}_N"] = force / friction.friction_limit
    return values


def reading_errors(found: Findings) -> dict[str, float]:
    """Relative difference of two ways of reading the same solution, by key; for the largest
    stresses the grid of tractions (`Findings.surface_error`), and, where the patch is not Hertz's,
    twice (RIDGE_STRESS_FACTOR) the error of the largest pressure.
    """
    errors = {key: found.patch.scatter[name] for key, name in SCATTER.items()}
    if not found.largest:
        return errors
    # The stress below a ridge of the pressure is as uncertain as the ridge.
    ridge = 0.0 if found.hertzian else RIDGE_STRESS_FACTOR * found.patch.scatter["max_pressure"]
    keys = [each.key for each in QUANTITIES if each.ridge_stress]
    return errors | {key: ridge + found.surface_error.get(key, 0.0) for key in keys}


def friction_errors(
    solved: Answered, found: FrictionSolution | None, area: float, pressure: float
) -> dict[str, tuple[float, float]]:
    """Two errors of each number of friction by key of summary.json: what the error of the patch
    changes, and what the grids of the tractions leave. Those of forces are over mu N, that of the
    stick share is absolute, others are relative. Numbers that are given or 0 have none; empty
    without grids.

    solved: has findings. found: tractions; None: of all mu N. area, pressure: relative errors of
        the area and of the largest pressure. Between several patches forces may move.
    """
    errors, friction, felt = dict[str, tuple[float, float]](), solved.forces, 1.0
    if found is not None and solved.findings is not None:
        felt = found.used if len(solved.findings.patch.each) > 1 else found.sensitivity
    values = _with_rises(friction)
    for key in friction.get("grid_error", {}).keys() - {"limit_N", "coefficient"}:
        value, change = abs(values[key]), friction["grid_error"][key]
        if key in friction["given"] or not value:
            continue
        if key in FRICTION_SHARES:
            errors[key] = felt * area, change / friction["limit_N"]
        elif key == "stick_share":
            errors[key] = area * value, change
        else:
            more = {"moment_Nmm": area / 2, "traction_max_MPa": pressure}
            errors[key] = area + more.get(key, 0.0), change / value
    return errors


def _with_rises(friction: Mapping[str, Any]) -> Mapping[str, Any]:
    """Entry "friction" of "result", with both temperature rises by keys of their own."""
    rises = friction.get("temperature_rise_max_K", {}).values()
    return {**friction, **dict(zip(RISE, rises, strict=False))}


Numbers = Mapping[str, float]
"""Values by key of summary.json."""
FRICTION_SHARES = {each.key for each in QUANTITIES if each.over_friction_limit}
"""Keys of forces of friction, whose values are over mu N (`friction_values`)."""
PROMISED = {*ESTIMATED, *FRICTION_SHARES, *MOTION[True], *MOTION[False]}
"""Keys that are compared with a wanted accuracy: sizes and values, forces, and the motion where a
force is given."""


def mesh_errors(
    meshes: Sequence[tuple[float, Numbers]], envelopes: Family | None
) -> tuple[dict[str, float], str]:
    """Mesh part of the errors of the finest mesh by key, and their source in words.

    meshes: n (elements per smaller semi-axis) and values by key of each mesh, the finest last.
    envelopes: calibrated error envelopes that hold for the scene, None without.

    Where no envelope covers the run, or the family has no law of a quantity, the part is twice
    (SCATTER_FACTOR) the larger change between the last three meshes. The earlier change is divided
    by 1.6 (STEP). With fewer meshes there is no part, and the words say why.
    """
    (n, fine), *before = reversed(meshes)
    parts: dict[str, float] = {}
    none: Numbers = {}
    source = "no calibrated family"
    if envelopes is not None and not envelopes.covers(n):
        source = (
            "{:.3g} elements a half length; laws of the family {} hold from {:.3g} to {:.3g}"
        ).format(n, envelopes.name, *envelopes.resolution)
    elif envelopes is not None:
        known = envelopes.laws.keys() & fine.keys()
        parts = {name: envelopes.mesh(name, n) for name in known}
        source = f"law of the family {envelopes.name}"
    middle, coarse, *_ = *_steps(n, before), none, none
    for name in fine.keys() & middle.keys() & coarse.keys() - parts.keys():
        last, earlier = _change(middle, fine, name), _change(coarse, middle, name)
        parts[name] = SCATTER_FACTOR * max(last, earlier / STEP)
        source = "scatter of three meshes"
    return parts, source


def _steps(n: float, before: Sequence[tuple[float, Numbers]]) -> list[Numbers]:
    """Values of the earlier meshes that are each coarser than the next one by a factor of at least
    1.5 (APART), the finest first. n: elements per smaller semi-axis of the finest mesh; before: n
    and values of the others, the finest first.
    """
    apart = []
    for m, values in before:
        if n >= APART * m:
            apart.append(values)
            n = m
    return apart


def _change(one: Numbers, other: Numbers, name: str) -> float:
    """Absolute value of the relative change of the quantity `name` from `other` to `one`, infinite
    where `other` is 0; for forces of friction, which are over mu N, that of the difference.
    """
    if name in FRICTION_SHARES:
        return abs(one[name] - other[name])
    return abs(one[name] / other[name] - 1) if other[name] else math.inf


def _of_rigid_bodies(solved: MeshSolution) -> set[str]:
    """Keys of the largest stresses that are in a body that is not meshed. They follow from the
    largest pressure of the solution.
    """
    stress = (solved.result or {}).get("stress", {})
    return {
        each.key
        for each in QUANTITIES
        if each.ridge_stress and stress.get(each.key.replace("_MPa", "_body")) in solved.plan.rigid
    }


def of_strain(
    plan: Plan, found: FrictionSolution, findings: Findings, approach: float
) -> dict[str, float]:
    """What a creepage along of second order (STRAIN), whose value is not known, changes in solids
    of like materials that roll, by key in its unit: the creepage where its force is given, else
    force, moment and T-gamma. The force grows as of Vermeulen and Johnson, J. Appl. Mech. 31
    (1964), from Kalker's linear theory on, and turns with the creepage. found, findings: tractions
    and patch. approach: mm.
    """
    scene = plan.scene
    creepage = STRAIN * approach / scene.wheel.rolling_radius
    if scene.rolling.force_along is not None:
        return {"creepage_along": creepage}
    a, b, pair = findings.patch.a, findings.patch.b, plan.context.half_spaces.materials
    c11 = kalker.coefficients(min(max(a / b, 0.05), 20.0), pair.poisson).c11
    slope = c11 * pair.shear_modulus * a * b * max(1 - found.used, 0.0) ** (2 / 3)
    along, across, spin = map(abs, found.rigid_motion)
    size = math.hypot(along, across) or 1.0
    turning = found.used * found.friction_limit / size - slope  # what turns beyond what grows
    force = (slope + turning * (across / size) ** 2) * creepage
    aside = abs(turning) * along * across / size**2 * creepage
    moment = slope * creepage * math.sqrt(a * b) / 2
    work = abs(found.force[0]) * creepage + force * along + aside * across + moment * spin
    return {
        "force_along_N": force,
        "force_across_N": aside,
        "moment_Nmm": moment,
        **dict.fromkeys(("t_gamma_N", "wear_number_N"), work),
        "power_W": work * (scene.rolling.speed or 0.0),
    }


def estimate(meshes: Sequence[MeshSolution]) -> tuple[Parts, str]:
    """Error estimates of the last of a scene's meshes by key, and the source of their mesh parts in
    words (rank 0; empty elsewhere). meshes: coarsest first.

    A quantity has no estimate without a mesh part or where its readings differ without bound. A run
    without convergence has no estimates, nor has one with yield for whose load steps there is no
    law.
    """
    solved = meshes[-1]
    if solved.findings is None or not solved.solution.newton.converged:
        return {}, "no solution"
    steps = solved.plan.load_step_errors
    if solved.solution.plasticity is not None and not steps:
        return {}, "the error of the load steps is not known"
    values = [(e.resolution, resolved_values(e)) for e in meshes if e.findings is not None]
    envelopes = solved.family
    parts, source = mesh_errors(values, envelopes)
    soft = solved.plan.scene.solver.method == "penalty"
    overlap = abs(solved.solution.penetration / solved.solution.approach) if soft else 0.0
    readings = reading_errors(solved.findings)
    for key in parts.keys() & _of_rigid_bodies(solved):
        parts[key] = max(parts[key], parts.get("max_MPa", math.inf))
        readings[key] += readings["max_MPa"]
    errors = {
        name: {
            "mesh": mesh,
            "reading": readings.get(name, 0.0),
            "contact_law": overlap * (envelopes.overlap.get(name, 1.0) if envelopes else 1.0),
            "left_out": solved.plan.omission_error,
            "geometry": solved.off_surface / min(solved.plan.zone),
            "load_steps": steps.get(name, 0.0),
            "algebraic": RESIDUAL_FACTOR * (solved.solution.newton.residual or 0.0),
            "profile": solved.plan.profile_error,
        }
        for name, mesh in parts.items()
    }
    found = solved.solution.friction
    if found is not None and "area_mm2" in errors:
        patch = [sum(errors[key].values()) for key in ("area_mm2", "max_MPa")]
        still, strain = solved.forces.get("resolution", {}), dict[str, float]()
        if found.misread is not None:
            strain = of_strain(solved.plan, found, solved.findings, solved.solution.approach)
        for name, (mesh, grid) in friction_errors(solved, found, *patch).items():
            over = abs(_with_rises(solved.forces)[name])
            over = found.friction_limit if name in FRICTION_SHARES else over
            mesh += abs(still.get(name, 0.0)) / over if name != "stick_share" else 0.0
            before = errors.get(name, dict.fromkeys(ALWAYS, 0.0))
            errors[name] = {**before, "mesh": max(mesh, before["mesh"]), "grid": grid}
            errors[name]["strain"] = strain.get(name, 0.0) / over
    estimates = {
        name: {part: value for part, value in each.items() if value or part in ALWAYS}
        for name, each in errors.items()
        if math.isfinite(sum(each.values()))
    }
    return estimates, source
