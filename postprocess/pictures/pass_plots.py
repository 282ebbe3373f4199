"""Pictures of passes over a rail that yields: residual stress, plastic strain, and increments."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from railhead.postprocess.findings import Findings, Units
from railhead.postprocess.pass_rows import Passes
from railhead.postprocess.pictures.diagrams import FE, HERTZ, Target, levels, new_figure

DEEP = 3.0  # shown depth over the smaller half length
LEVELS = 16  # of colour
SHOWN = 5  # passes of which curves are shown: the first, the last, and some between
PANELS = (
    ("equivalent plastic strain, %", "YlOrRd"),
    ("residual stress along the rail, MPa", "RdBu_r"),
    ("residual stress across, MPa", "RdBu_r"),
    ("residual normal stress, MPa", "RdBu_r"),
)


def draw_passes(passes: Passes, found: Findings, target: Target = None) -> Figure:
    """Three panels: residual stress along the rail and across it over the depth, equivalent plastic
    strain over the depth, and what each pass adds. found: gives the title.
    """
    count = len(passes.rows)
    shown = sorted({round(value) for value in np.geomspace(1, count, min(SHOWN, count))})
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(shown)))
    with new_figure(target, 12, 4.8, found) as figure:
        stress, strain, growth = figure.subplots(1, 3)
        for number, colour in zip(shown, colours, strict=True):
            section, label = passes.sections[number - 1], f"pass {number}"
            depth, (left, equivalent) = section.depth, section.below()
            stress.plot(left[:, 0], depth, color=colour, label=label)
            stress.plot(left[:, 1], depth, "--", color=colour)
            strain.plot(100 * equivalent, depth, color=colour, label=label)
        stress.set(xlabel="residual stress, MPa\n(full along, dashed across)")
        strain.set(xlabel="equivalent plastic strain, %")
        for axes in (stress, strain):
            axes.set_ylim(DEEP * min(passes.half_lengths), 0.0)
            axes.legend()
        stress.set(ylabel="depth below the middle of the patch, mm")
        _increments(growth, passes.rows, found.subject.units)
    return figure


def draw_passes_section(passes: Passes, found: Findings, target: Target = None) -> Figure:
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
            axes.set(xlabel="across, from the middle of the patch, mm", ylabel="height, mm")
            bar = axes.inset_axes((1.03, 0.0, 0.04, 1.0))  # stays beside axes with equal scales
            axes.figure.colorbar(filled, cax=bar, label=label)
            axes.set_aspect("equal")
            axes.grid(False)
    return figure


def _increments(axes: Axes, rows: list[dict[str, Any]], units: Units) -> None:
    """Draw the largest plastic increment and the absolute forward displacement of each pass; zeros
    are left out. The vertical axis is logarithmic unless nothing yields.
    """
    number = np.arange(1, len(rows) + 1)
    for key, factor, label, colour in (
        ("strain_increment_max", 100.0, "largest strain increment, %", FE),
        ("forward_mm", 1e3, "forward displacement (size), um", HERTZ),
    ):
        factor, label = units.value(factor, label), units.unit(label)
        values = np.array([factor * abs(row[key]) for row in rows])
        axes.plot(number[values > 0], values[values > 0], "o-", color=colour, label=label)
    if any(row["strain_increment_max"] for row in rows):
        axes.set_yscale("log")
    axes.set(xlabel="pass", ylabel="of each pass")
    axes.xaxis.get_major_locator().set_params(integer=True, min_n_ticks=1)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0))
