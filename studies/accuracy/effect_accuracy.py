"""Error against time of every effect: yield, friction, real profiles.

Each series is one scene on finer and finer meshes. Its errors are those of the largest pressure, of
the area and, where the creepage is prescribed, of the force over mu N. The truth is exact where a
formula holds, otherwise the finest mesh of the series, which then has no row of its own. The error
of that mesh is its change from the mesh before, divided by the ratio of their sizes. Where bodies
yield, the truth has STEPS times the usual number of load steps, too.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhead.planning import simulation_plan as planning
from railhead.postprocess.pictures.diagrams import new_figure
from railhead.results import pipeline
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.scene.quantities import numeric_values
from railhead.scene.scene import Scene
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import partial_slip
from studies import tables
from studies.mechanics import plasticity

COARSEST, RATIO = 3.0, 1.4  # elements per smaller semi-axis of the first mesh, and to the next
MESHES = 7
STEPS = 4
LARGEST = 250_000  # unknowns, as predicted; finer meshes are left out
ASKED = ("5%", "1%")
ROLLING = ("friction.coefficient=0.3", "rolling.creepage_along=0.0005")
ELASTIC = "effects.plasticity=off"
SERIES: dict[str, tuple[Scene, tuple[str, ...]]] = {
    "elastic ellipse": (catalogue.find("hertz_ellipse"), ()),
    "sphere at 5 times first yield": (plasticity.sphere(5), ()),
    "sphere at 20 times first yield": (plasticity.sphere(20), ()),
    "22.5 t axle that yields": (catalogue.find("uic54_22t5_axle"), ()),
    "strip that rolls": (catalogue.find("long_roller"), ("rail.extent=half-space", *ROLLING)),
    "ellipse that rolls and spins": (
        catalogue.find("hertz_ellipse"),
        (*ROLLING, "rolling.spin=0.0001"),
    ),
    "real pair, one patch": (catalogue.find("s1002_60e1"), (ELASTIC,)),
    "real pair, two patches": (catalogue.find("s1002_60e1"), (ELASTIC, "wheelset.shift=5mm")),
}
"""Scene and changed keys of each series."""
QUICK = "strip that rolls"
UNITS = {"seconds": "s"}


def main(out: Path, *, quick: bool) -> None:
    """Solve all series (quick: the strip on three meshes); write CSV, picture and page."""
    rows: list[tables.Row] = []
    with Progress(quiet=False) as progress:
        for name in (QUICK,) if quick else SERIES:
            rows += series(name, progress, 3 if quick else None)
    draw(rows, out / "effect_accuracy.png")
    tables.publish(out, page(rows), UNITS, effect_accuracy=rows)


def series(name: str, progress: Progress, meshes: int | None) -> Iterator[tables.Row]:
    """Rows of one series: a row a mesh, after a warm-up, and one for each accuracy that is asked
    for, in sections and where error envelopes hold. meshes: number of meshes; None: all, and the
    accuracies."""
    scene, keys = SERIES[name]
    scene = scene.replace(keys)
    plan = planning.make(scene)
    exact = exact_values(scene)
    progress.stage(f"{name}: warm-up")
    solve(scene)
    runs: list[tuple[Any, ...]] = []
    resolutions = [COARSEST * RATIO**step for step in range(meshes or MESHES)]
    resolutions = [n for n in resolutions if plan.at_resolution(n).unknowns <= LARGEST]
    on_mesh = [scene.replace([f"mesh.patch_size={plan.forecast.minor / n}"]) for n in resolutions]
    for n, each in zip(resolutions, on_mesh, strict=True):
        progress.stage(f"{name}: {n:.3g} elements per semi-axis")
        runs.append((n, None, *solve(each)))
    truth = runs[-1][-1] | exact
    missing = 0.0
    if set(truth) != set(exact):  # the finest mesh is the truth
        finest = runs.pop()[-1]
        if plan.effects["plasticity"].on:
            progress.stage(f"{name}: {STEPS} times the load steps")
            truth = solve(on_mesh[-1], STEPS)[-1]
        missing = max(errors(runs[-1][-1], finest).values()) / RATIO
    quick_or_signed = plan.plane_model or plan.family is not None
    for asked in ASKED if meshes is None and quick_or_signed else ():
        progress.stage(f"{name}: asked {asked}")
        runs.append((None, float(asked.strip("%")) / 100, *solve(scene.replace(accuracy=asked))))
    for n, wanted, seconds, unknowns, values in runs:
        apart = errors(values, truth)
        yield {
            "series": name,
            "elements_per_semi_axis": n,
            "asked": wanted,
            "unknowns": unknowns,
            "seconds": seconds,
            "error": max(apart.values()),
            **{f"error_{key}": apart.get(key) for key in ("max_MPa", "area_mm2", "force")},
            "error_of_truth": missing,
        }


def solve(scene: Scene, steps: int = 1) -> tuple[float, int, dict[str, float]]:
    """Processor seconds and unknowns of a scene, and its largest pressure, area and force over mu
    N; steps: factor on the number of load steps."""
    plan = planning.make(scene)
    plan = replace(plan, load_steps=steps * plan.load_steps)
    found, seconds = tables.timed(pipeline.solve, plan, Progress(quiet=True))
    summary = found.summary
    values = numeric_values(summary["result"])
    kept = {key: values[key] for key in ("max_MPa", "area_mm2")}
    if friction := summary["result"].get("friction"):
        kept["force"] = friction["force_along_N"] / friction["limit_N"]
    return seconds, summary["cost"]["dofs"], kept


def exact_values(scene: Scene) -> dict[str, float]:
    """Exact values of half-spaces that stay elastic, by the keys of `solve`: Hertz, and Carter for
    a strip that rolls; without those that no formula gives."""
    plan = planning.make(scene)
    if not plan.contact.half_space or plan.effects["plasticity"].on:
        return {}
    hertz, friction = plan.hertz, plan.effects["friction"].on
    exact = {"max_MPa": hertz.p0, "area_mm2": hertz.area}
    if friction and isinstance(hertz, LineContact):
        creepage = float(scene.rolling.creepage_along or 0.0)
        exact["force"] = partial_slip.carter_share(
            hertz, float(scene.friction.at(0.0, scene.heat.bulk)), creepage
        )
    return exact


def errors(values: dict[str, float], truth: dict[str, float]) -> dict[str, float]:
    """Relative errors by key; of the force, which is one over mu N, the difference."""
    return {
        key: abs(value - truth[key]) / (1.0 if key == "force" else truth[key])
        for key, value in values.items()
    }


def page(rows: Sequence[tables.Row]) -> str:
    """One sentence for each series, and a table of the runs that an accuracy was asked of."""
    fronts: dict[str, dict[str, Any]] = {}
    for name, own in tables.groups(rows, "series").items():
        meshes = [row for row in own if row["asked"] is None]
        front = tables.front(meshes)
        fronts[name] = {"first": front[0], "last": front[-1]}
        if front[-1] is meshes[-1] and front[-1]["error"] < front[0]["error"] / 2:
            fronts[name]["factor"] = tables.factor_ten(front)
    shown = [
        {
            **row,
            "size": tables.percent(row["asked"]),
            "worst": tables.percent(row["error"]),
            "pressure": tables.percent(row["error_max_MPa"]),
            "area": tables.percent(row["error_area_mm2"]),
            "tangential": tables.percent(row["error_force"]),
            "unsure": tables.percent(row["error_of_truth"]) if row["error_of_truth"] else "exact",
        }
        for row in rows
        if row["asked"] is not None
    ]
    formats = ("{series}", "{size}", "{unknowns}", "{seconds:.2f}", "{worst}")
    more = ("{pressure}", "{area}", "{tangential}", "{unsure}")
    return tables.render(
        "effect_accuracy", fronts=fronts, rows=tables.cells(shown, *formats, *more)
    )


def draw(rows: Sequence[tables.Row], path: Path) -> None:
    """Worst error over seconds: a line a series, with a star for each accuracy that was asked for.
    Where the finest mesh is the truth, a bar to the right shows how sure that is."""
    with new_figure(path, 9.5, 5.5) as figure:
        axes = figure.subplots()
        for number, (name, own) in enumerate(tables.groups(rows, "series").items()):
            meshes = [row for row in own if row["asked"] is None]
            colour, seconds = f"C{number}", [row["seconds"] for row in meshes]
            error = [100 * row["error"] for row in meshes]
            unsure = [100 * row["error_of_truth"] for row in meshes]
            axes.errorbar(seconds, error, unsure, fmt="o-", color=colour, capsize=2, label=name)
            stars = [row for row in own if row["asked"] is not None]
            axes.plot(
                [row["seconds"] for row in stars],
                [100 * row["error"] for row in stars],
                "*",
                color=colour,
                ms=14,
                mec="black",
            )
        label = "worst error of largest pressure, area and force, %"
        tables.log_axes(axes, (1, 2, 5), (1,), xlabel="processor seconds", ylabel=label)
        axes.legend(fontsize="small")
