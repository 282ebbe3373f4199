"""Bands of stress in a cut through both bodies: sigma_3 and the largest shear stress."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import BODIES
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots import BANDS, mark_largest, new_figure

LABELS = (r"smallest principal stress $\sigma_3$, MPa", r"largest shear stress $\tau$, MPa")
MAPS = ("YlGnBu_r", "YlOrRd")


@dataclass(frozen=True)
class Cut:
    """One body: places (n, 2) in the cut, mm, triangles (t, 3), sigma_3 and the largest shear
    stress (n,) each, MPa; rim: lines (k, 2, 2) of its outline."""

    local: Array
    triangles: NDArray[np.int64]
    stresses: tuple[Array, Array]
    rim: Array = field(default_factory=lambda: np.empty((0, 2, 2)))


@dataclass(frozen=True)
class Fringes:
    """seen: the values in the window, for the bands; width, height: its limits, mm; axis: 0 where
    it runs along x, 1 along s."""

    seen: list[Array]
    width: tuple[float, float]
    height: tuple[float, float]
    axis: int


def draw_fringes(parts: list[Cut], fringes: Fringes, findings: Findings, path: Path) -> None:
    """Both stresses beside each other; the largest shear stress of each body is marked in its own
    picture."""
    from matplotlib.collections import LineCollection
    from matplotlib.ticker import MaxNLocator

    names = findings.subject.names
    shape = np.ptp(fringes.height) / np.ptp(fringes.width)
    with new_figure(path, 10, 2.2 + 4.4 * shape, findings) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for number, axes in enumerate(panels):
            values = fringes.seen[number]
            ticks = MaxNLocator(BANDS + 2).tick_values(values.min(), values.max())
            for part in parts:
                bands = axes.tricontourf(
                    *part.local.T, part.triangles, part.stresses[number], np.array(ticks),
                    cmap=MAPS[number], extend="both" if number == 0 else "max",
                )  # fmt: skip
                lines = LineCollection(list(part.rim), colors="black", linewidths=1.2)
                axes.add_collection(lines)
            figure.colorbar(
                bands, ax=axes, label=LABELS[number], ticks=ticks[::2], location="bottom"
            )
            axes.set(xlabel=findings.subject.label(fringes.axis), aspect="equal")
            axes.set(xlim=fringes.width, ylim=fringes.height)
            axes.grid(False)
            for body in (name for name in BODIES.values() if name in findings.depth):
                height, side = (0.03, "bottom") if body == "rail" else (0.97, "top")
                axes.text(
                    0.02, height, names[body], transform=axes.transAxes, va=side, fontsize=13
                )  # fmt: skip
        panels[0].set_ylabel("height over the contact, mm")
        mark_largest(panels[1], findings, fringes.axis)
        figure.legend(loc="outside upper center", ncols=2)
