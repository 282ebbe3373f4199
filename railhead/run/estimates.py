"""How large the error of a number is, after the solve.

The estimate of a quantity is the sum of

    mesh          the envelope at n; outside all families the scatter of several meshes
    reading       what two ways of reading the same solution differ by
    contact_law   the overlap that the law lets through, over the approach, times its effect
    left_out      what effects left out by the plan add
    geometry      contact points off the exact surface, over the smaller semi-axis
    profile       what the noise of measured profiles hides (`planning.accuracy.uncertainty`)

Estimates are relative, those of forces by friction shares of mu N. An asked accuracy is one of
sizes and values. Of a place, the depth of the largest shear stress, it
asks that the stress there be that near to the largest one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from railhead.planning.accuracy.error_envelopes import STEP, Family, drop_beside_maximum
from railhead.planning.effects.material import plasticity
from railhead.postprocess.findings import RIVAL
from railhead.postprocess.friction.traction import MOTION
from railhead.theory.elastic.subsurface import max_shear

if TYPE_CHECKING:
    from railhead.postprocess.findings import Findings
    from railhead.run.mesh_solution import MeshSolution

SPREAD = 2.0  # times the change between meshes a step apart: first-order convergence leaves
# 1/(STEP - 1) = 1.67 of it
QUANTITIES = {
    "a_mm": ("patch", "a_mm"),
    "b_mm": ("patch", "b_mm"),
    "area_mm2": ("patch", "area_mm2"),
    "max_MPa": ("pressure", "max_MPa"),
    "approach_mm": ("approach_mm",),
    "tau_max_MPa": ("stress", "tau_max_MPa"),
    "tau_max_depth_mm": ("stress", "tau_max_depth_mm"),
    "von_mises_max_MPa": ("stress", "von_mises_max_MPa"),
}
"""Reported quantities that carry an estimate, and their place under "result" in summary.json."""
SHARES = {"force_along_N", "force_across_N"}
"""Quantities of friction whose error is one of mu N, not of their own size."""
READ = {"a_mm": "a", "b_mm": "b", "area_mm2": "area", "max_MPa": "max_pressure"}
RIDGED = ("tau_max_MPa", "von_mises_max_MPa")
BELOW = 2.0
"""How many times as uncertain as the pressure of a ridge the largest stresses below it are: chosen
on the scenes of seed 1, of which one alone makes three quarters of the law if it is 1."""
SPIKE = 0.02  # of an element: a narrower top of the shear stress is the mesh's own


@dataclass(frozen=True)
class Estimate:
    """Relative error of one quantity, in parts that add up; flatness: of the maximum that it is
    the place of (see `scales`), None of others."""

    mesh: float
    reading: float
    contact_law: float
    left_out: float
    geometry: float
    load_steps: float = 0.0
    profile: float = 0.0
    flatness: float | None = None

    @property
    def parts(self) -> dict[str, float]:
        """By name."""
        values = {name: value for name, value in vars(self).items() if name != "flatness"}
        own = ("load_steps", "profile")  # of bodies that yield, and of measured ones, alone
        return {name: value for name, value in values.items() if value or name not in own}

    @property
    def total(self) -> float:
        """The sum of all parts."""
        return sum(self.parts.values())

    @property
    def counts(self) -> float:
        """What is held against an asked accuracy: of a place what is lost there. Another hill that
        may be the highest is no higher than the error of the largest stress itself."""
        if self.flatness is None:
            return self.total
        return drop_beside_maximum((self.total - self.reading) / self.flatness)


def worst(found: Mapping[str, Estimate], solved: MeshSolution) -> float:
    """The largest of what counts against an asked accuracy; infinite where a quantity that the mesh
    can tell has no estimate."""
    if solved.result is None or set(found) != set(resolved(solved)):
        return math.inf
    return max((each.counts for each in found.values()), default=math.inf)


def flat(result: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of a "result" that it has."""
    values = {}
    for name, path in QUANTITIES.items():
        inner: Any = result
        for key in path:
            inner = None if inner is None else inner.get(key)
        if inner is not None:
            values[name] = float(inner)
    return values


