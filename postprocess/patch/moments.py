"""Moments and maximum of the computed contact pressure, in space and in a section."""

import math
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from railhead.postprocess import symmetry
from railhead.postprocess.findings import HERTZIAN, Array, Frame
from railhead.solver.system.fields import Fields

HERTZ_MOMENTS = {(2, False): (5.0, 15 / 7), (1, False): (4.0, 2.0), (1, True): (5 / 2, 10 / 7)}
"""Of Hertz's pressure: semi-axis squared over <t^2>, and <t^4>/<t^2>^2, by the number of axes along
which it varies and by whether a section is revolved."""
PEAK_RADIUS = 0.6  # of the semi-axes: where p^2 is fitted for the largest pressure
PEAK_POINTS = 4  # for each coefficient of that fit, at least


@dataclass(frozen=True, kw_only=True)
class PressureMoments:
    """Moments of the computed contact pressure p in the contact frame.

    force: integral of p over the contact, images in symmetry planes included, N: the normal force,
        not the vertical load.
    centre: (x, s) of the centre of pressure, mm.
    a, b: semi-axes along x and s, mm, of Hertz's pressure with the same second moments <t^2> about
        the centre: sqrt(5 <x^2>) and sqrt(5 <s^2>) of an ellipse. In a section both are the same:
        the half width sqrt(4 <t^2>) of a strip, or the radius sqrt(5/2 <r^2>) of a meridian
        section.
    shape_error: largest deviation of normalised moments <f> = int p f / int p about the centre from
        those of a semi-ellipsoid, of x as of s. From <x^4>/<x^2>^2 = 15/7 and
        <x^2 s^2>/(<x^2> <s^2>) = 5/7 it is relative, from <x^3>/<x^2>^(3/2) = 0 absolute. In a
        section the values are those of Hertz's pressure there. Infinite where all points with
        pressure lie on a line.
    fourth: the relative deviations of <x^4> and of <s^4>; in a section both are the same.
    """

    force: float
    centre: tuple[float, float]
    a: float
    b: float
    shape_error: float
    fourth: tuple[float, float]

    @property
    def hertzian(self) -> bool:
        """Whether the shape error is below 2 % (HERTZIAN): the pressure is nearly Hertz's."""
        return self.shape_error < HERTZIAN


def moments(fields: Fields, frame: Frame) -> PressureMoments:
    """Moments of the contact pressure p at all contact points, of which some must carry pressure,
    with coordinates from the centre of pressure, which lies on each symmetry plane.

    A semi-axis is sqrt(f int p t^2 / int p) with f = 5 in space, 5/2 for the radius of a body of
    revolution and 4 for the half width of a line contact: exact for Hertz's pressure. Where all
    points with pressure lie on a line the shape error is infinite.
    """
    contact, axes = fields.contact, fields.kinematics.varying
    weight = contact.weights * contact.pressure
    total = weight.sum()
    cut = np.abs(np.array(fields.mirrors).reshape(-1, 3)[:, axes]).any(axis=0)
    t = frame.local(contact.points)[:, axes]
    mean = np.where(cut, 0.0, weight @ t / total)
    t = t - mean
    square = weight @ t**2 / total
    factor, fourth = HERTZ_MOMENTS[len(axes), fields.kinematics.revolved]
    deviations, off = np.array([np.inf]), np.zeros(2)
    if square.min() > 0:
        off = np.broadcast_to(weight @ t**4 / total / square**2 / fourth - 1, 2)
        third = np.where(cut, 0.0, weight @ t**3 / total / square**1.5)
        mixed = weight @ t.prod(axis=1) ** 2 / total / square.prod() / (5 / 7) - 1
        deviations = np.array([*off, *third, mixed if len(axes) == 2 else 0.0])
    centre = np.zeros(2)
    centre[axes] = mean
    a, b = np.broadcast_to(np.sqrt(factor * square), 2)
    return PressureMoments(
        force=fields.copies * float(total),
        centre=(float(centre[0]), float(centre[1])),
        a=float(a),
        b=float(b),
        shape_error=float(np.abs(deviations).max()),
        fourth=(float(off[0]), float(off[1])),
    )


def largest_pressure(fields: Fields, frame: Frame, found: PressureMoments) -> float:
    """Largest pressure, MPa: the maximum of a quadratic polynomial fitted to p^2 around the centre
    of pressure.

    found: moments that give the centre and the semi-axes. Points nearer to the centre than
        0.6 (PEAK_RADIUS) of the semi-axes are used. Hertz's p^2 is such a polynomial. Where fewer
        than four points for each coefficient lie there, the largest computed pressure is returned;
        where the polynomial has no maximum there, its largest value at the points.
    """
    contact, axes = fields.contact, fields.kinematics.varying
    local = symmetry.vectors(frame.local(contact.points)[:, :2], fields.mirrors)
    p = symmetry.repeated(contact.pressure, fields.mirrors)
    weight = symmetry.repeated(contact.weights, fields.mirrors)
    return fitted_peak(((local - found.centre) / (found.a, found.b))[:, axes], p, weight)


def fitted_peak(points: Array, p: Array, weight: Array) -> float:
    """Largest pressure, MPa, of a quadratic polynomial fitted to the square of pressures p (n,),
    MPa, at points (n, d) nearer to the origin than 0.6 (PEAK_RADIUS), with weights (n,); as
    `largest_pressure`.
    """
    near = (np.linalg.norm(points, axis=1) < PEAK_RADIUS) & (p > 0)
    x = points[near]
    if len(x) < PEAK_POINTS * math.comb(x.shape[1] + 2, 2):
        return float(p.max())
    middle, slope, hessian = quadratic_fit(x, p[near] ** 2, weight[near])
    if np.linalg.eigvalsh(hessian).max() < 0:
        top = np.linalg.solve(hessian, -slope)
        if np.linalg.norm(top) < PEAK_RADIUS:
            return float(np.sqrt(middle + 0.5 * slope @ top))
    return float(np.sqrt(np.max(middle + x @ slope + ((x @ hessian) * x).sum(axis=1) / 2)))


def quadratic_fit(points: Array, values: Array, weights: Array) -> tuple[float, Array, Array]:
    """Constant, slope (d,) and Hessian (d, d) of the quadratic polynomial that fits values (n,) at
    points (n, d) best, by least squares with weights (n,).
    """
    dim, root = points.shape[1], np.sqrt(weights)
    pairs = list(combinations_with_replacement(range(dim), 2))
    squares = (points[:, i] * points[:, j] for i, j in pairs)
    basis = np.column_stack([np.ones(len(points)), points, *squares])
    c = np.linalg.lstsq(basis * root[:, None], values * root, rcond=None)[0]
    hessian = np.zeros((dim, dim))
    for (i, j), value in zip(pairs, c[dim + 1 :], strict=True):
        hessian[i, j] += value
        hessian[j, i] += value
    return float(c[0]), c[1 : dim + 1], hessian
