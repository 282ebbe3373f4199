"""The contact patch: semi-axes, area, outline and pressure."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from postprocess.findings import Array, AxisPressure, Frame, OnePatch, Patch, Surface
from postprocess.parts import Part
from postprocess.surface import SurfaceRecovery, chains, contour, smooth_outline, smooth_square
from solver.gather import Fields

HERTZIAN = 0.02  # largest deviation of the fourth moments from those of a semi-ellipsoid
PEAK_RADIUS = 0.6  # of the semi-axes: where p^2 is fitted for the largest pressure
LOBED = 0.1  # shape error from which the largest pressure is sought ...
PEAK_FACETS = 16  # ... by quadratics fitted to p^2 over that many facets around each node, ...
PEAK_SHARE = 0.75  # ... where the pressure is more than that share of the largest one
EDGE_CLIP = 0.1  # of the largest pressure: how far the indicator is followed below zero


@dataclass(frozen=True)
class Moments:
    """Moments of the pressure in the contact frame; force N (whole patch), lengths mm.

    shape_error: largest relative deviation of its normalised third and fourth moments from those
    of a semi-ellipsoid, <x^4>/<x^2>^2 = 15/7 and <x^2 s^2>/(<x^2> <s^2>) = 5/7.
    """

    force: float
    centre: tuple[float, float]
    a: float
    b: float
    shape_error: float

    @property
    def hertzian(self) -> bool:
        """Whether the semi-axes are those of an ellipse."""
        return self.shape_error < HERTZIAN


def moments(fields: Fields, frame: Frame) -> Moments:
    """a = sqrt(5 int p x^2 / int p), and b alike across: exact for Hertz's semi-ellipsoid."""
    contact = fields.contact
    weight = contact.weights * contact.pressure
    total = weight.sum()
    local = frame.local(contact.points)
    x, s = local[:, 0], local[:, 1]
    normals = np.abs(np.array(fields.mirrors).reshape(-1, 3))
    cut_x, cut_y = bool(normals[:, 0].any()), bool(normals[:, 1].any())
    xc = 0.0 if cut_x else float(weight @ x / total)
    sc = 0.0 if cut_y else float(weight @ s / total)
    x, s = x - xc, s - sc
    xx, ss = float(weight @ x**2 / total), float(weight @ s**2 / total)
    parts = 2 ** len(fields.mirrors)
    if not xx * ss > 0:  # all points in a line
        return Moments(parts * float(total), (xc, sc), np.sqrt(5 * xx), np.sqrt(5 * ss), np.inf)
    deviations = [
        weight @ x**4 / total / xx**2 / (15 / 7) - 1,
        weight @ s**4 / total / ss**2 / (15 / 7) - 1,
        weight @ (x**2 * s**2) / total / (xx * ss) / (5 / 7) - 1,
        0.0 if cut_x else weight @ x**3 / total / xx**1.5,
        0.0 if cut_y else weight @ s**3 / total / ss**1.5,
    ]
    return Moments(
        parts * float(total),
        (xc, sc),
        float(np.sqrt(5 * xx)),
        float(np.sqrt(5 * ss)),
        float(np.max(np.abs(deviations))),
    )


def mirrored(local: Array, values: Array, fields: Fields) -> tuple[Array, Array]:
    """Add the mirror images of points (n, 2 or 3) in the contact frame; values are even."""
    for normal in fields.mirrors:
        axis = int(np.argmax(np.abs(normal)))
        image = local.copy()
        image[:, axis] *= -1
        local, values = np.concatenate([local, image]), np.concatenate([values, values])
    return local, values


def largest_pressure(fields: Fields, frame: Frame, found: Moments) -> float:
    """Peak of a quadratic fitted to p^2 around the centre; Hertz's p^2 is one exactly."""
    contact = fields.contact
    local, p = mirrored(frame.local(contact.points)[:, :2], contact.pressure, fields)
    _, weight = mirrored(local[: len(contact.weights)], contact.weights, fields)
    scaled = (local - found.centre) / np.array([found.a, found.b])
    radius = np.hypot(*scaled.T)
    near = (radius < PEAK_RADIUS) & (p > 0)
    if near.sum() < 24:
        return float(p.max())
    x, s = scaled[near].T
    basis = np.column_stack([np.ones_like(x), x, s, x * x, x * s, s * s])
    root = np.sqrt(weight[near])
    c = np.linalg.lstsq(basis * root[:, None], p[near] ** 2 * root, rcond=None)[0]
    hessian = np.array([[2 * c[3], c[4]], [c[4], 2 * c[5]]])
    if np.linalg.eigvalsh(hessian).max() < 0:
        top = np.linalg.solve(hessian, -c[1:3])
        if np.hypot(*top) < PEAK_RADIUS:
            return float(np.sqrt(c[0] + 0.5 * c[1:3] @ top))
    return float(np.sqrt(np.max(basis @ c)))


