"""The contact patch: semi-axes, area, outline and pressure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import contourpy
import numpy as np

from railhead.postprocess import symmetry
from railhead.postprocess.findings import HERTZIAN, Array, AxisPressure, Frame, OnePatch, Patch
from railhead.postprocess.patch.moments import (
    PressureMoments,
    largest_pressure,
    moments,
)
from railhead.postprocess.patch.reconstruct import (
    ROUGHNESS,
    Samples,
    SquaredPressure,
    blend,
    ellipsoid,
    reconstruct,
    zero_squared_pressure,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch, separate_patches
from railhead.postprocess.patch.surface import Surfaces, recover_surfaces
from railhead.solver.system.fields import Fields

ELLIPTIC = 0.01  # shape error up to which p^2 is that of Hertz's ellipsoid alone
FOURTH_MOMENT_FACTOR = 9 / 8  # relative change of half lengths per deviation of fourth moments
# deviation of the fourth moments of an exact ellipse, over (element size / half length)^2
SOLID_SIZE_FACTOR = 0.07
HIGHER_ORDER_FACTOR = 0.4  # error by terms of higher order, over the shape error
MEASURES = ("a", "b", "area", "max_pressure")
AXIS_REACH, AXIS_POINTS = 1.25, 121  # pressure along x and s: in half lengths, either way
CENTRED = 0.02  # of a half length: a peak nearer to the centre is taken to be at the centre
Elliptic = tuple[tuple[float, float], tuple[float, float], float, dict[str, float]]
"""Centre (x, s) and semi-axes (a, b), mm, largest pressure, MPa, relative errors by MEASURES."""
ROUGHNESS_VARIATION = 100.0  # factor and divisor of the roughness: their change is the scatter
# The same where bodies yield: on 3 to 8 elements the area of the thesis's pair at 80 kN is within
# 0.4 %; a factor 100 moves it by 3.7 to 0.7 %.
YIELD_VARIATION = 10.0
GRID_LINES = 400  # in each direction: zeros of a parabola are exact to 4e-6 of its width


@dataclass(frozen=True, kw_only=True)
class PatchShape:
    """Extents and peak of one patch, images in symmetry planes included, measured on a smooth p^2
    in its frame.

    outlines: closed curves (k, 2) of (x, s), mm; a hole is a curve of its own.
    area: enclosed by the outlines, without the holes, mm2.
    a, b: half lengths along x and along s, mm.
    max_pressure: largest pressure, MPa.
    top: (x, s) of the largest pressure, mm; zeros for a section.
    """

    outlines: list[Array]
    area: float
    a: float
    b: float
    max_pressure: float
    top: tuple[float, float] = (0.0, 0.0)


def outline_shape(square: SquaredPressure) -> PatchShape:
    """Extents and peak of a patch from the zero contour of p^2, traced on a grid of 400 by 400
    points over the box.

    The border of the box counts as outside of the patch, since the contact surface may end there.
    """
    x, s = (np.linspace(low, high, GRID_LINES, dtype=np.float64) for low, high in square.box)
    values = square.grid(x, s)
    top = float(values.max())
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * top)
    values[:, [0, -1]] = np.minimum(values[:, [0, -1]], -1e-9 * top)
    lines = contourpy.contour_generator(x, s, values).lines(0.0)
    outlines = [np.asarray(line, dtype=np.float64) for line in lines]
    curves = (line.T for line in outlines)  # those of holes turn the other way than the others
    area = abs(sum(np.sum(t[:-1] * u[1:] - t[1:] * u[:-1]) for t, u in curves)) / 2
    a, b = np.ptp(np.concatenate(outlines), axis=0) / 2
    row, column = np.unravel_index(np.argmax(values), values.shape)
    return PatchShape(
        outlines=outlines,
        area=float(area),
        a=float(a),
        b=float(b),
        max_pressure=float(np.sqrt(top)),
        top=(float(x[column]), float(s[row])),
    )


@dataclass(frozen=True, kw_only=True)
class PatchReading:
    """What is read of the contact surfaces of one solution.

    patch: extents, outlines and pressures.
    surfaces: fields on the contact surface of the slave, and on that of the master, or None if the
        master is rigid or no facet of it faces the slave.
    moments: of the pressure of the most loaded patch, in a section of all contact points.
    recovered_pressure (q,): smooth pressure, from p^2, at the q contact points, MPa.
    along, across: smooth pressure along x and along s.
    """

    patch: Patch
    surfaces: Surfaces
    moments: PressureMoments
    recovered_pressure: Array
    along: AxisPressure
    across: AxisPressure


def read(
    fields: Fields, separate: list[SeparatePatch], frame: Frame, *, parabolic: bool = False
) -> PatchReading:
    """Patch, surfaces and pressures of bodies in space, of which some contact points carry
    pressure.

    separate: the patches, most loaded first. frame: contact frame of the results, that of the first
        patch if there are several. parabolic: whether Hertz's theory is exact, that is for elastic
        half-spaces whose gap is quadratic; second moments then give the semi-axes.
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
    highest = max(readings, key=lambda each: each.shape.max_pressure)
    scatter = first.scatter | {
        "area": float(np.average([each.scatter["area"] for each in readings], weights=areas)),
        "max_pressure": highest.scatter["max_pressure"],
    }
    patch = Patch(
        a=first.shape.a,
        b=first.shape.b,
        centre=found.centre,
        area=area,
        max_pressure=highest.shape.max_pressure,
        mean_pressure=moments(fields, frame).force / area,
        outlines=[
            _in_frame(line, each.frame, frame) for each in readings for line in each.shape.outlines
        ],
        each=tuple(
            OnePatch(
                centre=part.centre,
                angle=part.frame.angle,
                a=each.shape.a,
                b=each.shape.b,
                area=each.shape.area,
                max_pressure=each.shape.max_pressure,
                share=part.share,
            )
            for part, each in zip(separate, readings, strict=True)
        ),
        scatter=scatter,
    )
    through = _through(first, patch, frame, hertzian=found.hertzian)
    return PatchReading(
        patch=patch,
        surfaces=recover_surfaces(fields, frame, partial(_pressure, readings)),
        moments=found,
        recovered_pressure=_pressure(readings, contact.points),
        along=_line(readings, frame, patch, through, 0),
        across=_line(readings, frame, patch, through, 1),
    )


