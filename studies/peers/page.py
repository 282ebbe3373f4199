"""The page and the picture of the study peers."""

import os
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

from railhead.postprocess.plots.diagrams import FE, new_figure
from studies import tables
from studies.peers import running
from studies.peers.codes import Peer
from studies.peers.reading import COSTS, ERRORS
from studies.tables import Row, groups

OURS = "railhead"
TRAVEL = 0.04126  # mm of the far ends towards each other: close to 25 kN on these blocks


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
    """The whole page."""
    seen, done = medians(runs), [run for run in runs if not run["failure"]]
    own = groups((run for run in done if run["code"] == OURS), "setting").values()
    repeated = [[run["cpu_seconds"] for run in each] for each in own]
    forces = [run["force"] / 1e3 for run in done if run["code"] != OURS]
    waited = [run["seconds"] / run["cpu_seconds"] for run in done]
    return tables.render(
        "peers",
        ours=version("railhead"),
        threads=running.THREADS,
        cores=os.cpu_count(),
        travel=TRAVEL,
        forces=(min(forces), max(forces)) if forces else None,
        limit=f"{running.LIMIT:g}",
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


def _row(run: Row) -> tuple[Any, ...]:
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


PANELS = {"error_p_max": "largest pressure", "error_area": "area of the patch"}
COLOURS = ("#3b8f5a", "#c8502d", "#7b4fa3", "#b8860b", "#4fa3a3", "#777777", "#a3324f", "#5b6ee1")
MARKERS = "osv^Dp<>"
FLOOR = 1e-4  # relative; errors below it are chance, and drawn here


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
