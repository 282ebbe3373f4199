"""The picture of what yield does: where, what it leaves, and what it changes on the surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from railhead.meshing.tags import BODIES
from railhead.postprocess.findings import Array, AxisPressure, Findings, Frame
from railhead.postprocess.mirror import cut_axes
from railhead.postprocess.plots import FE, HERTZ, new_figure
from railhead.postprocess.stress import at_gauss
from railhead.solver.gather import Fields
from railhead.theory.hertz import Ellipse
from railhead.theory.line import LineContact
from railhead.theory.subsurface import von_mises

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

THIN = 0.12  # of the smaller half length: points nearer than this to a plane are shown on it
SPAN = 2.2  # half lengths of the patch that are shown


def draw(
    loaded: Fields,
    residual: Fields,
    found: Findings,
    elastic: Findings,
    exact: Ellipse | LineContact | None,
    path: Path,
) -> None:
    """Plastic strain and residual von Mises stress below the patch, the pressure beside the elastic
    one and Hertz's, and how far the surfaces stay displaced."""
    assert loaded.plastic is not None
    frame, patch = found.frame, found.patch
    half = patch.b if loaded.kinematics.dim == 3 else patch.a
    with new_figure(path, 11, 8.6, found) as figure:
        (strain, stress), (pressure, depth) = figure.subplots(2, 2)
        every = np.arange(len(loaded.cells))
        points, _ = at_gauss(loaded, every)
        _, left = at_gauss(residual, every)
        for axes, values, label in (
            (strain, 100 * loaded.plastic.equivalent, "equivalent plastic strain, %"),
            (stress, von_mises(left), "residual von Mises stress, MPa"),
        ):
            _cut(figure, axes, found, (points, values), (min(patch.a, patch.b), half), label)
        _pressures(pressure, found.across if loaded.kinematics.dim == 3 else found.along,
                   elastic.across if loaded.kinematics.dim == 3 else elastic.along, exact,
                   1 if loaded.kinematics.dim == 3 else 0)  # fmt: skip
        _left(depth, residual, loaded, frame, half)


def _cut(
    figure: Figure, axes: Axes, found: Findings, samples: tuple[Array, Array],
    sizes: tuple[float, float], label: str,
) -> None:  # fmt: skip
    """Gauss points near the plane across the rail (or all of a section), as coloured dots."""
    points, values = samples[0].reshape(-1, 3), samples[1].ravel()
    local = found.frame.local(points)
    flat = np.ptp(local, axis=0).argmin() if np.ptp(local, axis=0).min() < 1e-9 else 0
    across = 1 if flat == 0 else 0
    least, half = sizes
    near = np.abs(local[:, flat]) < THIN * least
    near &= (np.abs(local[:, across]) < SPAN * half) & (np.abs(local[:, 2]) < SPAN * half)
    order = np.argsort(values[near])
    s, z, colour = local[near, across][order], local[near, 2][order], values[near][order]
    if across in cut_axes(local):
        s, z, colour = np.r_[s, -s], np.r_[z, z], np.r_[colour, colour]
    dots = axes.scatter(s, z, c=colour, s=6, cmap="YlOrRd", vmin=0.0, linewidths=0)
    figure.colorbar(dots, ax=axes, label=label)
    axes.set(xlabel=found.subject.label(across), ylabel="height over the contact, mm")
    axes.set_aspect("equal")
    axes.grid(False)


def _pressures(
    axes: Axes, found: AxisPressure, elastic: AxisPressure, exact: Ellipse | LineContact | None,
    axis: int,
) -> None:  # fmt: skip
    axes.plot(found.coordinate, found.pressure, "o-", color=FE, lw=0.8, ms=3.5, label="with yield")
    if exact is not None:
        t = (exact.a, exact.b)[axis] * np.cos(np.linspace(0, np.pi, 181))
        axes.plot(t, exact.pressure(*((t, 0) if axis == 0 else (0, t))), color=HERTZ,
                  label="exact Hertz")  # fmt: skip
    axes.plot(elastic.coordinate, elastic.pressure, "--", color=FE, lw=1.2, label="elastic")
    axes.set(xlabel="s, mm" if axis else "x, mm", ylabel="contact pressure, MPa")
    axes.set_ylim(bottom=0)
    axes.legend()


def _left(axes: Axes, residual: Fields, loaded: Fields, frame: Frame, half: float) -> None:
    """Displacement into the body of the nodes of the contact surface, along both axes, um."""
    nodes = np.unique(loaded.contact.facet_nodes)
    local = frame.local(residual.points[nodes])
    rise = 1e3 * residual.displacement[nodes] @ frame.axes[2]
    for axis, name in ((0, "along"), (1, "across")):
        other = 1 - axis
        near = (np.abs(local[:, other]) < THIN * half) & (np.abs(local[:, axis]) < SPAN * half)
        t, height = local[near, axis], rise[near]
        if axis in cut_axes(local):
            t, height = np.r_[t, -t], np.r_[height, height]
        order = np.argsort(t)
        if len(order) > 1 and np.ptp(t) > 0:  # a section has one of them
            body = BODIES[loaded.slave]
            axes.plot(t[order], height[order], ".-", lw=0.8, label=f"{body}, {name} the rail")
    axes.set(xlabel="distance from the contact, mm",
             ylabel="height of the surface after the load, um")  # fmt: skip
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
