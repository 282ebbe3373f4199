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
    PEAK_RADIUS,
    PressureMoments,
    fitted_peak,
    largest_pressure,
    moments,
)
from railhead.postprocess.patch.reconstruct import (
    ROUGHNESS,
    Samples,
    SquaredPressure,
    blend,
    ellipsoid,
    misfit,
    reconstruct,
    zero_squared_pressure,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch, separate_patches
from railhead.postprocess.patch.surface import Surfaces, recover_surfaces
from railhead.solver.system.fields import Fields

ELLIPTIC = 0.01  # shape error up to which p^2 is that of Hertz's ellipsoid alone
FOURTH_MOMENT_FACTOR = 9 / 8  # relative change of half lengths per deviation of fourth moments
BEND_FACTOR = 21 / 4  # relative change of p^2 per deviation of fourth moments, in `nearly_elliptic`
# deviation of the fourth moments of an exact ellipse, over (element size / half length)^2
SOLID_SIZE_FACTOR = 0.07
HIGHER_ORDER_FACTOR = 0.4  # error by terms of higher order, over the shape error
MEASURES = ("a", "b", "area", "max_pressure")
AXIS_REACH, AXIS_POINTS = 1.25, 121  # pressure along x and s: in half lengths, either way
CENTRED = 0.02  # of a half length: a peak nearer to the centre is taken to be at the centre
Pair = tuple[float, float]
Elliptic = tuple[Pair, Pair, float, Pair, dict[str, float]]
"""Centre (x, s) and semi-axes (a, b), mm, largest pressure, MPa, alpha and beta of `ellipsoid`,
relative errors by MEASURES."""
ROUGHNESS_VARIATION = 100.0  # factor and divisor of the roughness: their change is the scatter
# The same where bodies yield: on 3 to 8 elements the area of the thesis's pair at 80 kN is within
# 0.4 %; a factor 100 moves it by 3.7 to 0.7 %.
YIELD_VARIATION = 10.0
# Least share of the difference of points that their means over neighbourhoods keep where it is not
# noise: 0.68 to 0.79 on layers of 0.1 to 0.5 half lengths, else up to 0.46.
SYSTEMATIC = 0.5
SPECK = 0.01  # of the largest outline's area
PEAK_REACH = 0.1  # of the smaller half length: least radius in which a sharp peak is fitted
EXPONENTS = (0.5, 0.75, 1.0)
GRID_LINES = 400  # in each direction: zeros of a parabola are exact to 4e-6 of its width


@dataclass(frozen=True, kw_only=True)
class PatchShape:
    """Extents and peak of one patch, images in symmetry planes included, measured on a smooth p^2
    in its frame.

    outlines: closed curves (k, 2) of (x, s), mm; a hole is a curve of its own.
    area: enclosed by the outlines, without the holes, mm2.
    a, b: half lengths along x and along s, mm.
    max_pressure: largest pressure, MPa.
    force: integral of the pressure over the plane of the patch, N.
    top: (x, s) of the largest pressure, mm; zeros for a section.
    """

    outlines: list[Array]
    area: float
    a: float
    b: float
    max_pressure: float
    force: float
    top: tuple[float, float] = (0.0, 0.0)


def outline_shape(square: SquaredPressure) -> PatchShape:
    """Extents and peak of a patch from the zero contour of p^2, traced on a grid of 400 by 400
    points over the box.

    The border of the box counts as outside of the patch, since the contact surface may end there.
    Outlines with less than 1 % (SPECK) of the area of the largest one are left out: beside a
    pressure that ends flatly F is nearly 0.
    """
    x, s = (np.linspace(low, high, GRID_LINES, dtype=np.float64) for low, high in square.box)
    values = square.grid(x, s)
    top = float(values.max())
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * top)
    values[:, [0, -1]] = np.minimum(values[:, [0, -1]], -1e-9 * top)
    lines = contourpy.contour_generator(x, s, values).lines(0.0)
    outlines = [np.asarray(line, dtype=np.float64) for line in lines]
    curves = (line.T for line in outlines)  # those of holes turn the other way than the others
    areas = np.array([np.sum(t[:-1] * u[1:] - t[1:] * u[:-1]) / 2 for t, u in curves])
    large = np.flatnonzero(np.abs(areas) > SPECK * np.abs(areas).max())
    outlines, area = [outlines[k] for k in large], abs(areas[large].sum())
    a, b = np.ptp(np.concatenate(outlines), axis=0) / 2
    row, column = np.unravel_index(np.argmax(values), values.shape)
    return PatchShape(
        outlines=outlines,
        area=float(area),
        a=float(a),
        b=float(b),
        max_pressure=float(np.sqrt(top)),
        force=float(np.sqrt(np.maximum(values, 0.0)).sum() * (x[1] - x[0]) * (s[1] - s[0])),
        top=(float(x[column]), float(s[row])),
    )


