"""Every effect on and off: what it costs, what leaving it out changes, and that off is free.

That off is free is shown by one contact that is solved by way of a plan with every optional effect
off, and without any plan.
"""

import math
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing import mesh
from railhead.meshing.bodies import CONTACT, RAIL, SUPPORT, WHEEL, Body, Options
from railhead.meshing.grading import Grading
from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.run import mesh_solution
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.scene.scene import Scene, SceneError
from railhead.solver import compat
from railhead.solver.contact import ContactModel
from railhead.solver.material import Material
from railhead.solver.system.setup import ContactBody, Setup
from railhead.theory.elastic import hertz
from studies.tables import Row, cells, columns, groups, publish, render, timed

SCENES = {
    "uic54_thesis": ("uic54_thesis", []),
    "axle near the R300-R80 joint": (
        "uic54_22t5_axle",
        ["rail.inclination=1:40", "effects.plasticity=off"],
    ),
    "sphere_on_plane": ("sphere_on_plane", []),
    "long_roller": ("long_roller", []),
    "wheel 2000 times stiffer": ("hertz_ellipse", ["wheel.young_modulus=4.14e8"]),
}
REPEATS, BARE_REPEATS = 2, 7  # the fastest and the median of so many runs count
UNITS = {"p_max": "MPa", "area": "mm2", "tau_max": "MPa", "approach": "mm"}


QUANTITIES = ("p_max", "area", "tau_max", "approach")
JUDGED = ("p_max", "area", "tau_max")
REDUCTIONS = (
    "symmetry",
    "symmetry_x",
    "symmetry_y",
    "axisymmetry",
    "plane_strain",
)  # on is cheaper
NOISE = 0.1  # relative difference of two median times that is none


def main(out: Path, *, quick: bool) -> None:
    """Run all scenes (quick: the last one), and write two CSV files and the page."""
    names = list(SCENES)[-1:] if quick else list(SCENES)
    with Progress(quiet=False) as progress:
        runs = [run for name in names for run in switch(name, progress, 1 if quick else REPEATS)]
        progress.stage("with and without a plan")
        bare = compare(1 if quick else BARE_REPEATS)
    publish(out, page(runs, bare), UNITS, effects=runs, effects_off=bare)


def switch(name: str, progress: Progress, repeats: int) -> Iterator[Row]:
    """A scene as planned (effect ""), then with each effect in its other state where that can be
    had; called_for: by the plan; seconds: of the processor; change_*: relative to the run as
    planned."""
    case, assignments = SCENES[name]
    scene = catalogue.find(case).replace(assignments)
    plan = planning.make(scene)
    decided = dict(plan.effects)
    pipeline.run(scene)  # compiles
    planned: dict[str, float] = {}
    both = ["symmetry"] if decided["symmetry_x"].on and decided["symmetry_y"].on else []
    decided.pop("mean_dilatation")  # a treatment of the cells, no effect of the scene
    for effect in ("", *decided, *both):
        state = decided.get(effect) or decided["symmetry_x"]
        on = state.on if not effect else not state.on
        chosen = scene.replace([f"effects.{effect}={'on' if on else 'off'}"] if effect else [])
        try:
            planning.make(chosen)
        except SceneError:
            continue
        progress.stage(f"{name}: {effect or 'as planned'} {'on' if on else 'off'}")
        runs = [timed(pipeline.run, chosen) for _ in range(repeats)]
        result = runs[0][0].summary
        values = columns(result["result"], QUANTITIES)
        planned = planned or values
        yield {
            "scene": name,
            "effect": effect,
            "on": on,
            "called_for": state.called_for,
            "accuracy": plan.context.accuracy,
            "unknowns": result["cost"]["dofs"],
            "seconds": min(seconds for _, seconds in runs),
            **values,
            **{f"change_{key}": values[key] / planned[key] - 1 for key in values},
        }


def page(runs: Sequence[Row], bare: Sequence[Row]) -> str:
    """The whole page; bare: the two routes of the same contact."""
    planned, direct = bare
    return render(
        "effects",
        verdict=verdict(runs),
        scenes={name: _scene(own) for name, own in groups(runs, "scene").items()},
        same=all(planned[key] == direct[key] for key in ("unknowns", "forms")),
        ratio=planned["seconds"] / direct["seconds"],
        noise=NOISE,
        bare=cells(bare, "{route}", "{unknowns}", "{forms}", "{seconds:.3f}", "{p_max:.10g}"),
    )


def wrong(runs: Sequence[Row]) -> list[Row]:
    """Runs which show that the plan left out too much: an effect left off, or a reduction used,
    that changes a judged quantity by more than the accuracy."""
    return [row for row in _left(runs) if _change(row) > row["accuracy"]]


def verdict(runs: Sequence[Row]) -> str:
    """Whether the plan left out too much, in words, with the numbers that decide."""
    left = _left(runs)
    kept = [row for row in runs if row["effect"] and not _simulates_more(row)]
    return render(
        "effects_verdict",
        change=_change,
        limit=runs[0]["accuracy"],
        wrong=wrong(runs),
        left=len(left),
        worst=max(left, key=_change, default=None),
        kept=len(kept),
        small=[row for row in kept if _change(row) <= row["accuracy"]],
        overruled=[row for row in runs if row["effect"] and _overruled(row)],
    )


