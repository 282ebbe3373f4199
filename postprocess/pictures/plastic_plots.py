"""Pictures of yield: strain, residual stress and height of the surface, after a load and passes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator, griddata

from railhead.meshing.bodies import BODY_NAMES, RAIL, WHEEL, other
from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, AxisPressure, Findings, Units
from railhead.postprocess.pass_rows import Passes
from railhead.postprocess.pictures.diagrams import (
    FE,
    HERTZ,
    Target,
    levels,
    loaded,
    new_figure,
    pressure_line,
)
from railhead.theory.elastic.line import Hertz
from railhead.theory.elastic.subsurface import von_mises

if TYPE_CHECKING:
    from railhead.solver.system.fields import Fields

THICK = 0.5  # of the smaller half length: points nearer than this to a plane tell the values on it
CELLS = 150  # of a cut, along each side
ROUNDING = 1e-3  # of the largest height: a body that moved less is not seen, and did not yield
SPAN = 2.2  # half lengths of what is shown: of the patch, or of the region that yields if less
DEEP = 3.0  # of passes: shown depth over the smaller half length
WIDE = 2.5  # of passes: shown width over the half length across
LEVELS = 16  # of colour
SHOWN = 5  # passes of which curves are shown: the first, the last, and some between
PANELS = (
    ("equivalent plastic strain, %", "YlOrRd"),
    ("residual stress along the rail, MPa", "RdBu_r"),
    ("residual stress across, MPa", "RdBu_r"),
    ("residual normal stress, MPa", "RdBu_r"),
)


@dataclass(frozen=True, kw_only=True)
class Yielded:
    """What the picture of yield shows, images of what symmetry left out included, in the contact
    frame. Points are the k Gauss points near the plane that is drawn.

    points: x, s and height over the tangent plane (k, 3), mm.
    body: tag of each point's body (k,).
    strain: equivalent plastic strain (k,).
    residual: von Mises stress after the load (k,), MPa.
    rises: by name of the body, its contact surface after the load (n, 3): x and s of its nodes, mm,
        and their displacement along the rail's outward normal, um.
    carrier: name of the body that carries the contact points.
    elastic: smooth pressure of the same load without yield, on a line along `axis`.
    axis: horizontal axis of the picture: 0 for x, 1 for s.
    window: middle on that axis, and half the side, of the square that is shown, mm.
    """

    points: Array
    body: NDArray[np.int64]
    strain: Array
    residual: Array
    rises: dict[str, Array]
    carrier: str
    elastic: AxisPressure
    axis: int
    window: tuple[float, float]


def read(pressed: Fields, residual: Fields, found: Findings, elastic: Findings) -> Yielded:
    """What the picture of yield shows of a solution.

    pressed: fields under the load, with plastic strain. residual: fields after it. found: findings
        of the yielding bodies. elastic: findings of the same load without yield.
    """
    from railhead.postprocess.stress.gauss_points import stress_at_gauss_points

    assert pressed.plastic_strain is not None
    frame, planes, every = found.frame, pressed.mirrors, np.arange(len(pressed.cells))
    axis = pressed.kinematics.varying[-1]
    places, _ = stress_at_gauss_points(pressed, every)
    _, left = stress_at_gauss_points(residual, every)
    local = symmetry.vectors(frame.local(places.reshape(-1, 3)), planes)
    strain = symmetry.repeated(pressed.plastic_strain.equivalent.ravel(), planes)
    stress = symmetry.repeated(von_mises(left).ravel(), planes)
    body = symmetry.repeated(np.repeat(pressed.body, places.shape[1]), planes)
    middle, half = window = _window(found, local[strain > 0], axis)
    near = np.abs(local[:, 1 - axis]) < THICK * min(found.patch.a, found.patch.b)
    near &= np.abs(local[:, axis] - middle) < 1.2 * half
    near &= np.abs(local[:, 2]) < 1.2 * half
    nodes = {pressed.slave: np.unique(pressed.contact.facet_nodes)}
    if pressed.master_surface is not None:
        nodes[other(pressed.slave)] = pressed.master_surface.nodes
    rises = {}
    for tag, own in nodes.items():
        at = symmetry.vectors(frame.local(residual.points[own]), planes)
        up = symmetry.repeated(1e3 * residual.displacement[own] @ frame.axes[2], planes)
        rises[BODY_NAMES[tag]] = np.column_stack([at[:, :2], up])
    return Yielded(
        points=local[near],
        body=body[near],
        strain=strain[near],
        residual=stress[near],
        rises=rises,
        carrier=BODY_NAMES[pressed.slave],
        elastic=(elastic.along, elastic.across)[axis],
        axis=axis,
        window=window,
    )


def draw(yielded: Yielded, found: Findings, exact: Hertz | None, target: Target = None) -> Figure:
    """Four panels: equivalent plastic strain, residual von Mises stress, contact pressure, and
    height of the surfaces after the load. exact: Hertz contact, or None.
    """
    with new_figure(target, 11, 8.6, found) as figure:
        (strain, stress), (pressure, height) = figure.subplots(2, 2)
        _cuts((strain, stress), found, yielded)
        pressure_line(pressure, found, exact, yielded.axis, "with yield")
        line = loaded(yielded.elastic)
        pressure.plot(*line, "--", color=FE, lw=1.2, label="elastic", zorder=4)
        pressure.set(ylabel="contact pressure, MPa", ylim=(0, None))
        pressure.legend(loc="lower center", fontsize=9)
        _heights(height, yielded, found)
    return figure


def draw_passes(passes: Passes, found: Findings, target: Target = None) -> Figure:
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
            sunk = [1e3 * row["groove_mm"] for row in rows]
            groove.plot(np.arange(1, count + 1), sunk, "o-")
            groove.set(xlabel="pass", ylabel="the surface has sunk by, um")
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
            _bar(axes, filled, label)
    return figure


def _window(found: Findings, yields: Array, axis: int) -> tuple[float, float]:
    """Middle, x (axis 0) or s (axis 1), and half the side, mm, of the square that is shown: around
    the points (n, 3) that yield, in the contact frame, but not larger than around all patches.
    """
    low, high = (each[axis] for each in found.patch.box)
    middle, half = (low + high) / 2, (high - low) / 2
    if len(yields):
        ends = yields[:, axis].min(), yields[:, axis].max()
        reach = max(float(np.ptp(ends)) / 2, float(np.abs(yields[:, 2]).max()))
        if reach < half:
            middle, half = float(np.mean(ends)), reach
    return middle, SPAN * half


def _cuts(panels: Sequence[Axes], found: Findings, yielded: Yielded) -> None:
    """Draw bands of equivalent plastic strain (first panel) and residual von Mises stress (second),
    interpolated linearly between the Gauss points within each body, in the plane across the rail
    through the contact, or of a section in its own: over x or s and the height.
    What lies outside of a body's Gauss points stays white.
    """
    local, across, (middle, half) = yielded.points, yielded.axis, yielded.window
    flat = np.ptp(local[:, 1 - across]) == 0
    used = [across, 2] if flat else [across, 2, 1 - across]
    t, z = middle + half * np.linspace(-1, 1, CELLS), half * np.linspace(-1, 1, CELLS)
    at = np.stack([*np.meshgrid(t, z), np.zeros((CELLS, CELLS))], axis=-1)[..., : len(used)]
    both = np.stack([100 * yielded.strain, yielded.residual], axis=1)
    fields = {}
    for tag in (RAIL, WHEEL):
        own = yielded.body == tag
        if own.any():  # both at once: the search for the places takes longest
            fields[tag] = LinearNDInterpolator(local[own][:, used], both[own])(at)
    labels = "equivalent plastic strain, %", "residual von Mises stress, MPa"
    for number, (axes, label) in enumerate(zip(panels, labels, strict=True)):
        values = both[:, number]
        limits = levels(found.subject.units, label, values)
        for tag, field in fields.items():
            bands = axes.contourf(t, z, field[..., number], levels=limits, cmap="YlOrRd")
            height, side = (0.04, "bottom") if tag == RAIL else (0.96, "top")
            place = {"va": side, "transform": axes.transAxes}
            axes.text(0.03, height, found.subject.names[BODY_NAMES[tag]], **place)
        if not values.any():
            axes.set_title("none here", fontsize=11)
        axes.set(xlabel=found.subject.label(across), ylabel="height over the contact, mm")
        _bar(axes, bands, label)


def _bar(axes: Axes, bands: Any, label: str) -> None:
    """Give axes of a cut equal scales, no grid, and a colour bar for the bands drawn on them. The
    bar is an inset, which stays beside the axes, whose shape follows from their scales.
    """
    axes.figure.colorbar(bands, cax=axes.inset_axes((1.03, 0.0, 0.04, 1.0)), label=label)
    axes.set_aspect("equal")
    axes.grid(False)


def _heights(axes: Axes, yielded: Yielded, found: Findings) -> None:
    """Draw the heights of the contact surfaces after the load (um), on lines along x and along s
    (mm) through the largest pressure, interpolated linearly between nodes. A body that was not
    displaced has no line.
    """
    subject, through = found.subject, (found.across.at, found.along.at)
    least = ROUNDING * max(float(np.abs(rise[:, 2]).max()) for rise in yielded.rises.values())
    t = yielded.window[1] * np.linspace(-1, 1, CELLS)
    for body, rise in yielded.rises.items():
        if np.abs(rise[:, 2]).max() <= least:
            continue
        local = rise[:, :2] - through
        wide = np.ptp(local, axis=0) > 0
        for axis, name, colour in ((0, subject.along, FE), (1, subject.across, HERTZ)):
            if wide[axis]:  # a section has one of them
                line = np.zeros((CELLS, 2))
                line[:, axis] = t
                height = griddata(local[:, wide], rise[:, 2], line[:, wide]).ravel()
                style = "-" if body == yielded.carrier else "--"
                label = subject.names[body] + ("" if subject.revolved else f", {name}")
                axes.plot(t, height, style, color=colour, label=label)
    axes.set(
        xlabel="x or s, distance from the largest pressure, mm",
        ylabel="height of the surface after the load, um",
    )
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _increments(axes: Axes, rows: list[dict[str, Any]], units: Units) -> None:
    """Draw the largest plastic increment and the absolute forward displacement of each pass; zeros
    are left out. The vertical axis is logarithmic unless nothing yields.
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