def sharp_peak(given: Samples, square: SquaredPressure, half: float) -> tuple[float, float]:
    """Largest pressure, MPa, of a patch with a peak that smooth functions cut off, and its relative
    uncertainty: tractions of unlike materials end at an angle where they change sign.

    Fits around the largest smooth p^2 within a radius of an element, or a tenth of the smaller half
    length (mm), and of twice that, whose errors are as the radius where the peak is a cone. The
    uncertainty is their difference.
    """
    top = np.argmax(square(given.x, given.s))
    away = np.column_stack([given.x - given.x[top], given.s - given.s[top]])[:, given.section :]
    reach, area = max(float(given.size.mean()), PEAK_REACH * half), given.force / given.pressure
    near, wide = (
        fitted_peak(away * PEAK_RADIUS / each, given.pressure, area) for each in (reach, 2 * reach)
    )
    return 2 * near - wide, abs(near / wide - 1)


@dataclass(frozen=True, kw_only=True)
class SmoothPatch:
    """Smooth pressure of one patch, which lies in a plane.

    frame: that plane: the tangent plane of the patch with its origin at the centre of pressure, or
        the contact frame.
    square: smooth p^2.
    shape: extents and peak of that p^2; where bodies yield the peak is of the reconstructed p^2.
    centre, half: (x, s) of the middle between the ends of the outlines, and half lengths between
        them along x and s, mm.
    scatter: relative uncertainties of a, b, area and max_pressure, by these names; empty where they
        were not asked for.
    force: integral of the computed pressure, not of `square`, over the patch, images in `mirrors`
        included, N.
    unbalance: relative difference of the integrals of both over the plane.
    mirrors: unit normals (3,) of the symmetry planes that the patch meets.
    """

    frame: Frame
    square: SquaredPressure
    shape: PatchShape
    centre: Pair
    half: Pair
    scatter: dict[str, float]
    force: float
    unbalance: float
    mirrors: tuple[Array, ...] = ()

    def at(self, x: Array, s: Array) -> Array:
        """Smooth pressure (n,), MPa, at x (n,), s (n,) in the plane, mm; zero outside the patch."""
        return np.asarray(np.sqrt(np.maximum(self.square(x, s), 0.0)))

    def pressure(self, frame: Frame, at: Array) -> Array:
        """Smooth pressure (n,), MPa, at points (x, s) (n, 2) of the plane of a frame, mm."""
        return self.at(*_in_frame(at, frame, self.frame).T)

    def nearest(self, others: list[SmoothPatch]) -> SmoothPatch:
        """The one of `others` with the nearest origin of its plane; ValueError: there are none."""
        return min(others, key=lambda each: math.dist(each.frame.origin, self.frame.origin))


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
        _smooth(part, part.frame if several else frame, facets, parabolic=parabolic)
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
        unbalance=max(each.unbalance for each in readings),
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


