"""One solved mesh: mesh, model, solution, findings."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from railhead.geometry.surfaces import ExactGap
from railhead.meshing.mesh import ContactMesh
from railhead.meshing.sizing import Grading
from railhead.planning import effects
from railhead.planning.accuracy import error_envelopes
from railhead.planning.accuracy.error_envelopes import Family, Setting
from railhead.planning.effects import After
from railhead.planning.effects.interface import friction
from railhead.planning.patch.forecast import Forecast, Nearest, Zone
from railhead.planning.plan import Plan
from railhead.planning.references import closed_forms
from railhead.postprocess import compare
from railhead.postprocess.findings import Findings, Frame
from railhead.postprocess.friction import traction
from railhead.postprocess.patch.parts import parts
from railhead.run import build
from railhead.run.progress import Progress
from railhead.theory.elastic.contacts import Hertz

if TYPE_CHECKING:
    from railhead.postprocess.patch.patch import Moments
    from railhead.postprocess.stress.plastic import Left
    from railhead.solver.contact import ContactModel
    from railhead.solver.fields import Fields
    from railhead.solver.solution import Solution

OUTGROWN = 1.25  # patch over the finely meshed ellipse, either way, that calls for a new mesh
MAX_MESHES = 3
MAX_LOADS = 6  # that are tried to meet a given approach between half-spaces ...
REACHED = 1e-9  # ... to this relative error


@dataclass(frozen=True)
class Level:
    """fields, findings and result ("result" of summary.json) are None off rank 0, the last two
    also where nothing touches. space: of the displacement. ellipse: exact Hertz under the load that
    was found. settled: the patch that was found is the one that was meshed for. plain: the same
    without yield or friction, where there is one. Where bodies yield, left: what the load leaves
    (rank 0); stepping: relative error by quantity of taking the load in as many steps as usual,
    where that was looked at."""

    plan: Plan
    grading: Grading
    mesh: ContactMesh
    space: Any
    unknowns: int
    ranks: int
    solution: Solution
    ellipse: Hertz
    fields: Fields | None
    findings: Findings | None
    result: dict[str, Any] | None
    settled: bool
    seconds: dict[str, float]
    plain: Level | None = None
    left: Left | None = None
    stepping: Mapping[str, float] = field(default_factory=dict)

    @property
    def approach_error(self) -> float:
        """Of the approach, relative to the one asked for; 0 where the load is given."""
        asked = self.plan.scene.approach
        return abs(self.solution.approach / asked - 1) if asked else 0.0

    @property
    def after(self) -> dict[str, After]:
        """The effects' indicators on the solution (rank 0)."""
        if self.findings is None:
            return {}
        plan = self.plan
        return effects.check(plan.context, plan.effects, self.findings)

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the patch that was meshed for."""
        return self.grading.resolution

    @property
    def setting(self) -> Setting:
        """What the errors of this mesh depend on, now that the patch is known (rank 0)."""
        plan, found = self.plan, self.findings
        return plan.setting if found is None else replace(plan.setting, ellipse=found.hertzian)

    @property
    def family(self) -> Family | None:
        """Whose error laws hold for it (rank 0): none were measured with yield or friction."""
        return error_envelopes.family(self.setting) if self.plan.plain else None

    @property
    def off_surface(self) -> float:
        """Largest distance in z of touching contact points from the exact surface, mm (rank 0)."""
        gap = self.plan.surfaces.gap(self.plan.slave)
        if self.fields is None or not isinstance(gap, ExactGap):
            return 0.0
        contact = self.fields.contact
        return float(np.max(gap.off_surface(contact.points[contact.pressure > 0]), initial=0.0))

    def finer(self, n: float) -> tuple[Plan, Grading]:
        """Plan and grading of a mesh around the same patch with n elements per semi-axis."""
        plan = self.plan.at_resolution(n)
        return plan, plan.grading()


def solve_level(
    plan: Plan, grading: Grading | None, progress: Progress, comm: MPI.Intracomm
) -> Level:
    """Mesh (as planned without a grading) and solve; where the patch is not the predicted one,
    mesh again around it."""
    grading = grading or plan.grading()
    clock = _Clock()
    frame = plan.contact.frame
    for attempt in range(1, MAX_MESHES + 1):
        progress.stage(f"meshing ({grading.size:.3g} mm in the patch)")
        mesh = build.generate(plan, grading, comm)
        clock.lap("mesh")
        from railhead.solver.fields import gather

        progress.stage("assembling")
        model = build.model(plan, mesh)
        clock.lap("assemble")
        progress.stage(f"solving {model.unknowns} unknowns")
        solution = solve(plan, model, frame, progress.newton)
        clock.lap("solve")
        fields, unknowns, space = gather(model, solution), model.unknowns, model.bulk.space
        left = _left(model, solution, fields, frame)
        plain = _plain(solution)
        plain_fields = None if plain is solution else gather(model, plain)
        model.release()
        better = comm.bcast(None if fields is None else _regrade(plan, grading, fields, frame))
        if better is None or attempt == MAX_MESHES or not solution.newton.converged:
            break
        plan, grading = better
    progress.stage("reading the result")

    def level(fields: Fields | None, solution: Solution) -> Level:
        return _read(
            plan, grading, mesh, (space, unknowns), solution, fields, better is None, clock
        )  # fmt: skip

    found = level(fields, solution)
    if plain is not solution:
        found = replace(found, plain=level(plain_fields, plain), left=left)
    clock.lap("postprocess")
    return found


def solve_on(
    mesh: ContactMesh, model: ContactModel, plan: Plan, progress: Progress, comm: MPI.Intracomm
) -> Level | None:
    """Solve the load of a plan, without yield and friction, on a mesh at least as fine as its own;
    None where that mesh does not suit what is found."""
    clock = _Clock()
    progress.stage(f"solving {model.unknowns} unknowns")
    frame = plan.contact.frame
    solution = solve(plan, model, frame, progress.newton)
    clock.lap("solve")
    from railhead.solver.fields import gather

    fields, grading = gather(model, solution), plan.grading()
    better = comm.bcast(None if fields is None else _regrade(plan, grading, fields, frame))
    if better is not None or not solution.newton.converged:
        return None
    size = model.bulk.space, model.unknowns
    found = _read(plan, grading, mesh, size, solution, fields, True, clock)
    clock.lap("postprocess")
    return found


def _read(
    plan: Plan,
    grading: Grading,
    mesh: ContactMesh,
    size: tuple[Any, int],
    solution: Solution,
    fields: Fields | None,
    settled: bool,
    clock: _Clock,
) -> Level:
    """What a solution on a mesh tells; size: space of the displacement, and unknowns."""
    findings = result = None
    if fields is not None and np.any(fields.contact.pressure > 0):
        frame = plan.contact.frame
        from railhead.postprocess import read

        unlike = solution.friction is not None and friction.unlike(plan.scene)
        parabolic = plan.contact.half_space and solution.plasticity is None and not unlike
        findings = read.findings(fields, frame, solution.friction, parabolic=parabolic)
        result = compare.from_findings(findings, solution.load, solution.approach)
        if solution.friction is not None:
            rolling = plan.scene.rolling
            result["friction"] = traction.quantities(
                solution.friction, rolling=rolling.given, like=not friction.unlike(plan.scene),
                speed=rolling.speed, cycle=plan.scene.friction.cycle,
                patches=np.array([each.centre for each in findings.patch.each] or [frame.origin]),
            )  # fmt: skip
            findings = replace(findings, dissipated=result["friction"].get("t_gamma_N", math.nan))
    ellipse = closed_forms.estimate(plan.scene, plan.contact, solution.load or None)
    return Level(
        plan, grading, mesh, *size, mesh.mesh.comm.size, solution, ellipse, fields, findings,
        result, settled, clock.seconds,
    )  # fmt: skip


def _plain(solution: Solution) -> Solution:
    """The same without yield and friction."""
    return solution if solution.reference is None else _plain(solution.reference)


def _left(
    model: ContactModel, solution: Solution, fields: Fields | None, frame: Frame
) -> Left | None:
    """What the load leaves where something yields (rank 0; collective)."""
    if solution.plasticity is None:
        return None
    from railhead.postprocess.stress import plastic
    from railhead.solver.fields import gather

    unloaded = solution.plasticity.residual_state
    residual = None if unloaded is None else gather(model, unloaded)
    return None if fields is None else plastic.left(solution.plasticity, fields, residual, frame)


def solve(
    plan: Plan, model: ContactModel, frame: Frame, progress: Callable[[int, float], None]
) -> Solution:
    """Solve the plan's load or approach, starting from the forecast."""
    scene = plan.scene

    def at(load: float, approach: float = 0.0) -> Solution:
        return model.solve(
            load=load,
            approach=approach,
            active=plan.forecast.touching(model.setup.kinematics.lift(model.interface.points)),
            max_steps=scene.solver.max_newton,
            progress=progress,
        )

    if scene.load is not None:
        return at(scene.load)
    target = float(scene.approach or 0.0)
    if not model.setup.load_control:
        return at(0.0, target)
    # Half-spaces: the far field needs the load. It grows about as approach^1.5, then by secants.
    load, power = plan.estimate.load, 1.5
    tried: list[tuple[float, float]] = []
    for _ in range(MAX_LOADS):
        solution = at(load)
        found = solution.approach
        if not (solution.newton.converged and found > 0) or abs(found / target - 1) < REACHED:
            break
        tried.append((math.log(load), math.log(found)))
        if len(tried) > 1:
            (load_0, found_0), (load_1, found_1) = tried[-2:]
            power = (load_1 - load_0) / (found_1 - found_0)
        load *= (target / found) ** power
    return solution


