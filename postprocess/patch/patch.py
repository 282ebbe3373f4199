"""The contact patch of a solid or a section: half lengths, area, outlines and pressure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import contourpy
import numpy as np

from railhead.postprocess import symmetry
from railhead.postprocess.findings import (
    HERTZIAN,
    Array,
    AxisPressure,
    Findings,
    Frame,
    OnePatch,
    Patch,
)
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
    ellipsoid,
    misfit,
    reconstruct,
    zero_squared_pressure,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch, separate_patches
from railhead.postprocess.patch.surface import recover_surface
from railhead.solver.space.kinematics import Kinematics
from railhead.solver.system.fields import Fields

ELLIPTIC = 0.01  # shape error up to which p^2 is that of Hertz's ellipsoid alone
Factors = tuple[float, float, float]
NEARLY_ELLIPTIC: dict[tuple[int, bool], Factors] = {
    (2, False): (9 / 8, 0.07, 21 / 4),
    (1, False): (1.0, 0.03, 16 / 5),
    (1, True): (9 / 8, 0.03, 21 / 4),
}
"""By the number of axes along which the pressure varies and by whether a section is revolved:
relative change of half lengths per deviation of fourth moments; deviation of the fourth moments of
an exact ellipse, over (element size / half length)^2; relative change of p^2 per deviation of
fourth moments. See `nearly_elliptic`."""
HIGHER_ORDER_FACTOR = 0.4  # error by terms of higher order, over the shape error
MEASURES = ("a", "b", "area", "max_pressure")
AXIS_REACH, AXIS_POINTS = 1.25, 121  # pressure along x and s: in half lengths, either way
CENTRED = 0.02  # of a half length: a peak nearer to the centre is taken to be at the centre
Pair = tuple[float, float]
Elliptic = Callable[[SquaredPressure], tuple[SquaredPressure, dict[str, float]]]
"""Gives, with the box and knots of a p^2, that of a nearly elliptic patch, and its relative errors
by MEASURES."""
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
LINE_POINTS = 2000  # the same of a section


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


def section_shape(square: SquaredPressure, kinematics: Kinematics, given: Samples) -> PatchShape:
    """Extents and peak of the patch of a section, whose p^2 depends on the coordinate along the
    section. In plane strain outlines are rectangles whose half length out of the plane is half the
    thickness. Of a body of revolution they are circles, and both half lengths their radius. Half
    lengths reach over gaps between patches; in plane strain the area leaves these out.
    """
    (axis,) = kinematics.varying
    t = np.linspace(*square.box[1], LINE_POINTS, dtype=np.float64)
    values = square(np.zeros_like(t), t)
    pressure = np.sqrt(np.maximum(values, 0.0))
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * values.max())
    turn = np.flatnonzero((values[:-1] > 0) != (values[1:] > 0))
    share = values[turn] / (values[turn] - values[turn + 1])
    spans = (t[turn] + share * (t[turn + 1] - t[turn])).reshape(-1, 2)
    half = np.full(2, (spans[-1, 1] - spans[0, 0]) / 2)
    if kinematics.revolved:
        angle, area = np.linspace(0, 2 * np.pi, 181), np.pi * half[0] ** 2
        ring = np.column_stack([np.cos(angle), np.sin(angle)])
        outlines = [radius * ring for _, radius in spans]
    else:
        area = kinematics.thickness * np.ptp(spans, axis=1).sum()
        half[1 - axis] = kinematics.thickness / 2
        outlines = [np.zeros((5, 2)) for _ in spans]
        for line, (low, high) in zip(outlines, spans, strict=True):
            line[:, axis] = low, high, high, low, low
            line[:, 1 - axis] = half[1 - axis] * np.array([-1.0, -1.0, 1.0, 1.0, -1.0])
    return PatchShape(
        outlines=outlines,
        area=float(area),
        a=float(half[0]),
        b=float(half[1]),
        max_pressure=float(pressure.max()),
        force=float(pressure @ given.measure(t) * (t[1] - t[0])),
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
    """Smooth pressure of one patch, which lies in a plane, or of all patches of a section.

    frame: that plane: the tangent plane of the patch with its origin at the centre of pressure, or
        the contact frame.
    square: smooth p^2; of a section over the coordinate along it as s.
    shape: extents and peak of that p^2; where bodies yield the peak is of the reconstructed p^2.
    centre, half: (x, s) of the middle between the ends of the outlines, and half lengths between
        them along x and s, mm.
    scatter: relative uncertainties of a, b, area and max_pressure, by these names; empty where they
        were not asked for.
    force: integral of the computed pressure, not of `square`, over the patch, images in `mirrors`
        included, N.
    unbalance: relative difference of the integrals of both over the plane.
    mirrors: unit normals (3,) of the symmetry planes that the patch meets.
    varying: axes along which the pressure varies: both, or that of a section.
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
    varying: tuple[int, ...] = (0, 1)

    def at(self, x: Array, s: Array) -> Array:
        """Smooth pressure (n,), MPa, at x (n,), s (n,) in the plane, mm; zero outside the patch."""
        if len(self.varying) == 1:
            x, s = 0 * x, (x, s)[self.varying[0]]
        return np.asarray(np.sqrt(np.maximum(self.square(x, s), 0.0)))

    def pressure(self, frame: Frame, at: Array) -> Array:
        """Smooth pressure (n,), MPa, at points (x, s) (n, 2) of the plane of a frame, mm."""
        return self.at(*_in_frame(at, frame, self.frame).T)

    def nearest(self, others: list[SmoothPatch]) -> SmoothPatch:
        """The one of `others` with the nearest origin of its plane; ValueError: there are none."""
        return min(others, key=lambda each: math.dist(each.frame.origin, self.frame.origin))