def resolved(solved: MeshSolution) -> dict[str, float]:
    """The quantities of a mesh that it can tell: a largest shear stress within one element of the
    surface, or on a spike much narrower than one, has no depth; the length of a line is given."""
    values = flat(solved.result or {}) | rubbed(solved)
    if solved.plan.contact.line:
        values.pop("b_mm" if solved.plan.contact.lengthwise else "a_mm", None)
    depth = values.get("tau_max_depth_mm")
    if depth is None or solved.findings is None or solved.result is None:
        return values
    flatness = depth * scales(solved.findings, solved.result)["tau_max_depth_mm"]
    if depth < solved.grading.size or flatness < SPIKE * solved.grading.size:
        del values["tau_max_depth_mm"]
    return values


def rubbed(solved: MeshSolution) -> dict[str, float]:
    """What follows of either direction of friction: the motion of a given force, else the force of
    what rolls, over mu N."""
    found, scene = solved.solution.friction, solved.plan.scene
    if found is None:
        return {}
    rolling, values = scene.rolling.prescribed, {}
    for index, (asked, force) in enumerate(
        zip(scene.tangential_forces[1:], found.force, strict=True)
    ):
        if asked:
            values[MOTION[rolling][index]] = found.rigid_motion[index]
        elif rolling and force:
            values[f"force_{('along', 'across')[index]}_N"] = force / found.friction_limit
    return values


def scales(found: Findings, result: Mapping[str, Any]) -> dict[str, float]:
    """What the error of a quantity is in proportion to, where that differs from scene to scene:
    the depth of the largest shear stress is as uncertain as its peak is flat."""
    body, depth = (result["stress"][f"tau_max_{key}"] for key in ("body", "depth_mm"))
    axis = found.depth[body]
    return {
        "tau_max_depth_mm": axis.flatness(max_shear(axis.stress)) / depth if depth else math.inf
    }


def reading(found: Findings, doubt: float = RIVAL) -> dict[str, float]:
    """What two ways of reading the same solution differ by, relative, by quantity; of the depth of
    the largest shear stress, how far other hills are that may be the highest, as they are lower by
    less than `doubt`."""
    peaks = {body: each.tau for body, each in found.largest.items()}
    top = max(peaks.values(), key=lambda peak: peak.value)
    high = {body: each for body, each in peaks.items() if each.value > (1 - doubt) * top.value}
    depths = [depth for peak in high.values() for depth in (peak.depth, *peak.rivals)]
    apart = max(abs(depth - top.depth) for depth in depths)
    for body in high.keys() & found.depth.keys():
        rivals = found.depth[body].rivals(doubt)
        apart = max(apart, max(rivals) - min(rivals))
    scatter = {name: found.patch.scatter[key] for name, key in READ.items()}
    if not found.hertzian:  # the stress below a ridge is as uncertain as the ridge
        scatter |= dict.fromkeys(RIDGED, BELOW * found.patch.scatter["max_pressure"])
    for name in ("tau_max_MPa", "von_mises_max_MPa"):
        scatter[name] = scatter.get(name, 0.0) + found.unread_peak
    return {**scatter, "tau_max_depth_mm": apart / top.depth if top.depth else math.inf}


Numbers = Mapping[str, float]


