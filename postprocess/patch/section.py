"""Findings of a section: a line contact in plane strain, or a circle of revolution."""

from __future__ import annotations

import numpy as np

from railhead.postprocess.findings import Array, AxisPressure, Frame, Patch, Surface
from railhead.postprocess.patch.outline import PatchShape
from railhead.postprocess.patch.patch import (
    FOURTH,
    PEAK_RADIUS,
    READ,
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
from railhead.postprocess.patch.surface import Surfaces, recover_surfaces
from railhead.solver.fields import Fields

MESH = 0.03  # see `patch`
SAMPLES = 61
GRID = 2000  # points at which p^2 is looked at


def coordinate(fields: Fields) -> int:
    """Which of (x, s) runs along the section's contact line."""
    return int(np.argmax(np.abs(fields.kinematics.axes[0])))


def moments(fields: Fields, frame: Frame) -> PressureMoments:
    """Half width w = 2 sqrt(int p t^2 / int p) of a strip, sqrt(5/2 int p r^2 / int p) of a circle,
    as both semi-axes: exact for Hertz's pressure."""
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
        parts * total, centre, w, w, float(np.max(np.abs(deviations))), (off, off)
    )


def largest_pressure(t: Array, pressure: Array, weights: Array, w: float, *, even: bool) -> float:
    """Peak of a parabola fitted to p^2 near t = 0 (mm); Hertz's p^2 is one exactly. Where it has
    none, the largest of its values there."""
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


def read(
    fields: Fields, frame: Frame, *, parabolic: bool = False
) -> tuple[Patch, Surfaces, PressureMoments, Array]:
    """Patch, recovered surfaces, moments, and the recovered pressure at the contact points of a
    section in which something touches; parabolic: see `patch.read`."""
    contact, axis = fields.contact, coordinate(fields)
    revolved, length = fields.kinematics.revolved, fields.kinematics.thickness
    found = moments(fields, frame)
    given = samples(fields, frame)
    share = general_shape_share(found.shape_error)
    square, scatter = zero_squared_pressure(given), dict.fromkeys(READ, 0.0)
    if share > 0:
        square, scatter = reconstruct_general_shape(given, lambda each: _shape(each, fields))
    if share < 1:
        t = frame.local(contact.points)[:, axis] - found.centre[axis]
        even = bool(fields.mirrors)
        peak = largest_pressure(t, contact.pressure, contact.weights, found.a, even=even)
        half, other = _ellipse(found, peak, float(given.size.mean()), fields, parabolic=parabolic)
        ellipse = ellipsoid(square, (0.0, found.centre[axis]), (1.0, half), peak)
        square = blend(square, ellipse, share)
        scatter = {key: share * scatter[key] + (1 - share) * other[key] for key in READ}
    shape = _shape(square, fields)
    outlines = _outlines(_spans(square), axis, None if revolved else length)
    patch = Patch(
        shape.a, shape.b, found.centre, shape.area, shape.peak, found.force / shape.area,
        outlines, scatter=scatter,
    )  # fmt: skip

    def pressure(points: Array) -> Array:
        return _pressure(square, frame.local(points)[:, axis])

    return patch, recover_surfaces(fields, frame, pressure), found, pressure(contact.points)


def samples(fields: Fields, frame: Frame) -> Samples:
    """Contact points with pressure, mirror images included, on the line of the section."""
    contact, axis = fields.contact, coordinate(fields)
    revolved, thickness = fields.kinematics.revolved, fields.kinematics.thickness
    touches = contact.pressure > 0
    t = frame.local(contact.points)[:, axis]
    ends = frame.local(fields.points[contact.facet_nodes])[..., axis]
    size = np.ptp(ends, axis=1)[contact.facet]
    onto = contact.weights * np.abs(contact.normals @ frame.axes[2])
    values = np.column_stack([onto * contact.pressure, contact.pressure, size])[touches]
    low, high = float(ends.min()), float(ends.max())
    t = t[touches]
    if fields.mirrors:
        t, values = np.concatenate([-t, t]), np.tile(values, (2, 1))
        low = -high
    if revolved:
        values[:, 0] /= 2  # either side of the axis is half of the circle
    limits = ((-1.0, 1.0), (low, high))
    force, pressure, size = values.T
    x = np.zeros_like(t)
    return Samples(x, t, force, pressure, size, True, limits, True, revolved, thickness)