def read(
    fields: Fields, separate: list[SeparatePatch], frame: Frame, *, parabolic: bool = False
) -> Findings:
    """Findings on the patch of a solution, of which some contact points carry pressure: its
    extents, the contact surfaces, the pressure along x and along s, shape and noise. Stresses and
    edges are left at their defaults.

    separate: the patches of a solid, most loaded first. Of a section there are none: its patches
    are read as one whose half width reaches from the first to the last end. frame: contact frame of
    the results, that of the first patch if there are several. parabolic: whether Hertz's theory is
    exact, that is for elastic half-spaces whose gap is quadratic; second moments then give the
    semi-axes.
    """
    several, sizes = len(separate) > 1, element_sizes(fields, frame)
    parts = [part.fields for part in separate] or [fields]
    frames = [part.frame for part in separate] if several else [frame]
    readings = [
        _smooth(part, plane, sizes, parabolic=parabolic)
        for part, plane in zip(parts, frames, strict=True)
    ]
    images = [2 ** (len(fields.mirrors) - len(part.mirrors)) for part in parts]
    first, found = readings[0], moments(parts[0], frame)
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
            for part, each in zip(separate, readings, strict=False)
        ),
        scatter=scatter,
        unbalance=max(each.unbalance for each in readings),
    )
    along, across = _lines(readings, frame, patch, fields.kinematics, hertzian=found.hertzian)
    return Findings(
        frame=frame,
        patch=patch,
        surface=recover_surface(fields, frame, partial(_pressure, readings)),
        along=along,
        across=across,
        shape_error=found.shape_error,
        hertzian=found.hertzian and not several,
        noise=noise(fields, _pressure(readings, fields.contact.points)),
    )


def noise(fields: Fields, recovered: Array) -> float:
    """Relative L2 difference of computed pressure p and smooth pressure p_s, ||p - p_s|| / ||p||,
    with the norms integrated over the contact points.

    recovered (q,): smooth pressure at the q contact points, MPa.
    """
    contact = fields.contact
    square = contact.weights @ (contact.pressure - recovered) ** 2
    return float(np.sqrt(square / (contact.weights @ contact.pressure**2)))


