"""Picture of passes: residual stress and plastic strain below the patch, increments, and groove."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps

from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.pictures.plots.diagrams import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from railhead.postprocess.pictures.plots.diagrams import Target

DEEP = 3.0  # shown depth over the smaller half length
WIDE = 2.5  # shown width over the half length across
SHOWN = 5  # passes of which curves are shown: the first, the last, and some between

Below = tuple[Array, Array, Array]
"""Depth (k,), mm, residual stress xx, yy, zz, yz (k, 4), MPa, plastic strain (k,)."""


def draw(
    rows: Sequence[Mapping[str, Any]],
    below: Sequence[Below],
    surfaces: Sequence[tuple[Array, Array]],
    half_lengths: tuple[float, float],
    found: Findings,
    target: Target = None,
) -> Figure:
    """Four panels: residual stress along the rail and across it over the
    depth, equivalent plastic strain over the depth, what each pass adds, and the groove.

    rows: of the passes, as in summary.json. below: state below the middle after each pass.
        surfaces: across (n,) and displacement out of the rail (n,), mm, after each pass.
        half_lengths: of the elastic patch, along and across, mm. found: gives the title. path: of
        the file.
    """
    count = len(rows)
    shown = sorted({round(value) for value in np.geomspace(1, count, min(SHOWN, count))})
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(shown)))
    deep = DEEP * min(half_lengths)
    with new_figure(target, 11, 8.6, found) as figure:
        (stress, strain), (growth, groove) = figure.subplots(2, 2)
        for number, colour in zip(shown, colours, strict=True):
            depth, left, equivalent = below[number - 1]
            label = f"pass {number}"
            stress.plot(left[:, 0], depth, color=colour, label=label)
            stress.plot(left[:, 1], depth, "--", color=colour)
            strain.plot(100 * equivalent, depth, color=colour, label=label)
        stress.set(xlabel="residual stress along (full) and across (dashed), MPa")
        strain.set(xlabel="equivalent plastic strain, %")
        for axes in (stress, strain):
            axes.set(ylabel="depth below the middle of the patch, mm", ylim=(deep, 0.0))
            axes.legend()
        _increments(growth, rows)
        if len(surfaces[0][0]) > 1:
            for number, colour in zip(shown, colours, strict=True):
                y, up = surfaces[number - 1]
                groove.plot(y, 1e3 * up, color=colour, label=f"pass {number}")
            wide = WIDE * half_lengths[1]
            groove.set(xlabel="across, from the middle of the patch, mm", xlim=(-wide, wide))
            groove.set(ylabel="residual height, um")
            groove.legend()
        else:
            depth = [1e3 * row["groove_mm"] for row in rows]
            groove.plot(np.arange(1, count + 1), depth, "o-")
            groove.set(xlabel="pass", ylabel="the surface has sunk by, um")
    return figure


def _increments(axes: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw the largest plastic increment and the forward displacement (um) over the passes, on
    logarithmic axes where they are not zero.
    """
    number = np.arange(1, len(rows) + 1)
    for key, factor, label in (
        ("strain_increment_max", 100.0, "largest strain increment, %"),
        ("forward_mm", 1e3, "forward displacement of the surface (size), um"),
    ):
        values = np.array([factor * abs(row[key]) for row in rows])
        axes.plot(number[values > 0], values[values > 0], "o-", label=label)
    if any(row["strain_increment_max"] for row in rows):
        axes.set_yscale("log")
    axes.set(xlabel="pass", ylabel="of each pass")
    axes.legend()
