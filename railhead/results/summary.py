"""summary.json: the contract with everyone who reads results."""

import math
import resource
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from railhead.contact.crossing import Crossing, HeadContact
from railhead.planning import effects
from railhead.planning.effects import material, shape
from railhead.planning.simulation_plan import Plan
from railhead.postprocess import fatigue, friction, symmetry
from railhead.postprocess.findings import OnePatch, Patch
from railhead.postprocess.patch import compare
from railhead.results import checks
from railhead.results.quantity_rows import ROUNDING
from railhead.results.result_folder import origin
from railhead.run import estimates, half_space_answer
from railhead.run.half_space_answer import HalfSpaceSolution, Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.run.refinement import Ending
from railhead.scene.catalogue import portable
from railhead.scene.quantities import numeric_values
from railhead.theory import damage
from railhead.theory.friction.solution import FrictionSolution

HALF_SPACE_SOURCE = "half-spaces: what finite bodies would change, and the error of the grid"
NO_SECTION = {"reason": "boundary elements know no section of bodies that end"}


def summarise(levels: list[MeshSolution], ending: Ending) -> dict[str, Any]:
    """summary.json of the last of a scene's meshes, with error estimates from all of them (rank 0).
    The second methods, half-spaces with and without friction, are solved here.
    ending: why the sequence of meshes ended.
    """
    solved = levels[-1]
    plan, newton = solved.plan, solved.solution.newton
    parts, source = estimates.estimate(levels)
    known = estimates.totals(parts)
    unresolved = solved.forces.get("below_resolution", [])
    reached = None
    if plan.scene.accuracy is not None and solved.findings is not None:
        reached = bool(estimates.largest_error(known, solved) <= plan.scene.accuracy)
    profiles = rubbed = None
    if plan.scene.asks("second_method"):
        profiles, rubbed = half_space_answer.beside(solved)
    second = {**exact_quantities(solved), "allowance": {}} if plan.contact.half_space else profiles
    second, beside = second or NO_SECTION, rubbed
    if not plan.scene.asks("second_method"):
        second = {"reason": checks.NOT_ASKED}
        beside = {"scene": second}
    other = effects.overruled(plan.effects)
    if not all(effects.EFFECTS[name].absent_in_half_spaces for name in other):
        second = {"reason": f"another problem than the scene's was chosen: {', '.join(other)}"}
        beside = None if rubbed is None else {"scene": second}
    judged = checks.run(solved, known, second)
    judged += checks.friction(solved, known, beside)
    judged += checks.passes(solved)
    stages = {key: sum(each.seconds[key] for each in levels) for key in solved.seconds}
    cost, missing = ending.would_cost, checks.not_made(solved, judged, second, beside)
    missing |= checks.not_asked(plan)
    return _summary(
        solved,
        method="finite elements",
        half_space=profiles,
        half_space_friction=rubbed,
        accuracy={
            "asked": plan.scene.accuracy,
            "bound": {name: each for name, each in known.items() if name not in unresolved}
            | _first_yield_error(solved),
            "reached": reached,
            "reason": ending.reason,
            "would_cost": cost and {"unknowns": cost[0], "seconds": cost[1]},
            "source": source,
            "parts": parts,
            "levels": [
                {
                    "elements_per_semi_axis": each.resolution,
                    "patch_size_mm": each.mesh.share * each.plan.grading.size,
                    "unknowns": each.unknowns,
                    "seconds": sum(each.seconds.values()),
                    "result": each.result,
                }
                for each in levels
            ],
        },
        checks={
            **checks.summary(judged, missing),
            "converged": newton.converged and solved.findings is not None,
            "max_penetration_mm": solved.solution.penetration,
        },
        newton={"reason": newton.reason, "history": [vars(step) for step in newton.history]},
        cost={
            "dofs": solved.unknowns,
            "cells": solved.mesh.cells,
            "mesh_quality": solved.mesh.quality,
            "mesh_size_share": solved.mesh.share,
            "ranks": solved.mesh.mesh.comm.size,
            "newton_iterations": len(newton.history),
            "linear_iterations": sum(step.linear_iterations for step in newton.history),
            "peak_rss_MB": _peak_memory(),
            "seconds": {**stages, "total": sum(stages.values())},
        },
    )


