"""One solved mesh: mesh, model, solution, findings."""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from railhead.contact import closed_forms
from railhead.geometry.surfaces import ExactGap
from railhead.meshing import mesh
from railhead.meshing.grading import Grading
from railhead.meshing.mesh import ContactMesh
from railhead.planning import effects
from railhead.planning.context import PostSolveVerdict
from railhead.planning.decisions import ELLIPTIC
from railhead.planning.effects import interface
from railhead.planning.error_envelopes import Family
from railhead.planning.forecast import Forecast, Zone, touches_nearby
from railhead.planning.simulation_plan import Plan
from railhead.postprocess import friction, symmetry
from railhead.postprocess.findings import Findings, Frame
from railhead.postprocess.patch import compare, half_space
from railhead.postprocess.patch.separate_patches import contact_frame, separate_patches
from railhead.run.progress import Progress
from railhead.theory.elastic.line import Hertz

if TYPE_CHECKING:
    from railhead.postprocess.pass_rows import Passes
    from railhead.postprocess.patch.moments import PressureMoments
    from railhead.postprocess.stress.plastic import ResidualState
    from railhead.solver.contact import ContactModel
    from railhead.solver.system.fields import Fields
    from railhead.solver.system.solution import Solution
    from railhead.theory.friction.solution import FrictionSolution

# largest ratio of solved and expected patch, either way, for which a mesh is kept:
REMESH_RATIO = 1.25
MAX_MESHES = 3
MAX_APPROACH_SOLVES = 6  # largest number of loads that are tried to meet an approach
APPROACH_TOLERANCE = 1e-9  # largest relative error of that approach


@dataclass(frozen=True, kw_only=True)
class Answered(ABC):
    """What solutions by finite elements and by half-spaces have in common.

    plan: the plan that was solved; its forecast is the one that a mesh was made for.
    findings: patch, pressure and stresses; None where nothing touches, and of finite elements off
        rank 0.
    forces: numbers of friction, as of `postprocess.friction.quantities`; empty without friction,
        and where `findings` is None.
    passes: of the wheel over the rail; None where there are none, and off rank 0.
    """

    plan: Plan
    findings: Findings | None = None
    forces: Mapping[str, Any] = field(default_factory=dict)
    passes: Passes | None = None

    @property
    @abstractmethod
    def load(self) -> float:
        """Vertical load on the wheel that the solution carries, friction included, of the whole
        model, N; 0 without a solution.
        """

    @property
    @abstractmethod
    def approach(self) -> float:
        """Of the supports or, between half-spaces, of distant points, along the vertical, mm."""

    @cached_property
    def result(self) -> dict[str, Any] | None:
        """Entry "result" of summary.json, without "plastic" and what friction does to the steel;
        None without findings.
        """
        if self.findings is None:
            return None
        known = compare.from_findings(self.findings, self.load, self.approach)
        return known | ({"friction": self.forces} if self.forces else {})

    @cached_property
    def after(self) -> dict[str, PostSolveVerdict]:
        """Verdicts by name of the effect or assumption (`effects.check`); empty without
        findings.
        """
        return effects.check(self.plan.context, self.findings)


