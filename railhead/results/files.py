"""The files of one solved scene: numbers, grids for ParaView, pictures and the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from railhead.postprocess import symmetry
from railhead.postprocess.findings import BASE_UNITS, Array, Findings, Units
from railhead.results import quantity_rows, result_folder
from railhead.results.result_folder import result
from railhead.results.subject import subject
from railhead.run.half_spaces.answer import HalfSpaceSolution, Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.theory.elastic.line import LineContact

if TYPE_CHECKING:
    import meshio
    from matplotlib.figure import Figure

    from railhead.postprocess.pass_rows import Passes
    from railhead.postprocess.pictures.plots.diagrams import Drawing
    from railhead.scene.scene import Scene

    Grids = tuple[meshio.Mesh, meshio.Mesh]

TABLE, PASSES, STATE = "result.csv", "passes.csv", "passes.npz"
PROFILE = "rail_profile.csv"


def write(
    solved: Solved,
    summary: dict[str, Any],
    folder: Path,
    *,
    pictures: bool = True,
    report: bool | Literal["brief"] = True,
    whole: bool = False,
    units: Units = BASE_UNITS,
) -> None:
    """Write all files of a solved scene, numbers first, on the rank that calls (rank 0); they
    replace those of an earlier result in the folder.

    summary: content of summary.json. pictures: whether PNG files are written; none where nothing
        touches. report: whether report.html is written; "brief": on one page. whole:
        whether the files for ParaView hold the mirror images of what symmetry left out. units: of
        pictures and report.
    OSError: the numbers cannot be written; or, a line for each, other files that could not be
        written, after all the others are.
    """
    with result(folder, "run", solved.plan.scene, summary) as (work, attempt):
        (work / TABLE).write_bytes(result_folder.encoded(quantity_rows.everything(summary)))
        if solved.passes is not None and solved.passes.rows:
            _write_passes(solved.passes, solved.plan.scene, work)
        stresses: Array | None = None
        grids: Grids | None = None
        found = _titled(solved, units)
        with attempt("*.vtu"):
            stresses = nodal_stress(solved)
            write_grids(solved, stresses, work, whole=whole)
        if pictures and found is not None:
            with attempt("*.png"):
                grids = _grids(solved, found, stresses)
                for name, draw in _drawings(solved, summary["result"], found, grids).items():
                    with attempt(name):
                        draw(work / name)
        if report:
            with attempt("report.html"):
                from railhead.results.report import html

                brief = report == "brief"
                html.write(solved, summary, units, work, found, grids, brief=brief)


def _write_passes(passes: Passes, scene: Scene, work: Path) -> None:
    """Write the table of passes, the state after them, and the rail's new profile."""
    from railhead.run.half_spaces import passes_file

    (work / PASSES).write_bytes(result_folder.encoded(result_folder.signed(passes.table())))
    passes_file.save(passes, scene, work / STATE)
    if passes.profile is not None:
        reach = passes.sections[-1].y[-1]
        holds = f"the groove is followed {reach:.3g} mm to each side of the patch"
        made = f"railhead {result_folder.VERSION}, {result_folder.now()}"
        text = f"# {len(passes.rows)} passes, {made}; {holds}\n"
        lines = [f"{y:.6f},{z:.6f}\n" for y, z in passes.profile]
        (work / PROFILE).write_text("".join([text, "y [mm],z [mm]\n", *lines]))


def plot(solved: Solved, summary: dict[str, Any], picture: str, ax: object = None) -> Figure:
    """Draw a picture of a solved scene, as `diagrams.draw_one`. summary: content of summary.json.
    ValueError: as there, and where nothing touches or off rank 0.
    """
    from railhead.postprocess.pictures.plots import diagrams

    found = _titled(solved, BASE_UNITS)
    if found is None:
        raise ValueError("there is nothing to draw: nothing touches, or this is not rank 0")
    grids = _grids(solved, found, nodal_stress(solved))
    return diagrams.draw_one(_drawings(solved, summary["result"], found, grids), picture, ax)


def _titled(solved: Solved, units: Units) -> Findings | None:
    """Findings with the whole contact surface, and the title, the units and the notes of pictures;
    None where nothing touches and off rank 0.
    """
    if solved.findings is None:
        return None
    surface = solved.findings.surface
    if solved.fields is not None:
        surface = symmetry.surface(surface, solved.fields.mirrors)
    after = solved.after.items()
    needed = tuple(f"{name.replace('_', ' ')}: {each.why}" for name, each in after if each.needed)
    words = subject(solved.plan, solved.load, units)
    return replace(solved.findings, surface=surface, notes=needed, subject=words)


def nodal_stress(solved: Solved) -> Array | None:
    """Stresses at the nodes (n, 6), columns xx, yy, zz, xy, xz, yz, MPa. None where nothing
    touches, off rank 0, and of half-spaces.
    """
    if not isinstance(solved, MeshSolution) or solved.fields is None or solved.findings is None:
        return None
    from railhead.postprocess.stress import gauss_points

    return gauss_points.nodal_stress(solved.fields)


