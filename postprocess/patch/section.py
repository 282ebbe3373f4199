"""The contact patch of a section: a line contact in plane strain, or a circle of revolution."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, AxisPressure, Frame, Patch, Surface
from railhead.postprocess.patch.moments import (
    PressureMoments,
    largest_pressure,
    moments,
)
from railhead.postprocess.patch.patch import (
    BEND_FACTOR,
    FOURTH_MOMENT_FACTOR,
    Elliptic,
    PatchReading,
    PatchShape,
    nearly_elliptic,
    smooth_square,
)
from railhead.postprocess.patch.reconstruct import Samples, SquaredPressure
from railhead.postprocess.patch.surface import recover_surfaces
from railhead.solver.system.fields import Fields

SECTION_SIZE_FACTOR = 0.03  # as `patch.SOLID_SIZE_FACTOR`, of sections
STRIP_BEND_FACTOR = 16 / 5  # as `patch.BEND_FACTOR`, of a strip
PRESSURE_POINTS = 61  # at which the pressure along the section is given
LINE_POINTS = 2000  # at which p^2 is evaluated to find its zeros and its maximum
Value = TypeVar("Value")


def read(fields: Fields, frame: Frame, *, parabolic: bool = False) -> PatchReading:
    """Patch, surfaces and pressures of a section, of which some contact points carry pressure.
    Separate patches are read as one: its half width reaches from the first to the last end, and its
    area leaves out what lies between them.

    parabolic: whether Hertz's theory is exact, that is for elastic half-spaces whose gap is
        quadratic; the second moment then gives the half width.
    """
    contact, (axis,) = fields.contact, fields.kinematics.varying
    found = moments(fields, frame)
    given = samples(fields, frame)

    def elliptic() -> Elliptic:
        """The patch with nearly Hertz's pressure, by moments. Only its second semi-axis counts."""
        peak = largest_pressure(fields, frame, found)
        element = float(given.size.mean())
        half, bulge, errors = _ellipse(found, peak, element, fields, parabolic=parabolic)
        return (0.0, found.centre[axis]), (1.0, half), peak, bulge, errors

    square, shape, scatter = smooth_square(
        given, found.shape_error, elliptic, lambda each: _shape(each, fields, given)
    )
    patch = Patch(
        a=shape.a,
        b=shape.b,
        centre=found.centre,
        area=shape.area,
        max_pressure=shape.max_pressure,
        mean_pressure=found.force / shape.area,
        outlines=shape.outlines,
        scatter=scatter,
        unbalance=given.unbalance(shape.force),
    )

    def pressure(points: Array) -> Array:
        """Smooth pressure (n,), MPa, at points (n, 3) in space, mm."""
        return _pressure(square, frame.local(points)[:, axis])

    surfaces = recover_surfaces(fields, frame, pressure)
    along, across = _axis_pressures(surfaces[0], patch, fields)
    return PatchReading(
        patch=patch,
        surfaces=surfaces,
        moments=found,
        recovered_pressure=pressure(contact.points),
        along=along,
        across=across,
    )


def samples(fields: Fields, frame: Frame) -> Samples:
    """Contact points of a section with pressure and their mirror images, projected to the tangent.
    Their s is the coordinate in the section, along x or s, and their x is zero.
    """
    contact, (axis,) = fields.contact, fields.kinematics.varying
    revolved, thickness = fields.kinematics.revolved, fields.kinematics.thickness
    touches = contact.pressure > 0
    ends = frame.local(fields.points[contact.facet_nodes])[..., axis]
    size = np.ptp(ends, axis=1)[contact.facet]
    onto = contact.weights * np.abs(contact.normals @ frame.axes[2])
    values = np.column_stack([onto * contact.pressure, contact.pressure, size])[touches]
    low, high = float(ends.min()), float(ends.max())
    local = symmetry.vectors(frame.local(contact.points[touches])[:, :2], fields.mirrors)
    values = symmetry.repeated(values, fields.mirrors)
    low = -high if fields.mirrors else low
    if revolved:
        values[:, 0] /= 2  # either side of the axis is half of the circle
    limits = ((-1.0, 1.0), (low, high))
    force, pressure, size = values.T
    return Samples(
        x=np.zeros(len(local)),
        s=local[:, axis],
        force=force,
        pressure=pressure,
        size=size,
        even=True,
        limits=limits,
        section=True,
        revolved=revolved,
        thickness=thickness,
        yields=fields.plastic_strain is not None,
        rubs=fields.rubs,
        uneven=fields.rubs or fields.plastic_strain is not None,
    )


def _pressure(square: SquaredPressure, t: Array) -> Array:
    """Smooth pressure (n,), MPa, of a section at coordinates t (n,), mm."""
    return np.asarray(np.sqrt(np.maximum(square(np.zeros_like(t), t), 0.0)))


