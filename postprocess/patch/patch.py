"""The contact patch: semi-axes, area, outline and pressure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from railhead.postprocess.findings import Array, AxisPressure, Frame, OnePatch, Patch
from railhead.postprocess.patch.outline import PatchShape, outline_shape
from railhead.postprocess.patch.reconstruct import (
    ROUGHNESS,
    Samples,
    SquaredPressure,
    blend,
    ellipsoid,
    reconstruct,
    zero_squared_pressure,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch
from railhead.postprocess.patch.surface import Surfaces, recover_surfaces

if TYPE_CHECKING:
    from railhead.solver.fields import Fields

HERTZIAN = 0.02  # largest deviation of the fourth moments from those of a semi-ellipsoid, and ...
ELLIPTIC = 0.01  # ... that up to which nothing but Hertz's ellipsoid is read
FOURTH = 9 / 8  # times the deviation of the fourth moments: of half lengths by second ones
MESH = 0.07  # of the fourth moments of an exact ellipse, by elements over half length squared
HIGHER = 0.4  # of the shape error: what is no such polynomial
PEAK_RADIUS = 0.6  # of the semi-axes: where p^2 is fitted for the largest pressure
READ = ("a", "b", "area", "max_pressure")
LINE, LINE_POINTS = 1.25, 121  # lines over the patch reach that many half lengths either way
BESIDE = 0.02  # of its half length: a peak that near to the centre is there
VARIATION = 100.0  # of the roughness, either way: how far readings differ


@dataclass(frozen=True)
class PressureMoments:
    """Moments of the pressure in the contact frame; force N (whole patch), lengths mm.

    shape_error: largest relative deviation of its normalised third and fourth moments from those
    of a semi-ellipsoid, <x^4>/<x^2>^2 = 15/7 and <x^2 s^2>/(<x^2> <s^2>) = 5/7; fourth: those of
    <x^4> and <s^4>.
    """

    force: float
    centre: tuple[float, float]
    a: float
    b: float
    shape_error: float
    fourth: tuple[float, float] = (0.0, 0.0)

    @property
    def hertzian(self) -> bool:
        """Whether the semi-axes are those of an ellipse."""
        return self.shape_error < HERTZIAN


def moments(fields: Fields, frame: Frame) -> PressureMoments:
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
        return PressureMoments(
            parts * float(total), (xc, sc), np.sqrt(5 * xx), np.sqrt(5 * ss), np.inf
        )
    deviations = [
        weight @ x**4 / total / xx**2 / (15 / 7) - 1,
        weight @ s**4 / total / ss**2 / (15 / 7) - 1,
        weight @ (x**2 * s**2) / total / (xx * ss) / (5 / 7) - 1,
        0.0 if cut_x else weight @ x**3 / total / xx**1.5,
        0.0 if cut_y else weight @ s**3 / total / ss**1.5,
    ]
    return PressureMoments(
        parts * float(total),
        (xc, sc),
        float(np.sqrt(5 * xx)),
        float(np.sqrt(5 * ss)),
        float(np.max(np.abs(deviations))),
        (float(deviations[0]), float(deviations[1])),
    )


def mirrored(local: Array, values: Array, fields: Fields) -> tuple[Array, Array]:
    """Add the mirror images of points (n, 2 or 3) in the contact frame; values are even."""
    for normal in fields.mirrors:
        axis = int(np.argmax(np.abs(normal)))
        image = local.copy()
        image[:, axis] *= -1
        local, values = np.concatenate([local, image]), np.concatenate([values, values])
    return local, values


def largest_pressure(fields: Fields, frame: Frame, found: PressureMoments) -> float:
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


def read(
    fields: Fields, separate: list[SeparatePatch], frame: Frame, *, parabolic: bool = False
) -> tuple[Patch, Surfaces, PressureMoments, Array, tuple[AxisPressure, AxisPressure]]:
    """Patch, recovered surfaces, moments, the recovered pressure at the contact points and
    along x and s through the centre, of a solution in which something touches.

    separate: its parts; frame: of the first one where there are several; parabolic: whether the
    pressure is Hertz's by construction, that of elastic half-spaces with a quadratic gap.
    """
    contact = fields.contact
    several = len(separate) > 1
    facets = np.bincount(contact.facet, contact.weights).astype(np.float64)
    readings = [
        _reading(part, part.frame if several else frame, facets, parabolic=parabolic)
        for part in separate
    ]
    images = [2 ** (len(fields.mirrors) - len(part.fields.mirrors)) for part in separate]
    first, found = readings[0], moments(separate[0].fields, frame)
    areas = [each.shape.area * count for each, count in zip(readings, images, strict=True)]
    area = sum(areas)
    highest = max(readings, key=lambda each: each.shape.peak)
    scatter = first.scatter | {
        "area": float(np.average([each.scatter["area"] for each in readings], weights=areas)),
        "max_pressure": highest.scatter["max_pressure"],
    }
    patch = Patch(
        first.shape.a,
        first.shape.b,
        found.centre,
        area,
        highest.shape.peak,
        moments(fields, frame).force / area,
        [_in_frame(line, each.frame, frame) for each in readings for line in each.shape.outlines],
        tuple(
            OnePatch(
                part.centre, part.frame.angle, each.shape.a, each.shape.b, each.shape.area,
                each.shape.peak, part.share,
            )
            for part, each in zip(separate, readings, strict=True)
        ),
        scatter,
    )  # fmt: skip
    surfaces = recover_surfaces(fields, frame, partial(_pressure, readings))
    through = _through(first, patch, frame, hertzian=found.hertzian)
    lines = _line(readings, frame, patch, through, 0), _line(readings, frame, patch, through, 1)
    return patch, surfaces, found, _pressure(readings, contact.points), lines


@dataclass(frozen=True)
class _Reading:
    """p^2 and shape of one patch in its frame, and the scatter of its readings."""

    frame: Frame
    square: SquaredPressure
    shape: PatchShape
    scatter: dict[str, float]


def _reading(part: SeparatePatch, frame: Frame, facets: Array, *, parabolic: bool) -> _Reading:
    """Of Hertz's ellipsoid up to a shape error of ELLIPTIC, of the pressure rebuilt from its
    moments from HERTZIAN on; between, of their mean."""
    fields, found = part.fields, moments(part.fields, frame)
    given = samples(fields, frame, facets)
    share = general_shape_share(found.shape_error)
    square, scatter = zero_squared_pressure(given), dict.fromkeys(READ, 0.0)
    if share > 0:
        square, scatter = reconstruct_general_shape(given)
    if share < 1:
        peak = largest_pressure(fields, frame, found)
        (a, b), (da, db) = nearly_elliptic(found, float(given.size.mean()), parabolic=parabolic)
        off = abs(found.force / (peak * 2 / 3 * np.pi * found.a * found.b) - 1)
        other = {"a": da, "b": db, "area": da + db, "max_pressure": max(off, da)}
        square = blend(square, ellipsoid(square, found.centre, (a, b), peak), share)
        scatter = {key: share * scatter[key] + (1 - share) * other[key] for key in READ}
    return _Reading(frame, square, outline_shape(square), scatter)


def reconstruct_general_shape(
    given: Samples, measure: Callable[[SquaredPressure], PatchShape] = outline_shape
) -> tuple[SquaredPressure, dict[str, float]]:
    """Any shape, and how far it differs, as `measure` reads it, with other roughnesses: beyond any
    bound where one of them did not come to a minimum."""
    stiff = reconstruct(given, VARIATION * ROUGHNESS)
    square = reconstruct(given, start=stiff)
    soft = reconstruct(given, ROUGHNESS / VARIATION, square)
    if not (stiff.settled and square.settled and soft.settled):
        return square, dict.fromkeys(READ, np.inf)
    return square, relative_differences(measure(square), [measure(stiff), measure(soft)])


def general_shape_share(shape_error: float) -> float:
    """Share of the free reading in that of a patch: 0 of an ellipse, 1 of other shapes."""
    return float(np.clip((shape_error - ELLIPTIC) / (HERTZIAN - ELLIPTIC), 0.0, 1.0))


def relative_differences(shape: PatchShape, others: list[PatchShape]) -> dict[str, float]:
    """Largest relative difference from the same patch read otherwise, by the names in `Patch`."""

    def largest(value: float, varied: list[float]) -> float:
        return max(abs(other / value - 1) for other in varied)

    return {
        "a": largest(shape.a, [other.a for other in others]),
        "b": largest(shape.b, [other.b for other in others]),
        "area": largest(shape.area, [other.area for other in others]),
        "max_pressure": largest(shape.peak, [other.peak for other in others]),
    }


def nearly_elliptic(
    found: PressureMoments,
    element: float,
    *,
    parabolic: bool,
    fourth: float = FOURTH,
    mesh: float = MESH,
) -> tuple[Array, Array]:
    """Half lengths (2,) of a nearly elliptic patch, mm, and their relative errors (2,).

    parabolic: those by second moments, exact for Hertz; errors: to those by fourth moments. Else
    to first order those of p^2 = (1 - u - v)(1 + alpha u + beta v), u = x^2/a^2, v = s^2/b^2:
    1 + `fourth` times the deviation of the fourth moments; `mesh` times (element over the smaller
    half length)^2 is what elements round off these. The errors are of that and of higher orders.
    """
    half, off = np.array([found.a, found.b]), np.array(found.fourth)
    if parabolic:
        return half, np.abs((1 + off) ** 0.25 - 1)
    rounded = mesh * (element / half.min()) ** 2
    error = fourth * (rounded + HIGHER * found.shape_error)
    return half * (1 + fourth * (off + rounded)), np.full(2, error)


def samples(fields: Fields, frame: Frame, facets: Array) -> Samples:
    """Contact points with pressure, mirror images included, on the tangent plane; facets: area of
    each, mm2."""
    contact = fields.contact
    touches = contact.pressure > 0
    onto = contact.weights * np.abs(contact.normals @ frame.axes[2])
    size = np.sqrt(2 * facets[contact.facet])  # leg of a right triangle
    values = np.column_stack([contact.pressure * onto, contact.pressure, size])[touches]
    local = frame.local(contact.points[touches])[:, :2]
    border = frame.local(fields.points[contact.facet_nodes.ravel()])[:, :2]
    x, s = np.concatenate([local, border]).T
    whole, _ = mirrored(np.column_stack([x, s]), x, fields)
    (x0, s0), (x1, s1) = whole.min(axis=0), whole.max(axis=0)
    local, values = mirrored(local, values, fields)
    even = any(abs(normal[0]) > 0.5 for normal in fields.mirrors)
    force, pressure, size = values.T
    return Samples(
        local[:, 0], local[:, 1], force, pressure, size, even, ((x0, x1), (s0, s1)),
        yields=fields.plastic_strain is not None,
    )  # fmt: skip


def _pressure(readings: list[_Reading], points: Array) -> Array:
    """Recovered pressure (n,) at points (n, 3); each patch knows its own."""
    square = [each.square(*each.frame.local(points)[:, :2].T) for each in readings]
    return np.asarray(np.sqrt(np.maximum(np.max(square, axis=0), 0.0)))


def _in_frame(line: Array, own: Frame, frame: Frame) -> Array:
    """A curve (k, 2) in the tangent plane of one frame, seen in another."""
    flat = np.column_stack([line, np.zeros(len(line))])
    return frame.local(np.array(own.origin) + flat @ own.axes)[:, :2]


def _through(first: _Reading, patch: Patch, frame: Frame, *, hertzian: bool) -> Array:
    """(x, s) of the centre of an ellipse, else of the largest pressure of the most loaded patch."""
    centre = np.array(patch.centre)
    if hertzian:
        return centre
    (top,) = _in_frame(np.array([first.shape.top]), first.frame, frame)
    near = np.abs(top - centre) < BESIDE * np.array([patch.a, patch.b])
    return np.where(near, centre, top)


def _line(
    readings: list[_Reading], frame: Frame, patch: Patch, through: Array, axis: int
) -> AxisPressure:
    """Recovered pressure along x (axis 0) or s (axis 1) through a point, over the whole patch."""
    low, high = patch.main[:, axis].min(), patch.main[:, axis].max()
    local = np.tile([*through, 0.0], (LINE_POINTS, 1))
    reach = LINE * (high - low) / 2
    local[:, axis] = (low + high) / 2 + np.linspace(-reach, reach, LINE_POINTS)
    points = np.array(frame.origin) + local @ frame.axes
    return AxisPressure(local[:, axis], _pressure(readings, points), float(through[1 - axis]))
