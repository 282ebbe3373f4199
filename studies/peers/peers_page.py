"""What codes found against exact Hertz at the force that each carries itself; the page and the
picture of the study peers."""

import os
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from railhead.postprocess.pictures.diagrams import FE, new_figure
from railhead.scene.quantities import numeric_values
from railhead.theory.elastic import hertz
from studies import processes, tables
from studies.peers.codes import Peer
from studies.tables import Row, groups

OURS = "railhead"
TRAVEL = 0.04126  # mm of the far ends towards each other: close to 25 kN on these blocks
LEAST = 0.15  # of the largest pressure: below it, pressures are no part of the fit
ERRORS = ("p_max", "p_fit", "a", "b", "area", "approach", "tau_max")
OWN = ("max_MPa", None, "a_mm", "b_mm", "area_mm2", "approach_mm", "tau_max_MPa")
"""What ERRORS are in our own summary."""
COSTS = ("seconds", "cpu_seconds", "peak_bytes")
COLUMNS = (*COSTS, "unknowns", "iterations", "force", *(f"error_{name}" for name in ERRORS))
UNITS = {"force": "N"}
PANELS = {"error_p_max": "largest pressure", "error_area": "area of the patch"}
COLOURS = ("#3b8f5a", "#c8502d", "#7b4fa3", "#b8860b", "#4fa3a3", "#777777", "#a3324f", "#5b6ee1")
MARKERS = "osv^Dp<>"
FLOOR = 1e-4  # relative; errors below it are chance, and drawn here


def row(code: str, method: str, setting: str, found: Mapping[str, Any], failure: str = "") -> Row:
    """One solve. Errors are relative, None where the code does not give the quantity or failed;
    p_max is what the code gives, p_fit, a and b are of the ellipse fitted to its pressures (ours:
    what the result says)."""
    head = {"code": code, "method": method, "setting": setting}
    return {**head, **{key: found.get(key) for key in COLUMNS}, "failure": failure}


def fitted(x: ArrayLike, y: ArrayLike, pressure: ArrayLike) -> tuple[float, float, float]:
    """p0 (MPa), a and b (mm) of p^2 = p0^2 (1 - (x/a)^2 - (y/b)^2), by least squares over points
    with more than LEAST of the largest pressure. ValueError: they lie on no ellipse."""
    x, y, p = (np.asarray(each, float) for each in (x, y, pressure))
    high = p > LEAST * p.max(initial=0.0)
    terms = np.column_stack([np.ones(high.sum()), -(x[high] ** 2), -(y[high] ** 2)])
    (c, along, across), _, rank, _ = np.linalg.lstsq(terms, p[high] ** 2, rcond=None)
    flat = 1e-9 * c  # rounding, where the pressure does not fall along an axis
    if rank < 3 or c <= 0 or min(along * np.ptp(x) ** 2, across * np.ptp(y) ** 2) <= flat:
        raise ValueError("its pressures lie on no ellipse")
    return float(np.sqrt(c)), float(np.sqrt(c / along)), float(np.sqrt(c / across))


def read(case: Mapping[str, float], found: Mapping[str, Any]) -> dict[str, Any]:
    """Unknowns, iterations, force and errors, from what `solve` gave."""
    modulus = hertz.contact_modulus(case["young"], case["poisson"], case["young"], case["poisson"])
    curvatures = 1 / case["wheel_radius"], 1 / case["rail_radius"]
    exact = hertz.point_contact(*curvatures, modulus, found["force"])
    p_fit, a, b = fitted(found["x"], found["y"], found["pressure"])
    shear = exact.axis_extrema(case["poisson"]).tau_max
    pairs = {
        "p_max": (found["pressure_max"], exact.p0),
        "p_fit": (p_fit, exact.p0),
        "a": (a, exact.a),
        "b": (b, exact.b),
        "area": (a * b, exact.a * exact.b),
        "approach": (found.get("approach"), exact.approach),
        "tau_max": (found.get("tau_max"), shear),
    }
    return {key: found.get(key) for key in ("unknowns", "iterations", "force")} | {
        f"error_{name}": None if value is None else value / right - 1
        for name, (value, right) in pairs.items()
    }


