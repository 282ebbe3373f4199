"""The picture of what friction does: where the patch sticks, and the tractions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots import FE, HERTZ, new_figure
from railhead.solver.solution import Rubbing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STICK, SLIP = "#8fb8de", "#e8a87c"
ARROWS = 220  # at most
THIN = 0.15  # of the patch's half length across: points nearer to its middle line are drawn on it


def draw(
    found: Rubbing, findings: Findings, coefficient: float, path: Path, *, mirrored: bool
) -> None:  # fmt: skip
    """Stick and slip in the tangent plane with the tractions of the wheel on the rail as arrows
    (not of a section), and the traction along the middle line against mu p. mirrored: the other
    half, across, is an image."""
    frame, patch = findings.frame, findings.patch
    touches = found.pressure > 0
    local = frame.local(found.points[touches])[:, :2] - np.array(patch.centre)
    traction = found.traction[touches] @ frame.axes.T[:, :2]
    pressure, sticks = found.pressure[touches], found.sticks[touches]
    if mirrored:
        local = np.concatenate([local, local * [1, -1]])
        traction = np.concatenate([traction, traction * [1, -1]])
        pressure, sticks = np.tile(pressure, 2), np.tile(sticks, 2)
    flat = np.ptp(local[:, 1]) < 1e-9
    with new_figure(path, 7 if flat else 11.5, 4.8, findings) as figure:
        along = findings.subject.label(0)
        panels = figure.subplots(1, 1 if flat else 2, squeeze=False)[0]
        if not flat:
            _map(panels[0], local, traction, sticks)
            panels[0].set(xlabel=along, ylabel=findings.subject.label(1))
        middle = np.abs(local[:, 1]) < (np.inf if flat else THIN * patch.b)
        order = np.argsort(local[middle, 0])
        x = local[middle, 0][order]
        axes = panels[-1]
        axes.plot(x, coefficient * pressure[middle][order], ".", color=HERTZ, ms=2.5, label="mu p")
        axes.plot(x, -coefficient * pressure[middle][order], ".", color=HERTZ, ms=2.5)
        axes.plot(x, traction[middle, 0][order], ".", color=FE, ms=3, label="along the rail")
        if not flat:
            axes.plot(x, traction[middle, 1][order], ".", color="#5a9367", ms=3, label="across")
        axes.set(xlabel=along, ylabel="traction, MPa")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper right", ncols=3)


def _map(axes: Axes, local: Array, traction: Array, sticks: NDArray[np.bool_]) -> None:
    for chosen, colour, name in ((sticks, STICK, "sticks"), (~sticks, SLIP, "slips")):
        x, s = local[chosen].T
        axes.scatter(x, s, s=9, color=colour, linewidths=0, label=name)
    few = np.random.default_rng(0).permutation(len(local))[:ARROWS]
    axes.quiver(*local[few].T, *traction[few].T, color=FE, width=0.003)
    axes.set_aspect("equal")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, markerscale=2)