def _smooth(
    part: SeparatePatch, frame: Frame, facets: Array, *, parabolic: bool, doubt: bool = True
) -> SmoothPatch:
    """Smooth pressure of one patch of a solid, in the plane of a frame.

    facets (f,): area of every contact facet of the slave, mm2. parabolic: whether Hertz's theory is
        exact, so that half lengths are those from second moments. doubt: whether uncertainties are
        wanted.
    """
    fields, found = part.fields, moments(part.fields, frame)
    given = samples(fields, frame, facets)

    def elliptic() -> Elliptic:
        """The nearly elliptic patch by moments."""
        peak = largest_pressure(fields, frame, found)
        element = float(given.size.mean())
        (a, b), (da, db), bulge = nearly_elliptic(found, element, parabolic=parabolic)
        off = abs(found.force / (peak * 2 / 3 * np.pi * found.a * found.b) - 1)
        errors = {"a": da, "b": db, "area": da + db, "max_pressure": max(off, da)}
        return found.centre, (a, b), peak, bulge, errors

    square, shape, scatter = smooth_square(given, found.shape_error, elliptic, doubt=doubt)
    every = np.concatenate(shape.outlines)
    (x0, s0), (x1, s1) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    return SmoothPatch(
        frame=frame,
        square=square,
        shape=shape,
        centre=((x0 + x1) / 2, (s0 + s1) / 2),
        half=((x1 - x0) / 2, (s1 - s0) / 2),
        scatter=scatter,
        force=part.force,
        unbalance=given.unbalance(shape.force),
        mirrors=tuple(np.array(plane) for plane in fields.mirrors),
    )


def smooth_square(
    given: Samples,
    shape_error: float,
    elliptic: Callable[[], Elliptic],
    measure: Callable[[SquaredPressure], PatchShape] = outline_shape,
    *,
    doubt: bool = True,
) -> tuple[SquaredPressure, PatchShape, dict[str, float]]:
    """Smooth p^2 of a patch, its extents and peak, and their relative uncertainties by the names a,
    b, area and max_pressure. Uncertainties are those of the reading, not of the mesh.

    Up to a shape error of 1 % (ELLIPTIC) p^2 is that of Hertz's ellipsoid. From 2 % (HERTZIAN) on,
    in sections that yield, and where unlike materials rub, it is reconstructed from the moments of
    the pressure. Between the two it is their weighted mean. The peak of bodies that yield is always
    the reconstructed one: yield lowers it before the moments show it. At 1.6 times the load of
    first yield an ellipsoid's is 0.8 % too high. Where unlike materials rub it is `sharp_peak`.
    given: contact points with pressure. shape_error: relative deviation of the moments from those
    of Hertz's pressure. elliptic: function that gives the nearly elliptic patch. measure: function
    that measures the extents of a p^2. doubt: whether uncertainties are wanted, which takes three
    reconstructions.
    """
    general = given.rubs or (given.yields and given.section)
    share = 1.0 if general else general_shape_weight(shape_error)
    square, scatter = zero_squared_pressure(given), dict.fromkeys(MEASURES, 0.0)
    if share > 0 or given.yields:
        square, scatter = reconstruct_general_shape(given, measure, doubt=doubt)
    if share == 1 or square.exponent != 0.5:
        shape = measure(square)
        if given.rubs:
            peak, off = sharp_peak(given, square, min(shape.a, shape.b))
            shape, scatter = replace(shape, max_pressure=peak), scatter | {"max_pressure": off}
        return square, shape, scatter
    centre, semi, peak, bulge, errors = elliptic()
    mixed = blend(square, ellipsoid(square, centre, semi, peak, bulge), share)
    shape = measure(mixed)
    if share > 0:
        errors = {key: share * scatter[key] + (1 - share) * errors[key] for key in MEASURES}
    if given.yields:
        shape = replace(shape, max_pressure=measure(square).max_pressure)
        errors = errors | {"max_pressure": scatter["max_pressure"]}
    return mixed, shape, errors


def smooth_patches(fields: Fields, *, parabolic: bool) -> list[SmoothPatch]:
    """Separate patches of a solid with their smooth pressure, each in its own tangent plane, most
    loaded first. parabolic: whether Hertz's theory is exact, so that half lengths are those from
    second moments.
    """
    facets = np.bincount(fields.contact.facet, fields.contact.weights).astype(np.float64)
    return [
        _smooth(part, part.frame, facets, parabolic=parabolic, doubt=False)
        for part in separate_patches(fields)
    ]