def summarise_half_spaces(solved: HalfSpaceSolution) -> dict[str, Any]:
    """summary.json of a solution by half-spaces, with the keys of one by finite elements; nothing
    is compared with a second method.
    """
    unresolved = solved.forces.get("below_resolution", [])
    known = estimates.totals(solved.error_parts)
    bound = {key: each for key, each in known.items() if key not in unresolved}
    asked, reached = solved.plan.scene.accuracy, None
    if asked is not None and solved.findings is not None:
        reached = estimates.largest_bound(bound) <= asked
    missing = {checks.SECOND: "half-spaces are the answer itself"} | checks.not_asked(solved.plan)
    return _summary(
        solved,
        method="half-spaces",
        half_space=None,
        half_space_friction=None,
        accuracy={
            "asked": asked,
            "bound": bound,
            "reached": reached,
            "reason": "half-spaces are solved once",
            "would_cost": None,
            "source": HALF_SPACE_SOURCE,
            "parts": solved.error_parts,
            "levels": [],
        },
        checks={
            **checks.summary([*checks.half_spaces(solved, bound), *checks.passes(solved)], missing),
            "converged": solved.findings is not None,
            "max_penetration_mm": 0.0,
        },
        newton={"reason": solved.reason or "no finite elements", "history": []},
        cost={
            "dofs": 0,
            "cells": 0,
            "mesh_quality": None,
            "mesh_size_share": None,
            "ranks": 1,
            "newton_iterations": 0,
            "linear_iterations": 0,
            "peak_rss_MB": _peak_memory(),
            "seconds": {
                **dict.fromkeys(("mesh", "assemble", "postprocess"), 0.0),
                "solve": solved.seconds,
                "total": solved.seconds,
            },
        },
    )


def _summary(
    solved: Solved,
    *,
    method: str,
    half_space: Mapping[str, Any] | None,
    half_space_friction: Mapping[str, Any] | None,
    accuracy: dict[str, Any],
    checks: dict[str, Any],
    newton: dict[str, Any],
    cost: dict[str, Any],
) -> dict[str, Any]:
    """summary.json of a solution; the arguments are its entries of the same names. Where another
    problem was chosen, the "source" of `accuracy` is changed in place to say so; its "reason" is
    followed by what a wanted accuracy is not asked of.
    """
    result, reference, found = solved.result, solved.elastic_reference, solved.findings
    hertz = exact_quantities(solved)
    if other := effects.overruled(solved.plan.effects):
        accuracy["source"] += f"; of the problem that was chosen ({', '.join(other)})"
    name = "elastic" if solved.residual_state is not None else "frictionless"
    rubbed = {} if half_space_friction is None else {"half_space_friction": half_space_friction}
    more = {} if result is None else _more(solved, accuracy)
    known = accuracy["bound"].keys()
    told = {*known, *numeric_values(result)} - {solved.plan.contact.prescribed_length}
    told |= {*more.get("friction", {}).get("below_resolution", ())}
    accuracy["reason"] += estimates.not_asked(solved.plan, told, known)
    return {
        "case": solved.plan.scene.name,
        "method": method,
        **origin(),
        "scene": portable(solved.plan.scene),
        "plan": solved.plan.summary(),
        "result": result and {**result, **more},
        **({} if reference is None else {name: reference.result}),
        "hertz": hertz,
        "half_space": half_space,
        **rubbed,
        "difference": None if result is None else compare.difference(result, hertz),
        "effects_after": {name: vars(each) for name, each in solved.after.items()},
        "accuracy": accuracy,
        "checks": {
            **checks,
            "hertzian": None if found is None else found.hertzian,
            "shape_error": None if found is None else found.shape_error,
        },
        "newton": newton,
        "cost": cost,
    }