def _pressure(square: SquaredPressure, t: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(square(np.zeros_like(t), t), 0.0)))


def _shape(square: SquaredPressure, fields: Fields) -> PatchShape:
    """Half widths, area and peak of a section."""
    spans, axis = _spans(square), coordinate(fields)
    length = fields.kinematics.thickness
    half = (spans[-1][1] - spans[0][0]) / 2
    peak = _pressure(square, np.linspace(*square.box[1], GRID, dtype=np.float64)).max()
    if fields.kinematics.revolved:
        return PatchShape([], float(np.pi * half**2), half, half, float(peak))
    area = length * sum(end - begin for begin, end in spans)
    semi = (half, length / 2) if axis == 0 else (length / 2, half)
    return PatchShape([], float(area), *semi, float(peak))


def _ellipse(
    found: PressureMoments, peak: float, element: float, fields: Fields, *, parabolic: bool
) -> tuple[float, dict[str, float]]:
    """Half width, mm, and relative errors: of the peak the difference from that of the parabola of
    p^2 that has the force."""
    revolved, length = fields.kinematics.revolved, fields.kinematics.thickness
    (half, _), (error, _) = nearly_elliptic(
        found, element, parabolic=parabolic, fourth=FOURTH if revolved else 1.0, mesh=MESH
    )
    unit = 2 / 3 * np.pi * found.a**2 if revolved else np.pi / 2 * found.a * length
    along, across = (error, error) if revolved else (error, 0.0)
    if coordinate(fields) == 1:
        along, across = across, along
    area = 2 * error if revolved else error
    off = abs(found.force / (peak * unit) - 1)
    return half, {"a": along, "b": across, "area": area, "max_pressure": max(off, error)}


def axis_pressures(
    surface: Surface, patch: Patch, fields: Fields
) -> tuple[AxisPressure, AxisPressure]:
    """Recovered pressure along x and along s; constant along a line contact."""
    axis = coordinate(fields)
    half, middle = (patch.a, patch.b)[axis], patch.centre[axis]
    t, p = _both(surface.local[:, axis], surface.pressure, bool(fields.mirrors))
    order = np.argsort(t)
    at = middle + 1.25 * half * np.linspace(-1.0, 1.0, SAMPLES)
    found = AxisPressure(at, np.interp(at, t[order], p[order]))
    if fields.kinematics.revolved:
        return found, found
    length = fields.kinematics.thickness
    constant = AxisPressure(length / 2 * np.array([-1.0, 1.0]), np.full(2, patch.max_pressure))
    return (found, constant) if axis == 0 else (constant, found)


def _both(t: Array, values: Array, mirrored: bool) -> tuple[Array, Array]:
    """With the mirror images at t = 0."""
    return (np.concatenate([-t, t]), np.tile(values, 2)) if mirrored else (t, values)


def _spans(square: SquaredPressure) -> list[tuple[float, float]]:
    """Intervals of t in which p^2 is positive, in ascending order."""
    t = np.linspace(*square.box[1], GRID, dtype=np.float64)
    values = square(np.zeros_like(t), t)
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * values.max())
    turn = np.flatnonzero((values[:-1] > 0) != (values[1:] > 0))
    share = values[turn] / (values[turn] - values[turn + 1])
    zeros = [float(zero) for zero in t[turn] + share * (t[turn + 1] - t[turn])]
    return list(zip(zeros[::2], zeros[1::2], strict=True))


def _outlines(spans: list[tuple[float, float]], axis: int, length: float | None) -> list[Array]:
    """Closed outlines (x, s): circles about the origin, or rectangles of the contact length."""
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