def read(fields: Fields, separate: list[Part], frame: Frame) -> tuple[Patch, Surface, Moments]:
    """Patch and recovered surface fields of a solution in which something touches.

    separate: its parts; frame: of the first one where there are several.
    """
    contact = fields.contact
    recovery = SurfaceRecovery(fields)
    points = fields.points[recovery.nodes]
    local = frame.local(points)[:, :2]
    projected = np.maximum(recovery.project(contact.pressure), 0.0)
    several = len(separate) > 1
    found = moments(separate[0].fields if several else fields, frame)
    peaks = [_peak(each.fields, frame, points, projected) for each in separate]
    peak = max(peaks)

    indicator = recovery.project(np.maximum(contact.indicator, -EDGE_CLIP * peak))
    sites, values = mirrored(
        frame.local(contact.points)[:, :2], recovery.interpolate(projected), fields
    )
    pressure = np.where(indicator > 0, smooth_square(sites, values, local), 0.0)
    segments, area = contour(local, recovery.triangles, indicator)
    area *= 2 ** len(fields.mirrors)
    a, b = found.a, found.b
    jagged = _close(chains(segments, 1e-6 * a), fields)
    size = float(np.sqrt(np.bincount(contact.facet, contact.weights)[contact.facet].mean()))
    outlines = [smooth_outline(line, size) for line in jagged]
    if several:
        a, b = separate[0].a, separate[0].b
    elif found.hertzian:
        area = float(np.pi * a * b)
    elif outlines:
        extent = np.ptp(np.concatenate(outlines), axis=0)
        a, b = float(extent[0] / 2), float(extent[1] / 2)
    areas = _areas(separate, points, recovery.triangles, indicator) if several else [area]
    each = tuple(
        OnePatch(part.centre, part.frame.angle, part.a, part.b, own, top, part.share)
        for part, own, top in zip(separate, areas, peaks, strict=True)
    )
    if not several:
        each = (replace(each[0], a=a, b=b),)
    force = moments(fields, frame).force if several else found.force
    area = float(sum(areas))
    patch = Patch(a, b, found.centre, area, peak, force / area, outlines, each)
    gap = recovery.project(contact.gap)
    return patch, Surface(points, local, recovery.triangles, pressure, gap), found


def _peak(fields: Fields, frame: Frame, points: Array, projected: Array) -> float:
    """Largest pressure of one patch; points (n, 3) and projected (n,): recovered at the nodes."""
    found = moments(fields, frame)
    if found.shape_error < LOBED:
        return largest_pressure(fields, frame, found)
    contact = fields.contact
    own = cKDTree(contact.points).query(points)[0] < 0.2 * min(found.a, found.b)
    high = points[own & (projected > PEAK_SHARE * np.max(projected, where=own, initial=0.0))]
    if not len(high):  # a patch smaller than its elements
        return float(contact.pressure.max())
    sites, pressure = mirrored(frame.local(contact.points)[:, :2], contact.pressure, fields)
    samples = PEAK_FACETS * int(np.bincount(contact.facet).max())
    targets = frame.local(high)[:, :2]
    return float(np.max(smooth_square(sites, pressure, targets, samples, degree=2)))


def _areas(
    separate: list[Part], points: Array, triangles: NDArray[np.int64], indicator: Array
) -> list[float]:
    """Area of each patch in its own tangent plane, from the triangles nearest to it."""
    middles = points[triangles].mean(axis=1)
    distance = [cKDTree(part.fields.contact.points).query(middles)[0] for part in separate]
    owner = np.argmin(distance, axis=0)
    return [
        contour(part.frame.local(points)[:, :2], triangles[owner == number], indicator)[1]
        * 2 ** len(part.fields.mirrors)
        for number, part in enumerate(separate)
    ]


def _close(lines: list[Array], fields: Fields) -> list[Array]:
    """Whole closed outlines from those of the modelled part."""
    for normal in fields.mirrors:
        axis = int(np.argmax(np.abs(normal)))
        flip = np.where(np.arange(2) == axis, -1.0, 1.0)
        joined = []
        for line in lines:
            image = line[::-1] * flip
            ends = np.abs(line[[0, -1], axis])
            scale = 1e-3 * np.abs(line).max()
            if ends[1] < scale:
                line = np.concatenate([line, image[1:]])
                joined.append(line)
            elif ends[0] < scale:
                joined.append(np.concatenate([image, line[1:]]))
            else:
                joined += [line, image]
        lines = joined
    return lines


def axis_pressure(surface: Surface, patch: Patch, axis: int, fields: Fields) -> AxisPressure:
    """Recovered pressure along x (axis 0) or s (axis 1) through the patch centre."""
    half = (patch.a, patch.b)[axis] * 1.25
    cut = any(int(np.argmax(np.abs(n))) == axis for n in fields.mirrors)
    centre = np.array(patch.centre)
    coordinate = np.linspace(0.0 if cut else -half, half, 61) + centre[axis]
    probes = np.tile(centre, (len(coordinate), 1))
    probes[:, axis] = coordinate
    probes += 1e-9 * half  # off the symmetry line, into the model
    corners = surface.local[surface.triangles]
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    det = np.cross(e1, e2)
    offset = probes[:, None, :] - corners[None, :, 0]
    u, v = np.cross(offset, e2) / det, np.cross(e1, offset) / det
    outside = np.maximum(np.maximum(-u, -v), u + v - 1)
    best = np.argmin(outside, axis=1)
    rows = np.arange(len(probes))
    u, v = u[rows, best], v[rows, best]
    p = surface.pressure[surface.triangles[best]]
    values = p[:, 0] * (1 - u - v) + p[:, 1] * u + p[:, 2] * v
    if cut:
        coordinate = np.concatenate([-coordinate[:0:-1], coordinate])
        values = np.concatenate([values[:0:-1], values])
    return AxisPressure(coordinate, values)
