"""The files of one solved scene: numbers, grids for ParaView, pictures and the report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from railhead.planning.simulation_plan import Plan
from railhead.postprocess import symmetry
from railhead.postprocess.findings import BASE_UNITS, Drawing, Subject, Units, brief
from railhead.postprocess.pass_rows import Passes
from railhead.results import quantity_rows, result_folder
from railhead.run.half_space_answer import Solved
from railhead.run.mesh_solution import MeshSolution

if TYPE_CHECKING:
    import meshio

    from railhead.postprocess.pictures.gallery import Shown

TABLE, PASSES = "result.csv", "passes.csv"
PROFILE, SHOWN = "rail_profile.csv", "pictures.npz"


def write(
    solved: Solved,
    summary: dict[str, Any],
    folder: Path,
    *,
    pictures: bool = True,
    report: bool | Literal["brief"] = True,
    units: Units = BASE_UNITS,
    aside: bool = False,
) -> None:
    """Write all files of a solved scene, numbers first, on the rank that calls (rank 0); they
    replace those of an earlier result in the folder.

    summary: content of summary.json.
    pictures: whether PNG files are written; none where nothing touches.
    report: whether report.html is written; "brief": on one page.
    units: of pictures and report.
    aside: as of `result_folder.result`.
    OSError: the numbers cannot be written; or, a line for each, other files that could not be
        written, after all the others are.
    """
    scene = solved.plan.scene
    with result_folder.result(folder, "run", scene, summary, aside=aside) as (work, attempt):
        (work / TABLE).write_bytes(result_folder.encoded(quantity_rows.everything(summary)))
        if solved.passes is not None and solved.passes.rows:
            _write_passes(solved.passes, work)
        made: dict[str, meshio.Mesh] = {}
        with attempt("*.vtu"):
            made = grids(solved)
            if made:
                from railhead.postprocess import vtu

                for name, grid in made.items():
                    vtu.write(grid, work / f"{name}.vtu")
        shown: Shown | None = None
        with attempt(SHOWN):
            if solved.plan.scene.asks("pictures"):
                shown = _shown(solved, units)
            if shown is not None:
                from railhead.postprocess.pictures import gallery

                gallery.save(shown, work / SHOWN)
        if pictures and shown is not None:
            cells = cache(partial(_cells, solved, made))
            result_folder.draw(gallery.drawings(shown, cells, _friction(summary)), work, attempt)
        if report:
            with attempt("report.html"):
                from railhead.results.report import html

                title = scene.name if shown is None else shown.found.subject.title
                brief = report == "brief"
                text = html.render(solved, summary, units, work, title, brief=brief)
                (work / html.NAME).write_text(text, encoding="utf-8")


def _write_passes(passes: Passes, work: Path) -> None:
    """Write the tables of passes and the rail's new profile."""
    for suffix, each in passes.files.items():
        table = result_folder.encoded(result_folder.signed(each.table()))
        (work / f"passes{suffix}.csv").write_bytes(table)
    if passes.profile is not None:
        reach = passes.sections[-1].y[-1]
        holds = f"the groove is followed {reach:.3g} mm to each side of the patch"
        made = f"railhead {result_folder.VERSION}, {result_folder.now()}"
        text = f"# {len(passes.rows)} passes, {made}; {holds}\n"
        lines = [f"{y:.6f},{z:.6f}\n" for y, z in passes.profile]
        (work / PROFILE).write_text("".join([text, "y [mm],z [mm]\n", *lines]))


def drawings(solved: Solved, summary: Mapping[str, Any], units: Units) -> dict[str, Drawing]:
    """The pictures of a solved scene by name of their PNG file. summary: content of summary.json.
    ValueError: nothing touches, or off rank 0.
    """
    from railhead.postprocess.pictures import gallery

    shown = _shown(solved, units)
    if shown is None:
        raise ValueError("there is nothing to draw: nothing touches, or this is not rank 0")
    cells = cache(lambda: _cells(solved, grids(solved)))
    return gallery.drawings(shown, cells, _friction(summary))


