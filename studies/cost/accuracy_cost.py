"""Error against time for each method and element, and what an asked accuracy costs."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from matplotlib import patheffects
from matplotlib.axes import Axes

from railhead.meshing.mesh import MeshError
from railhead.planning import simulation_plan as planning
from railhead.postprocess.pictures.diagrams import new_figure
from railhead.results import pipeline
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from studies import tables
from studies.tables import COLUMNS, Row, columns, groups, log_axes, percent, power_law

CASES = ("hertz_ellipse", "sphere_on_plane", "uic54_thesis")
NO_FORMULA = ("uic54_thesis",)  # no half-space: held against its own converged run
REFERENCE = 16.0  # elements per smaller semi-axis of that run
METHODS = ("nitsche", "penalty")
ELEMENTS = {
    "tetrahedron 2": ("tetrahedron", 2, (2.0, 4.0, 7.0, 12.0)),
    "tetrahedron 1": ("tetrahedron", 1, (7.0, 12.0, 20.0, 30.0)),
    "hexahedron 1": ("hexahedron", 1, (4.0, 7.0, 12.0, 20.0)),
}
"""Name: cell, order, elements per smaller semi-axis of the patch."""
ASKED = ("none", "10%", "5%", "2%", "1%", "0.2%")  # none: as the case ships
MAX_UNKNOWNS = 200_000  # predicted; finer meshes are left out
REPEATS, SHORT = 3, 5.0  # runs below so many seconds are repeated; the least seconds count
MAIN = ("a", "b", "p_max")
ESTIMATED = ("a_mm", "b_mm", "area_mm2", "max_MPa")  # whose largest estimate is "estimate"
DEFAULT, SOLID185 = ("nitsche", "tetrahedron 2"), ("penalty", "hexahedron 1")
ASYMPTOTIC = 0.02  # error below which a power law is expected
LOOKS = {
    "tetrahedron 2": ("#1f4e79", "^"),
    "tetrahedron 1": ("#3b8f5a", "v"),
    "hexahedron 1": ("#c8502d", "s"),
}
LINES = {"nitsche": "-", "penalty": "--"}
STAR = "#e8a800"
PRICE_AXES = (("asked", 100.0), ("seconds", 1.0))
Exact = dict[str, float]
UNSOLVED: Row = {
    "seconds": None,
    "newton_iterations": None,
    "linear_iterations": None,
    "converged": False,
    "failure": "",
    "reached": None,
    "estimate": None,
    **dict.fromkeys(("error", "error_all", *(f"error_{key}" for key in COLUMNS))),
}
"""What a run without a result has in the columns behind its setting. Errors are relative (error:
worst of a, b, p_max; error_all: of all quantities; estimate: largest of ESTIMATED); asked: the
accuracy, for runs that choose their own meshes."""


def main(out: Path, *, quick: bool) -> None:
    """Run everything (quick: half-spaces, two sizes, one asked accuracy); CSV, picture, page."""
    runs: list[Row] = []
    priced: list[Row] = []
    with Progress(quiet=False) as progress:
        for name in CASES[: 1 if quick else None]:
            progress.stage(f"{name}: reference")
            scene = catalogue.find(name).replace(["effects.axisymmetry=off"])  # solids alone
            exact = reference(scene)
            runs += fixed_meshes(scene, exact, 2 if quick else None, progress)
            priced += asked_accuracies(scene, exact, 2 if quick else None, progress)
        for name in sorted(set() if quick else {*catalogue.shipped()} - {*CASES}):
            priced += asked_accuracies(catalogue.find(name), {}, -1, progress)
    runs += [row for row in priced if row["asked"] is not None and row["case"] in CASES]
    draw(runs, out / "accuracy_cost.png")
    draw_prices(priced, out / "accuracy_asked.png")
    tables.publish(out, page(runs, MAX_UNKNOWNS), accuracy_cost=runs, accuracy_asked=priced)


def reference(scene: Scene) -> Exact:
    """Exact Hertz; for NO_FORMULA this program's own result on a fine mesh (REFERENCE)."""
    if scene.name not in NO_FORMULA:
        return columns(pipeline.run(scene).summary["hertz"], COLUMNS)
    fine = scene.replace([f"mesh.patch_size={_minor(scene) / REFERENCE!r}"])
    return columns(pipeline.run(fine).summary["result"], COLUMNS)