def _peak_memory() -> float:
    """Largest memory of this process (one MPI rank) so far, MB (1e6 bytes)."""
    return 1024e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _more(solved: Solved, accuracy: Mapping[str, Any]) -> dict[str, Any]:
    """Entries "plastic", "friction" (and effects on the steel) and those of passes of "result" in
    summary.json; those that do not apply are missing. accuracy: entry of this name, to whose bounds
    and parts those of "fatigue" are added.
    """
    plan, found, result = solved.plan, solved.findings, solved.result
    assert found is not None and result is not None
    contact, rolling, out = plan.contact, plan.scene.rolling, dict[str, Any]()
    if solved.residual_state is not None:
        out["plastic"] = _plastic(solved)
    if not contact.half_space:
        out["side_force_N"] = _side_force(plan, found.patch)
    if isinstance(contact, HeadContact):
        out |= _heads(contact, found.patch, result, solved.friction)
    height = shape.height_in_patch(contact, found)
    if height is not None:
        ahead = result["contact_point_mm"][0]
        out["surface_shape"] = {"position_mm": ahead, "height_in_patch_mm": height}
    if forces := solved.forces:
        axle = {"axle": rolling.axle} if rolling.from_wheelset else {}
        stresses = friction.wear_and_shakedown(
            found,
            forces,
            material.shear_yield(plan.context),
            poisson=min(plan.poisson_ratios.values()),
            rolling=rolling.prescribed,
            line=contact.line,
        )
        small = [
            key
            for key in friction.LOADS[:2]
            if ROUNDING < abs(forces[key]) / forces["limit_N"] < accuracy["bound"].get(key, 0.0)
        ]
        below = sorted({*forces["below_resolution"], *small} - {*forces["given"]})
        out["friction"] = {**forces, **axle, **stresses, "below_resolution": below}
    if solved.passes is not None and solved.passes.rows:
        out |= solved.passes.summary()
    return (
        out
        | _fatigue(solved, out.get("friction", {}), accuracy)
        | {"yield": _yield(solved, out.get("friction", {}))}
    )


def _fatigue(
    solved: Solved, friction: Mapping[str, Any], accuracy: Mapping[str, Any]
) -> dict[str, Any]:
    """Entry "fatigue" of "result" in summary.json, in a dictionary; empty where it is not asked
    for, where steel yields, of a shift, and of sections along which no wheel rolls. friction:
    "friction" of the result. accuracy: as of `_more`; errors are those of the stresses and of the
    paths.
    """
    plan, found = solved.plan, solved.findings
    line = plan.contact.line and not getattr(plan.hertz, "across", False)
    shifts = solved.friction is not None and not plan.scene.rolling.prescribed
    asked = plan.scene.asks("fatigue") and not shifts and solved.residual_state is None
    if not (asked and found and found.largest and (line or found.patch.each)):
        return {}
    body = found.axis.body
    passes = solved.passes if solved.passes and solved.passes.rows and body == "rail" else None
    section = plan.scene.rail if body == "rail" else plan.scene.wheel
    given = {"dang_van": section.dang_van, "findley": section.findley}
    out = fatigue.read(
        found,
        symmetry.surface(found.surface, solved.mirrors),
        solved.friction,
        plan.context.stressed[body].poisson_ratio,
        slopes=[(given[name] or (slope,))[0] for name, slope in fatigue.SLOPES.items()],
        line=line,
        body=body,
        residual=passes.sections[-1].residual if passes else None,
    )
    bound, parts = accuracy["bound"], accuracy["parts"]
    other = bound.get("tau_max_MPa", bound.get("max_MPa"))
    left = 0.0 if passes is None else passes.residual_error
    if left is None:
        out["estimate"] = {}
    for key, own in out["estimate"].items() if other is not None else ():
        more = {"residual": left / out[key]} if left else {}
        parts[key] = {"stresses": other, "paths": own, **more}
        bound[key] = sum(parts[key].values())
    out |= {
        f"{name}_over_limit": out[f"{name}_MPa"] / limit[1]
        for name, limit in given.items()
        if limit
    }
    pressure, shear = found.patch.max_pressure, material.shear_yield(plan.context)
    used = friction.get("traction_coefficient", 0.0)
    index = None if line else damage.subsurface_fatigue_index(pressure, used)
    traction = friction.get("traction_max_MPa", 0.0)
    surface = None if shear is None else damage.surface_fatigue_index(traction, pressure, shear)
    errors = bound.get("traction_max_MPa") if traction else 0.0, bound.get("max_MPa")
    if surface is not None and None not in errors:
        shares = {"tractions": traction / pressure, "pressure": abs(surface)}
        own = {
            name: share * each for (name, share), each in zip(shares.items(), errors, strict=True)
        }
        bound["fi_surface"], parts["fi_surface"] = sum(own.values()), own
    return {"fatigue": {**out, "fi_surface": surface, "fi_subsurface_MPa": index}}


