"""A solved scene: its numbers by name, its fields, files and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal

from mpi4py import MPI
from rich.console import Console

from railhead.planning.simulation_plan import Plan
from railhead.postprocess import symmetry
from railhead.postprocess.findings import BASE_UNITS, Array, Drawing, Findings, Surface, Units
from railhead.results.report import terminal
from railhead.run.half_space_answer import Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.scene import quantities
from railhead.scene.catalogue import as_path
from railhead.scene.sections import refuse_first

if TYPE_CHECKING:
    from railhead.solver.system.fields import Fields
    from railhead.theory.elastic.line import Hertz
    from railhead.theory.friction.solution import FrictionSolution

BOUNDS = {
    each.bound: each.key
    for each in quantities.QUANTITIES
    if each.estimated or each.table == "friction"
}
"""Keys in summary.json of what `Result.estimate` names, by that name."""


@dataclass(frozen=True, repr=False)
class Result(terminal.Drawn):
    """A solved scene. `summary` and the numbers made from it are the same on all MPI ranks.
    `fields`, `findings`, `surface`, `stress_at` and `plot` are on rank 0 only (findings and surface
    of half-spaces on every rank). On others the first two are None, the rest raises ValueError. The
    dolfinx mesh is distributed.

    solution: on the finest mesh, or by half-spaces; None of a result that was loaded.
    summary: content of summary.json.

    The properties `patch`, `pressure`, `stress`, `friction`, `plastic`, `load` and `approach` hold
    numbers of that solution, `hertz` the same of exact Hertz, `estimate` bounds of relative errors.
    `railhead.scene.quantities` describes each number. Where nothing touches, all of them but
    `hertz` and `estimate` raise ValueError. They are of the whole model, images in symmetry planes
    included. A loaded result has `summary` and these numbers; all that needs the solution raises
    ValueError.
    """

    solution: Solved | None
    summary: dict[str, Any]

    def __repr__(self) -> str:
        """Scene, load, largest pressure, area and verdict in one line."""
        if self.summary["result"] is None:
            return f"<Result {self.summary['case']}: nothing touches>"
        verdict = "passed" if self.passed else f"failed {', '.join(self.failed)}"
        return (
            f"<Result {self.summary['case']}: {self.load:.6g} N, {self.pressure.max:.5g} MPa on "
            f"{self.patch.area:.4g} mm2, {verdict}>"
        )

    def show(self, console: Console, units: Units | None = None) -> None:
        """Print the table of `railhead run` on a console. units: units of the numbers; None: mm, N,
        MPa.
        """
        terminal.show_result(self.summary, console, units or BASE_UNITS)

    def as_dict(self) -> dict[str, Any]:
        """The content of summary.json."""
        return self.summary

    @property
    def passed(self) -> bool:
        """Whether all checks that were made hold."""
        return bool(self.summary["checks"]["passed"])

    @property
    def failed(self) -> list[str]:
        """Names of the checks that failed, in the order of the checks."""
        return list(self.summary["checks"]["failed"])

    @property
    def patch(self) -> quantities.PatchQuantities:
        """Half lengths and area of the contact patch. ValueError: nothing touches."""
        return self._answer.patch

    @property
    def pressure(self) -> quantities.PressureQuantities:
        """Largest and mean contact pressure. ValueError: nothing touches."""
        return self._answer.pressure

    @property
    def stress(self) -> quantities.StressQuantities:
        """The largest shear and von Mises stresses of both bodies, away from sharp edges and held
        faces, and where they are. ValueError: nothing touches.
        """
        return self._answer.stress

    @property
    def plastic(self) -> quantities.PlasticQuantities | None:
        """Yield under the load and the state after unloading; None where nothing yields or yield
        was not simulated. ValueError: nothing touches.
        """
        return self._answer.plastic

    @property
    def surface_shape(self) -> quantities.SurfaceShapeQuantities | None:
        """Where surfaces that vary along the rail touch; None where they do not vary. ValueError:
        nothing touches.
        """
        return self._answer.surface_shape

    @property
    def friction(self) -> quantities.FrictionQuantities | None:
        """Forces, creepages or shifts, and stick; None without friction. ValueError: nothing
        touches.
        """
        return self._answer.friction

    @property
    def load(self) -> float:
        """Vertical component of the force between the bodies, friction included, of the whole
        model, N. At a contact angle the normal force is larger. ValueError: nothing touches.
        """
        return float(self._answer.load)

    @property
    def approach(self) -> float:
        """Vertical approach of the bodies' supports, mm; where half-spaces answer, that of distant
        points of theirs. ValueError: nothing touches.
        """
        return float(self._answer.approach)

    @property
    def hertz(self) -> quantities.Answer:
        """Quantities of exact Hertz for the curvatures at the first contact, under the same
        vertical load; where nothing touches, under the load or approach of the scene.
        """
        return quantities.read(quantities.Answer, self.summary["hertz"])

    @property
    def estimate(self) -> SimpleNamespace:
        """Bounds of the relative errors of the solution, as attributes: a, b, area, pressure_max,
        approach, tau_max, von_mises_max, and those of friction: force_along and force_across (over
        mu N), creepages or shifts. None where there is no bound.

        source: where the bounds come from, or why there are none. What `friction.below_resolution`
            names has none either.
        """
        said = self.summary["accuracy"]
        bounds = {name: said["bound"].get(key) for name, key in BOUNDS.items()}
        return SimpleNamespace(**bounds, source=said["source"])

    @property
    def _answer(self) -> quantities.Answer:
        """Quantities of the solution, read from `summary`. ValueError: there is no result, as
        nothing touches or the solution did not converge.
        """
        if self.summary["result"] is None:
            raise ValueError("there is no result: nothing touches, or it did not converge")
        return quantities.read(quantities.Answer, self.summary["result"])

    @property
    def mesh_solution(self) -> MeshSolution:
        """The solution on the finest mesh; its arrays are those of this rank. ValueError:
        half-spaces answered, which have no mesh, or the result was loaded.
        """
        if not isinstance(self.solved, MeshSolution):
            raise ValueError("half-spaces have no mesh; effects.finite_bodies=auto solves bodies")
        return self.solved

    @property
    def solved(self) -> Solved:
        """The solution, by finite elements or half-spaces. ValueError: the result was loaded, and
        has numbers only.
        """
        if self.solution is None:
            raise ValueError("a loaded result has numbers only; solve the scene again for fields")
        return self.solution

    @property
    def comm(self) -> MPI.Intracomm:
        """The MPI ranks that share the result: COMM_WORLD of half-spaces, which each rank has
        completely; COMM_SELF of a pickled result. ValueError: the result was loaded.
        """
        if not isinstance(self.solved, MeshSolution):
            return MPI.COMM_WORLD
        return MPI.COMM_SELF if self.solved.mesh is None else self.mesh.comm

    @property
    def mesh(self) -> Any:
        """The dolfinx mesh of the deformable bodies (of the meshed part, where there is symmetry),
        mm; of a section with two coordinates.
        ValueError: half-spaces answered, or the result was pickled or loaded.
        """
        if self.mesh_solution.mesh is None:
            raise ValueError("a pickled result has no dolfinx mesh; solve the scene again for it")
        return self.mesh_solution.mesh.mesh

    @property
    def displacement(self) -> Any:
        """Displacement as a dolfinx Function on `mesh`, mm; collective, as ghosts are updated.
        ValueError: as of `mesh`.
        """
        from railhead.solver import compat

        assert self.mesh is not None
        return compat.function(self.mesh_solution.space, self.mesh_solution.solution.displacement)

    @property
    def surface(self) -> Surface:
        """Contact surface of the body that carries the contact points (the slave, `plan.slave`), at
        its n nodes: `points` (n, 3) in space, undeformed, mm; smooth `pressure` (n,), MPa; `gap`
        (n,) of the deformed surfaces, mm, negative where they overlap; `displacement` (n, 3), mm;
        `triangles` (t, 3), rows of the nodes, of a section lines (t, 2). Images of what symmetry
        left out come behind the part that was meshed, without sharing nodes.

        Of half-spaces the nodes are centres of cells, and the displacement is NaN. The gap of
        boundary elements is infinite where the bodies do not face each other, that of exact Hertz
        is NaN. ValueError: nothing touches; off rank 0, but for half-spaces, which every rank has;
        or the result was loaded.
        """
        if self.findings is None:
            raise ValueError("there is no contact surface: nothing touches, or this is not rank 0")
        return symmetry.surface(self.findings.surface, self.solved.mirrors)

    @property
    def tractions(self) -> FrictionSolution | None:
        """Friction at the n contact points of all ranks, images of the meshed part behind it, of
        half-spaces at the cells that touch: `points` (n, 3) in space, mm; `weights` (n,), areas,
        mm2; `pressure` (n,), MPa; `traction` (n, 3) of the wheel on the rail, MPa; `slip` (n, 3)
        of the wheel over the rail, mm, rolling without dimension; `sticks` (n,). None without
        friction. ValueError: the result was loaded.
        """
        return self.solved.friction

    @property
    def contact_points(self) -> dict[str, Array]:
        """Arrays over the n points of the whole patch that touch, by name: "points" (n, 3) in
        space, mm; "pressure" (n,), MPa. Without friction these are nodes of `surface`.

        With friction, of `tractions`: "area" (n,), mm2; "traction" (n, 3), MPa; "slip" (n, 3) and
        "sticks" (n,). Where the wheel rolls: "dissipation" (n,), traction times slip, MPa, the
        energy per area and rolled length; with a speed "power" (n,), W/mm2; with heat "rise_rail"
        and "rise_wheel" (n,), K. ValueError: as of `surface`.
        """
        found, rolling = self.tractions, self.plan.scene.rolling
        if found is None:
            surface = self.surface
            values = {"points": surface.points, "pressure": surface.pressure}
        else:
            names = "points", "pressure", "traction", "slip", "sticks", "rise_rail", "rise_wheel"
            values = {name: getattr(found, name) for name in names}
            values["area"] = found.weights
            if rolling.prescribed:
                values["dissipation"] = (found.traction * found.slip).sum(axis=1)
            if rolling.speed is not None:
                values["power"] = rolling.speed * values["dissipation"]
        touches = values["pressure"] > 0
        return {name: each[touches] for name, each in values.items() if each is not None}

    def stress_at(self, points: Array, body: str | None = None) -> Array:
        """Smooth stress (n, 6), components xx, yy, zz, xy, xz, yz in global axes, MPa, tension
        positive, at points (n, 3) in space of the undeformed bodies, mm; NaN outside of them.
        Points may lie in images of the meshed part; of a section in plane strain only their place
        in its plane counts.

        body: "rail" or "wheel"; None: for each point the one with the nearer cell.
        ValueError: points of another shape or not finite, a body that is rigid, off rank 0,
            half-spaces, or a loaded result.
        """
        from railhead.postprocess.stress import recovery

        if self.fields is None:
            raise ValueError("no fields: half-spaces answered, or this is not rank 0")
        return recovery.stress_at(self.fields, points, body)

    def save(
        self,
        folder: str | Path,
        *,
        pictures: bool = True,
        report: bool | Literal["brief"] = True,
        units: Units | None = None,
        force: bool | None = False,
    ) -> None:
        """Write the files of `railhead run` into a folder. Under MPI to be called on all ranks;
        rank 0 writes, errors are raised on all.

        pictures: whether PNG files are written; not where the scene does not ask for them.
        report: whether report.html is written, "brief" on one page; without pictures it is not.
        units: of pictures and report.html; None: mm, N, MPa.
        force: whether a result of another command or scene in the folder is replaced; one of the
            same scene always is. None: another one is renamed to NAME.1, or the first free number.
        Raises SceneError for a folder with other files and, without `force`, with another result,
        and for a report or units that are none; OSError where it cannot be written, ValueError for
        a loaded result.
        """
        from railhead.results import files, result_folder

        known, named = report in (True, False, "brief"), isinstance(units, Units | None)
        refuse_first(
            (not known, "report", f"{report!r} is not allowed; give True, False or 'brief'"),
            (not named, "units", f"{units!r} is no `Units`; give output_units.parse of a text"),
        )
        problem: Exception | None = None
        comm, out = self.comm, as_path(folder, "folder")
        pictures = pictures and self.plan.scene.asks("pictures")
        if comm.rank == 0:
            try:
                result_folder.check_free(out, "run", self.plan.scene, force=force is not False)
                files.write(
                    self.solved,
                    self.summary,
                    out,
                    pictures=pictures,
                    report=report if pictures else False,
                    units=units or BASE_UNITS,
                    aside=force is None,
                )
            except Exception as error:  # whatever it is, the other ranks wait for it
                problem = error
        if (problem := comm.bcast(problem)) is not None:
            raise problem

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Functions that draw the pictures, by name of their PNG file. units: of their numbers.
        ValueError: as of `plot`.
        """
        from railhead.results import files

        return files.drawings(self.solved, self.summary, units)

    @property
    def plan(self) -> Plan:
        """The plan of the finest mesh, or that half-spaces answered. ValueError: the result was
        loaded.
        """
        return self.solved.plan

    @property
    def ellipse(self) -> Hertz:
        """Exact Hertz for the curvatures at the first contact, an ellipse or a line contact, under
        the load of the solution, of half-spaces under the load of the scene. Its own load is the
        normal force. ValueError: the result was loaded.
        """
        return self.solved.ellipse

    @property
    def fields(self) -> Fields | None:
        """The solution as arrays, of the meshed part and all ranks; None off rank 0, and of
        half-spaces. ValueError: the result was loaded.
        """
        return self.solved.fields

    @property
    def findings(self) -> Findings | None:
        """Patch, pressure and stresses read from the solution; None off rank 0 (half-spaces have
        them on every rank) and where nothing touches. ValueError: the result was loaded.
        """
        return self.solved.findings