def _shape(square: SquaredPressure, fields: Fields, given: Samples) -> PatchShape:
    """Outlines, half lengths along x and s, area and largest pressure of a section's smooth p^2.
    In plane strain outlines are rectangles whose half length out of the plane is half the
    thickness. Of a body of revolution they are circles, and both half lengths their radius. Half
    lengths reach over gaps between patches; in plane strain the area leaves these out.
    """
    spans, (axis,) = _spans(square), fields.kinematics.varying
    half = a = b = (spans[-1][1] - spans[0][0]) / 2
    t = np.linspace(*square.box[1], LINE_POINTS, dtype=np.float64)
    pressure = _pressure(square, t)
    force, peak = float(pressure @ given.measure(t) * (t[1] - t[0])), float(pressure.max())
    if fields.kinematics.revolved:
        angle, area = np.linspace(0, 2 * np.pi, 181), np.pi * half**2
        ring = np.column_stack([np.cos(angle), np.sin(angle)])
        outlines = [radius * ring for _, radius in spans]
    else:
        length = fields.kinematics.thickness
        area, (a, b) = length * sum(np.ptp(spans, axis=1)), _along_across(axis, half, length / 2)
        other = length / 2 * np.array([-1.0, -1.0, 1.0, 1.0, -1.0])
        outlines = [
            np.column_stack(_along_across(axis, np.array([low, high, high, low, low]), other))
            for low, high in spans
        ]
    return PatchShape(outlines=outlines, area=float(area), a=a, b=b, max_pressure=peak, force=force)


def _along_across(axis: int, own: Value, other: Value) -> tuple[Value, Value]:
    """The value along x and the value along s, given that along the section (`own`) and the other
    one. axis: 0 where the section runs along x, 1 along s.
    """
    return (own, other)[axis], (own, other)[1 - axis]


def _ellipse(
    found: PressureMoments, peak: float, element: float, fields: Fields, *, parabolic: bool
) -> tuple[float, tuple[float, float], dict[str, float]]:
    """Half width from moments, mm, the bulge, and relative errors of a, b, area and max_pressure,
    by these names, as of `nearly_elliptic`.

    peak: fitted largest pressure, MPa; its error is the difference from that of Hertz's pressure
        with the same force and half width. element: element size, mm. parabolic: whether Hertz's
        theory is exact.
    """
    revolved, length = fields.kinematics.revolved, fields.kinematics.thickness
    (half, _), (error, _), bulge = nearly_elliptic(
        found,
        element,
        parabolic=parabolic,
        fourth=FOURTH_MOMENT_FACTOR if revolved else 1.0,
        mesh=SECTION_SIZE_FACTOR,
        bend=BEND_FACTOR if revolved else STRIP_BEND_FACTOR,
    )
    unit = 2 / 3 * np.pi * found.a**2 if revolved else np.pi / 2 * found.a * length
    along, across = _along_across(fields.kinematics.varying[0], error, error if revolved else 0.0)
    off = abs(found.force / (peak * unit) - 1)
    errors = {"a": along, "b": across, "area": along + across, "max_pressure": max(off, error)}
    return half, bulge, errors


def _axis_pressures(
    surface: Surface, patch: Patch, fields: Fields
) -> tuple[AxisPressure, AxisPressure]:
    """Pressure along x and along s of a section, from the nodal pressures of the slave's surface.
    In plane strain it is constant in the direction of the thickness; of a body of revolution
    both are equal.
    """
    (axis,) = fields.kinematics.varying
    half, middle = (patch.a, patch.b)[axis], patch.centre[axis]
    t = symmetry.vectors(surface.local, fields.mirrors)[:, axis]
    p = symmetry.repeated(surface.pressure, fields.mirrors)
    order = np.argsort(t)
    at = middle + 1.25 * half * np.linspace(-1.0, 1.0, PRESSURE_POINTS)
    found = AxisPressure(at, np.interp(at, t[order], p[order]))
    if fields.kinematics.revolved:
        return found, found
    length = fields.kinematics.thickness
    constant = AxisPressure(length / 2 * np.array([-1.0, 1.0]), np.full(2, patch.max_pressure))
    return _along_across(axis, found, constant)


def _spans(square: SquaredPressure) -> list[tuple[float, float]]:
    """Intervals of the coordinate t, mm, in which the p^2 of a section is positive, ascending."""
    t = np.linspace(*square.box[1], LINE_POINTS, dtype=np.float64)
    values = square(np.zeros_like(t), t)
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * values.max())
    turn = np.flatnonzero((values[:-1] > 0) != (values[1:] > 0))
    share = values[turn] / (values[turn] - values[turn + 1])
    zeros = [float(zero) for zero in t[turn] + share * (t[turn + 1] - t[turn])]
    return list(zip(zeros[::2], zeros[1::2], strict=True))
