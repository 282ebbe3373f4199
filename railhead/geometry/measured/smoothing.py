"""Smoothing of measured points along the length of their curve, as locally as the noise allows.

Points are fitted by splines of the arc length s with a penalty on the third derivative, the change
of curvature (P. H. C. Eilers and B. D. Marx, Flexible smoothing with B-splines and penalties,
Statistical Science 11, 1996), so that steep faces are smoothed like flat ones and a turned profile
like the upright one. Without a penalty typed in, the change of curvature is a random one whose
variance may differ from place to place, and that variance is the most probable one under the noise
(D. J. C. MacKay, Bayesian interpolation, Neural Computation 4, 1992): a straight tread is smoothed
over tens of millimetres where a gauge corner is smoothed over a few.

Points that are no farther off a curve than the rounding of their coordinates are drawn, not
measured. Their curve passes through them within that rounding, and of all such curves its curvature
changes least in sum: it is constant along arcs, and jumps where arcs meet.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, make_interp_spline
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.linalg.lapack import dtbtrs
from scipy.ndimage import gaussian_filter1d, median_filter
from scipy.sparse import csr_array, diags

from railhead.geometry.measured.ordering import (
    LARGEST_GAP,
    WIDEST_GAP,
    PointError,
    chord_lengths,
    cross,
    turns,
)
from railhead.theory.array_types import Array

LEAST_POINTS = 12
ORDER = 3  # of the derivative that is penalised, and of the splines
DIFFERENCE = 5  # order of the differences that show the noise ...
MEDIAN = 101  # ... points over which their median is taken ...
MEANS, CHANCE = 1.2, 1.5  # mm of means that show a filter, and the least ratio that does
NORMAL = 0.6745  # ... and the median of the modulus of a standard normal number
LEAST_NOISE = 1e-5  # mm: less is no noise of a gauge
ROUNDED = 2.0  # times the rounding of the numbers in a file is no noise of a gauge either ...
ROUGH = 0.005  # ... but more than this share of the points' distance leaves no curve through them
UNIFORM = math.sqrt(12)  # last digit over the standard deviation of its rounding
FINEST = 1e-9  # mm: closer no curve needs to pass the points
PIECES = 250  # of the spline, at most; of a drawn profile ...
COARSER = 2.0  # times its rounding, and half its points, show what a drawn profile leaves open
KNOTS, KNOT = 8, 0.05  # ... knots a point at most, and mm between them at least, if fewer
STIFF, SINGULAR = 1e9, 1e-14  # weights of squared differences: more than all, and that of a knot
EVEN = 5e-4  # 1/mm2: slower changes of the curvature are spread evenly
PILOT, DRAWN_PILOT = 12.0, 2.0  # points in the wavelength of the curve that normals and lengths
# are taken from; of a drawn profile, whose corners it must follow
SHORTEST, LONGEST = 4.0, 60.0  # wavelengths: points and knots, and mm
NEIGHBOURS = 1.2  # mm along which the roughness is taken for alike, as a standard deviation
BLENDING = 1.5  # mm over which wavelengths change into each other: sudden changes overshoot
BENDING = 1.2  # times the wavelength that suits heights is one that suits curvatures (chosen on
# the worn pairs of the study)
LONGER = 1.2  # times the way through its points is no curve through them
UPDATES, SETTLED = 60, 0.02
FINE, MOST = 20, 100_000  # samples a point, and in all, where a curve is measured or bent open


@dataclass(frozen=True, kw_only=True)
class Smoothed:
    """Smooth curve through the points of a measured profile.
    curve: spline of the arc length s (mm) with values (y, z), mm.
    points: (n, 2) of (y, z) that were smoothed, mm, in their order along the curve.
    s: (n,) arc length of each point, mm.
    residual: (n,) signed distance of each point from the curve along its left normal, mm.
    noise: standard deviation of the points across the curve, estimated from their differences, mm;
        its median along the curve.
    places: (k,) arc lengths at which wavelength is given, mm.
    wavelength: (k,) length of waves that keep half of their height, mm; 0 for a drawn profile.
    rounding: last digit of the points of a drawn profile, mm; 0 for one that is smoothed.
    """

    curve: BSpline
    points: Array
    s: Array
    residual: Array
    noise: float
    places: Array
    wavelength: Array
    rounding: float

    @property
    def length(self) -> float:
        """Arc length of the curve from the first to the last point, mm."""
        return float(self.s[-1])

    def rough_curvature(self) -> Array:
        """Curvature (n - 2,) of the circles through each three points that follow each other, 1/mm,
        positive where they bend to the right.
        """
        one, two = np.diff(self.points, axis=0)[:-1], np.diff(self.points, axis=0)[1:]
        sides = [np.linalg.norm(side, axis=1) for side in (one, two, one + two)]
        return np.asarray(-2 * cross(one, two) / np.prod(sides, axis=0))


def noise(points: Array) -> Array:
    """Standard deviation (n,) in mm of the noise across the curve, at points (n, 2) in their order
    along the curve, mm.
    The noise is the running median of the divided differences of fifth order, in which no arc is
    left. A gauge that errs in height errs less across a steep face.
    """
    sigma = _scatter(points, 1)
    sigma = median_filter(sigma, min(len(sigma), MEDIAN), mode="reflect")
    sigma = gaussian_filter1d(sigma, MEDIAN / 4, mode="nearest")
    ends = (DIFFERENCE - DIFFERENCE // 2, DIFFERENCE // 2)
    return np.pad(sigma, ends, mode="edge")


def filtered(points: Array) -> float:
    """Factor, at least 1, by which noise that an instrument has filtered leaves more open than its
    differences from point to point (`noise`) show. points: (n, 2) along the curve, mm.
    Means of k points have 1/sqrt(k) of the noise if it is independent, and more if it is not: the
    largest ratio counts, for means of 2, 4, ... points that are at most 1.2 mm (MEANS) long. It
    is 1 below 1.5 (CHANCE): in 160 draws independent noise had 1.33 at most, filtered one 1.89 at
    least.
    """
    apart, alone = float(np.median(np.diff(chord_lengths(points)))), np.median(_scatter(points, 1))
    most = min(MEANS / apart, len(points) / (2 * (DIFFERENCE + 1)))
    counts = 2 ** np.arange(1, 1 + max(0, int(math.log2(max(most, 1.0)))))
    more = [math.sqrt(k) * float(np.median(_scatter(points, int(k)))) for k in counts]
    ratio = float(max(more, default=0.0) / alone) if alone else 0.0
    return ratio if ratio > CHANCE else 1.0


def _scatter(points: Array, mean: int) -> Array:
    """Moduli of the divided differences of fifth order across the curve, of means of so many points
    (n, 2) that follow each other, mm; their median is the noise of these means.
    """
    whole = np.vstack([np.zeros(2), np.cumsum(points, axis=0)])
    points = (whole[mean:] - whole[:-mean]) / mean
    s = chord_lengths(points)
    span = DIFFERENCE * mean + 1
    windows = np.lib.stride_tricks.sliding_window_view(np.arange(len(s)), span)[:, ::mean]
    at = s[windows]
    apart = at[:, :, None] - at[:, None, :] + np.eye(DIFFERENCE + 1)
    weights = 1 / apart.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1)[:, None]
    difference = np.einsum("nk,nkd->nd", weights, points[windows])
    chord = points[windows[:, -1]] - points[windows[:, 0]]
    across = cross(chord, difference) / np.linalg.norm(chord, axis=1)
    return np.abs(across) / NORMAL


def folded(points: Array) -> PointError:
    """Error that no curve runs through points (n, 2), at the point where they turn most."""
    text = "makes no smooth curve here; delete points that stand off, or round an upright corner"
    return PointError(text, points[1 + int(np.argmax(turns(points)))])


def smooth(
    points: Array, wavelength: float | None = None, stretch: float = 1.0, resolution: float = 0.0
) -> Smoothed:
    """Smooth curve through points (n, 2) in mm that are in their order along it; a point that
    repeats the one before is left out.
    wavelength: of waves that keep half of their height, mm, everywhere; None: chosen by the noise,
        from place to place. Then a profile whose noise is the rounding of its coordinates is drawn:
        the curve passes through its points within that rounding.
    stretch: factor on the wavelengths. Unless it is 1, a drawn profile has every second point and
        twice (COARSER) the rounding instead, from the second point on where it is above 1.
    resolution: last digit of the coordinates, mm; 0 where it is not known.
    Raises ValueError for fewer than 12 points. Raises PointError for a gap of more than 10 mm
    between points, and where they bend the curve back.
    """
    repeated = np.linalg.norm(np.diff(points, axis=0, prepend=np.nan), axis=1) == 0
    points = points[~repeated]
    if len(points) < LEAST_POINTS:
        raise ValueError(f"has {len(points)} points; give at least {LEAST_POINTS}")
    s = chord_lengths(points)
    apart = np.diff(s)
    if apart.max() > WIDEST_GAP:
        y, z = points[int(np.argmax(apart))]
        text = f"has a gap of {apart.max():.3g} mm behind the point {y:.4g}, {z:.4g}; "
        text += f"give points at most {LARGEST_GAP:g} mm apart"
        raise PointError(text, np.array([y, z]))
    sigma = noise(points)
    typical = max(float(np.median(sigma)), LEAST_NOISE)
    drawn = 0.0 if wavelength else drawn_to(sigma, resolution, float(np.median(apart)))
    rounding = drawn
    if drawn and stretch != 1:
        points = points[np.unique([0, *range(int(stretch > 1), len(s), 2), len(s) - 1])]
        s, rounding = chord_lengths(points), COARSER * drawn
    spacing, pieces, waves = s[-1] / (len(s) - 1), min(PIECES, len(s)), PILOT
    if drawn:
        pieces, waves = max(len(s), min(KNOTS * len(s), round(s[-1] / KNOT))), DRAWN_PILOT
    for _ in range(2):
        pilot = _Fit(s, pieces)
        curve = pilot.curve(points, pilot.penalty(np.full(len(pilot.places), waves * spacing)))
        s = _lengths(curve, s, points)
    fit = _Fit(s, pieces)
    heights = _developed(curve, s)(s) + _off(curve, s, points)
    lengths = np.zeros(len(fit.places))
    if drawn:
        curve = _bent(curve, s, points, fit, fit.sharpest(heights, rounding))
        s = _lengths(curve, s, points)
    else:
        sigma = np.interp(fit.places, s, np.maximum(filtered(points) * sigma, LEAST_NOISE))
        lengths += stretch * (wavelength or fit.most_probable(heights, sigma))
        for _ in range(2):
            curve = _bent(curve, s, points, fit, fit.penalty(lengths))
            s = _lengths(curve, s, points)
            fit = _Fit(s, pieces)
    return Smoothed(
        curve=curve,
        points=points,
        s=s,
        residual=_off(curve, s, points),
        noise=drawn or typical,
        places=fit.places,
        wavelength=lengths,
        rounding=UNIFORM * drawn,
    )


def drawn_to(sigma: Array, resolution: float, apart: float) -> float:
    """Standard deviation in mm to which points are drawn, 0 where a gauge has measured them.
    sigma: (n,) noise of the points, mm; resolution: last digit of their coordinates, mm, or 0.
    apart: distance of the points, mm.
    It is that of the rounding if the noise is no more than twice (ROUNDED) as large, else the noise
    of exact points, below 0.01 um (LEAST_NOISE). A rounding of more than 0.005 (ROUGH) of the
    points' distance leaves no curve through them. Where a column has few digits and yet less noise
    everywhere, as even steps across have, the noise counts.
    """
    noise, rounding = float(np.median(sigma)), min(resolution / UNIFORM, float(sigma.max()))
    level = max(rounding if noise <= ROUNDED * rounding else noise, FINEST)
    return level if level <= max(LEAST_NOISE, rounding) and level < ROUGH * apart else 0.0


class _Fit:
    """Least-squares fit of cubic B-splines with penalised third differences of the coefficients.
    knots: knots of the splines, even except at the ends, mm of arc length.
    basis: sparse values (n, m) of the m splines at the n points.
    squares: lower bands (4, m) of basis^T basis (m, m), as scipy's banded solvers take them.
    signs: (4,) the weights of a third difference.
    differences: sparse matrix (rows, m) of third differences.
    places: (rows,) arc lengths at which the third differences lie, mm.
    step: distance of the knots, mm.
    spacing: mean distance of the points, mm.
    least: (rows,) least weights with which the equations can be factored; knots in the gaps of the
        points have nothing else.
    unit: spacing times step^5, mm^6, which makes the weights of squared differences dimensionless.
        The sum of these squares is step^5 times the integral of the squared third derivative, and
        there are 1/spacing points a millimetre.
    """

    def __init__(self, s: Array, pieces: int) -> None:
        """Fit for points at arc lengths s (n,) in mm, ascending from 0, by so many pieces."""
        self.step, self.spacing = s[-1] / pieces, s[-1] / (len(s) - 1)
        self.knots = self.step * np.arange(-ORDER, pieces + ORDER + 1)
        self.knots[ORDER], self.knots[-ORDER - 1] = 0.0, s[-1]
        self.basis = BSpline.design_matrix(s, self.knots, ORDER)
        self.squares = _bands(self.basis.T @ self.basis)
        signs = [(-1.0) ** (ORDER - k) * math.comb(ORDER, k) for k in range(ORDER + 1)]
        rows = pieces, pieces + ORDER
        self.differences = csr_array(diags(signs, range(ORDER + 1), rows))
        self.signs = np.array(signs)
        self.places = self.step * (np.arange(self.differences.shape[0]) + 0.5)
        self.unit = self.spacing * self.step ** (2 * ORDER - 1)
        gap = np.diff(s)[np.clip(np.searchsorted(s, self.places) - 1, 0, len(s) - 2)]
        self.least = SINGULAR * np.maximum(gap / self.step, 4.0) ** (2 * ORDER)

    def penalty(self, wavelength: Array) -> Array:
        """Weights (k,) of squared third differences, relative to the points, that halve the height
        of waves of these lengths (k,), mm. Waves of wavenumber omega have a squared third
        derivative omega^6.
        """
        return np.asarray((wavelength / (2 * math.pi)) ** (2 * ORDER) / self.unit)

    def curve(self, data: Array, penalty: Array) -> BSpline:
        """Spline fitted to data (n, ...) at the points, with weights penalty (rows,) of the squared
        third differences; it does not go through them.
        """
        factor = self._factor(penalty), True
        solved = cho_solve_banded(factor, self.basis.T @ data, check_finite=False)
        return BSpline(self.knots, solved, ORDER)

    def most_probable(self, heights: Array, sigma: Array) -> Array:
        """Wavelengths (rows,) in mm of the most probable smoothing, times 1.2 (BENDING).
        heights: (n,) heights of the points, mm; sigma: (rows,) noise, mm.
        MacKay's fixed point: the variance of the differences is their sum of squares over the
        number of them that the points determine, both as means over the neighbourhood. It ends
        without an error after 60 updates (UPDATES).
        """
        d, width = self.differences, NEIGHBOURS / self.step
        right, columns = self.basis.T @ heights, d.T.toarray(order="F")
        shortest = SHORTEST * max(self.spacing, self.step)
        least, most = self.penalty(np.array([shortest, LONGEST]))
        penalty = np.full(len(self.places), math.sqrt(most * least))
        for _ in range(UPDATES):
            factor = self._factor(penalty)
            found = d @ cho_solve_banded((factor, True), right, check_finite=False)
            # d (L L^T)^-1 d^T has the squared lengths of the columns of L^-1 d^T on its diagonal.
            unknown = (dtbtrs(factor, columns, uplo="L")[0] ** 2).sum(axis=0)
            known = gaussian_filter1d(1 - np.minimum(penalty * unknown, 1 - 1e-9), width)
            variance = gaussian_filter1d(found**2, width) / known
            better = np.clip(sigma**2 / np.maximum(variance, 1e-300), least, most)
            change = np.abs(np.log(better / penalty)).max()
            penalty = better
            if change < SETTLED:
                break
        penalty = np.exp(gaussian_filter1d(np.log(penalty), BLENDING / self.step))
        lengths = 2 * math.pi * (penalty * self.unit) ** (1 / (2 * ORDER))
        return np.asarray(BENDING * lengths)

    def sharpest(self, heights: Array, sigma: float) -> Array:
        """Weights (rows,) of the squared third differences with which their moduli add up to the
        least that heights (n,) in mm, with a rounding of standard deviation sigma (mm), allow.

        The sum of the moduli is the total variation of the curvature: arcs and lines that meet at
        few places have the least (E. Mammen and S. van de Geer, Locally adaptive regression
        splines, Annals of Statistics 25, 1997). It is the sum of squares over the moduli of the
        step before, and changes below 0.0005/mm2 (EVEN) count as squares.
        """
        penalty = self.penalty(np.full(len(self.places), PILOT * self.spacing))
        strength, even = penalty[0], EVEN * self.step**ORDER
        right = self.basis.T @ heights
        for _ in range(UPDATES):
            fitted = cho_solve_banded((self._factor(penalty), True), right, check_finite=False)
            off, change = heights - self.basis @ fitted, np.diff(fitted, ORDER)
            far = max(float(np.sqrt(np.mean(off**2))), float(np.abs(off).max()) / UNIFORM)
            strength *= np.clip(sigma / max(far, 1e-300), 0.3, 3.0) ** 2
            strength = min(strength, STIFF)
            penalty = strength / np.hypot(change / even, 1.0)
        return penalty

    def _factor(self, penalty: Array) -> Array:
        """Lower bands (4, m) of the Cholesky factor of the normal equations with weights penalty
        (rows,) of the squared differences.
        """
        penalty = np.maximum(penalty, self.least)
        bands, signs = self.squares.copy(), self.signs
        for k in range(ORDER + 1):  # row r of the differences has them in columns r to r + ORDER
            products = signs[: len(signs) - k] * signs[k:]
            bands[k, : bands.shape[1] - k] += np.convolve(penalty, products)
        return np.asarray(cholesky_banded(bands, lower=True, check_finite=False))


def _bands(matrix: Any) -> Array:
    """Main diagonal and the three below it, (4, m), of a sparse symmetric matrix (m, m) without
    others, padded with zeros at the end.
    """
    return np.array([np.pad(matrix.diagonal(-k), (0, k)) for k in range(ORDER + 1)])


def _frame(curve: BSpline, s: Array) -> tuple[Array, Array]:
    """Unit tangents (n, 2) and left normals (n, 2) of a curve at arc lengths s (n,) in mm."""
    tangent = curve(s, 1)
    tangent = tangent / np.linalg.norm(tangent, axis=1)[:, None]
    return tangent, np.column_stack([-tangent[:, 1], tangent[:, 0]])


def _off(curve: BSpline, s: Array, points: Array) -> Array:
    """Signed distance (n,) in mm of points (n, 2) from the curve at arc lengths s (n,), positive to
    its left.
    """
    return np.asarray(np.einsum("nd,nd->n", points - curve(s), _frame(curve, s)[1]))


def curvature(curve: BSpline, s: Array) -> Array:
    """Curvature (n,) in 1/mm of a curve at arc lengths s (n,) in mm, positive where it bends to the
    right.
    """
    first, second = curve(s, 1), curve(s, 2)
    return np.asarray(-cross(first, second) / np.linalg.norm(first, axis=1) ** 3)


def _lengths(curve: BSpline, s: Array, points: Array) -> Array:
    """Arc lengths (n,) in mm of the curve's points that are nearest to the measured points (n, 2).
    s: (n,) first guess of these lengths, mm. Raises PointError where the curve is far longer than
        the way through the points.
    """
    tangent, _ = _frame(curve, s)
    speed = np.linalg.norm(curve(s, 1), axis=1)
    nearest = s + np.einsum("nd,nd->n", points - curve(s), tangent) / speed
    nearest = np.clip(nearest, 2 * s[0] - s[1], 2 * s[-1] - s[-2])  # no farther off the ends
    nearest = np.maximum.accumulate(nearest - nearest[0])
    fine = np.linspace(0, nearest[-1], min(FINE * len(s), MOST))
    lengths = np.interp(nearest, fine, chord_lengths(curve(fine)))
    if lengths[-1] > LONGER * chord_lengths(points)[-1]:
        raise folded(points)
    return np.asarray(lengths)


def _developed(curve: BSpline, s: Array) -> CubicSpline:
    """Height (mm) over arc length, up to the last of s (n,), of the curve bent open, as a spline.
    Its second derivative is the curvature, positive to the left, so that nothing depends on how the
    profile lies, and every circle is a parabola.
    """
    places = np.linspace(0, s[-1], min(FINE * len(s), MOST))
    return CubicSpline(places, -curvature(curve, places)).antiderivative(2)


def _bent(curve: BSpline, s: Array, points: Array, fit: _Fit, penalty: Array) -> BSpline:
    """Curve moved along its normals so that, bent open, it is the fit with weights penalty (rows,)
    to the points (n, 2) at arc lengths s (n,).
    """
    straight = _developed(curve, s)
    smooth = fit.curve(straight(s) + _off(curve, s, points), penalty)
    places = np.linspace(0, s[-1], 2 * len(fit.places))
    offset = smooth(places) - straight(places)
    moved = curve(places) + offset[:, None] * _frame(curve, places)[1]
    return make_interp_spline(places, moved, ORDER)