def _minor(scene: Scene) -> float:
    """The smaller semi-axis of the predicted patch, mm."""
    ellipse = planning.make(scene).hertz
    return min(ellipse.a, ellipse.b)


def fixed_meshes(
    scene: Scene, exact: Exact, sizes: int | None, progress: Progress
) -> Iterator[Row]:
    """Rows of every element, method and size; before an element's first run, a warm-up that is not
    timed (imports, compilation of the forms). sizes: number of sizes of each; None: all."""
    for element, (cell, order, resolutions) in ELEMENTS.items():
        base = scene.replace([f"mesh.cell={cell}", f"mesh.order={order}"])
        minor = _minor(base)
        progress.stage(f"{base.name}: {element}, warm-up")
        _solve(base.replace([f"mesh.patch_size={minor / resolutions[0]!r}"]))
        for method in METHODS:
            for n in resolutions[:sizes]:
                one = base.replace([f"solver.method={method}", f"mesh.patch_size={minor / n!r}"])
                predicted = planning.make(one).unknowns
                progress.stage(f"{base.name}: {method}, {element}, b/{n:g}, about {predicted}")
                run = _run(base, method, element, None, n, minor / n, predicted)
                yield _timed(run, one, exact, 1 if sizes else REPEATS)


def asked_accuracies(
    scene: Scene, exact: Exact, count: int | None, progress: Progress
) -> Iterator[Row]:
    """Rows of runs that choose their meshes for an asked accuracy, after a warm-up, without those
    that have no estimate; their seconds are of all meshes. exact: empty where it is not known.
    count: how many of ASKED; None: all."""
    _solve(scene)
    for asked in ASKED[:count]:
        progress.stage(f"{scene.name}: asked accuracy {asked}")
        accurate = scene.replace([f"accuracy={asked}"])
        run = _run(scene, *DEFAULT, accurate.accuracy, None, None, None)
        row = _timed(run, accurate, exact, REPEATS)
        if row["seconds"] is None or row["estimate"] is not None:
            yield row


def _run(scene: Scene, *setting: Any) -> dict[str, Any]:
    """A run that is not solved yet; setting: the columns behind the case."""
    names = ("method", "element", "asked", "elements_per_semi_axis", "patch_size_mm", "unknowns")
    return {"case": scene.name, **dict(zip(names, setting, strict=True)), **UNSOLVED}


def _solve(scene: Scene) -> dict[str, Any] | str:
    """The summary, or why there is none: too many unknowns (MAX_UNKNOWNS), or what was raised."""
    try:
        plan = planning.make(scene)
        if plan.unknowns > MAX_UNKNOWNS:
            return f"left out: {plan.unknowns} unknowns predicted"
        return pipeline.solve(plan, Progress(quiet=True)).summary
    except (MeshError, ValueError, RuntimeError, ArithmeticError) as error:
        return " ".join(f"{type(error).__name__}: {error}".split())


def _timed(run: dict[str, Any], scene: Scene, exact: Exact, repeats: int) -> Row:
    """The run of a scene, where it is short (SHORT) the quickest of several (`repeats`)."""
    rows = [_recorded(run, scene, exact)]
    while len(rows) < repeats and (rows[0]["seconds"] or SHORT) < SHORT:
        rows.append(_recorded(run, scene, exact))
    return min(rows, key=lambda row: row["seconds"] or 0.0)


def _recorded(run: dict[str, Any], scene: Scene, exact: Exact) -> Row:
    """The run of a scene with its price and its errors, or with the reason of its failure."""
    done, seconds = tables.timed(_solve, scene)
    if isinstance(done, str):
        return run | {"failure": done}
    cost, converged = done["cost"], done["checks"]["converged"]
    return run | {
        "patch_size_mm": done["plan"]["patch_size_mm"],
        "unknowns": cost["dofs"],
        "seconds": seconds,
        "newton_iterations": cost["newton_iterations"],
        "linear_iterations": cost["linear_iterations"],
        "converged": converged,
        "failure": "" if converged else done["newton"]["reason"],
        "reached": done["accuracy"]["reached"],
        "estimate": max(
            (value for key, value in done["accuracy"]["bound"].items() if key in ESTIMATED),
            default=None,
        ),
        **_errors(done["result"], exact),
    }