def _regrade(
    plan: Plan, grading: Grading, fields: Fields, frame: Frame
) -> tuple[Plan, Grading] | None:
    """A mesh around the patch that was found, where it is not the one that was predicted."""
    if not np.any(fields.contact.pressure > 0):
        return None
    from railhead.postprocess import read

    found = read.moments(fields, frame)
    x, s, a, b = plan.forecast.moments
    fits = all(1 / OUTGROWN < ratio < OUTGROWN for ratio in (found.a / a, found.b / b))
    beside = abs(found.centre[0] - x) / a, abs(found.centre[1] - s) / b
    if fits and max(beside) < OUTGROWN - 1:
        return None
    expected = found_forecast(fields, found, frame)
    if plan.scene.mesh.patch_size is None:
        plan = replace(plan, patch_size=expected.minor / grading.resolution)
    plan = replace(plan, forecast=expected)
    return plan, plan.grading()


def found_forecast(fields: Fields, found: Moments, frame: Frame) -> Forecast:
    """What a finer or better placed mesh can expect, from a solution."""
    contact = fields.contact
    points, touches = contact.points, contact.pressure > 0
    if fields.kinematics.dim == 2:
        x, y, z = np.array(frame.origin) + np.array([*found.centre, 0.0]) @ frame.axes
        zones: tuple[Zone, ...] = (Zone((x, y, z), found.a, found.b, frame.angle),)
    else:
        least = math.sqrt(contact.weights[touches].max() / math.pi)  # one point has no moments
        found = replace(found, a=max(found.a, least), b=max(found.b, least))
        zones = tuple(
            Zone(part.centre, max(part.a, least), max(part.b, least), part.frame.angle)
            for part in parts(fields)
        )
    nearest = Nearest(cKDTree(points), touches, max(zone.b for zone in zones))
    moments = (*found.centre, found.a, found.b)
    return Forecast(zones, moments, nearest, found.hertzian)


class _Clock:
    """Seconds of each stage."""

    def __init__(self) -> None:
        self._last = time.perf_counter()
        self.seconds = dict.fromkeys(("mesh", "assemble", "solve", "postprocess"), 0.0)

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] += now - self._last
        self._last = now
