"""The pressure on a patch of any shape, from the moments of the computed one.

p = sqrt(max(F, 0)) with F(x, s) = sum_k x^k c_k(s), cubic splines c_k: bodies are smooth along the
rail and may have joints of arcs across it. The computed pressure p_h oscillates
from point to point, but its integrals against smooth functions are accurate. F is the minimum of
the convex functional

    int 2/3 F+^(3/2) dA - int p_h F dA + 1/2 int r |D3 F|^2

so int p G = int p_h G for every G of that space, up to the term with the roughness r. D3 F holds
the third derivatives of F (P. Eilers and B. Marx, Statist. Sci. 11, 1996, penalise splines in the
same way). Where F is a polynomial of degree 2 they vanish, and F is Hertz's ellipsoid by second
moments.

Units of length in D3 F: across, an element; along, half the width of the box, since third
derivatives along are small for bodies of one radius along the rail. The change across of the
curvature along is measured in elements in both directions. Otherwise a patch with a neck would be
as uncertain on a fine mesh as on a coarse one. r is small inside, where joints of arcs bend F. It
is large near the ends across, where F would otherwise follow facets that are half in contact.
"""

import math
from dataclasses import dataclass, replace
from math import comb

import numpy as np
import scipy.sparse as sp
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import BSpline
from scipy.linalg import cho_factor, cho_solve

from railhead.postprocess.findings import Array

DEGREE = 4  # of F along the rail
UNEVEN_DEGREE = 8  # of an uneven F: with 4 the largest pressure of a sphere that yields at 20 times
# its first-yield load is 7.5 % too high on six elements, with 8 it is 1.5 %
NECK = 3.0  # elements: the unit of length along, in the change across of the curvature along
ROUGHNESS = 1e-5  # r of a spline with INTERVALS intervals
INTERVALS = 16  # r grows with their number squared; else finer meshes would scatter as much
END_ZONE, END_EXPONENT = 6.0, 6  # r grows like (1 + (6 elements / distance from the end)^6)
BOX_MARGIN = 0.8  # elements of the box around the points with pressure
ROWS, COLUMNS = 6, 120  # points of integration: a spline's interval, and the box along x
LINE_ROWS = 60  # of a section, where no second direction averages the end of the patch
NEWTON_STEPS, CONVERGED = 80, 1e-10  # of the functional
DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-9, 1e6  # of the tangent, over its diagonal
SETTLED = 1e-8  # of the functional: what Newton's method may still promise at the end
NEIGHBOURHOOD = 1.5  # elements, see `misfit`
EDGE = 0.02  # of the largest pressure: below it the tangent of sqrt(F) is that of this pressure
Box = tuple[tuple[float, float], tuple[float, float]]
"""(lowest, highest) place along x and along s, mm."""


@dataclass(frozen=True, kw_only=True)
class Samples:
    """Contact points with pressure of a whole patch, mirror images included, in its tangent plane.

    x, s (k,): coordinates, mm; of a section x is 0 and s the coordinate along the section.
    force (k,): pressure times the area of each point, projected to the plane, N. The area of a
        plane section is that over its thickness, of a meridian half of the circle's on either side
        of the axis.
    pressure (k,): MPa.
    size (k,): size of the element of each point, mm: sqrt(2 facet area), of a section its length.
    even: whether the patch is symmetric about x = 0, where the model was cut; True for a section.
    limits: (lowest, highest) place of the contact surface along x and along s, mm; of a section
        (-1, 1) along x.
    section: whether the points are those of a plane or meridian section, where the pressure depends
        on s only.
    revolved: whether that section is a meridian of a body of revolution.
    thickness: length of a plane section across its plane, mm.
    yields: whether the solution has plastic strains.
    rubs: whether unlike materials rub, so that tractions bend the pressure.
    uneven: whether the pressure changes along x within elements: where bodies yield or rub, and
        where a polynomial of fourth degree was found not to follow it.
    """

    x: Array
    s: Array
    force: Array
    pressure: Array
    size: Array
    even: bool
    limits: Box
    section: bool = False
    revolved: bool = False
    thickness: float = 1.0
    yields: bool = False
    rubs: bool = False
    uneven: bool = False

    @property
    def degree(self) -> int:
        """Highest power of x in the polynomial for p^2; higher of an uneven one, 0 of a section."""
        return 0 if self.section else UNEVEN_DEGREE if self.uneven else DEGREE

    def measure(self, s: Array) -> Array:
        """Weight at s (n,) by which an integral over (x, s) becomes one over the contact area: 1
        for bodies in space. Of a section it is the length of the contact at s, mm: the
        thickness, or half a circle pi |s|.
        """
        return np.pi * np.abs(s) if self.revolved else np.full_like(s, self.thickness)


