"""The picture of the study: errors of the largest pressure and of the area against time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from railhead.postprocess.plots.diagrams import FE, new_figure
from studies.peers.page import OURS, medians
from studies.peers.reading import Run

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
