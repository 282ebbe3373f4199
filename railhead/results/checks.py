"""What a result must meet before it is signed: each check with its value, limit and reason.

The limits follow from physics or from the asked accuracy. Two were set anew after right results had
been refused: that of the noise, and that of the flux with linear cells.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from railhead.meshing.tags import BODY_NAMES
from railhead.planning import effects
from railhead.planning.accuracy.error_envelopes import RANGE
from railhead.planning.sizing import LINEAR_REFINEMENT
from railhead.postprocess.findings import Frame
from railhead.run.estimates import Estimate, flat, resolved, worst
from railhead.run.mesh_solution import MeshSolution
from railhead.scene import steels

ROUGH = 0.05  # relative: what a number without an asked accuracy may be off by at most
BALANCE = 1e-6  # relative: what equations solved to 1e-8 leave
NOISE = 0.5  # relative L2: where half of the pressure is noise, none of it is an answer
FAR_BEYOND = 110.0  # times the load of first yield
SHEAR = (
    0.2,
    0.6,
)  # over the largest pressure: 0.266 to 0.488 in Hertz's ellipses of any axis ratio
# and Poisson's ratio (theory.subsurface), a quarter more room
STRAIN = 0.2  # p0/E*: a sphere's patch then has 0.31 of its radius, Tabor's representative strain
# 0.2 a/R (Johnson 1985, 6.3) is 6 %, and linear theory is off by about as much; it is a choice
HARDEST = (4000.0, 4200.0)  # MPa, largest elastic pressure of a line and of a point contact that
# leaves 1e-4 of the diameter in hardened bearing steel (ISO 76:2006, 3.1 to 3.3)
ROUNDED = 5.25
"""What a fourth power in p^2 changes of the largest over the mean pressure, over the shape error,
to first order: p^2 = (1 - r^2)(1 + c r^2) has c/5 and 4 c/105; a strip has c/8 and c/16."""
MISS = 1.5  # times an estimate: what a signed number may be off by
OPINIONS = (
    "a_mm",
    "b_mm",
    "max_MPa",
    "area_mm2",
    "tau_max_MPa",
    "von_mises_max_MPa",
    "approach_mm",
)
"""Quantities held against a second opinion, as far as it has them and knows what it leaves out."""
HELD = "the shift of bodies that end depends on where they are held"
READ = 0.01  # relative: what reading two largest values apart from each other may cost


@dataclass(frozen=True)
class Check:
    """value must not be above limit (least: not below); source: where the limit comes from;
    advice: what to change where it fails. A value that is not a number fails."""

    name: str
    value: float
    limit: float
    source: str
    advice: str
    least: bool = False

    @property
    def passed(self) -> bool:
        """Whether the limit is kept."""
        return self.value >= self.limit if self.least else self.value <= self.limit


FINER = "give a smaller mesh.patch_size, or an accuracy"
SOLVER = (
    "try solver.gamma_factor=1, solver.method=nitsche with solver.theta=1, a smaller "
    "mesh.patch_size, or solver.linear=direct"
)


def run(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Any],
    *,
    reached: bool | None,
) -> list[Check]:
    """All checks of a solved mesh (rank 0).

    second: quantities nested as "result" that another method computed, with "allowance" and
    "grid_error" as in `half_space_reference.half_space`, or the "reason" why there are none;
    reached: whether the asked accuracy was met, None without one.
    """
    checks = [_effects(solved), *_equations(solved)]
    if solved.result is not None and solved.findings is not None:
        checks += _mesh(solved)
        checks += _physics(solved)
        checks += _shape(solved.elastic_reference or solved, estimates)
        checks += _opinion(solved.elastic_reference or solved, estimates, second)
    if reached is not None:
        off = worst(estimates, solved)
        asked = float(solved.plan.scene.accuracy or 0.0)
        off = off if reached else max(off, math.nextafter(asked, math.inf))
        advice = "ask for less, or give a larger budget; see accuracy.would_cost"
        checks.append(Check("accuracy", off, asked, "asked", advice))
    return checks


def friction(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Mapping[str, Any]] | None,
) -> list[Check]:
    """Tangential forces against the stresses of the bodies, and against half-spaces."""
    found, scene = solved.solution.friction, solved.plan.scene
    if found is None or solved.result is None:
        return []
    out = _tangential(solved)
    other = (second or {}).get("boundary elements") or (second or {}).get("Carter") or {}
    both = list(zip(("along", "across"), found.force, found.rigid_motion, strict=False))
    off = [abs(force - other[name]) / found.friction_limit
           for way, force, _ in both if (name := f"force_{way}_N") in other]  # fmt: skip
    room = ROUGH
    names = ("force_along_N", "force_across_N")
    if drift := solved.result.get("friction", {}).get("resolution"):
        own = [MISS * estimates[name].total for name in names if name in estimates]
        room *= math.hypot(*found.force) / found.friction_limit
        room = max(own, default=room)
        room += MISS * math.hypot(*(drift[name] for name in names)) / found.friction_limit
    room += other.get("grid_error", 0.0)
    if off and scene.rolling.prescribed:
        out.append(
            Check(
                "second_opinion_friction", max(off), room,
                f"half-spaces with friction, over mu N; {MISS:g} times the estimate, or without "
                f"one {ROUGH:g} of the force (unlike bodies: of mu N); {MISS:g} times what is "
                "found without creepage; the error of their grid",
                FINER,
            )
        )  # fmt: skip
    if "shift_along_mm" in other:
        shifts = [(shift, other[f"shift_{way}_mm"]) for way, _, shift in both]
        whole = math.hypot(*(shift for _, shift in shifts))
        out.append(
            Check(
                "second_opinion_shift", max(abs(one - two) for one, two in shifts) / whole, room,
                "half-spaces with friction, over their shift, and the error of their grid", FINER,
            )
        )  # fmt: skip
    return out


def _effects(solved: MeshSolution) -> Check:
    """Effects that are called for, not simulated and not overruled."""
    missing = effects.left_out(solved.plan.effects, solved.after)
    why = "; ".join(f"{name}: {reason}" for name, reason in missing.items())
    overrule = " ".join(f"--without {name}" for name in missing)
    return Check(
        "effects_left_out", float(len(missing)), 0.0, why or "none that is called for",
        f"{overrule} accepts the answer without",
    )  # fmt: skip


def _tangential(solved: MeshSolution) -> list[Check]:
    """The tangential forces, given or found, against those that the stresses of each body carry."""
    from railhead.postprocess.stress.flux import contact_force, pressure_force

    plan, found, fields = solved.plan, solved.solution.friction, solved.fields
    assert found is not None and fields is not None
    axes = Frame(plan.contact.origin, plan.contact.touch.angle).axes[:2]
    _, *given = plan.scene.tangential_forces
    wanted = [asked or force for asked, force in zip(given, found.force, strict=True)]
    pressed = pressure_force(fields)
    return [
        Check(
            f"tangential_flux_{BODY_NAMES[body]}",
            float(np.linalg.norm(axes @ (contact_force(fields, body) - pressed) - wanted))
            / found.friction_limit,
            ROUGH, "the tangential force, over mu N; as for the load", FINER,
        )
        for body in plan.deformable
    ]  # fmt: skip


def _equations(solved: MeshSolution) -> list[Check]:
    solution, scene = solved.solution, solved.plan.scene
    newton = solution.newton
    target = scene.load if scene.load is not None else solution.reaction
    balance = max(_off(solution.load, target), _off(solution.reaction, solution.load))
    found = [
        Check(
            "converged", 0.0 if newton.converged and solved.result is not None else math.inf, 0.0,
            f"Newton's method: {newton.reason}", SOLVER,
        ),
        Check("force_balance", balance, BALANCE, "equations solved to 1e-8", SOLVER),
        Check(
            "approach_reached", solved.approach_error, BALANCE, "the given approach",
            "give the load in the place of the approach",
        ),
        Check(
            "patch_settled", 0.0 if solved.mesh_fits_patch else 1.0, 0.0,
            "the mesh is around the patch that was found",
            "give mesh.patch_size, or a scene whose patch is not at an edge",
        ),
    ]  # fmt: skip
    yielding = solution.plasticity
    if yielding is not None and yielding.residual_state is not None:
        last = yielding.newton_results[-1]
        found.append(
            Check(
                "unloaded", 0.0 if last.converged else 1.0, 0.0,
                f"Newton's method without the load: {last.reason}", SOLVER,
            )
        )  # fmt: skip
    return found


def _mesh(solved: MeshSolution) -> list[Check]:
    plan, found, solution = solved.plan, solved.findings, solved.solution
    assert found is not None
    least = RANGE[0] * (LINEAR_REFINEMENT if plan.order == 1 else 1.0)
    allowed = max(ROUGH, plan.scene.accuracy or 0.0)
    along, wide = found.elements_across
    across = max(along, wide) if plan.section else min(along, wide)
    nodes = _touching_nodes(solved)
    fitted = allowed * math.sqrt(nodes)
    noisy = (
        f"a fit over {nodes} nodes leaves one over their square root of it"
        if fitted < NOISE
        else "where half of the pressure is noise, none of it is an answer"
    )
    return [
        Check(
            "elements_across", across, 2 * least,
            "with a third fewer the largest shear stress was 8 % off, with linear cells the area",
            FINER, least=True,
        ),
        Check(
            "pressure_noise", found.noise, min(fitted, NOISE), noisy, FINER,
        ),
        Check(
            "penetration", solution.penetration / abs(solution.approach), allowed,
            "overlap over approach: it enters pressure and area in proportion",
            "give a larger solver.gamma_factor, or solver.method=nitsche",
        ),
    ]  # fmt: skip


def _touching_nodes(solved: MeshSolution) -> int:
    """Nodes of facets with pressure, of the whole model: as many independent values it has."""
    assert solved.fields is not None
    contact = solved.fields.contact
    touching = contact.facet_nodes[np.unique(contact.facet[contact.pressure > 0])]
    return int(np.unique(touching).size * 2 ** len(solved.fields.mirrors))


def _physics(solved: MeshSolution) -> list[Check]:
    from railhead.postprocess.stress.flux import contact_force

    plan, found, solution, result = solved.plan, solved.findings, solved.solution, solved.result
    assert found is not None and solved.fields is not None and result is not None
    allowed = max(ROUGH, plan.scene.accuracy or 0.0)
    if plan.order == 1:
        allowed *= LINEAR_REFINEMENT  # stresses are constant in linear cells
    fluxes = [
        Check(
            f"flux_{BODY_NAMES[body]}", _off(-contact_force(solved.fields, body)[2], solution.load),
            allowed, "the load; the elements' stresses are integrated around the patch", FINER,
        )
        for body in plan.deformable
    ]  # fmt: skip
    elastic = (solved.elastic_reference or solved).result or result  # yield cuts both
    shear = elastic["stress"]["tau_max_MPa"] / elastic["pressure"]["max_MPa"]
    why = "0.266 to 0.488 in Hertz's ellipses, and a quarter more room"
    mises = elastic["stress"]["von_mises_max_MPa"] / elastic["stress"]["tau_max_MPa"]
    bounds = "von Mises stress over shear stress, sqrt(3) to 2 in any state, and what reading costs"
    checks = [
        *fluxes,
        Check(
            "stress_misfit", found.misfit, allowed,
            "the elements' own stresses around the largest smooth ones, on the average", FINER,
        ),
        Check("shear_over_pressure", shear, SHEAR[1], why, FINER),
        Check("shear_over_pressure_least", shear, SHEAR[0], why, FINER, least=True),
        Check("mises_over_shear", mises, 2.0 * (1 + READ), bounds, FINER),
        Check("mises_over_shear_least", mises, math.sqrt(3.0) * (1 - READ), bounds, FINER,
              least=True),
    ]  # fmt: skip
    if solved.residual_state is not None:
        checks.append(
            Check(
                "load_over_first_yield",
                solved.residual_state.load_over_first_yield,
                FAR_BEYOND,
                "as far as spheres of others go; strains are no longer small beyond",
                "give a smaller load",
            )  # fmt: skip
        )
    checks += _strains(solved)
    across = max(found.elements_across) if plan.section else min(found.elements_across)
    checks.append(
        Check(
            "edge_distance",
            found.edge_distance,
            2 / across,
            "one element, over the smaller half length: at an edge the pressure has no bound",
            "move the wheel, or give wider bodies",
            least=True,
        )  # fmt: skip
    )
    return checks


def _strains(solved: MeshSolution) -> list[Check]:
    """Whether strains are small enough for linear theory, and the pressure for any steel."""
    plan, result = solved.plan, solved.result
    assert result is not None
    pressure, advice = result["pressure"]["max_MPa"], "give a smaller load"
    parts = {"rail": plan.scene.rail, "wheel": plan.scene.wheel}
    checks = [
        Check(
            "small_strain", pressure / plan.estimate.contact_modulus, STRAIN,
            "p0/E*: a sphere's representative strain is 6 % there", advice,
        )
    ]  # fmt: skip
    if any(steels.is_steel(parts[BODY_NAMES[body]].young_modulus) for body in plan.deformable):
        checks.append(
            Check(
                "pressure_of_steel", pressure, HARDEST[0 if plan.contact.line else 1],
                "ISO 76: hardened bearing steel yields beyond", f"{advice}, or a yield_stress",
            )
        )  # fmt: skip
    return checks


def _shape(solved: MeshSolution, estimates: Mapping[str, Estimate]) -> list[Check]:
    """Largest pressure, area and load against each other, where the pressure is a semi-ellipsoid
    (3/2 of the mean) or a semi-ellipse (4/pi)."""
    found, result = solved.findings, solved.result
    assert found is not None and result is not None
    if not found.hertzian:
        return []
    line = solved.setting.shape == "plane strain"
    normal = solved.solution.load / math.cos(solved.plan.contact.touch.angle)
    mean = normal / result["patch"]["area_mm2"]
    peak = (4 / math.pi if line else 1.5) * mean
    names = ("max_MPa", "area_mm2")
    room = sum(_room(estimates, name) for name in names)
    sensitivity = 1.0 if solved.plan.contact.half_space else 2.0 if line else ROUNDED
    off = sensitivity * found.shape_error
    return [
        Check(
            "pressure_over_mean", _off(result["pressure"]["max_MPa"], peak),
            room + off,
            f"{'4/pi' if line else '3/2'} of load over area; both estimates ({room:.2g}) and how "
            "far the pressure is from that shape", FINER,
        )
    ]  # fmt: skip


def _opinion(
    solved: MeshSolution, estimates: Mapping[str, Estimate], second: Mapping[str, Any]
) -> list[Check]:
    """Finite elements against the second opinion, within both errors and what it cannot know."""
    if _unknown(second):
        return []  # `not_made` has the reason
    checks = []
    own, other = resolved(solved), flat(second)
    for name in OPINIONS:
        if name not in own or name not in other:
            continue
        if second["allowance"] and name not in second["allowance"]:
            continue  # it leaves out what nobody has computed
        mine = _room(estimates, name)
        allowance = second["allowance"].get(name, {}).get("total", 0.0)
        allowance += second.get("grid_error", {}).get(name, 0.0)
        checks.append(
            Check(
                f"second_opinion_{name}",
                _off(own[name], other[name]),
                mine + allowance,
                f"{mine:.2g} ({MISS:g} times the estimate, or without one {ROUGH:g}), and "
                f"{allowance:.2g} for what it cannot know",
                "ask for an accuracy, and look at the profiles",
            )  # fmt: skip
        )
    return checks


def _unknown(second: Mapping[str, Any]) -> str:
    """Why a second opinion cannot be compared; empty where it can."""
    return str(second.get("reason") or second["allowance"].get("reason") or "")


def not_made(
    solved: MeshSolution,
    judged: Sequence[Check],
    second: Mapping[str, Any],
    rubbed: Mapping[str, Mapping[str, Any]] | None,
) -> dict[str, str]:
    """Why a second opinion is missing, by the name of the check that was not made of it; second and
    rubbed as in `run` and `friction`."""
    plain = solved.elastic_reference or solved
    if plain.result is None:
        return {}
    made, out = {each.name for each in judged}, {}
    if reason := _unknown(second):
        out["second_opinion"] = reason
    else:
        other = flat(second)
        out = {
            f"second_opinion_{name}": "what half-spaces leave out of it is not known"
            if name in other
            else "the second method does not give it"
            for name in OPINIONS
            if name in resolved(plain) and f"second_opinion_{name}" not in made
        }
    if solved.solution.friction is not None:
        name = "friction" if solved.plan.scene.rolling.prescribed else "shift"
        reasons = [each["reason"] for each in (rubbed or {}).values() if "reason" in each]
        if f"second_opinion_{name}" not in made:
            out[f"second_opinion_{name}"] = next(iter(reasons), HELD)
    return out


def _room(estimates: Mapping[str, Estimate], name: str) -> float:
    """What a signed number may be off by, relative."""
    return MISS * estimates[name].total if name in estimates else ROUGH


def _off(value: float, target: float) -> float:
    """Relative deviation; infinite where there is nothing to compare with."""
    return abs(value / target - 1) if target else math.inf


def summary(checks: list[Check], missing: Mapping[str, str]) -> dict[str, Any]:
    """Value by name, limits with their sources, what failed, and why others were not made
    (missing), as in summary.json."""
    failed = [each.name for each in checks if not each.passed]
    return {
        **{each.name: each.value for each in checks if each.name != "converged"},
        "limits": {each.name: [each.limit, each.source] for each in checks},
        "advice": {each.name: each.advice for each in checks if not each.passed},
        "not_made": dict(missing),
        "failed": failed,
        "passed": not failed,
    }