def _yield(solved: Solved, friction: Mapping[str, Any]) -> dict[str, Any]:
    """Entry "yield" of "result" in summary.json: the elastic p0/k of the load against first yield
    and the limit of shakedown, under repeated rolling, and the same as loads. They are those of
    "friction" where the wheel rolls with it, else of the patch with the largest pressure, as an
    ellipse or line without tractions (`damage.ellipse_limit`, at most twice first yield, where
    stresses left are as large as yield). First yield is that of this shape of patch, and its load
    that of these bodies. Empty without a yield stress or stresses, and where nothing touches.
    """
    context, reference = solved.plan.context, solved.elastic_reference or solved
    found, shear = reference.findings, material.shear_yield(context)
    if shear is None or found is None or not found.largest:
        return {}
    keys = "traction_coefficient", "p0_over_k", "first_yield_p0_over_k", "shakedown_limit_p0_over_k"
    power, ratio = context.contact.load_power, found.patch.max_pressure / shear
    patches: Sequence[OnePatch | Patch] = found.patch.each or [found.patch]
    patch = max(patches, key=lambda one: one.max_pressure)
    first = ratio / context.over_yield
    limit = min(damage.ellipse_limit(patch.a / patch.b), 2 * first)
    limit = damage.LINE if context.contact.line else limit
    out: dict[str, Any] = dict(zip(keys, (0.0, ratio, first, limit), strict=True))
    out["shakedown"] = damage.state(ratio, first, limit)
    if "p0_over_k" in friction:
        out |= {key: friction[key] for key in out}
        out["load_over_first_yield"] = (out[keys[1]] / out[keys[2]]) ** power
    else:
        out["load_over_first_yield"] = context.overload
    out["load_over_shakedown"] = (out[keys[1]] / out[keys[3]]) ** power
    return {**out, "load_N": reference.load}


def _leaning(angle: float, lean: float) -> float:
    """Angle to the horizontal of a plane that is turned by an angle about a line that rises by the
    angle `lean`, with the sign of the turn, rad.
    """
    return math.copysign(math.acos(math.cos(angle) * math.cos(lean)), angle)


def _heads(
    contact: HeadContact, patch: Patch, result: Mapping[str, Any], rubbed: FrictionSolution | None
) -> dict[str, Any]:
    """Entries of "result" for a rail of sections: its patches with their heads, vertical force,
    share, largest pressure and area of each head, and what it has of the tractions; height of the
    wheel, and force of the pressure along the rail. result: those that are known, of which load,
    approach and places are used.
    """
    crossing, each = contact.crossing, patch.each
    tractions = {} if rubbed is None else _rubbed(crossing, rubbed)
    lifts = {name: of.pop("upwards_N") for name, of in tractions.items()}
    names = [crossing.nearest(one.centre) for one in each]
    angles = [
        _leaning(one.angle, crossing.heads[name].touches[0].lean)
        for one, name in zip(each, names, strict=True)
    ]
    upwards = np.array([one.share for one in each]) * np.cos(angles)
    heads, force_along = {}, 0.0
    for name, head in crossing.heads.items():
        own = [k for k, other in enumerate(names) if other == name]
        pressed = float(upwards[own].sum() / upwards.sum()) * (
            result["load_N"] + sum(lifts.values())
        )
        force = pressed - lifts.get(name, 0.0)
        heads[name] = {
            "force_N": force,
            "share": force / result["load_N"],
            "max_MPa": max((each[k].max_pressure for k in own), default=0.0),
            "area_mm2": sum(each[k].area for k in own),
            **({"friction": tractions[name]} if name in tractions else {}),
        }
        force_along += pressed * head.touches[0].rise
    rigid = crossing.height(crossing.lift)
    more = zip(result["patches"], names, angles, strict=True)

    def ahead(place: Sequence[float]) -> list[float]:
        """A place (3,), mm, with x from the axle."""
        return [place[0] + contact.ahead, *place[1:]]

    return {
        "contact_point_mm": ahead(result["contact_point_mm"]),
        "patches": [
            {**of, "centre_mm": ahead(of["centre_mm"]), "head": name, "contact_angle_rad": angle}
            for of, name, angle in more
        ],
        "heads": heads,
        "wheel_height_mm": {"rigid": rigid, "loaded": rigid - result["approach_mm"]},
        "force_along_N": force_along,
    }