@dataclass(frozen=True)
class SquaredPressure:
    """Smooth p^2 = F(x, s) of a patch in a box, MPa^2; negative outside of the patch. x and s are
    coordinates of its samples: along and across the rail in a tangent plane.

    box: (lowest, highest) place along x and along s, mm.
    knots (n + 4,): of the n cubic splines in s, mm.
    coefficients (k, n): factors of each of k powers of (x - middle)/half times each of n splines,
        MPa^2; middle and half are the centre and half the width of the box along x.
    powers (k,): exponents of (x - middle)/half.
    settled: whether the minimisation that gave the coefficients converged; True where there was
        none.
    exponent: g of p = F^g, where F is in MPa^(1/g): 1/2, or more where the pressure ends less
        steeply than as a square root.
    """

    box: Box
    knots: Array
    coefficients: Array
    powers: Array
    settled: bool = True
    exponent: float = 0.5

    @property
    def middle(self) -> float:
        """Coordinate x of the centre of the box, mm."""
        return sum(self.box[0]) / 2

    @property
    def half(self) -> float:
        """Half the width of the box along x, by which x is scaled in the powers, mm."""
        return (self.box[0][1] - self.box[0][0]) / 2

    def _along(self, x: Array) -> Array:
        """Powers (k, n) of (x - middle)/half at x (n,), mm, where middle and half are the centre
        and half the width of the box along x.
        """
        return np.asarray(((x - self.middle) / self.half) ** self.powers[:, None])

    def grid(self, x: Array, s: Array) -> Array:
        """Smooth p^2 (m, n), MPa^2, on the grid of x (n,) and s (m,), mm, which must lie in the
        box.
        """
        return self._squared(_splines(self.knots, s) @ self.coefficients.T @ self._along(x))

    def _squared(self, values: Array) -> Array:
        """p^2, MPa^2, negative outside of the patch, from values of F."""
        if self.exponent != 0.5:
            values = np.sign(values) * np.abs(values) ** (2 * self.exponent)
        return np.asarray(values)

    def __call__(self, x: Array, s: Array) -> Array:
        """Smooth p^2 (n,), MPa^2, at points x (n,), s (n,), mm; minus infinity outside the box."""
        (x0, x1), (s0, s1) = self.box
        inside = (x >= x0) & (x <= x1) & (s >= s0) & (s <= s1)
        across = _splines(self.knots, np.clip(s, s0, s1)) @ self.coefficients.T
        values = self._squared(np.sum(across.T * self._along(x), axis=0))
        return np.where(inside, values, -np.inf)


def zero_squared_pressure(samples: Samples) -> SquaredPressure:
    """A smooth p^2 that is zero everywhere, with a box around the samples and with spline knots one
    element size apart.
    """
    knots = _knots(samples)
    step = 2 if samples.even else 1
    powers = np.arange(0, samples.degree + 1, step, dtype=np.float64)
    return SquaredPressure(_box(samples), knots, np.zeros((len(powers), len(knots) - 4)), powers)


