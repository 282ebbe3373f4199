"""Findings of a section: a line contact in plane strain, or a circle of revolution."""

from __future__ import annotations

import numpy as np

from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, AxisPressure, Frame, Patch, Surface
from railhead.postprocess.patch.outline import PatchShape
from railhead.postprocess.patch.patch import (
    FOURTH_MOMENT_FACTOR,
    MEASURES,
    PEAK_RADIUS,
    PatchReading,
    PressureMoments,
    general_shape_share,
    nearly_elliptic,
    reconstruct_general_shape,
)
from railhead.postprocess.patch.reconstruct import (
    Samples,
    SquaredPressure,
    blend,
    ellipsoid,
    zero_squared_pressure,
)
from railhead.postprocess.patch.surface import recover_surfaces
from railhead.solver.fields import Fields

ELEMENT_SIZE_FACTOR = 0.03  # of a section, see `patch`
AXIS_POINTS = 61  # of the pressure along the contact line
LINE_POINTS = 2000  # at which p^2 is evaluated to find its zeros and its maximum


def coordinate(fields: Fields) -> int:
    """Axis of the contact frame in the plane of a section, along which the pressure varies: 0 for
    x, 1 for s. The coordinate along this axis is called t.
    """
    return int(np.argmax(np.abs(fields.kinematics.axes[0])))


def moments(fields: Fields, frame: Frame) -> PressureMoments:
    """Moments of the contact pressure p of a section; both semi-axes are its half width.

    The half width is 2 sqrt(int p t^2 / int p) in plane strain and sqrt(5/2 int p r^2 / int p) for
    a body of revolution, with t from the centre of pressure and r from the axis. Both are exact for
    Hertz's pressure.
    """
    contact, revolved = fields.contact, fields.kinematics.revolved
    axis = coordinate(fields)
    weight = contact.weights * contact.pressure
    total = float(weight.sum())
    t = frame.local(contact.points)[:, axis]
    middle = 0.0 if fields.mirrors else float(weight @ t / total)
    t = t - middle
    square = float(weight @ t**2 / total)
    factor, fourth = (5 / 2, 10 / 7) if revolved else (4.0, 2.0)
    deviations = [weight @ t**4 / total / square**2 / fourth - 1]
    if not fields.mirrors:
        deviations.append(weight @ t**3 / total / square**1.5)
    w = float(np.sqrt(factor * square))
    centre = (middle, 0.0) if axis == 0 else (0.0, middle)
    parts = 1 if revolved else 2 ** len(fields.mirrors)
    off = float(deviations[0])
    return PressureMoments(
        force=parts * total,
        centre=centre,
        a=w,
        b=w,
        shape_error=float(np.max(np.abs(deviations))),
        fourth=(off, off),
    )


def largest_pressure(t: Array, pressure: Array, weights: Array, w: float, *, even: bool) -> float:
    """Largest pressure, MPa, of a section: the maximum of a parabola fitted to p^2 near t = 0.

    t (n,): coordinate of the contact points from the centre of pressure, mm. pressure (n,): MPa.
        weights (n,): areas of the points, mm2. w: half width, mm. even: whether p is symmetric in
        t. Points with |t| below PEAK_RADIUS half widths are used. Hertz's p^2 is a parabola. Of
        fewer than six points the largest computed pressure is returned; where the parabola has no
        maximum, its largest value at the points.
    """
    near = (np.abs(t) < PEAK_RADIUS * w) & (pressure > 0)
    if near.sum() < 6:
        return float(pressure.max())
    x = t[near] / w
    basis = np.column_stack([np.ones_like(x), x**2] + ([] if even else [x]))
    root = np.sqrt(weights[near])
    c = np.linalg.lstsq(basis * root[:, None], pressure[near] ** 2 * root, rcond=None)[0]
    if c[1] >= 0:
        return float(np.sqrt(np.max(basis @ c)))
    top = 0.0 if even else float(np.clip(-c[2] / (2 * c[1]), -PEAK_RADIUS, PEAK_RADIUS))
    shift = 0.0 if even else c[2] * top
    return float(np.sqrt(c[0] + c[1] * top**2 + shift))


def read(fields: Fields, frame: Frame, *, parabolic: bool = False) -> PatchReading:
    """Patch, surfaces and pressures of a section, of which some contact points carry pressure.

    parabolic: whether Hertz's theory is exact, that is for elastic half-spaces whose gap is
        quadratic; the second moment then gives the half width.
    """
    contact, axis = fields.contact, coordinate(fields)
    revolved, length = fields.kinematics.revolved, fields.kinematics.thickness
    found = moments(fields, frame)
    given = samples(fields, frame)
    share = general_shape_share(found.shape_error)
    square, scatter = zero_squared_pressure(given), dict.fromkeys(MEASURES, 0.0)
    if share > 0:
        square, scatter = reconstruct_general_shape(given, lambda each: _shape(each, fields))
    if share < 1:
        t = frame.local(contact.points)[:, axis] - found.centre[axis]
        even = bool(fields.mirrors)
        peak = largest_pressure(t, contact.pressure, contact.weights, found.a, even=even)
        half, other = _ellipse(found, peak, float(given.size.mean()), fields, parabolic=parabolic)
        ellipse = ellipsoid(square, (0.0, found.centre[axis]), (1.0, half), peak)
        square = blend(square, ellipse, share)
        scatter = {key: share * scatter[key] + (1 - share) * other[key] for key in MEASURES}
    shape = _shape(square, fields)
    outlines = _outlines(_spans(square), axis, None if revolved else length)
    patch = Patch(
        a=shape.a,
        b=shape.b,
        centre=found.centre,
        area=shape.area,
        max_pressure=shape.peak,
        mean_pressure=found.force / shape.area,
        outlines=outlines,
        scatter=scatter,
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
    contact, axis = fields.contact, coordinate(fields)
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
        line=True,
        circle=revolved,
        thickness=thickness,
    )