def _errors(result: dict[str, Any] | None, exact: Exact) -> dict[str, Any]:
    """Columns of relative errors of a "result"; empty where it or what is exact is not known."""
    found = columns(result, COLUMNS) if result and exact else {}
    errors = {f"error_{key}": abs(value / exact[key] - 1) for key, value in found.items()}
    if errors:
        errors["error_all"] = max(errors.values())
        errors["error"] = max(errors[f"error_{key}"] for key in MAIN)
    return errors


def page(rows: Sequence[Row], max_unknowns: int) -> str:
    """The whole page; max_unknowns: above it, runs were left out."""
    worst, a = orders(rows), orders(rows, "error_a")
    shown = [
        {
            **row,
            "size": _size(row),
            "end": "yes" if row["reached"] else "no",
            "took": "-" if row["seconds"] is None else f"{row['seconds']:.2f}",
            **{f"{key} %": percent(row[key]) for key in ("asked", "error", "error_all")},
        }
        for row in rows
    ]
    return tables.render(
        "accuracy_cost",
        max_unknowns=max_unknowns,
        short=f"{SHORT:g}",
        repeats=REPEATS,
        asymptotic=ASYMPTOTIC,
        fronts={case: _factor_ten(own) for case, own in groups(rows, "case").items()},
        solid185=_rival(rows),
        orders=[(*key, f"{a[key]:.2f}", f"{worst[key]:.2f}") for key in worst],
        asked=tables.cells(
            [row for row in shown if row["asked"] is not None],
            *("{case}", "{asked %}", "{end}", "{error %}", "{error_all %}", "{took}"),
        ),
        failed=[(row, row["size"]) for row in shown if not row["converged"]],
    )


def orders(rows: Sequence[Row], quantity: str = "error") -> dict[tuple[str, str, str], float]:
    """Order of convergence of an error field by (case, method, element), from converged runs."""
    return {
        key: power_law([row["patch_size_mm"] for row in own], [row[quantity] for row in own])[1]
        for key, own in groups(_fixed(rows), "case", "method", "element").items()
        if len(own) > 1
    }


def _fixed(rows: Sequence[Row], *which: tuple[str, str]) -> list[Row]:
    """Converged runs on given meshes, of all or of some (method, element)."""
    return [
        row
        for row in rows
        if row["converged"] and row["asked"] is None
        if not which or (row["method"], row["element"]) in which
    ]