@dataclass(frozen=True)
class _Reading:
    """Smooth p^2 and extents of one patch.

    frame: tangent plane of the patch; of a single patch the contact frame.
    square: smooth p^2.
    shape: extents and peak of that p^2; where bodies yield the peak is of the reconstructed p^2.
    scatter: relative uncertainties of a, b, area and max_pressure, by these names.
    """

    frame: Frame
    square: SquaredPressure
    shape: PatchShape
    scatter: dict[str, float]


def _reading(part: SeparatePatch, frame: Frame, facets: Array, *, parabolic: bool) -> _Reading:
    """Smooth p^2 and extents of one patch, in the frame given.

    facets (f,): area of every contact facet of the slave, mm2. parabolic: whether Hertz's theory is
        exact, so that half lengths are those from second moments.
    """
    fields, found = part.fields, moments(part.fields, frame)
    given = samples(fields, frame, facets)

    def elliptic() -> Elliptic:
        """The nearly elliptic patch by moments."""
        peak = largest_pressure(fields, frame, found)
        (a, b), (da, db) = nearly_elliptic(found, float(given.size.mean()), parabolic=parabolic)
        off = abs(found.force / (peak * 2 / 3 * np.pi * found.a * found.b) - 1)
        errors = {"a": da, "b": db, "area": da + db, "max_pressure": max(off, da)}
        return found.centre, (a, b), peak, errors

    return _Reading(frame, *smooth_square(given, found.shape_error, elliptic))


def smooth_square(
    given: Samples,
    shape_error: float,
    elliptic: Callable[[], Elliptic],
    measure: Callable[[SquaredPressure], PatchShape] = outline_shape,
) -> tuple[SquaredPressure, PatchShape, dict[str, float]]:
    """Smooth p^2 of a patch, its extents and peak, and their relative uncertainties by the names a,
    b, area and max_pressure. Uncertainties are those of the reading, not of the mesh.

    Up to a shape error of 1 % (ELLIPTIC) p^2 is that of Hertz's ellipsoid. From 2 % (HERTZIAN) on,
    and in sections that yield, it is reconstructed from the moments of the pressure. Between the
    two it is their weighted mean. The peak of bodies that yield is always the reconstructed one:
    yield lowers it before the moments show it. At 1.6 times the load of first yield an ellipsoid's
    is 0.8 % too high.
    given: contact points with pressure. shape_error: relative deviation of the moments from those
    of Hertz's pressure. elliptic: function that gives the ellipsoid's centre (x, s) and semi-axes,
    mm, its largest pressure, MPa, and its uncertainties. measure: function that measures the
    extents of a p^2.
    """
    share = 1.0 if given.yields and given.section else general_shape_weight(shape_error)
    square, scatter = zero_squared_pressure(given), dict.fromkeys(MEASURES, 0.0)
    if share > 0 or given.yields:
        square, scatter = reconstruct_general_shape(given, measure)
    if share == 1:
        return square, measure(square), scatter
    centre, semi, peak, errors = elliptic()
    mixed = blend(square, ellipsoid(square, centre, semi, peak), share)
    shape = measure(mixed)
    if share > 0:
        errors = {key: share * scatter[key] + (1 - share) * errors[key] for key in MEASURES}
    if given.yields:
        shape = replace(shape, max_pressure=measure(square).max_pressure)
        errors = errors | {"max_pressure": scatter["max_pressure"]}
    return mixed, shape, errors


