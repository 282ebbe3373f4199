"""Findings of a section: a line contact in plane strain, or a circle of revolution."""

from __future__ import annotations

import numpy as np

from postprocess.findings import Array, AxisPressure, Frame, Patch, Surface
from postprocess.patch import EDGE_CLIP, HERTZIAN, PEAK_RADIUS, Moments
from postprocess.surface import SurfaceRecovery, smooth_square
from solver.gather import Fields

SAMPLES = 61
SMOOTHED_SAMPLES = 24  # points on about three elements


def coordinate(fields: Fields) -> int:
    """Which of (x, s) runs along the section's contact line."""
    return int(np.argmax(np.abs(fields.kinematics.axes[0])))


def moments(fields: Fields, frame: Frame) -> Moments:
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
    return Moments(parts * total, centre, w, w, float(np.max(np.abs(deviations))))


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


def read(fields: Fields, frame: Frame) -> tuple[Patch, Surface, Moments]:
    """Patch and recovered surface of a section in which something touches."""
    contact, axis = fields.contact, coordinate(fields)
    mirrored, revolved = bool(fields.mirrors), fields.kinematics.revolved
    recovery = SurfaceRecovery(fields)
    points = fields.points[recovery.nodes]
    local = frame.local(points)[:, :2]
    projected = np.maximum(recovery.project(contact.pressure), 0.0)
    found = moments(fields, frame)
    hertzian = found.shape_error < HERTZIAN

    t = frame.local(contact.points)[:, axis]
    start = found.centre[axis] if hertzian else local[np.argmax(projected), axis]
    if mirrored:
        start = 0.0 if hertzian else start
    peak = largest_pressure(t - start, contact.pressure, contact.weights, found.a, even=mirrored)
    indicator = recovery.project(np.maximum(contact.indicator, -EDGE_CLIP * peak))
    sites, values = _both(t, recovery.interpolate(projected), mirrored)
    smooth = smooth_square(_flat(sites), values, _flat(local[:, axis]), SMOOTHED_SAMPLES)
    pressure = np.where(indicator > 0, smooth, 0.0)

    spans = _spans(local[:, axis], recovery.triangles, indicator, mirrored)
    half = found.a
    if not hertzian and spans:
        half = (max(end for _, end in spans) - min(begin for begin, _ in spans)) / 2
    width = 2 * half if hertzian or not spans else sum(end - begin for begin, end in spans)
    length = fields.kinematics.thickness
    semi = (half, half) if revolved else (half, length / 2) if axis == 0 else (length / 2, half)
    area = np.pi * half**2 if revolved else width * length
    patch = Patch(
        *semi, found.centre, float(area), peak, found.force / float(area),
        _outlines(spans, axis, None if revolved else length),
    )  # fmt: skip
    gap = recovery.project(contact.gap)
    return patch, Surface(points, local, recovery.triangles, pressure, gap), found


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


def _flat(t: Array) -> Array:
    return np.column_stack([t, np.zeros_like(t)])


def _spans(t: Array, lines: np.ndarray, values: Array, mirrored: bool) -> list[tuple[float, float]]:
    """Intervals of t in which a P1 field on lines is positive, in ascending order."""
    ends, v = t[lines], values[lines]
    pieces = []
    for (t0, t1), (v0, v1) in zip(ends, v, strict=True):
        zero = t0 + (t1 - t0) * v0 / (v0 - v1) if (v0 > 0) != (v1 > 0) else np.nan
        kept = sorted(x for x in (t0 if v0 > 0 else zero, t1 if v1 > 0 else zero) if x == x)
        if len(kept) == 2:
            pieces.append((kept[0], kept[1]))
            pieces += [(-kept[1], -kept[0])] if mirrored else []
    joined: list[tuple[float, float]] = []
    tiny = 1e-6 * float(np.ptp(t))
    for begin, end in sorted(pieces):
        if joined and begin - joined[-1][1] < tiny:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((float(begin), float(end)))
    return joined


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