def reconstruct(
    samples: Samples,
    roughness: float = ROUGHNESS,
    start: SquaredPressure | None = None,
    exponent: float = 0.5,
) -> SquaredPressure:
    """Smooth p = F^g that minimises int F+^(1 + g)/(1 + g) dA - int p_h F dA + 1/2 int r |D3 F|^2,
    by Newton's method with the damping of Levenberg and Marquardt.

    F+ is the positive part of F, p_h the computed pressure, D3 F the third derivatives of F, g the
    `exponent`. roughness: the factor r. start: a result for the same samples and exponent from
    which the iteration starts; None: it starts from Hertz's ellipsoid. A result that did not
    converge is returned, too: see `SquaredPressure.settled`.
    """
    like = replace(zero_squared_pressure(samples), exponent=exponent)
    knots, powers, middle, half = like.knots, like.powers, like.middle, like.half
    n, top = len(knots) - 4, float(samples.pressure.max())
    unit = top ** (1 / exponent)  # of F

    inner = knots[3:-3]
    width = np.diff(inner)
    count = LINE_ROWS if samples.section else ROWS
    s = (inner[:-1, None] + width[:, None] * (np.arange(count) + 0.5) / count).ravel()
    rows = np.repeat(width / count, count) * samples.measure(s)
    across = _splines(knots, s)
    along: Array = np.ones((1, 1))
    cell: Array = rows
    if not samples.section:
        x = (np.arange(COLUMNS) + 0.5) * 2 / COLUMNS - 1
        along, cell = x ** powers[:, None], rows * 2 * half / COLUMNS
    force = samples.force / top
    each = ((samples.x - middle) / half) ** powers[:, None]
    moments = np.stack([_splines(knots, samples.s).T @ (force * power) for power in each])
    scale = float(cell.sum() * along.shape[1])  # the box, in mm2
    moments, cell = np.asarray(moments.ravel() / scale), np.asarray(cell / scale)
    roughness *= ((len(knots) - 7) / INTERVALS) ** 2
    penalty = roughness * _penalty(knots, powers, s, rows / rows.sum(), samples)

    def field(c: Array) -> Array:
        """Smooth p^2 (m, n) over the largest computed pressure squared, on the integration points
        of the box, from coefficients c (kn,) of k powers and n splines.
        """
        return np.asarray((across @ c.reshape(-1, n).T) @ along)

    def value(c: Array) -> float:
        """Value of the functional to be minimised, made dimensionless, for coefficients c (kn,)."""
        volume = cell @ (np.maximum(field(c), 0.0) ** (1 + exponent)).sum(axis=1)
        return float(volume / (1 + exponent) - moments @ c + 0.5 * c @ penalty @ c)

    splines, columns = _products(across), (along[:, None] * along).reshape(-1, along.shape[1])
    c = _start(samples, like) if start is None else np.asarray(start.coefficients.ravel() / unit)
    best, damping = value(c), DAMPING
    for _ in range(NEWTON_STEPS):
        squared = field(c)
        pressure = np.maximum(squared, 0.0) ** exponent
        gradient = (across.T @ (pressure @ along.T * cell[:, None])).T.ravel()
        gradient = gradient - moments + penalty @ c
        slope = np.where(
            squared > 0, exponent / np.maximum(pressure, EDGE) ** (1 / exponent - 1), 0.0
        )
        blocks = splines @ (cell[:, None] * (slope @ columns.T))
        tangent = blocks.reshape(n, n, len(along), len(along)).transpose(2, 0, 3, 1)
        tangent = tangent.reshape(len(c), len(c)) + penalty
        diagonal = np.diag(np.diag(tangent))
        while damping < MOST_DAMPING:
            step = -cho_solve(cho_factor(tangent + damping * diagonal), gradient)
            decrease = float(gradient @ step)
            if (found := value(c + step)) <= best + 1e-4 * decrease:
                break
            damping *= 10
        else:
            break
        c, best, damping = c + step, found, max(damping / 10, LEAST_DAMPING)
        if -decrease < CONVERGED * abs(best) and damping < DAMPING:
            break
    left = gradient @ cho_solve(cho_factor(tangent + LEAST_DAMPING * diagonal), gradient)
    settled = bool(left < SETTLED * abs(best))
    return replace(like, coefficients=unit * c.reshape(-1, n), settled=settled)


