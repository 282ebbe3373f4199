"""Bands of stress in a cut through both bodies: sigma_3 and the largest shear stress."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import BODY_NAMES
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.plots.diagrams import BANDS, mark_largest, new_figure

LABELS = (r"smallest principal stress $\sigma_3$, MPa", r"largest shear stress $\tau$, MPa")
LONG = 66  # letters of a label: two longer ones do not fit beside each other
MAPS = ("YlGnBu_r", "YlOrRd")


@dataclass(frozen=True)
class Cut:
    """One body in a plane cut through the contact, with nodal stresses.

    local (n, 2): coordinates of the nodes in the cut, x or s and height over the tangent plane, mm.
    triangles (t, 3): nodes of each triangle.
    stresses: smallest principal stress (n,) and largest shear stress (n,) at the nodes, MPa.
    rim (k, 2, 2): start and end of the lines of the outline, in the coordinates of the cut, mm.
    """

    local: Array
    triangles: NDArray[np.int64]
    stresses: tuple[Array, Array]
    rim: Array = field(default_factory=lambda: np.empty((0, 2, 2)))


@dataclass(frozen=True)
class Fringes:
    """The window that a picture of a cut shows.

    seen: smallest principal stresses and largest shear stresses in the window, MPa; they set the
        limits of the colour bands.
    width: limits of the window along x or s, mm.
    height: limits of the height over the tangent plane, mm.
    axis: 0 where the horizontal axis of the picture is x, 1 where it is s.
    """

    seen: list[Array]
    width: tuple[float, float]
    height: tuple[float, float]
    axis: int


def draw_fringes(parts: list[Cut], fringes: Fringes, findings: Findings, path: Path) -> None:
    """Write a PNG file with two panels: bands of the smallest principal stress and of the largest
    shear stress in all bodies of a cut.

    parts: the bodies. fringes: the window. findings: give the title, the edges of the patch and the
        largest shear stress of each body, which is marked in the second panel. path: of the file.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    names = findings.subject.names
    shape = np.ptp(fringes.height) / np.ptp(fringes.width)
    with new_figure(path, 10, 2.0 + 4.4 * shape, findings) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for number, axes in enumerate(panels):
            values = fringes.seen[number]
            ticks = levels(values, below=number == 0)
            for part in parts:
                bands = axes.tricontourf(
                    *part.local.T,
                    part.triangles,
                    part.stresses[number],
                    ticks,
                    cmap=MAPS[number],
                    extend="max" if number == 0 else "neither",
                )
                lines = LineCollection(list(part.rim), colors="black", linewidths=1.2)
                axes.add_collection(lines)
            figure.colorbar(
                bands,
                ax=axes,
                label=LABELS[number],
                ticks=ticks[::-2][::-1] if number == 0 else ticks[::2],
                location="bottom",
            )
            axes.set(xlabel=findings.subject.label(fringes.axis), aspect="equal")
            axes.set(xlim=fringes.width, ylim=fringes.height)
            axes.grid(False)
            for body in BODY_NAMES.values():
                height, side = (0.03, "bottom") if body == "rail" else (0.97, "top")
                text = names[body] + ("" if body in findings.depth else ": rigid")
                axes.text(0.02, height, text, transform=axes.transAxes, va=side, fontsize=13)
            for line in findings.patch.outlines:  # the bodies are drawn undeformed
                ends = np.array([line[:, fringes.axis].min(), line[:, fringes.axis].max()])
                axes.plot(ends, [0, 0], "|", color="black", ms=14, mew=1.6, gid="contact patch")
        panels[0].set_ylabel("height over the contact, mm")
        mark_largest(panels[1], findings, fringes.axis)
        handles, labels = panels[1].get_legend_handles_labels()
        edges = Line2D([], [], color="black", marker="|", ms=12, mew=1.6, ls="none")
        long = max(map(len, labels), default=0) > LONG
        figure.legend(
            [*handles, edges],
            [*labels, "edges of the patch (drawn undeformed)"],
            loc="outside upper center",
            ncols=1 if long else 2,
            fontsize=10,
        )


def levels(values: Array, *, below: bool) -> Array:
    """Limits (k,) of the colour bands, MPa, for values (n,). Zero is one of the limits. below:
    whether the bands cover the negative values, from the smallest to zero; otherwise they cover
    the positive ones, from zero to the largest.
    """
    from matplotlib.ticker import MaxNLocator

    low, high = (min(values.min(), 0.0), 0.0) if below else (0.0, max(values.max(), 0.0))
    if low == high:
        low, high = (-1.0, 0.0) if below else (0.0, 1.0)
    return np.array(MaxNLocator(BANDS + 2).tick_values(low, high), dtype=np.float64)