def grids(solved: Solved) -> dict[str, meshio.Mesh]:
    """Grids of the files for ParaView by their names: with passes "passes_section"; with stresses
    "contact" (the slave's contact surface), "solution" (cells), where steel yields "residual"
    (cells after the load), and with friction "traction" (contact points). Cells are those that were
    meshed, the others have the images of what symmetry left out. Of half-spaces, where nothing
    touches, and off rank 0 there are none but the first.
    """
    fields, found, passes = solved.fields, solved.findings, solved.passes
    with_stresses = fields is not None and found is not None and found.largest
    if not with_stresses and not (passes and passes.rows):
        return {}
    from railhead.postprocess import vtu
    from railhead.postprocess.stress import gauss_points

    made: dict[str, meshio.Mesh] = {}
    if passes and passes.rows:
        for suffix, each in passes.files.items():
            made[f"passes_section{suffix}"] = vtu.section_grid(each.sections[-1])
    if not with_stresses:
        return made
    assert isinstance(solved, MeshSolution) and fields and found
    contact = vtu.contact_grid(found.surface, fields.slave)
    made["contact"] = symmetry.grid(contact, fields.mirrors)
    made["solution"] = vtu.volume_grid(fields, gauss_points.nodal_stress(fields))
    if (left := solved.unloaded_fields) is not None:
        made["residual"] = vtu.volume_grid(left, gauss_points.nodal_stress(left))
    if (friction := solved.solution.friction) is not None:
        made["traction"] = symmetry.grid(vtu.traction_points(friction), fields.mirrors)
    return made


def _friction(summary: Mapping[str, Any]) -> Mapping[str, Any]:
    """The tables "friction" and "yield" of the result in summary.json, and its "fatigue"; empty
    without them.
    """
    result = summary["result"] or {}
    more = {key: result[key] for key in ("fatigue",) if key in result}
    return (result.get("friction") or {}) | (result.get("yield") or {}) | more


def _shown(solved: Solved, units: Units) -> Shown | None:
    """What the pictures of a solved scene show, but for its cells; None where nothing touches and
    off rank 0.
    """
    found, plan = solved.findings, solved.plan
    if found is None:
        return None
    from railhead.postprocess.pictures import gallery

    after = solved.after.items()
    needed = tuple(f"{name.replace('_', ' ')}: {each.why}" for name, each in after if each.needed)
    return gallery.Shown(
        found=replace(
            found,
            notes=needed,
            subject=subject(plan, solved.load, units),
            surface=symmetry.surface(found.surface, solved.mirrors),
        ),
        # Hertz's ellipse lies at the first contact, which need not be the most loaded of several.
        exact=solved.ellipse if len(found.patch.each) < 2 else None,
        poisson=next(iter(plan.poisson_ratios.values())),
        friction=solved.friction and symmetry.tractions(solved.friction, ()),  # finest grids alone
        passes=solved.passes if solved.passes is not None and solved.passes.rows else None,
        axes=(0, 1) if solved.fields is None else solved.fields.kinematics.varying,
        unloaded=solved.unloaded_fields is not None,
    )


def _cells(solved: Solved, made: Mapping[str, meshio.Mesh]) -> meshio.Mesh:
    """Grid of the cells, images of what symmetry left out included, of bodies that were unloaded
    with the von Mises stress that is left at nodes. made: `grids`. ValueError: there are no cells.
    """
    if solved.fields is None or "solution" not in made:
        raise ValueError("there are no stresses at nodes")
    whole = symmetry.grid(made["solution"], solved.fields.mirrors)
    if "residual" in made:
        left = symmetry.grid(made["residual"], solved.fields.mirrors)
        whole.point_data["residual_von_mises"] = left.point_data["von_mises"]
    return whole


def subject(plan: Plan, load: float, units: Units = BASE_UNITS) -> Subject:
    """Title of a scene with its load, pair of profiles and friction, and what labels of pictures
    say of it. load: vertical load of the solution, N, or of the scene. units: of the numbers that
    are shown.
    """
    scene, half_space = plan.scene, plan.contact.half_space
    rail, wheel = scene.rail, scene.wheel
    kilo = load >= 1e3 and "N" not in units.chosen
    title = f"{scene.name}: {f'{brief(load / 1e3)} kN' if kilo else units.text(load, 'N')}, "
    title += f"wheel R {units.text(wheel.rolling_radius, 'mm', 6)}, tread "
    title += f"{_profile(wheel.profile, wheel.transverse_radius, units)}, on rail "
    title += _profile(rail.sections or rail.profile, rail.crown_radius, units)
    title += ", as half-spaces" if half_space else ""
    has_friction = plan.effects["friction"].on
    if has_friction:
        values = sorted({mu for _, mu in scene.friction.table or scene.friction.pairs})
        text = f"{values[0]:g} to {values[-1]:g}" if len(values) > 1 else f"{values[0]:g}"
        title += f", friction\N{NO-BREAK SPACE}{text}"
    return Subject(
        title,
        gauge=rail.profile != "arc" and not half_space,
        rolls=scene.rolling.prescribed and has_friction,
        has_friction=has_friction,
        revolved=plan.contact.revolved,
        method="half-spaces" if plan.by_half_spaces else "finite elements",
        units=units,
    )


def _profile(profile: str, radius: float | None, units: Units) -> str:
    """Name of a profile, of a file without its folder; of an arc its radius, or "flat"."""
    if profile != "arc":
        return Path(profile).name
    if radius is None or math.isinf(radius):
        return "flat"
    return f"R {units.text(radius, 'mm', 6)}"