@dataclass(frozen=True, kw_only=True)
class SmoothPatch:
    """Smooth pressure of one patch in its own tangent plane.

    frame: tangent plane, with its origin at the centre of pressure.
    centre, half: (x, s) in the frame of the middle between the ends of the patch, and its half
        lengths along x and s, mm.
    force: integral of the computed pressure, not of `square`, over the patch, images in `mirrors`
        included, N.
    mirrors: unit normals (3,) of the symmetry planes that the patch meets.
    square: smooth p^2.
    """

    frame: Frame
    centre: tuple[float, float]
    half: tuple[float, float]
    force: float
    mirrors: tuple[Array, ...]
    square: SquaredPressure

    def pressure(self, frame: Frame, at: Array) -> Array:
        """Smooth pressure (n,), MPa, at points (x, s) (n, 2) of the plane of a frame, mm; zero
        outside of the patch.
        """
        x, s = _in_frame(at, frame, self.frame).T
        return np.asarray(np.sqrt(np.maximum(self.square(x, s), 0.0)))

    def nearest(self, others: list[SmoothPatch]) -> SmoothPatch:
        """The one of `others` with the nearest centre of pressure; ValueError: there are none."""
        return min(others, key=lambda each: math.dist(each.frame.origin, self.frame.origin))


def smooth_patches(fields: Fields, *, parabolic: bool) -> list[SmoothPatch]:
    """Separate patches of a solid with their smooth pressure, most loaded first. parabolic: whether
    Hertz's theory is exact, so that half lengths are those from second moments.
    """
    contact, found = fields.contact, []
    facets = np.bincount(contact.facet, contact.weights).astype(np.float64)
    for part in separate_patches(fields):
        read = _reading(part, part.frame, facets, parabolic=parabolic)
        outline = np.concatenate(read.shape.outlines)
        low, high = outline.min(axis=0), outline.max(axis=0)
        (x, s), (a, b) = (low + high) / 2, (high - low) / 2
        found.append(
            SmoothPatch(
                frame=part.frame,
                centre=(float(x), float(s)),
                half=(float(a), float(b)),
                force=part.force,
                mirrors=tuple(np.array(plane) for plane in part.fields.mirrors),
                square=read.square,
            )
        )
    return found


def reconstruct_general_shape(
    given: Samples, measure: Callable[[SquaredPressure], PatchShape]
) -> tuple[SquaredPressure, dict[str, float]]:
    """Smooth p^2 of a patch of any shape, and the uncertainty of its extents.

    given: contact points with pressure. measure: function that measures the extents of a p^2. The
        second entry holds, by name, the largest relative differences of a, b, area and max_pressure
        when the roughness is 100 times larger or smaller, where bodies yield ten times. They are
        infinite where one of the three minimisations did not converge.
    """
    variation = YIELD_VARIATION if given.yields else ROUGHNESS_VARIATION
    stiff = reconstruct(given, variation * ROUGHNESS)
    square = reconstruct(given, start=stiff)
    soft = reconstruct(given, ROUGHNESS / variation, square)
    if not (stiff.settled and square.settled and soft.settled):
        return square, dict.fromkeys(MEASURES, np.inf)
    shape, *others = (measure(each) for each in (square, stiff, soft))
    return square, {
        name: max(abs(getattr(each, name) / getattr(shape, name) - 1) for each in others)
        for name in MEASURES
    }


def general_shape_weight(shape_error: float) -> float:
    """Weight (0 to 1) of the p^2 that is reconstructed for any shape; the rest is the weight of an
    ellipsoid.

    The weight is 0 up to a shape error of 1 % (ELLIPTIC), 1 from 2 % (HERTZIAN) on, and linear
    between them.
    shape_error: relative deviation of the moments from those of an ellipsoid.
    """
    return float(np.clip((shape_error - ELLIPTIC) / (HERTZIAN - ELLIPTIC), 0.0, 1.0))


