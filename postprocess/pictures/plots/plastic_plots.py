"""Picture of yield: plastic strain, residual stress, pressure and height of the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator, griddata

from railhead.meshing.bodies import BODY_NAMES, RAIL, WHEEL, other
from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.patch.moments import coordinate
from railhead.postprocess.pictures.plots.diagrams import (
    FE,
    HERTZ,
    exact_line,
    levels,
    loaded,
    new_figure,
)
from railhead.postprocess.stress.gauss_points import stress_at_gauss_points
from railhead.solver.fields import Fields
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.subsurface import von_mises

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from railhead.postprocess.pictures.plots.diagrams import Target

THICK = 0.5  # of the smaller half length: points nearer than this to a plane tell the values on it
CELLS = 150  # of a cut, along each side
ROUNDING = 1e-3  # of the largest height: a body that moved less is not seen, and did not yield
SPAN = 2.2  # half lengths of what is shown: of the patch, or of the region that yields if less


def draw(
    pressed: Fields,
    residual: Fields,
    found: Findings,
    elastic: Findings,
    exact: Hertz | None,
    target: Target = None,
) -> Figure:
    """Four panels: equivalent plastic strain, residual von Mises stress, contact
    pressure, and height of the surfaces after the load.

    pressed: fields under the load, with plastic strain. residual: fields after it. found: findings
        of the yielding bodies. elastic: findings of the same load without yield. exact: Hertz
        contact, or None.
    """
    assert pressed.plastic_strain is not None
    axis = 1 if pressed.kinematics.dim == 3 else coordinate(pressed)
    with new_figure(target, 11, 8.6, found) as figure:
        (strain, stress), (pressure, depth) = figure.subplots(2, 2)
        every = np.arange(len(pressed.cells))
        points = stress_at_gauss_points(pressed, every)[0].reshape(-1, 3)
        local = symmetry.vectors(found.frame.local(points), pressed.mirrors)
        body = np.repeat(pressed.body, len(points) // len(every))
        body = symmetry.repeated(body, pressed.mirrors)
        _, left = stress_at_gauss_points(residual, every)
        yields = symmetry.repeated(pressed.plastic_strain.equivalent.ravel() > 0, pressed.mirrors)
        window = _window(found, local[yields], axis)
        for axes, values, label in (
            (strain, 100 * pressed.plastic_strain.equivalent, "equivalent plastic strain, %"),
            (stress, von_mises(left), "residual von Mises stress, MPa"),
        ):
            values = symmetry.repeated(values.ravel(), pressed.mirrors)
            _cut(figure, axes, found, (local, values, body), axis, window, label)
        _pressures(pressure, found, elastic, exact, axis)
        _residual_heights(depth, residual, pressed, found, window[1])
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


def _cut(
    figure: Figure,
    axes: Axes,
    found: Findings,
    samples: tuple[Array, Array, NDArray[np.integer]],
    across: int,
    window: tuple[float, float],
    label: str,
) -> None:
    """Draw bands of values at Gauss points, interpolated linearly within each body, in the plane
    across the rail through the contact, or of a section in its own: over x or s and the height.
    What lies outside of a body's Gauss points stays white.

    samples: coordinates (n, 3) in the contact frame, mm, values (n,) and body tags (n,), images
        included. across: 0 where the horizontal axis is x, 1 where it is s. window: middle and half
        the side of what is shown, mm. label: of the colour bar.
    """
    (local, values, body), (middle, half) = samples, window
    near = np.abs(local[:, 1 - across]) < THICK * min(found.patch.a, found.patch.b)
    near &= np.abs(local[:, across] - middle) < 1.2 * half
    near &= np.abs(local[:, 2]) < 1.2 * half
    flat = np.ptp(local[near, 1 - across]) == 0
    used = [across, 2] if flat else [across, 2, 1 - across]
    t, z = middle + half * np.linspace(-1, 1, CELLS), half * np.linspace(-1, 1, CELLS)
    at = np.stack([*np.meshgrid(t, z), np.zeros((CELLS, CELLS))], axis=-1)[..., : len(used)]
    limits = levels(found.subject.units, label, values[near])
    for tag, height in ((RAIL, 0.04), (WHEEL, 0.96)):
        own = near & (body == tag)
        if own.any():
            field = LinearNDInterpolator(local[own][:, used], values[own])(at)
            bands = axes.contourf(t, z, field, levels=limits, cmap="YlOrRd")
            place = {"va": "bottom" if tag == RAIL else "top", "transform": axes.transAxes}
            axes.text(0.03, height, found.subject.names[BODY_NAMES[tag]], **place)
    if not values[near].any():
        axes.set_title("none here", fontsize=11)
    # An inset stays beside the axes, whose shape follows from their equal scales.
    figure.colorbar(bands, cax=axes.inset_axes((1.04, 0.0, 0.05, 1.0)), label=label)
    axes.set(xlabel=found.subject.label(across), ylabel="height over the contact, mm")
    axes.set_aspect("equal")
    axes.grid(False)


def _pressures(
    axes: Axes, found: Findings, elastic: Findings, exact: Hertz | None, axis: int
) -> None:
    """Draw contact pressure (MPa) along x (axis 0) or s (axis 1), mm: of the yielding bodies, of
    the elastic ones, and of the exact Hertz contact if there is one.
    """
    line, without = (loaded((each.along, each.across)[axis]) for each in (found, elastic))
    axes.plot(*line, "o-", color=FE, lw=0.8, ms=3.5, label="with yield")
    if exact is not None:
        axes.plot(*exact_line(exact, axis), color=HERTZ, label="exact Hertz")
    axes.plot(*without, "--", color=FE, lw=1.2, label="elastic")
    axes.set(xlabel=found.subject.label(axis), ylabel="contact pressure, MPa")
    axes.set_ylim(bottom=0)
    axes.legend()


def _residual_heights(
    axes: Axes, residual: Fields, pressed: Fields, found: Findings, half: float
) -> None:
    """Draw the displacement along the rail's outward normal (um) of the contact surfaces after the
    load, on lines along x and along s (mm) through the largest pressure, interpolated linearly
    between nodes. A body that was not displaced has no line.

    residual: fields after the load. pressed: fields under the load, which give the nodes of the
        contact surfaces. half: half the length that is shown, mm.
    """
    frame, subject = found.frame, found.subject
    surfaces = {pressed.slave: np.unique(pressed.contact.facet_nodes)}
    if pressed.master_surface is not None:
        surfaces[other(pressed.slave)] = pressed.master_surface.nodes
    rises = {
        tag: 1e3 * residual.displacement[nodes] @ frame.axes[2] for tag, nodes in surfaces.items()
    }
    least = ROUNDING * max(float(np.abs(rise).max()) for rise in rises.values())
    through, t = (found.across.at, found.along.at), np.linspace(-half, half, CELLS)
    for tag, rise in rises.items():
        if np.abs(rise).max() <= least:
            continue
        local = symmetry.vectors(frame.local(residual.points[surfaces[tag]]), pressed.mirrors)
        local, rise = local[:, :2] - through, symmetry.repeated(rise, pressed.mirrors)
        wide = np.ptp(local, axis=0) > 0
        for axis, name, colour in ((0, subject.along, FE), (1, subject.across, HERTZ)):
            if wide[axis]:  # a section has one of them
                line = np.zeros((CELLS, 2))
                line[:, axis] = t
                height = griddata(local[:, wide], rise, line[:, wide]).ravel()
                style, label = "-" if tag == pressed.slave else "--", subject.names[BODY_NAMES[tag]]
                label += "" if subject.revolved else f", {name}"
                axes.plot(t, height, style, color=colour, label=label)
    axes.set(
        xlabel="x or s, distance from the largest pressure, mm",
        ylabel="height of the surface after the load, um",
    )
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
