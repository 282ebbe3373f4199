"""The page and the picture of the study peers."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

from railhead.postprocess.plots.diagrams import FE, new_figure
from studies import tables
from studies.peers.codes import Peer
from studies.peers.process import running
from studies.peers.reading import Run

OURS = "railhead"
TRAVEL = 0.04126  # mm of the far ends towards each other: close to 25 kN on these blocks
ERRORS = ("p_max", "p_fit", "a", "b", "area", "approach", "tau_max")


def medians(runs: Sequence[Run]) -> list[Run]:
    """One run for each code and setting, in the order of codes: the medians of what was measured
    several times. (Its errors are the same each time.)"""
    groups: dict[tuple[str, str], list[Run]] = {}
    for run in sorted(runs, key=lambda run: (run.code != OURS, run.code)):
        groups.setdefault((run.code, run.setting), []).append(run)
    return [_median(group) for group in groups.values()]


def _median(group: Sequence[Run]) -> Run:
    done = [run for run in group if not run.failure]
    if not done:
        return group[0]
    costs = {
        key: median(getattr(run, key) for run in done)
        for key in ("seconds", "cpu_seconds", "peak_bytes")
    }
    return replace(done[0], **costs)


def page(
    runs: Sequence[Run],
    present: Sequence[Peer],
    versions: Mapping[str, str],
    absent: Mapping[str, str],
) -> str:
    """The whole page."""
    seen = medians(runs)
    own = [run for run in runs if run.code == OURS and not run.failure]
    repeated = [
        [run.cpu_seconds for run in own if run.setting == setting and run.cpu_seconds]
        for setting in {run.setting for run in own}
    ]
    forces = [run.force / 1e3 for run in runs if run.code != OURS and run.force]
    waited = [run.seconds / run.cpu_seconds for run in runs if run.seconds and run.cpu_seconds]
    return tables.render(
        "peers",
        ours=version("railhead"),
        threads=running.THREADS,
        cores=os.cpu_count(),
        travel=TRAVEL,
        forces=(min(forces), max(forces)) if forces else None,
        limit=f"{running.LIMIT:g}",
        waited=median(waited) if waited else None,
        repeats=max((len(each) for each in repeated), default=0),
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
        failed=[run for run in seen if run.failure],
        rows=[_row(run) for run in seen if not run.failure],
    )


def _row(run: Run) -> tuple[Any, ...]:
    values = vars(run)
    errors = [values[f"error_{name}"] for name in ERRORS]
    return (
        run.code,
        run.setting,
        run.unknowns,
        f"{run.cpu_seconds:.1f}",
        f"{run.seconds:.1f}",
        f"{(run.peak_bytes or 0) / 1e6:.0f}",
        *("-" if error is None else f"{100 * error:+.2f}" for error in errors),
    )


PANELS = {"error_p_max": "largest pressure", "error_area": "area of the patch"}
COLOURS = ("#3b8f5a", "#c8502d", "#7b4fa3", "#b8860b", "#4fa3a3", "#777777", "#a3324f", "#5b6ee1")
MARKERS = "osv^Dp<>"
FLOOR = 1e-4  # relative; errors below it are chance, and drawn here


def draw(runs: Sequence[Run], path: Path) -> None:
    """A line for each code and family of settings, over the processor's seconds of its process;
    ours are stars with what was asked."""
    lines: dict[str, list[Run]] = {}
    for run in medians(runs):
        if run.cpu_seconds is not None:
            lines.setdefault(_name(run), []).append(run)
    looks = zip(COLOURS * 2, MARKERS + MARKERS[::-1], strict=True)
    with new_figure(path, 13.5, 6.0) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for name, line in lines.items():
            if name == OURS:
                style = {"color": FE, "marker": "*", "ms": 16, "lw": 0, "zorder": 4}
            else:
                colour, marker = next(looks)
                style = {"color": colour, "marker": marker, "ms": 7, "lw": 1.2, "mfc": "white"}
                if line[0].method != "finite elements":
                    style["ls"] = "--"
            for axes, quantity in zip(panels, PANELS, strict=True):
                errors = [100 * max(abs(getattr(run, quantity)), FLOOR) for run in line]
                seconds = [run.cpu_seconds or 0.0 for run in line]
                axes.plot(seconds, errors, label=name, **style)
                for run, *at in zip(line, seconds, errors, strict=True):
                    if name == OURS:
                        text = run.setting.removeprefix("--accuracy ")
                        axes.annotate(
                            text, at, xytext=(8, -12), textcoords="offset points", color=FE
                        )
        for axes, title in zip(panels, PANELS.values(), strict=True):
            axes.set(title=title, xscale="log", yscale="log")
            axes.set_xlabel("processor seconds of the whole process, one thread")
        panels[0].set_ylabel(f"error against exact Hertz, % (below {100 * FLOOR:g}: drawn there)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=5)


def _name(run: Run) -> str:
    """Code and family: its setting up to the last comma, beyond which is the size."""
    family = run.setting.rpartition(", ")[0]
    name = run.code if run.code == OURS or not family else f"{run.code}, {family}"
    return name if run.method == "finite elements" else f"{name} ({run.method})"