def read_own(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Unknowns, iterations, force and errors beside Hertz of our own run, from summary.json."""
    result, exact = (numeric_values(summary[key]) for key in ("result", "hertz"))
    return {
        "unknowns": summary["cost"]["dofs"],
        "iterations": summary["cost"]["newton_iterations"],
        "force": summary["result"]["load_N"],
        **{
            f"error_{name}": result[key] / exact[key] - 1
            for name, key in zip(ERRORS, OWN, strict=True)
            if key
        },
    }


def medians(runs: Sequence[Row]) -> list[Row]:
    """One run for each code and setting, in the order of codes: the medians of what was measured
    several times. (Its errors are the same each time.)"""
    ordered, found = sorted(runs, key=lambda run: (run["code"] != OURS, run["code"])), []
    for group in groups(ordered, "code", "setting").values():
        done = [run for run in group if not run["failure"]]
        costs = {key: median(run[key] for run in done) for key in COSTS if done}
        found.append({**(done or group)[0], **costs})
    return found


def page(
    runs: Sequence[Row],
    present: Sequence[Peer],
    versions: Mapping[str, str],
    absent: Mapping[str, str],
) -> str:
    """Text of docs/peers.md."""
    seen, done = medians(runs), [run for run in runs if not run["failure"]]
    own = groups((run for run in done if run["code"] == OURS), "setting").values()
    repeated = [[run["cpu_seconds"] for run in each] for each in own]
    forces = [run["force"] / 1e3 for run in done if run["code"] != OURS]
    waited = [run["seconds"] / run["cpu_seconds"] for run in done]
    default = [run for run in seen if run["code"] == OURS and run["setting"] == "default"]
    others = [run for run in seen if run["method"] == "finite elements" and run["code"] != OURS]
    others = [run for run in others if not run["failure"]]
    best = [min(each, key=_worst) for each in (default, others) if each]
    return tables.render(
        "peers",
        best=[(100 * _worst(run), run["cpu_seconds"], run["code"]) for run in best],
        ours=version("railhead-contact"),
        threads=processes.THREADS,
        cores=os.cpu_count(),
        travel=TRAVEL,
        forces=(min(forces), max(forces)) if forces else None,
        limit=f"{processes.LIMIT:g}",
        waited=median(waited) if waited else None,
        repeats=max(map(len, repeated), default=0),
        spread=max((max(each) / min(each) for each in repeated), default=1.0),
        peers=[
            {
                "title": peer.TITLE,
                "version": versions[peer.TITLE],
                "method": peer.METHOD,
                "settings": " ".join(peer.SETTINGS.split()),
            }
            for peer in present
        ],
        absent=absent,
        failed=[run for run in seen if run["failure"]],
        rows=[_row(run) for run in seen if not run["failure"]],
    )


def _worst(run: Row) -> float:
    """The larger error of largest pressure and area, in size."""
    return max(abs(run[f"error_{name}"]) for name in ("p_max", "area"))


def _row(run: Row) -> tuple[Any, ...]:
    """Cells of the page's table for one run; errors in %."""
    errors = [run[f"error_{name}"] for name in ERRORS]
    return (
        run["code"],
        run["setting"],
        run["unknowns"],
        f"{run['cpu_seconds']:.1f}",
        f"{run['seconds']:.1f}",
        f"{run['peak_bytes'] / 1e6:.0f}",
        *("-" if error is None else f"{100 * error:+.2f}" for error in errors),
    )


def draw(runs: Sequence[Row], path: Path) -> None:
    """A line for each code and family of settings, over the processor's seconds of its process;
    ours are stars with what was asked."""
    done = [{**run, "name": _name(run)} for run in medians(runs) if not run["failure"]]
    looks = zip(COLOURS * 2, MARKERS + MARKERS[::-1], strict=True)
    with new_figure(path, 13.5, 6.0) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for name, line in groups(done, "name").items():
            style: dict[str, Any] = {"color": FE, "marker": "*", "ms": 16, "lw": 0, "zorder": 4}
            if name != OURS:
                colour, marker = next(looks)
                style = {"color": colour, "marker": marker, "ms": 7, "lw": 1.2, "mfc": "white"}
                style["ls"] = "-" if line[0]["method"] == "finite elements" else "--"
            seconds = [run["cpu_seconds"] for run in line]
            for axes, quantity in zip(panels, PANELS, strict=True):
                errors = [100 * max(abs(run[quantity]), FLOOR) for run in line]
                axes.plot(seconds, errors, label=name, **style)
                for run, *at in zip(line, seconds, errors, strict=True) if name == OURS else ():
                    text = run["setting"].removeprefix("--accuracy ")
                    axes.annotate(text, at, xytext=(8, -12), textcoords="offset points", color=FE)
        for axes, title in zip(panels, PANELS.values(), strict=True):
            axes.set(title=title, xscale="log", yscale="log")
            axes.set_xlabel("processor seconds of the whole process, one thread")
        panels[0].set_ylabel(f"error against exact Hertz, % (below {100 * FLOOR:g}: drawn there)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=5)


def _name(run: Row) -> str:
    """Code and family: its setting up to the last comma, beyond which is the size."""
    family = run["setting"].rpartition(", ")[0]
    name = run["code"] if run["code"] == OURS or not family else f"{run['code']}, {family}"
    return name if run["method"] == "finite elements" else f"{name} ({run['method']})"