def nearly_elliptic(
    found: PressureMoments,
    element: float,
    *,
    parabolic: bool,
    fourth: float = FOURTH_MOMENT_FACTOR,
    mesh: float = SOLID_SIZE_FACTOR,
) -> tuple[Array, Array]:
    """Half lengths (2,) along x and s of a nearly elliptic patch, mm, and their relative errors
    (2,).

    found: moments of the pressure. element: element size, mm.
    parabolic: half lengths are those from second moments, exact for Hertz; errors are the
        differences from those by fourth moments.
    Otherwise half lengths are to first order those of p^2 = (1 - u - v)(1 + alpha u + beta v), with
    u = x^2/a^2, v = s^2/b^2 and small coefficients alpha, beta: those by second moments times 1 +
    `fourth` times the deviation of the fourth moments. `mesh` times (element / smaller half
    length)^2 corrects the fourth moments for the element size. Errors are those of this correction
    and of higher orders.
    """
    half, off = np.array([found.a, found.b]), np.array(found.fourth)
    if parabolic:
        return half, np.abs((1 + off) ** 0.25 - 1)
    rounded = mesh * (element / half.min()) ** 2
    error = fourth * (rounded + HIGHER_ORDER_FACTOR * found.shape_error)
    return half * (1 + fourth * (off + rounded)), np.full(2, error)


def samples(fields: Fields, frame: Frame, facets: Array) -> Samples:
    """Contact points with pressure and their mirror images, projected to the tangent plane of the
    frame.

    facets (f,): area of each contact facet, mm2; the element size at a point is sqrt(2 area).
    """
    contact = fields.contact
    touches = contact.pressure > 0
    onto = contact.weights * np.abs(contact.normals @ frame.axes[2])
    size = np.sqrt(2 * facets[contact.facet])  # leg of a right triangle
    values = np.column_stack([contact.pressure * onto, contact.pressure, size])[touches]
    local = frame.local(contact.points[touches])[:, :2]
    border = frame.local(fields.points[contact.facet_nodes.ravel()])[:, :2]
    reach = symmetry.vectors(np.concatenate([local, border]), fields.mirrors)
    (x0, s0), (x1, s1) = reach.min(axis=0), reach.max(axis=0)
    local = symmetry.vectors(local, fields.mirrors)
    force, pressure, size = symmetry.repeated(values, fields.mirrors).T
    even = any(abs(normal[0]) > 0.5 for normal in fields.mirrors)
    return Samples(
        x=local[:, 0],
        s=local[:, 1],
        force=force,
        pressure=pressure,
        size=size,
        even=even,
        limits=((x0, x1), (s0, s1)),
        yields=fields.plastic_strain is not None,
    )


def _pressure(readings: list[_Reading], points: Array) -> Array:
    """Smooth pressure (n,), MPa, at points (n, 3) in space, mm: the largest of those that the p^2
    of all patches (`readings`) give there; zero outside of all.
    """
    square = [each.square(*each.frame.local(points)[:, :2].T) for each in readings]
    return np.asarray(np.sqrt(np.maximum(np.max(square, axis=0), 0.0)))


def _in_frame(line: Array, own: Frame, frame: Frame) -> Array:
    """Coordinates (k, 2) x, s in `frame`, mm, of a curve (k, 2) given as x, s in the tangent plane
    of `own`.
    """
    flat = np.column_stack([line, np.zeros(len(line))])
    return frame.local(np.array(own.origin) + flat @ own.axes)[:, :2]


def _through(first: _Reading, patch: Patch, frame: Frame, *, hertzian: bool) -> Array:
    """(x, s) in the frame, mm, of the point through which the pressure along x and along s is
    taken.

    Of an ellipse's pressure (hertzian) it is the centre of pressure. Otherwise x and s are chosen
    each by itself: that of the centre where it lies within 0.02 (CENTRED) half lengths of that of
    the largest pressure, else that of the largest pressure. first: the most loaded patch.
    """
    centre = np.array(patch.centre)
    if hertzian:
        return centre
    (top,) = _in_frame(np.array([first.shape.top]), first.frame, frame)
    near = np.abs(top - centre) < CENTRED * np.array([patch.a, patch.b])
    return np.where(near, centre, top)


def _line(
    readings: list[_Reading], frame: Frame, patch: Patch, through: Array, axis: int
) -> AxisPressure:
    """Smooth pressure at 121 points on a line along x (axis 0) or s (axis 1), 1.25 times as long as
    the main outline.

    readings: of all patches; the largest of their pressures counts. through (2,): x, s of a point
        on the line, mm.
    """
    low, high = patch.main[:, axis].min(), patch.main[:, axis].max()
    local = np.tile([*through, 0.0], (AXIS_POINTS, 1))
    reach = AXIS_REACH * (high - low) / 2
    local[:, axis] = (low + high) / 2 + np.linspace(-reach, reach, AXIS_POINTS)
    points = np.array(frame.origin) + local @ frame.axes
    return AxisPressure(local[:, axis], _pressure(readings, points), float(through[1 - axis]))