def write_grids(
    solved: Solved, stresses: Array | None, folder: Path, *, whole: bool = False
) -> None:
    """Write the files for ParaView into a folder; without stresses none but the section of passes.

    stresses (n, 6): as of `nodal_stress`. whole: with the mirror images of what symmetry left out.
    """
    if stresses is None and solved.passes is None:
        return
    from railhead.postprocess import vtu

    for name, grid in paraview_grids(solved, stresses, whole=whole):
        vtu.write(grid, folder / f"{name}.vtu")
    if stresses is not None and isinstance(solved, MeshSolution) and solved.unloaded_fields:
        names = {0.0: "solution.vtu", 1.0: "residual.vtu"}
        vtu.series(names, folder / "solution.pvd")


def paraview_grids(
    solved: Solved, stresses: Array | None, *, whole: bool
) -> Iterator[tuple[str, meshio.Mesh]]:
    """Names and grids of the files for ParaView, as `vtu.grids`; with passes "passes_section". None
    of the former without stresses.

    stresses (n, 6): as of `nodal_stress`. whole: with the mirror images of what symmetry left out.
    """
    from railhead.postprocess import vtu

    if solved.passes is not None and solved.passes.rows:
        yield "passes_section", vtu.section_grid(solved.passes.sections[-1])
    if stresses is None:
        return
    assert isinstance(solved, MeshSolution) and solved.fields and solved.findings
    friction, residual = solved.solution.friction, solved.unloaded_fields
    yield from vtu.grids(solved.fields, stresses, solved.findings, residual, friction, whole=whole)


def _grids(solved: Solved, found: Findings, stresses: Array | None) -> Grids | None:
    """Grids of the cells, mirrored to the whole model, and of the slave's contact surface; None
    without stresses. found: findings with the whole contact surface (`_titled`). stresses (n, 6):
    as of `nodal_stress`.
    """
    from railhead.postprocess import vtu

    fields = solved.fields
    if stresses is None or fields is None:
        return None
    surface = vtu.contact_grid({fields.slave: found.surface})
    return symmetry.grid(vtu.volume_grid(fields, stresses), fields.mirrors), surface


def _drawings(
    solved: Solved, numbers: Mapping[str, Any], found: Findings, grids: Grids | None
) -> dict[str, Drawing]:
    """The pictures of a solved scene by name of their PNG file.

    numbers: "result" of summary.json. found: with the title and the notes of pictures. grids: of
        the cells and of the slave's contact surface; None where there are none, which leaves only
        pictures of half-spaces.
    """
    from railhead.postprocess.pictures.plots import diagrams, friction_plots

    # Hertz's ellipse lies at the first contact, which need not be the most loaded of several.
    exact = solved.ellipse if len(found.patch.each) < 2 else None
    planes: Sequence[tuple[float, float, float]] = ()
    every: dict[str, Drawing] = {}
    if isinstance(solved, HalfSpaceSolution):
        friction = solved.friction
        if isinstance(exact, LineContact):
            every["pressure.png"] = partial(diagrams.pressure, found, exact)
        else:
            every["patch.png"] = partial(diagrams.patch, found, exact)
    elif grids is None or solved.fields is None:
        return {}
    else:
        from railhead.postprocess.patch.moments import coordinate
        from railhead.postprocess.pictures.plots import plastic_plots
        from railhead.postprocess.pictures.views import gallery

        fields, friction = solved.fields, solved.solution.friction
        planes, poisson = fields.mirrors, solved.plan.reported_body.poisson_ratio
        axis = coordinate(fields) if fields.kinematics.dim == 2 else None
        every = gallery.drawings(grids, axis, found, exact, poisson)
        residual, elastic = solved.unloaded_fields, solved.elastic_reference
        if residual is not None and elastic is not None and elastic.findings:
            every["plastic.png"] = partial(
                plastic_plots.draw, fields, residual, found, elastic.findings, exact
            )
        if "p0_over_k" in numbers.get("friction", {}):
            every["shakedown.png"] = partial(
                friction_plots.draw_shakedown,
                numbers["friction"],
                poisson,
                title=found.subject.title,
            )
    if solved.passes is not None and solved.passes.rows:
        from railhead.postprocess.pictures.plots import passes_plots

        every["passes.png"] = partial(passes_plots.draw, solved.passes, found)
        if len(solved.passes.sections[-1].y) > 1:
            every["passes_section.png"] = partial(passes_plots.draw_section, solved.passes, found)
    if friction is not None:
        coefficient = solved.plan.scene.friction.coefficient
        every["friction.png"] = partial(
            friction_plots.draw_tractions, friction, found, coefficient, planes=planes
        )
    return every