def _smooth(
    fields: Fields, frame: Frame, sizes: Array, *, parabolic: bool, doubt: bool = True
) -> SmoothPatch:
    """Smooth pressure of one patch of a solid, or of a section, in the plane of a frame.

    fields: with the contact points of the patch alone. sizes (f,): as of `element_sizes`.
        parabolic: whether Hertz's theory is exact, so that half lengths are those from second
        moments. doubt: whether uncertainties are wanted.
    """
    kinematics, found = fields.kinematics, moments(fields, frame)
    given, axes = samples(fields, frame, sizes), kinematics.varying

    def elliptic(like: SquaredPressure) -> tuple[SquaredPressure, dict[str, float]]:
        """The nearly elliptic patch by moments; of a section only its second semi-axis counts."""
        peak = largest_pressure(fields, frame, found)
        factors = NEARLY_ELLIPTIC[len(axes), kinematics.revolved]
        element = float(given.size.mean())
        (a, b), error, bulge = nearly_elliptic(found, element, factors, parabolic=parabolic)
        centre, volume = found.centre, 2 / 3 * np.pi * found.a * found.b
        if given.section:
            centre, a = (0.0, found.centre[axes[0]]), 1.0
        if given.section and not given.revolved:
            volume, error[1 - axes[0]] = np.pi / 2 * found.a * given.thickness, 0.0
        off = abs(found.force / (peak * volume) - 1)
        largest = max(off, error[axes[0]])
        errors = dict(zip(MEASURES, (*error, error.sum(), largest), strict=True))
        return ellipsoid(like, centre, (a, b), peak, bulge), errors

    measure = outline_shape
    if given.section:
        measure = partial(section_shape, kinematics=kinematics, given=given)
    square, shape, scatter = smooth_square(given, found.shape_error, elliptic, measure, doubt=doubt)
    every = np.concatenate(shape.outlines)
    (x0, s0), (x1, s1) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    return SmoothPatch(
        frame=frame,
        square=square,
        shape=shape,
        centre=((x0 + x1) / 2, (s0 + s1) / 2),
        half=((x1 - x0) / 2, (s1 - s0) / 2),
        scatter=scatter,
        force=found.force,
        unbalance=abs(shape.force / float(given.force.sum()) - 1),
        mirrors=tuple(np.array(plane) for plane in fields.mirrors),
        varying=tuple(axes),
    )