def _left(runs: Sequence[Row]) -> list[Row]:
    """Runs that simulate something which the plan, not the scene, had left out."""
    return [r for r in runs if r["effect"] and _simulates_more(r) and not _overruled(r)]


def _simulates_more(row: Row) -> bool:
    """Whether a run simulates what the plan left out: an effect on, or a reduction off."""
    return bool(row["on"] != (row["effect"] in REDUCTIONS))


def _overruled(row: Row) -> bool:
    """Whether the plan called for the state of this run, and the scene chose the other one."""
    return bool(row["on"] == row["called_for"])


def _change(row: Row) -> float:
    """Largest relative change of the judged quantities from the run as planned."""
    return max(abs(row[f"change_{key}"]) for key in JUDGED)


def _scene(rows: Sequence[Row]) -> tuple[Row, list[Row], list[list[Any]]]:
    """Of one scene: the run as planned, that of the whole model if there is one, and the rows of
    the table."""
    first = rows[0]
    whole = [row for row in rows if row["effect"] == "symmetry" and not row["on"]]
    lines = []
    for row in rows:
        state = f"{row['effect']} {'on' if row['on'] else 'off'}" if row["effect"] else "as planned"
        changes = [f"{row[f'change_{key}']:+.3%}" for key in (*JUDGED, "approach")]
        time = f"{row['seconds']:.2f}", f"x {row['seconds'] / first['seconds']:.2f}"
        lines.append([state, row["unknowns"], *time, *(changes if row["effect"] else [""] * 4)])
    return first, whole, lines


CASE = "sphere_on_plane"
# Nothing else is on and could be left out.
OPTIONAL = ("axisymmetry", "symmetry", "far_field")


def compare(repeats: int) -> list[dict[str, Any]]:
    """The same contact by way of the plan with all optional effects off (route), and without a
    plan, in turn; median processor seconds of mesh, assembly and solve."""
    off = [f"effects.{name}=off" for name in OPTIONAL]
    same = f"solver.tolerance={Setup.tolerance}"
    scene = catalogue.find(CASE).replace(["mesh.patch_size=0.25", same, *off])
    routes = {"plan, all optional effects off": _planned, "no plan": _unplanned}
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in routes}
    for _ in range(1 + repeats):  # the first compiles
        for name, route in routes.items():
            with mock.patch.object(compat, "form", wraps=compat.form) as form:
                (unknowns, p_max), seconds = timed(route, scene)
            row = {"route": name, "unknowns": unknowns, "forms": form.call_count}
            found[name].append({**row, "seconds": seconds, "p_max": p_max})
    return [
        runs[1] | {"seconds": statistics.median(run["seconds"] for run in runs[1:])}
        for runs in found.values()
    ]


def _planned(scene: Scene) -> tuple[int, float]:
    """Unknowns and largest pressure, MPa, by way of a plan."""
    plan = planning.make(scene)
    model = mesh_solution.assemble(plan, mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD))
    return model.unknowns, float(mesh_solution.solve(plan, model).pressure.max())


def _unplanned(scene: Scene) -> tuple[int, float]:
    """Unknowns and largest pressure, MPa, of one elastic block under Hertz's gap against a rigid
    plane, by meshing and solver alone."""
    wheel, radius, load = scene.wheel, scene.wheel.rolling_radius, float(scene.load or 0.0)
    modulus = wheel.young_modulus / (1 - wheel.poisson_ratio**2)
    ellipse = hertz.point_contact(1 / radius, 1 / radius, modulus, load)
    size, edge = float(scene.mesh.patch_size or 0.0), 8 * ellipse.a
    section = outlines.block_section(
        profiles.single_radius(math.inf, edge), -edge, edge, edge, outwards=-1, half=False
    )
    section = [replace(c, role="support") if c.role == "free" else c for c in section]
    grading = Grading(
        centre=(0.0, 0.0, 0.0),
        a=ellipse.a,
        b=ellipse.b,
        angle=0.0,
        size=size,
        growth=0.3,
        coarsest=0.25 * edge,
    )
    body = Body(WHEEL, section, edge, end_role="support")
    made = mesh.generate([body], grading, Options("tetrahedron", 1, False), MPI.COMM_WORLD)
    steel = Material(wheel.young_modulus, wheel.poisson_ratio)
    setup = Setup(
        fixed=ContactBody(RAIL, CONTACT + RAIL, SUPPORT + RAIL, Material(math.inf, 0.3)),
        moving=ContactBody(WHEEL, CONTACT + WHEEL, SUPPORT + WHEEL, steel),
        slave=WHEEL,
        gap=ParabolicGap(1 / radius, 1 / radius, -1),
        degree=2,
    )
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    points = model.interface.points
    inside = (np.hypot(points[:, 0], points[:, 1]) < ellipse.a) & (np.abs(points[:, 2]) < ellipse.a)
    return model.unknowns, float(model.solve(load=load, active=inside).pressure.max())
