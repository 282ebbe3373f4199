"""Picture of passes: residual stress and plastic strain below the patch, increments, and groove."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from railhead.postprocess.findings import Findings, Units
from railhead.postprocess.pass_rows import Passes
from railhead.postprocess.pictures.plots.diagrams import Target, levels, new_figure

DEEP = 3.0  # shown depth over the smaller half length
WIDE = 2.5  # shown width over the half length across
LEVELS = 16  # of colour
SHOWN = 5  # passes of which curves are shown: the first, the last, and some between

PANELS = (
    ("equivalent plastic strain, %", "YlOrRd"),
    ("residual stress along the rail, MPa", "RdBu_r"),
    ("residual stress across, MPa", "RdBu_r"),
    ("residual normal stress, MPa", "RdBu_r"),
)


def draw(passes: Passes, found: Findings, target: Target = None) -> Figure:
    """Four panels: residual stress along the rail and across it over the depth, equivalent plastic
    strain over the depth, what each pass adds, and the groove. found: gives the title.
    """
    rows, half_lengths = passes.rows, passes.half_lengths
    count = len(rows)
    shown = sorted({round(value) for value in np.geomspace(1, count, min(SHOWN, count))})
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(shown)))
    deep = DEEP * min(half_lengths)
    with new_figure(target, 11, 8.6, found) as figure:
        (stress, strain), (growth, groove) = figure.subplots(2, 2)
        for number, colour in zip(shown, colours, strict=True):
            section, label = passes.sections[number - 1], f"pass {number}"
            depth, (left, equivalent) = section.depth, section.below()
            stress.plot(left[:, 0], depth, color=colour, label=label)
            stress.plot(left[:, 1], depth, "--", color=colour)
            strain.plot(100 * equivalent, depth, color=colour, label=label)
        stress.set(xlabel="residual stress along (full) and across (dashed), MPa")
        strain.set(xlabel="equivalent plastic strain, %")
        for axes in (stress, strain):
            axes.set(ylabel="depth below the middle of the patch, mm", ylim=(deep, 0.0))
            axes.legend()
        _increments(growth, rows, found.subject.units)
        if len(passes.sections[0].across) > 1:
            for number, colour in zip(shown, colours, strict=True):
                section = passes.sections[number - 1]
                groove.plot(section.across, 1e3 * section.up, color=colour, label=f"pass {number}")
            wide = WIDE * half_lengths[1]
            groove.set(xlabel="across, from the middle of the patch, mm", xlim=(-wide, wide))
            groove.set(ylabel="residual height, um")
            groove.legend()
        else:
            depth = [1e3 * row["groove_mm"] for row in rows]
            groove.plot(np.arange(1, count + 1), depth, "o-")
            groove.set(xlabel="pass", ylabel="the surface has sunk by, um")
    return figure


def draw_section(passes: Passes, found: Findings, target: Target = None) -> Figure:
    """Section of a solid after the last pass: equivalent plastic strain, and residual stress along
    the rail, across it and normal to its surface. found: gives the title.
    """
    left = passes.sections[-1]
    values = [100 * left.strain, *np.moveaxis(left.stress[..., :3], -1, 0)]
    with new_figure(target, 11, 6.4, found) as figure:
        for axes, each, (label, colours) in zip(
            figure.subplots(2, 2).ravel(), values, PANELS, strict=True
        ):
            both = each if each is values[0] else np.array([-each, each])
            limits = levels(found.subject.units, label, both, LEVELS)
            filled = axes.contourf(left.y, -left.depth, each.T, limits, cmap=colours)
            # An inset stays beside the axes, whose shape follows from their equal scales.
            axes.figure.colorbar(filled, cax=axes.inset_axes((1.03, 0.0, 0.03, 1.0)), label=label)
            axes.grid(False)
            axes.set(xlabel="across, from the middle of the patch, mm", ylabel="height, mm")
            axes.set_aspect("equal")
    return figure


def _increments(axes: Axes, rows: list[dict[str, Any]], units: Units) -> None:
    """Draw the largest plastic increment and the forward displacement over the passes, on
    logarithmic axes where they are not zero.
    """
    number = np.arange(1, len(rows) + 1)
    for key, factor, label in (
        ("strain_increment_max", 100.0, "largest strain increment, %"),
        ("forward_mm", 1e3, "forward displacement (size), um"),
    ):
        factor, label = units.value(factor, label), units.unit(label)
        values = np.array([factor * abs(row[key]) for row in rows])
        axes.plot(number[values > 0], values[values > 0], "o-", label=label)
    if any(row["strain_increment_max"] for row in rows):
        axes.set_yscale("log")
    axes.set(xlabel="pass", ylabel="of each pass")
    axes.xaxis.get_major_locator().set_params(integer=True, min_n_ticks=1)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize=10, ncols=2)