def reconstruct_general_shape(
    given: Samples, measure: Callable[[SquaredPressure], PatchShape], *, doubt: bool
) -> tuple[SquaredPressure, dict[str, float]]:
    """Smooth p^2 of a patch of any shape, and the uncertainty of its extents.

    given: contact points with pressure. measure: function that measures the extents of a p^2. The
        second entry holds, by name, the largest relative differences of a, b, area and max_pressure
        when the roughness is 100 times larger or smaller, where bodies yield ten times. They are
        infinite where one of the three minimisations did not converge; without `doubt` they are
        zero, and one minimisation is made.

    Where a p^2 of fourth degree along x leaves a difference to the computed pressure that does not
    oscillate (SYSTEMATIC), as on thin layers, p is an uneven F^g. Of the EXPONENTS g it has the one
    with the least difference in the mean of neighbourhoods. The uncertainty is the change to each
    other one, times the square root of the ratio of both differences.
    """
    variation = YIELD_VARIATION if given.yields else ROUGHNESS_VARIATION
    stiff = reconstruct(given, variation * ROUGHNESS) if doubt else None
    square = reconstruct(given, start=stiff)
    others = [] if stiff is None else [stiff, reconstruct(given, ROUGHNESS / variation, square)]
    settled, weights = all(each.settled for each in (square, *others)), [1.0, 1.0]
    off, mean_off = misfit(square, given)
    if not (given.uneven or given.section) and mean_off > SYSTEMATIC * off:
        given = replace(given, uneven=True)
        found = [reconstruct(given, exponent=each) for each in EXPONENTS]
        least, *more = sorted((misfit(each, given)[1], k) for k, each in enumerate(found))
        square, others = found[least[1]], [found[k] for _, k in more]
        settled, weights = square.settled, [math.sqrt(least[0] / each) for each, _ in more]
    if not settled:
        return square, dict.fromkeys(MEASURES, np.inf)
    shape, scatter = measure(square), dict.fromkeys(MEASURES, 0.0)
    for weight, each in zip(weights, map(measure, others), strict=False):
        for name in MEASURES:
            change = abs(getattr(each, name) / getattr(shape, name) - 1)
            scatter[name] = max(scatter[name], weight * change)
    return square, scatter


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
    bend: float = BEND_FACTOR,
) -> tuple[Array, Array, Pair]:
    """Half lengths (2,) along x and s of a nearly elliptic patch, mm, their relative errors (2,),
    and the coefficients alpha and beta below.

    found: moments of the pressure. element: element size, mm.
    parabolic: half lengths are those from second moments, exact for Hertz; errors are the
        differences from those by fourth moments, and both coefficients zero.
    Otherwise all are to first order those of p^2 = (1 - u - v)(1 + alpha u + beta v), with u =
    x^2/a^2, v = s^2/b^2. Half lengths are those by second moments times 1 + `fourth` times the
    deviation of the fourth moments. alpha is -`bend` times (4 x + s), beta -`bend` times (x + 4 s),
    of the deviations x and s along both. `mesh` times (element / smaller half length)^2 corrects
    the fourth moments for the element size. Errors are those of this correction and of higher
    orders.
    """
    half, off = np.array([found.a, found.b]), np.array(found.fourth)
    if parabolic:
        return half, np.abs((1 + off) ** 0.25 - 1), (0.0, 0.0)
    rounded = mesh * (element / half.min()) ** 2
    error = fourth * (rounded + HIGHER_ORDER_FACTOR * found.shape_error)
    off = off + rounded
    alpha, beta = -bend * (3 * off + off.sum())
    return half * (1 + fourth * off), np.full(2, error), (float(alpha), float(beta))


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
        rubs=fields.rubs,
        uneven=fields.rubs or fields.plastic_strain is not None,
    )


def _pressure(patches: list[SmoothPatch], points: Array) -> Array:
    """Smooth pressure (n,), MPa, at points (n, 3) in space, mm: the largest of those of all patches
    there; zero outside of all.
    """
    each = [one.at(*one.frame.local(points)[:, :2].T) for one in patches]
    return np.asarray(np.max(each, axis=0))


def _in_frame(line: Array, own: Frame, frame: Frame) -> Array:
    """Coordinates (k, 2) x, s in `frame`, mm, of a curve (k, 2) given as x, s in the tangent plane
    of `own`.
    """
    flat = np.column_stack([line, np.zeros(len(line))])
    return frame.local(np.array(own.origin) + flat @ own.axes)[:, :2]


def _through(first: SmoothPatch, patch: Patch, frame: Frame, *, hertzian: bool) -> Array:
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
    readings: list[SmoothPatch], frame: Frame, patch: Patch, through: Array, axis: int
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