def _pressure(square: SquaredPressure, t: Array) -> Array:
    """Smooth pressure (n,), MPa, of a section at coordinates t (n,), mm."""
    return np.asarray(np.sqrt(np.maximum(square(np.zeros_like(t), t), 0.0)))


def _shape(square: SquaredPressure, fields: Fields) -> PatchShape:
    """Half lengths along x and s, area and largest pressure of a section's smooth p^2. In plane
    strain the length is the thickness; of a body of revolution the patch is a circle.
    """
    spans, axis = _spans(square), coordinate(fields)
    length = fields.kinematics.thickness
    half = (spans[-1][1] - spans[0][0]) / 2
    peak = _pressure(square, np.linspace(*square.box[1], LINE_POINTS, dtype=np.float64)).max()
    if fields.kinematics.revolved:
        return PatchShape(
            outlines=[], area=float(np.pi * half**2), a=half, b=half, peak=float(peak)
        )
    area = float(length * sum(end - begin for begin, end in spans))
    semi = (half, length / 2) if axis == 0 else (length / 2, half)
    return PatchShape(outlines=[], area=area, a=semi[0], b=semi[1], peak=float(peak))


def _ellipse(
    found: PressureMoments, peak: float, element: float, fields: Fields, *, parabolic: bool
) -> tuple[float, dict[str, float]]:
    """Half width from moments, mm, and relative errors of a, b, area and max_pressure, by these
    names.

    peak: fitted largest pressure, MPa; its error is the difference from that of Hertz's pressure
        with the same force and half width. element: element size, mm. parabolic: whether Hertz's
        theory is exact.
    """
    revolved, length = fields.kinematics.revolved, fields.kinematics.thickness
    (half, _), (error, _) = nearly_elliptic(
        found,
        element,
        parabolic=parabolic,
        fourth=FOURTH_MOMENT_FACTOR if revolved else 1.0,
        mesh=ELEMENT_SIZE_FACTOR,
    )
    unit = 2 / 3 * np.pi * found.a**2 if revolved else np.pi / 2 * found.a * length
    along, across = (error, error) if revolved else (error, 0.0)
    if coordinate(fields) == 1:
        along, across = across, along
    area = 2 * error if revolved else error
    off = abs(found.force / (peak * unit) - 1)
    return half, {"a": along, "b": across, "area": area, "max_pressure": max(off, error)}


def _axis_pressures(
    surface: Surface, patch: Patch, fields: Fields
) -> tuple[AxisPressure, AxisPressure]:
    """Pressure along x and along s of a section, from the nodal pressures of the slave's surface.
    In plane strain it is constant in the direction of the thickness; of a body of revolution
    both are equal.
    """
    axis = coordinate(fields)
    half, middle = (patch.a, patch.b)[axis], patch.centre[axis]
    t = symmetry.vectors(surface.local, fields.mirrors)[:, axis]
    p = symmetry.repeated(surface.pressure, fields.mirrors)
    order = np.argsort(t)
    at = middle + 1.25 * half * np.linspace(-1.0, 1.0, AXIS_POINTS)
    found = AxisPressure(at, np.interp(at, t[order], p[order]))
    if fields.kinematics.revolved:
        return found, found
    length = fields.kinematics.thickness
    constant = AxisPressure(length / 2 * np.array([-1.0, 1.0]), np.full(2, patch.max_pressure))
    return (found, constant) if axis == 0 else (constant, found)


def _spans(square: SquaredPressure) -> list[tuple[float, float]]:
    """Intervals of the coordinate t, mm, in which the p^2 of a section is positive, ascending."""
    t = np.linspace(*square.box[1], LINE_POINTS, dtype=np.float64)
    values = square(np.zeros_like(t), t)
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * values.max())
    turn = np.flatnonzero((values[:-1] > 0) != (values[1:] > 0))
    share = values[turn] / (values[turn] - values[turn + 1])
    zeros = [float(zero) for zero in t[turn] + share * (t[turn + 1] - t[turn])]
    return list(zip(zeros[::2], zeros[1::2], strict=True))


def _outlines(spans: list[tuple[float, float]], axis: int, length: float | None) -> list[Array]:
    """Closed outlines (k, 2) of (x, s), mm, of intervals of the coordinate t along x (axis 0) or s
    (axis 1).

    length: of the contact along the other axis, mm; None for circles about the origin, whose radii
        are the ends of the intervals.
    """
    if length is None:
        angle = np.linspace(0, 2 * np.pi, 181)
        ring = np.column_stack([np.cos(angle), np.sin(angle)])
        return [radius * ring for _, radius in spans]
    curves = []
    for begin, end in spans:
        t = np.array([begin, end, end, begin, begin])
        s = length / 2 * np.array([-1.0, -1.0, 1.0, 1.0, -1.0])
        curves.append(np.column_stack([t, s] if axis == 0 else [s, t]))
    return curves