@dataclass(frozen=True, kw_only=True)
class MeshSolution(Answered):
    """A scene solved on one mesh, and the quantities read from the solution.

    mesh: the mesh with its tags; None after pickling.
    space: function space of the displacement (dolfinx); None after pickling.
    unknowns: number of free unknowns of all ranks.
    solution: displacement, pressure, forces, and history of Newton's method; arrays are those of
        this rank.
    fields: the solution as arrays, of the meshed part and all ranks; None off rank 0.
    mesh_fits_patch: whether the patch lies where the mesh is fine.
    seconds: time by stage "mesh", "assemble", "solve" and "postprocess", s, of all meshes that were
        tried.
    elastic_reference: the same scene without yield and friction, on the same mesh; None where it
        has neither.
    residual_state: yield, and the stresses and shapes that remain after it; None where nothing
        yields and off rank 0.
    """

    mesh: ContactMesh
    space: Any
    unknowns: int
    solution: Solution
    fields: Fields | None
    mesh_fits_patch: bool
    seconds: dict[str, float]
    elastic_reference: MeshSolution | None = None
    residual_state: ResidualState | None = None

    def __getstate__(self) -> dict[str, Any]:
        """The attributes without mesh and space of dolfinx, which cannot be pickled."""
        return {**self.__dict__, "mesh": None, "space": None}

    @cached_property
    def ellipse(self) -> Hertz:
        """Exact Hertz for the curvatures at the first contact, an ellipse or a line contact. Its
        normal force is the solution's vertical load over the cosine of the contact angle; without a
        load in the solution, the load or approach of the scene is taken.
        """
        plan = self.plan
        return closed_forms.hertz_contact(plan.scene, plan.contact, self.solution.load or None)

    @property
    def load(self) -> float:
        """Vertical load of the whole model, friction included, N."""
        return self.solution.load

    @property
    def approach(self) -> float:
        """Of the supports, along the vertical, mm."""
        return self.solution.approach

    @property
    def approach_error(self) -> float:
        """Relative deviation from the scene's approach; 0 where the scene has a load."""
        target = self.plan.scene.approach
        return abs(self.solution.approach / target - 1) if target else 0.0

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the forecast patch that the mesh was made for, not of
        the solved one.
        """
        return self.plan.grading.resolution

    @property
    def family(self) -> Family | None:
        """Calibrated error envelopes that hold for this solution, with the shape of the solved
        patch; None where there are none. A patch that is no ellipse in the plan is one where it is
        read as an ellipse alone. With yield, off rank 0, and where nothing touches, those of the
        plan.
        """
        plan, found = self.plan, self.findings
        if found is None or plan.family is None or plan.effects["plasticity"].on:
            return plan.family
        elliptic = plan.setting["ellipse"] or found.shape_error < ELLIPTIC
        return plan.family_of({**plan.setting, "ellipse": found.hertzian and elliptic})

    @property
    def mirrors(self) -> tuple[Any, ...]:
        """Unit normals of the symmetry planes of the meshed part; none off rank 0."""
        return () if self.fields is None else self.fields.mirrors

    @property
    def friction(self) -> FrictionSolution | None:
        """Tractions at the contact points, images of the meshed part behind it; None without
        friction.
        """
        found, planes = self.solution.friction, [normal for _, normal in self.plan.planes]
        return found and symmetry.tractions(found, planes)

    @property
    def unloaded_fields(self) -> Fields | None:
        """The solution after unloading as arrays; None without yield, where the load is not
        removed, and off rank 0.
        """
        return None if self.residual_state is None else self.residual_state.unloaded

    @property
    def off_surface(self) -> float:
        """Largest distance of touching contact points from the exact surface of the slave, mm; 0
        off rank 0, where nothing touches, and for half-spaces. Each distance is along the surface's
        gradient at the point.
        """
        gap = self.plan.contact.smooth.gap(self.plan.slave)
        if self.fields is None or not isinstance(gap, ExactGap):
            return 0.0
        contact = self.fields.contact
        return float(np.max(gap.off_surface(contact.points[contact.pressure > 0]), initial=0.0))


def generate(plan: Plan, grading: Grading, comm: MPI.Intracomm) -> mesh.ContactMesh:
    """Mesh the bodies of a plan with element sizes `grading`, which need not be the plan's own;
    collective. Raises MeshError where gmsh fails.
    """
    return mesh.generate(plan.parts(), grading, plan.options, comm, meanwhile=_load_solver)


def _load_solver() -> None:
    """Import the modules that solve and read, while gmsh meshes in another process; the import
    takes about as long as a small mesh. Nothing is solved.
    """
    from railhead.postprocess import read  # noqa: F401
    from railhead.solver.system import fields  # noqa: F401


def assemble(plan: Plan, made: mesh.ContactMesh) -> ContactModel:
    """The assembled contact model of a plan on its mesh; collective."""
    from railhead.run.model_setup import setup
    from railhead.solver.contact import ContactModel

    return ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup(plan))


def mesh_and_solve(plan: Plan, progress: Progress, comm: MPI.Intracomm) -> MeshSolution:
    """Mesh the bodies of a plan, solve, and read the result; collective. Where the patch is not the
    expected one, mesh and solve again around it, with at most three (MAX_MESHES) meshes. The last
    solution is returned even where it did not converge or the mesh does not fit the patch. Raises
    MeshError where gmsh cannot mesh the bodies, SceneError as `solve`.
    """
    clock = _Clock()
    for attempt in range(1, MAX_MESHES + 1):
        progress.stage(f"meshing ({plan.grading.size:.3g} mm in the patch)")
        mesh = generate(plan, plan.grading, comm)
        clock.lap("mesh")
        progress.stage("assembling")
        model = assemble(plan, mesh)
        clock.lap("assemble")
        last = attempt == MAX_MESHES
        solved, better = _solve_unread(mesh, model, plan, progress, clock, comm, last=last)
        model.release()
        if better is None or last or not solved.solution.newton.converged:
            break
        plan = better
    progress.stage("reading the result")
    solved = _read(solved)
    clock.lap("postprocess")
    return solved


def _solve_unread(
    mesh: ContactMesh,
    model: ContactModel,
    plan: Plan,
    progress: Progress,
    clock: _Clock,
    comm: MPI.Intracomm,
    *,
    last: bool,
) -> tuple[MeshSolution, Plan | None]:
    """Solve a plan on a mesh (collective): the solution, of which findings are not read yet, and
    the plan of a mesh that fits the patch; None where this mesh does. last: whether there is no
    other mesh to come, so that friction of solids is solved also where this mesh does not fit.
    """
    from railhead.solver.system.fields import gather

    progress.stage(f"solving {model.unknowns} unknowns")
    solution = solve(
        plan,
        model,
        progress.newton,
        stage=progress.stage,
        misplaced=lambda fields: not last and _remesh_for_found_patch(plan, fields) is not None,
    )
    clock.lap("solve")
    fields = gather(model, solution)
    better = comm.bcast(None if fields is None else _remesh_for_found_patch(plan, fields))
    solved = MeshSolution(
        plan=plan,
        mesh=mesh,
        space=model.bulk.space,
        unknowns=model.unknowns,
        solution=solution,
        fields=fields,
        mesh_fits_patch=better is None,
        seconds=clock.seconds,
    )
    elastic = _elastic_reference(solution)
    if elastic is not solution:
        reference = replace(solved, solution=elastic, fields=gather(model, elastic))
        state = _read_residual_state(model, solution, fields, plan.contact.frame)
        if state is not None:
            state = replace(state, load_over_first_yield=plan.context.overload)
        solved = replace(solved, elastic_reference=reference, residual_state=state)
    return solved, better


def _read(solved: MeshSolution) -> MeshSolution:
    """The solution and its elastic reference with findings and numbers of friction. Unchanged off
    rank 0 and where nothing touches.
    """
    plan, solution, fields = solved.plan, solved.solution, solved.fields
    if solved.elastic_reference is not None:
        solved = replace(solved, elastic_reference=_read(solved.elastic_reference))
    if fields is None or not np.any(fields.contact.pressure > 0):
        return solved
    from railhead.postprocess import read

    frame, unlike = plan.contact.frame, interface.unlike(plan.context)
    elastic = solution.plasticity is None and not (unlike and solution.friction is not None)
    parabolic = plan.parabolic and elastic
    stresses = plan.scene.asks("stresses" if solution.friction is None else "friction_stresses")
    findings = read.findings(fields, frame, parabolic=parabolic, stresses=stresses)
    if plan.rigid and stresses:
        findings = half_space.with_rigid_bodies(findings, plan.rigid)
    if solution.friction is not None and stresses:
        section = plan.plane_model and not fields.kinematics.revolved
        findings = half_space.with_surface(
            findings, solution.friction, plan.poisson_ratios, section=section
        )
    if solution.friction is None:
        return replace(solved, findings=findings)
    findings, forces = read_friction(plan, findings, solution.friction)
    return replace(solved, findings=findings, forces=forces)


def read_friction(
    plan: Plan, found: Findings, solution: FrictionSolution
) -> tuple[Findings, dict[str, Any]]:
    """Findings with what friction dissipates, and entry "friction" of "result" in summary.json."""
    rolling = plan.scene.rolling
    quantities = friction.quantities(
        solution,
        rolling=rolling.prescribed,
        like=not interface.unlike(plan.context),
        speed=rolling.speed,
        patches=np.array([each.centre for each in found.patch.each] or [found.frame.origin]),
    )
    given, wing = plan.scene.friction.given, plan.scene.wing
    if wing is not None and wing.friction_coefficient is not None:
        given = [*given, wing.friction_coefficient]
    for key in [key for key in quantities if key.startswith("coefficient")]:
        quantities[key] = min(max(quantities[key], min(given)), max(given))
    if friction.RISE[0] in quantities:
        rises = zip(("rail", "wheel"), (quantities.pop(key) for key in friction.RISE), strict=True)
        quantities["temperature_rise_max_K"] = dict(rises)
    if plan.condenses and not (plan.plane_model or plan.by_half_spaces):
        unread = {*quantities["below_resolution"], *friction.AT_NODES}
        quantities["below_resolution"] = sorted(unread)
    forces = zip(plan.scene.tangential_forces[1:], ("along", "across"), strict=True)
    motions = friction.MOTION[rolling.prescribed]
    quantities["given"] = [motions[2]] + [
        f"force_{way}_N" if force else motion
        for (force, way), motion in zip(forces, motions[:2], strict=True)
    ]
    return replace(found, dissipated=quantities.get("t_gamma_N", math.nan)), quantities


def _elastic_reference(solution: Solution) -> Solution:
    """The solution without yield and friction from which a solution with them started; the solution
    itself where it has neither.
    """
    return solution if solution.reference is None else _elastic_reference(solution.reference)


def _read_residual_state(
    model: ContactModel, solution: Solution, fields: Fields | None, frame: Frame
) -> ResidualState | None:
    """Yield, and what remains after unloading, collected from a solution; nothing is solved here.
    None where nothing yields and off rank 0; without unloading, and where it did not converge, only
    what yielded under the load.
    Collective. frame: axes at the first contact.
    """
    if solution.plasticity is None:
        return None
    from railhead.postprocess.stress import plastic
    from railhead.solver.system.fields import gather

    after, last = solution.plasticity.residual_state, solution.plasticity.newton_results[-1]
    unloaded = gather(model, after) if after is not None and last.converged else None
    if fields is None:
        return None
    frame = contact_frame(separate_patches(fields), frame)
    return plastic.residual_state(solution.plasticity, fields, unloaded, frame)


def solve(
    plan: Plan,
    model: ContactModel,
    progress: Callable[[int, float], None] = lambda *_: None,
    *,
    stage: Callable[[str], None] = lambda name: None,
    misplaced: Callable[[Fields], bool] = lambda fields: False,
) -> Solution:
    """Solve for the scene's load or approach, starting from the contact points of the forecast
    patch; collective. A solution that did not converge is returned, too.

    progress: called with number and relative residual of each Newton step.
    stage: called with the name of each stage of friction.
    misplaced: whether a patch needs another mesh, so that friction of solids is left out; asked on
        rank 0 only.

    Between half-spaces the far field is that of a load. A given approach is then met by secants in
    the logarithms of load and approach, from load ~ approach^1.5 (Hertz), in at most
    six (MAX_APPROACH_SOLVES) solutions. Raises SceneError where friction has too many unknowns.
    """
    from railhead.run import solid_friction

    scene = plan.scene
    tractions = partial(
        solid_friction.solve_by_suited_method,
        stage=stage,
        parabolic=plan.parabolic,
        misplaced=misplaced,
    )

    def at(load: float, approach: float = 0.0) -> Solution:
        """The solution under a vertical load (N) or, without load control, an approach of the
        supports (mm).
        """
        return model.solve(
            load=load,
            approach=approach,
            active=plan.forecast.touching(model.setup.kinematics.lift(model.interface.points)),
            max_steps=scene.solver.max_newton,
            progress=progress,
            friction=tractions,
        )

    if scene.load is not None:
        return at(scene.load)
    target = float(scene.approach or 0.0)
    if not model.setup.load_control:
        return at(0.0, target)
    load, power = plan.hertz.load, 1.5
    before: tuple[float, float] | None = None
    for _ in range(MAX_APPROACH_SOLVES):
        solution = at(load)
        found = solution.approach
        if (
            not (solution.newton.converged and found > 0)
            or abs(found / target - 1) < APPROACH_TOLERANCE
        ):
            break
        if before is not None:
            power = math.log(load / before[0]) / math.log(found / before[1])
        before = load, found
        load *= (target / found) ** power
    return solution


def _remesh_for_found_patch(plan: Plan, fields: Fields) -> Plan | None:
    """Plan of a mesh around the solved patch; None where half lengths are the expected ones within
    a factor 1.25 (REMESH_RATIO) and the centre within a quarter of them, or nothing touches. A
    patch size that the scene gives is kept. fields: on rank 0.
    """
    if not np.any(fields.contact.pressure > 0):
        return None
    from railhead.postprocess.patch.moments import moments

    frame = plan.contact.frame
    found = moments(fields, frame)
    x, s, a, b = plan.forecast.moments
    fits = all(1 / REMESH_RATIO < ratio < REMESH_RATIO for ratio in (found.a / a, found.b / b))
    beside = abs(found.centre[0] - x) / a, abs(found.centre[1] - s) / b
    if fits and max(beside) < REMESH_RATIO - 1:
        return None
    expected = forecast_from_solution(fields, found, frame)
    if plan.scene.mesh.patch_size is None:
        plan = replace(plan, patch_size=expected.minor / plan.grading.resolution)
    return replace(plan, forecast=expected)


def forecast_from_solution(fields: Fields, found: PressureMoments, frame: Frame) -> Forecast:
    """Forecast, for the next mesh, that expects the patches of a solution where they were found:
    one place in a section, in a solid one for each separate patch. Half lengths are not below the
    radius of the largest area of a contact point.

    fields: the solution. found: moments of the whole pressure (centre, half lengths) in `frame`,
        the frame of the first contact.
    """
    contact = fields.contact
    points, touches = contact.points, contact.pressure > 0
    if fields.kinematics.dim == 2:
        x, y, z = np.array(frame.origin) + np.array([*found.centre, 0.0]) @ frame.axes
        zones = [Zone((x, y, z), found.a, found.b, frame.angle)]
    else:
        least = math.sqrt(contact.weights[touches].max() / math.pi)  # one point has no moments
        found = replace(found, a=max(found.a, least), b=max(found.b, least))
        zones = [
            Zone(part.centre, max(part.a, least), max(part.b, least), part.frame.angle)
            for part in separate_patches(fields)
        ]
    touching = partial(touches_nearby, cKDTree(points), touches, max(zone.b for zone in zones))
    moments = (*found.centre, found.a, found.b)
    return Forecast(tuple(map(_rounded, zones)), moments, touching, found.hertzian)


def _rounded(zone: Zone) -> Zone:
    """The patch with lengths in steps of 1e-6 to 1e-5 of its smaller half length, and its angle in
    steps of 1e-6 rad: rounding, which differs with the number of processes, makes no other mesh.
    """
    digits = 5 - math.floor(math.log10(min(zone.a, zone.b)))
    x, y, z, a, b = (round(float(value), digits) for value in (*zone.centre, zone.a, zone.b))
    return Zone((x, y, z), a, b, round(zone.angle, 6))


class _Clock:
    """Stopwatch of the stages of a run.

    seconds: time by stage "mesh", "assemble", "solve" and "postprocess", s; every solution that is
        made with this clock holds the same dictionary.
    """

    def __init__(self) -> None:
        """Start now, with zero seconds for each stage."""
        self._last = time.perf_counter()
        self.seconds = dict.fromkeys(("mesh", "assemble", "solve", "postprocess"), 0.0)

    def lap(self, stage: str) -> None:
        """Add the time since the last call to the seconds of a stage."""
        now = time.perf_counter()
        self.seconds[stage] += now - self._last
        self._last = now