def _factor_ten(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Ends of the default's front, and the factor in time for ten in accuracy; None: no front."""
    front = tables.front(_fixed(rows, DEFAULT))
    fine = [row for row in front if row["error"] < ASYMPTOTIC]
    front = fine if len(fine) > 1 else front
    if len(front) < 2:
        return None
    return {"first": front[0], "last": front[-1], "factor": tables.factor_ten(front)}


def _rival(rows: Sequence[Row]) -> list[tuple]:
    """For each run of the default: its error beside the least of SOLID185's elements in no more
    time, as cells of a table."""
    lines = []
    for run in _fixed(rows, DEFAULT):
        rivals = [row for row in _fixed(rows, SOLID185) if row["case"] == run["case"]]
        quick = [row["error"] for row in rivals if row["seconds"] <= run["seconds"]]
        best, error = min(quick, default=None), run["error"]
        ratio = "none as quick" if best is None else f"{best / error:.1f}"
        took = f"{run['seconds']:.2f}"
        lines.append((run["case"], took, percent(error), percent(best), ratio))
    return lines


def _size(row: Row) -> str:
    """Elements per semi-axis of a run, or the asked accuracy, as text."""
    n = row["elements_per_semi_axis"]
    return f"asked {percent(row['asked'])}" if n is None else f"b/{n:g}"


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw error over processor seconds, a panel for each case.

    One line for each method and element. Runs that did not converge are crosses, runs with an asked
    accuracy are stars with what was asked. A broad line is the Pareto front of all converged runs:
    which error can be had in what time.
    """
    cases = groups(rows, "case")
    with new_figure(path, max(12.5, 1.5 + 4.7 * len(cases)), 5.8) as figure:
        panels = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
        named: dict[str, Any] = {}
        for axes, (case, own) in zip(panels, cases.items(), strict=True):
            _panel(axes, [row for row in own if row["error"] is not None])
            log_axes(axes, (1, 2, 5), (1,), title=case, xlabel="processor seconds")
            handles, labels = axes.get_legend_handles_labels()
            named |= dict(zip(labels, handles, strict=True))
        panels[0].set_ylabel("worst error of a, b and the largest pressure, %")
        figure.legend(named.values(), named.keys(), loc="outside upper center", ncols=4)


def _panel(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw the runs of one case that have an error."""
    lines = groups(_fixed(rows), "element", "method")
    for element, (colour, marker) in LOOKS.items():
        for method in (each for each in LINES if (element, each) in lines):
            name = method.replace("nitsche", "Nitsche")
            axes.plot(
                *_curve(lines[element, method]),
                LINES[method],
                color=colour,
                marker=marker,
                ms=6,
                mfc=colour if method == "nitsche" else "white",
                label=f"{element[:-2]}, order {element[-1]}, {name}",
                zorder=3,
            )
    failed = [row for row in rows if not row["converged"]]
    if failed:
        axes.plot(*_curve(failed), "x", color="black", ms=8, label="not converged", zorder=4)
    if done := [row for row in rows if row["converged"]]:
        axes.step(
            *_curve(tables.front(done)),
            color="#b8c7d6",
            lw=9,
            where="post",
            solid_capstyle="round",
            solid_joinstyle="round",
            label="Pareto front",
            zorder=1,
        )
    halo = [patheffects.withStroke(linewidth=3, foreground="white")]
    asked = [row for row in rows if row["asked"] is not None]
    for number, same in enumerate(groups(asked, "unknowns").values()):  # the same mesh
        at = (same[0]["seconds"], 100 * same[0]["error"])
        axes.plot(
            *_curve(same),
            "*",
            color=STAR,
            mec="black",
            ms=15,
            lw=0,
            label="asked accuracy",
            zorder=5,
        )
        axes.annotate(
            ", ".join(f"{100 * row['asked']:g}" for row in same) + " %",
            at,
            xytext=(0, 15 * (-1) ** number),  # above and below by turns: neighbours may be close
            textcoords="offset points",
            ha="center",
            va="center",
            path_effects=halo,
            zorder=6,
        )


def draw_prices(rows: Sequence[Row], path: Path) -> None:
    """Draw processor seconds over the asked accuracy, a line for each case; an open mark is the
    case as it ships, at its estimate. Runs that did not reach what was asked are crossed."""
    with new_figure(path, 9.5, 5.8) as figure:
        axes = figure.subplots()
        for number, (case, own) in enumerate(groups(rows, "case").items()):
            look: dict[str, Any] = {"color": f"C{number}", "marker": "osv^DPX<>"[number % 9]}
            asked = [row for row in own if row["asked"] is not None and row["seconds"]]
            x, y = ([scale * row[key] for row in asked] for key, scale in PRICE_AXES)
            axes.plot(x, y, label=case, **look)
            for row in own:
                if row["asked"] is None and row["estimate"] and row["seconds"]:
                    axes.plot(100 * row["estimate"], row["seconds"], ms=11, mfc="none", **look)
                elif not row["reached"] and row["seconds"]:
                    axes.plot(100 * row["asked"], row["seconds"], "x", color="black", ms=12)
        label = "asked accuracy; of open marks the estimate, %"
        log_axes(axes, (1, 2, 5), (1, 2, 5), xlabel=label, ylabel="processor seconds")
        axes.invert_xaxis()
        figure.legend(loc="outside upper center", ncols=3)


def _curve(rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    """Seconds and errors in % of the rows, in their order."""
    return [row["seconds"] for row in rows], [100 * row["error"] for row in rows]