def misfit(square: SquaredPressure, samples: Samples) -> tuple[float, float]:
    """Relative L2 difference of smooth and computed pressure: of points, where the computed one
    oscillates, and of their means over squares of 1.5 (NEIGHBOURHOOD) elements, where it does not.
    """
    area, side = samples.force / samples.pressure, NEIGHBOURHOOD * float(samples.size.mean())
    off = samples.pressure - np.sqrt(np.maximum(square(samples.x, samples.s), 0.0))
    cells = np.floor(np.column_stack([samples.x, samples.s]) / side)
    _, number = np.unique(cells, axis=0, return_inverse=True)
    of_cells = np.bincount(number, area * off) ** 2 / np.bincount(number, area)
    whole = float(samples.force @ samples.pressure)
    return math.sqrt(area @ off**2 / whole), math.sqrt(of_cells.sum() / whole)


def _products(across: sp.csr_matrix) -> sp.csr_matrix:
    """Products (nn, m), sparse, of each two of the n cubic B-splines with values (m, n); four of
    them are not zero at a point.
    """
    m, n = across.shape
    values, at = across.data.reshape(m, 4), across.indices.reshape(m, 4).astype(np.int64)
    pairs = at[:, :, None] * n + at[:, None, :]
    products = values[:, :, None] * values[:, None, :]
    points = np.repeat(np.arange(m), 16)
    return sp.csr_matrix((products.ravel(), (pairs.ravel(), points)), shape=(n * n, m))


def _splines(knots: Array, s: Array) -> sp.csr_matrix:
    """Values (m, n), sparse, of the n cubic B-splines with these knots at s (m,)."""
    return BSpline.design_matrix(s, knots, 3).tocsr()


def _box(samples: Samples) -> Box:
    """Extents along x and along s of the samples with a margin of 0.8 (BOX_MARGIN) elements, cut at
    the ends of the contact surface, mm.
    """
    margin = BOX_MARGIN * float(samples.size.mean())
    ends = [
        (max(float(t.min()) - margin, low), min(float(t.max()) + margin, high))
        for t, (low, high) in zip((samples.x, samples.s), samples.limits, strict=True)
    ]
    return ends[0], ends[1]


def _knots(samples: Samples) -> Array:
    """Knots of the cubic splines in s, mm, ascending: one element size apart, at least four
    intervals, with three more knots beyond either end.
    """
    low, high = _box(samples)[1]
    bins = max(int(2 * (high - low) / samples.size.mean()), 4)
    edges = np.linspace(low, high, bins + 1)
    count, _ = np.histogram(samples.s, edges)
    total, _ = np.histogram(samples.s, edges, weights=samples.size)
    known = np.flatnonzero(count)
    size = np.interp(np.arange(bins), known, total[known] / count[known])
    passed = np.concatenate([[0.0], np.cumsum(np.diff(edges) / size)])
    intervals = max(int(np.ceil(passed[-1])), 4)
    inner = np.interp(np.linspace(0, passed[-1], intervals + 1), passed, edges)
    inner[[0, -1]] = low, high
    first, last = inner[1] - inner[0], inner[-1] - inner[-2]
    return np.concatenate([low - first * np.arange(3, 0, -1), inner, high + last * np.arange(1, 4)])


