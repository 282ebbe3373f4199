"""Picture of yield: plastic strain, residual stress, pressure and height of the surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from railhead.meshing.bodies import BODY_NAMES, other
from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, Findings
from railhead.postprocess.patch.moments import coordinate
from railhead.postprocess.pictures.plots.diagrams import FE, HERTZ, exact_line, loaded, new_figure
from railhead.postprocess.stress.gauss_points import stress_at_gauss_points
from railhead.solver.fields import Fields
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.subsurface import von_mises

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

THIN = 0.12  # of the smaller half length: points nearer than this to a plane are shown on it
ROUNDING = 1e-6  # of the largest height: what stays of a body that did not yield
SPAN = 2.2  # half lengths of the patch that are shown


def draw(
    pressed: Fields,
    residual: Fields,
    found: Findings,
    elastic: Findings,
    exact: Hertz | None,
    path: Path,
) -> None:
    """Write a PNG file with panels of equivalent plastic strain, residual von Mises stress, contact
    pressure, and height of the surfaces after the load.

    pressed: fields under the load, with plastic strain. residual: fields after it. found: findings
        of the yielding bodies. elastic: findings of the same load without yield. exact: Hertz
        contact, or None. path: of the file.
    """
    assert pressed.plastic_strain is not None
    patch = found.patch
    axis = 1 if pressed.kinematics.dim == 3 else coordinate(pressed)
    half = (patch.a, patch.b)[axis]
    with new_figure(path, 11, 8.6, found) as figure:
        (strain, stress), (pressure, depth) = figure.subplots(2, 2)
        every = np.arange(len(pressed.cells))
        points = stress_at_gauss_points(pressed, every)[0].reshape(-1, 3)
        local = symmetry.vectors(found.frame.local(points), pressed.mirrors)
        _, left = stress_at_gauss_points(residual, every)
        for axes, values, label in (
            (strain, 100 * pressed.plastic_strain.equivalent, "equivalent plastic strain, %"),
            (stress, von_mises(left), "residual von Mises stress, MPa"),
        ):
            values = symmetry.repeated(values.ravel(), pressed.mirrors)
            _cut(figure, axes, found, (local, values), axis, label)
        _pressures(pressure, found, elastic, exact, axis)
        _left(depth, residual, pressed, found, half)


def _cut(
    figure: Figure,
    axes: Axes,
    found: Findings,
    samples: tuple[Array, Array],
    across: int,
    label: str,
) -> None:
    """Draw values at Gauss points as coloured dots, over x or s and the height. Shown are the
    points near the plane across the rail through the contact, or all of a section.

    samples: coordinates (n, 3) in the contact frame, mm, and values (n,), images included; both
        bodies. across: 0 where the horizontal axis is x, 1 where it is s. label: of the colour bar.
    """
    local, values = samples
    low, high = (each[across] for each in found.patch.box)
    middle, half = (low + high) / 2, (high - low) / 2
    near = np.abs(local[:, 1 - across]) < THIN * min(found.patch.a, found.patch.b)
    near &= np.abs(local[:, across] - middle) < SPAN * half
    near &= np.abs(local[:, 2]) < SPAN * half
    order = np.argsort(values[near])
    s, z, colour = local[near, across][order], local[near, 2][order], values[near][order]
    dots = axes.scatter(
        s, z, c=colour, s=6, cmap="YlOrRd", vmin=0.0, vmax=colour.max() or 1.0, linewidths=0
    )
    if not colour.any():
        axes.set_title("none here", fontsize=11)
    # An inset stays beside the axes, whose shape follows from their equal scales.
    figure.colorbar(dots, cax=axes.inset_axes((1.04, 0.0, 0.05, 1.0)), label=label)
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


def _left(axes: Axes, residual: Fields, pressed: Fields, found: Findings, half: float) -> None:
    """Draw the displacement along the rail's outward normal (um) of the contact surfaces after the
    load, on lines along x and along s (mm) through the origin of the frame. A body that was not
    displaced has no line.

    residual: fields after the load. pressed: fields under the load, which give the nodes of the
        contact surfaces. half: half length of the patch, mm, which sets the range that is shown.
    """
    frame, subject = found.frame, found.subject
    surfaces = {pressed.slave: np.unique(pressed.contact.facet_nodes)}
    if pressed.master_surface is not None:
        surfaces[other(pressed.slave)] = pressed.master_surface.nodes
    rises = {
        tag: 1e3 * residual.displacement[nodes] @ frame.axes[2] for tag, nodes in surfaces.items()
    }
    least = ROUNDING * max(float(np.abs(rise).max()) for rise in rises.values())
    for tag, rise in rises.items():
        if np.abs(rise).max() <= least:
            continue
        local = symmetry.vectors(frame.local(residual.points[surfaces[tag]]), pressed.mirrors)
        rise = symmetry.repeated(rise, pressed.mirrors)
        style = ".-" if tag == pressed.slave else ".--"
        for axis, name, colour in ((0, subject.along, FE), (1, subject.across, HERTZ)):
            off, along = np.abs(local[:, 1 - axis]), np.abs(local[:, axis])
            near = (off < THIN * half) & (along < SPAN * half)
            t, height = local[near, axis], rise[near]
            order = np.argsort(t)
            if len(order) > 1 and np.ptp(t) > 0:  # a section has one of them
                label = f"{subject.names[BODY_NAMES[tag]]}, {name}"
                axes.plot(t[order], height[order], style, lw=0.8, color=colour, label=label)
    axes.set(
        xlabel="x or s, distance from the contact, mm",
        ylabel="height of the surface after the load, um",
    )
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