def mesh_parts(
    levels: Sequence[tuple[float, Numbers, Numbers]], known: Family | None, scale: Numbers
) -> tuple[dict[str, float], str]:
    """Mesh part by quantity and its source, from (n, values, their readings' parts) of each mesh,
    the finest last; scale: see `scales`.

    Two meshes confirm a law where they differ by no more than both estimates allow; what is
    confirmed may be used on a mesh that is finer by STEP than both. Where they
    do not, or no law covers the run, SPREAD times the larger change between the last three meshes
    is taken, the earlier change counted as one step older; with fewer there is no estimate.
    """
    (n, fine, own), *before = reversed(levels)
    parts: dict[str, float] = {}
    denied = 0
    coarser = [m for m, *_ in before]
    if known is not None and known.covers(n, coarser):
        for name in known.laws:
            if name not in fine:
                continue
            factor, read = scale.get(name, 1.0), own.get(name, 0.0)
            if all(
                _change(values, fine, name)
                <= factor * (known.mesh(name, m) + known.mesh(name, n))
                + read
                + readings.get(name, 0.0)
                for m, values, readings in before
                if known.covers(m, coarser) and m < n and name in values
            ):
                parts[name] = factor * known.mesh(name, n)
            else:
                denied += 1
        if not denied:
            return parts, f"law of the family {known.name}"
    apart = _steps(n, before)
    if len(apart) >= 2:
        middle, coarse = apart[:2]
        for name in fine:
            if name not in parts and name in middle and name in coarse:
                last, earlier = _change(middle, fine, name), _change(coarse, middle, name)
                parts[name] = SPREAD * max(last, earlier / STEP)
    if known is None:
        return parts, "scatter of three meshes" if parts else "no calibrated family"
    return parts, f"law of the family {known.name}, where meshes do not deny it"


def _steps(n: float, before: Sequence[tuple[float, Numbers, Numbers]]) -> list[Numbers]:
    """Values of earlier meshes, each a whole STEP (or nearly) coarser than the one after it: of
    two nearly equal meshes the difference is noise."""
    apart = []
    for m, values, _ in before:
        if n >= 0.95 * STEP * m:
            apart.append(values)
            n = m
    return apart


def _change(one: Mapping[str, float], other: Mapping[str, float], name: str) -> float:
    if name in SHARES:
        return abs(one[name] - other[name])
    return abs(one[name] / other[name] - 1) if other[name] else math.inf


def next_resolution(n: float, worst: float, accuracy: float) -> float:
    """A finer mesh after the estimate `worst` missed the accuracy: first order, within a factor
    STEP."""
    return n * min(max(1.1 * worst / accuracy, 1.25), STEP)


def estimate(levels: Sequence[MeshSolution]) -> tuple[dict[str, Estimate], str]:
    """Estimates of the last of some meshes of a scene by quantity, and the source of their mesh
    parts (rank 0). A quantity without a mesh part or without a bound of its reading has none;
    neither has a run that did not converge."""
    solved = levels[-1]
    if solved.result is None or solved.findings is None or not solved.solution.newton.converged:
        return {}, "no solution"
    values = [
        (each.resolution, resolved(each), reading(each.findings))
        for each in levels
        if each.findings is not None
    ]
    known = solved.family
    flatness = scales(solved.findings, solved.result)
    parts, source = mesh_parts(values, known, flatness)
    overlap = 0.0
    if solved.plan.scene.solver.method == "penalty":
        overlap = abs(solved.solution.penetration / solved.solution.approach)
    doubt = 2 * (parts.get("tau_max_MPa", 0.0) + values[-1][2].get("tau_max_MPa", 0.0))
    scatter = reading(solved.findings, max(RIVAL, doubt))
    geometry = solved.off_surface / min(solved.plan.zone)
    found = {
        name: Estimate(
            mesh,
            scatter.get(name, 0.0),
            overlap * (known.overlap[name] if known is not None else 1.0),
            solved.plan.omission_error,
            geometry,
            levels[0].load_step_errors.get(name, 0.0)
            * plasticity.steps(solved.plan.context)
            / solved.plan.load_steps,
            solved.plan.profile_error,
            flatness.get(name),
        )
        for name, mesh in parts.items()
    }
    return {name: each for name, each in found.items() if math.isfinite(each.total)}, source