def _rubbed(crossing: Crossing, found: FrictionSolution) -> dict[str, dict[str, float]]:
    """Tractions of the finest grid by head that is touched: forces of the wheel on it along and
    across its own tangents, and upwards; largest force that friction allows; share of the sum of
    the forces of all heads, by their sizes; and the mean of the creepages, weighted by pressure.
    """
    touches = [crossing.placed(name)[0] for name in crossing.heads]
    owner = np.abs(found.points[:, 1:2] - [each.y for each in touches]).argmin(axis=1)
    loads, heads = found.weights * found.pressure, {}
    for number, (name, touch) in enumerate(zip(crossing.heads, touches, strict=True)):
        own = (owner == number) & (loads > 0)
        if own.any():
            force = found.weights[own] @ found.traction[own]
            creepage = loads[own] @ found.rigid_slip[own] / loads[own].sum()
            heads[name] = {
                "force_along_N": float(touch.axes[0] @ force),
                "force_across_N": float(touch.axes[1] @ force),
                "limit_N": float(found.weights[own] @ found.bound[own]),
                "creepage_along": float(touch.axes[0] @ creepage),
                "creepage_across": float(touch.axes[1] @ creepage),
                "upwards_N": float(force[2]),
                "share": float(np.linalg.norm(force)),
            }
    whole = sum(each["share"] for each in heads.values())
    return {name: each | {"share": each["share"] / whole} for name, each in heads.items()}


def _first_yield_error(solved: MeshSolution) -> dict[str, float]:
    """Relative error, by its key, of the load over that of first yield: what the largest stresses
    of the elastic solution would make of it, and their misfit. Empty where nothing yields.
    """
    reference, context = solved.elastic_reference, solved.plan.context
    found = reference and reference.findings
    if solved.residual_state is None or not found or not found.largest:
        return {}
    power = context.contact.load_power
    parts = ((found.largest[name], part) for name, part in context.stressed.items() if part.yields)
    ratio = max(each.von_mises.value / part.first_yield for each, part in parts)
    change = abs((ratio / context.over_yield) ** power - 1)
    return {"load_over_first_yield": change + power * found.misfit}


def _side_force(plan: Plan, patch: Patch) -> float:
    """Force of the contact pressure on the rail across the track, N, positive to the field side,
    from the angles of the patches; 0 where y = 0 is a plane of symmetry.
    """
    angles = [(each.share, each.angle) for each in patch.each] or [(1.0, plan.contact.touch.angle)]
    sines = 0.0 if plan.half_y else sum(share * math.sin(angle) for share, angle in angles)
    return sines * patch.mean_pressure * patch.area


def _plastic(solved: Solved) -> dict[str, Any]:
    """Entry "plastic" of "result" in summary.json: yield and the state after unloading."""
    scene, residual, elastic = solved.plan.scene, solved.residual_state, solved.elastic_reference
    assert residual is not None and elastic is not None and elastic.findings is not None
    part = scene.rail if residual.body == "rail" else scene.wheel
    shear = part.first_yield / math.sqrt(3)
    return residual.summary(elastic.findings.patch.max_pressure, shear)


def exact_quantities(solved: Solved) -> dict[str, Any]:
    """Quantities of exact Hertz for the first contact under the vertical load of the solution, as
    "result" of summary.json; load and approach are along the vertical. Where nothing touches, the
    load or approach of the scene is taken. "approach_mm" is None where no formula is known for it.
    """
    contact, hertz, scene = solved.plan.contact, solved.ellipse, solved.plan.scene
    angle, approach = contact.touch.angle, contact.exact_approach(hertz)
    stresses = scene.asks("stresses") or scene.asks("friction_stresses")
    poisson = solved.plan.poisson_ratios if stresses else {}
    return compare.from_exact(hertz, poisson, angle, contact.origin, approach)