def smooth_square(
    given: Samples,
    shape_error: float,
    elliptic: Elliptic,
    measure: Callable[[SquaredPressure], PatchShape],
    *,
    doubt: bool,
) -> tuple[SquaredPressure, PatchShape, dict[str, float]]:
    """Smooth p^2 of a patch, its extents and peak, and their relative uncertainties by the names a,
    b, area and max_pressure. Uncertainties are those of the reading, not of the mesh.

    Up to a shape error of 1 % (ELLIPTIC) p^2 is that of Hertz's ellipsoid. From 2 % (HERTZIAN) on,
    in sections that yield, and where unlike materials rub, it is reconstructed from the moments of
    the pressure. Between the two it is their weighted mean, and the standard deviation of both
    under these weights is a part of its uncertainty. The peak of bodies that yield is always
    the reconstructed one: yield lowers it before the moments show it. At 1.6 times the load of
    first yield an ellipsoid's is 0.8 % too high. Where unlike materials rub it is `sharp_peak`.
    given: contact points with pressure. shape_error: relative deviation of the moments from those
    of Hertz's pressure. elliptic: gives the nearly elliptic patch. measure: function
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
    ellipse, errors = elliptic(square)
    mean = share * square.coefficients + (1 - share) * ellipse.coefficients
    mixed = replace(square, coefficients=mean)
    shape = measure(mixed)
    if share > 0 and doubt:
        apart = compare_extents(measure(square), measure(ellipse))
        spread = math.sqrt(share * (1 - share))
        errors = {
            key: share * scatter[key] + (1 - share) * errors[key] + spread * apart[key]
            for key in MEASURES
        }
    if given.yields:
        shape = replace(shape, max_pressure=measure(square).max_pressure)
        errors = errors | {"max_pressure": scatter["max_pressure"]}
    return mixed, shape, errors


def smooth_patches(fields: Fields, *, parabolic: bool) -> list[SmoothPatch]:
    """Separate patches of a solid with their smooth pressure, each in its own tangent plane, most
    loaded first. parabolic: whether Hertz's theory is exact, so that half lengths are those from
    second moments.
    """
    separate = separate_patches(fields)
    sizes = [element_sizes(fields, part.frame) for part in separate]
    return [
        _smooth(part.fields, part.frame, size, parabolic=parabolic, doubt=False)
        for part, size in zip(separate, sizes, strict=True)
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
        for name, change in compare_extents(shape, each).items():
            scatter[name] = max(scatter[name], weight * change)
    return square, scatter


def compare_extents(shape: PatchShape, other: PatchShape) -> dict[str, float]:
    """Relative changes of a, b, area and max_pressure from a shape to another one, by name."""
    return {key: abs(getattr(other, key) / getattr(shape, key) - 1) for key in MEASURES}


def general_shape_weight(shape_error: float) -> float:
    """Weight (0 to 1) of the p^2 that is reconstructed for any shape; the rest is the weight of an
    ellipsoid.

    The weight is 0 up to a shape error of 1 % (ELLIPTIC), 1 from 2 % (HERTZIAN) on, and linear
    between them.
    shape_error: relative deviation of the moments from those of an ellipsoid.
    """
    return float(np.clip((shape_error - ELLIPTIC) / (HERTZIAN - ELLIPTIC), 0.0, 1.0))


def nearly_elliptic(
    found: PressureMoments, element: float, factors: Factors, *, parabolic: bool
) -> tuple[Array, Array, Pair]:
    """Half lengths (2,) along x and s of a nearly elliptic patch, mm, their relative errors (2,),
    and the coefficients alpha and beta below.

    found: moments of the pressure. element: element size, mm. factors: `fourth`, `mesh` and `bend`
        below, an entry of NEARLY_ELLIPTIC.
    parabolic: half lengths are those from second moments, exact for Hertz; errors are the
        differences from those by fourth moments, and both coefficients zero.
    Otherwise all are to first order those of p^2 = (1 - u - v)(1 + alpha u + beta v), with u =
    x^2/a^2, v = s^2/b^2. Half lengths are those by second moments times 1 + `fourth` times the
    deviation of the fourth moments. alpha is -`bend` times (4 x + s), beta -`bend` times (x + 4 s),
    of the deviations x and s along both. `mesh` times (element / smaller half length)^2 corrects
    the fourth moments for the element size. Errors are those of this correction and of higher
    orders.
    """
    fourth, mesh, bend = factors
    half, off = np.array([found.a, found.b]), np.array(found.fourth)
    if parabolic:
        return half, np.abs((1 + off) ** 0.25 - 1), (0.0, 0.0)
    rounded = mesh * (element / half.min()) ** 2
    off = off + rounded
    error = fourth * (rounded + HIGHER_ORDER_FACTOR * float(np.abs(off).max()))
    alpha, beta = -bend * (3 * off + off.sum())
    return half * (1 + fourth * off), np.full(2, error), (float(alpha), float(beta))


def element_sizes(fields: Fields, frame: Frame) -> Array:
    """Sizes (f,) of the elements at all contact facets of the slave, mm: sqrt(2 area), the leg of a
    right triangle, or of a section the length of the facet in the frame.
    """
    contact, axes = fields.contact, fields.kinematics.varying
    if len(axes) == 1:
        return np.ptp(frame.local(fields.points[contact.facet_nodes])[..., axes[0]], axis=1)
    return np.asarray(np.sqrt(2 * np.bincount(contact.facet, contact.weights)))


def samples(fields: Fields, frame: Frame, sizes: Array) -> Samples:
    """Contact points with pressure and their mirror images, projected to the tangent plane of the
    frame. Of a section their s is the coordinate along it, and their x is zero.

    sizes (f,): as of `element_sizes`.
    """
    contact, kinematics = fields.contact, fields.kinematics
    touches, section = contact.pressure > 0, kinematics.dim == 2
    onto = contact.weights * np.abs(contact.normals @ frame.axes[2])
    onto = onto / 2 if kinematics.revolved else onto  # either side of the axis has half of a circle
    values = np.column_stack([contact.pressure * onto, contact.pressure, sizes[contact.facet]])
    force, pressure, size = symmetry.repeated(values[touches], fields.mirrors).T
    local = symmetry.vectors(frame.local(contact.points[touches])[:, :2], fields.mirrors)
    border = frame.local(fields.points[contact.facet_nodes.ravel()])[:, :2]
    reach = np.concatenate([local, symmetry.vectors(border, fields.mirrors)])
    (x0, s0), (x1, s1) = reach.min(axis=0).tolist(), reach.max(axis=0).tolist()
    x, s, limits = *local.T, ((x0, x1), (s0, s1))
    if section:
        (axis,) = kinematics.varying
        x, s, limits = 0 * x, local[:, axis], ((-1.0, 1.0), limits[axis])
    bent = fields.rubs or fields.plastic_strain is not None
    return Samples(
        x=x,
        s=s,
        force=force,
        pressure=pressure,
        size=size,
        even=section or any(abs(normal[0]) > 0.5 for normal in fields.mirrors),
        limits=limits,
        section=section,
        revolved=kinematics.revolved,
        thickness=kinematics.thickness,
        yields=fields.plastic_strain is not None,
        rubs=fields.rubs,
        uneven=bent,
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


def _lines(
    readings: list[SmoothPatch],
    frame: Frame,
    patch: Patch,
    kinematics: Kinematics,
    *,
    hertzian: bool,
) -> tuple[AxisPressure, AxisPressure]:
    """Smooth pressure along x and along s: at 121 points on lines 1.25 times as long as the main
    outline, of a section as all outlines. In plane strain it is constant across the section; of a
    body of revolution both are equal.

    readings: of all patches; the largest of their pressures counts. The lines of an ellipse's
    pressure (hertzian) go through the centre of pressure. Otherwise their x and s are chosen each
    by itself: that of the centre where it lies within 0.02 (CENTRED) half lengths of that of the
    largest pressure, else that of the largest pressure.
    """
    section, centre = kinematics.dim == 2, np.array(patch.centre)
    (top,) = _in_frame(np.array([readings[0].shape.top]), readings[0].frame, frame)
    near = np.abs(top - centre) < CENTRED * np.array([patch.a, patch.b])
    through = np.zeros(2) if section else centre if hertzian else np.where(near, centre, top)
    low, high = patch.box if section else (patch.main.min(axis=0), patch.main.max(axis=0))
    lines = []
    for axis in (0, 1):
        local = np.tile([*through, 0.0], (AXIS_POINTS, 1))
        reach = AXIS_REACH * (high - low)[axis] / 2 * np.linspace(-1.0, 1.0, AXIS_POINTS)
        local[:, axis] = (low + high)[axis] / 2 + reach
        values = _pressure(readings, np.array(frame.origin) + local @ frame.axes)
        lines.append(AxisPressure(local[:, axis], values, float(through[1 - axis])))
    if kinematics.revolved:
        return lines[0], lines[0]
    if section:
        ends = kinematics.thickness / 2 * np.array([-1.0, 1.0])
        (axis,) = kinematics.varying
        lines[1 - axis] = AxisPressure(ends, np.full(2, patch.max_pressure))
    return lines[0], lines[1]