def _penalty(knots: Array, powers: Array, s: Array, weight: Array, samples: Samples) -> Array:
    """Matrix (kn, kn) of the mean of r |D3 F|^2, without the constant factor of r, for coefficients
    of k powers and n splines. D3 F are the third derivatives of F(x, s).

    Derivatives along s are per interval of the splines, those along x per half width of the box. In
    the term with two derivatives along x and one along s, the unit along x is three elements
    (NECK). Of an uneven pressure the unit along x is one element throughout: edges of a plateau and
    peaks are as sharp along x as along s.

    s (m,): points of integration, mm. weight (m,): their weights, which add up to 1.
    """
    inner = knots[3:-3]
    width = np.interp(s, (inner[1:] + inner[:-1]) / 2, np.diff(inner))
    margin = BOX_MARGIN * float(samples.size.mean())
    inside = np.minimum(s - inner[0], inner[-1] - s) - margin
    distance = np.maximum(inside / samples.size.mean(), 0.0) + 0.5
    weight = weight * (1 + (END_ZONE / distance) ** END_EXPONENT)
    at, share = leggauss(samples.degree + 2)
    x0, x1 = _box(samples)[0]
    element = 2 * float(samples.size.mean()) / (x1 - x0)
    units = [1.0, element, element, element] if samples.uneven else [1.0, 1.0, NECK * element, 1.0]
    total = np.zeros((len(powers) * (len(knots) - 4),) * 2)
    splines = BSpline(knots, np.eye(len(knots) - 4), 3)
    for order in range(4):  # of the derivative along x
        along: Array = np.stack([Polynomial.basis(int(k)).deriv(order)(at) for k in powers])
        across = splines(s, nu=3 - order) * width[:, None] ** (3 - order)
        total += (
            comb(3, order)
            * units[order] ** (2 * order)
            * np.kron(along * share / 2 @ along.T, across.T @ (across * weight[:, None]))
        )
    return total


def ellipsoid(
    like: SquaredPressure,
    centre: tuple[float, float],
    semi: tuple[float, float],
    peak: float,
    bulge: tuple[float, float] = (0.0, 0.0),
) -> SquaredPressure:
    """p^2 = p0^2 (1 - u - v) (1 + alpha u + beta v) with u = (x - xc)^2/a^2, v = (s - sc)^2/b^2:
    Hertz's without a bulge, then represented exactly; else fitted by the splines.

    like: gives the box, the knots and the powers. centre: (xc, sc), mm. semi: (a, b), mm. peak: p0,
        MPa. bulge: (alpha, beta). Of a section the terms in x are left out.
    """
    places, (alpha, beta) = np.linspace(*like.box[1], 4 * len(like.knots)), bulge
    u = Polynomial([like.middle - centre[0], like.half]) ** 2 / semi[0] ** 2
    v = (places - centre[1]) ** 2 / semi[1] ** 2
    u = u if len(like.powers) > 1 else Polynomial([0.0])
    factors = 1 + (beta - 1) * v - beta * v**2, alpha - 1 - (alpha + beta) * v, 0 * v - alpha
    values = sum(
        np.outer(np.pad(term.coef, (0, UNEVEN_DEGREE))[like.powers.astype(int)], factor)
        for term, factor in zip((u**0, u, u**2), factors, strict=True)
    )
    c = np.linalg.lstsq(_splines(like.knots, places).toarray(), np.transpose(values), rcond=None)[0]
    return replace(like, coefficients=peak**2 * c.T)


def _start(samples: Samples, like: SquaredPressure) -> Array:
    """Coefficients (kn,) of Hertz's ellipsoid with the force and second moments of the samples,
    divided by the largest computed pressure squared.
    """
    share = samples.force / samples.force.sum()
    least = (0.5 * float(samples.size.mean())) ** 2
    xc, sc = float(share @ samples.x), float(share @ samples.s)
    a, b = (
        float(np.sqrt(max(5 * float(share @ (t - m) ** 2), least)))
        for t, m in ((samples.x, xc), (samples.s, sc))
    )
    peak = 1.5 * float(samples.force.sum()) / (np.pi * a * b) / float(samples.pressure.max())
    peak = 1.0 if samples.section else peak
    return ellipsoid(like, (xc, sc), (a, b), peak).coefficients.ravel()
