"""Line contact of two cylinders: pressure, stresses and displacements of the half-plane, exactly.

Plane strain; lengths in mm, load in N over a contact `length`, stresses in MPa. The half-plane's
points are given as t across the line of contact and depth >= 0, with zeta = t + i depth and
s = sqrt(zeta^2 - w^2), which is analytic there; F(zeta) = int p/(zeta - t) dt
= pi p0 w/(zeta + s) gives stresses and displacements (Johnson, Contact Mechanics, 2.7 and 4.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from railhead.theory.elastic.hertz import Strip, contact_modulus, line_contact
from railhead.theory.elastic.subsurface import AxisExtrema, line_axis_stress, max_shear, von_mises

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LineContact:
    """Hertz's strip over a contact length, with the attributes of `theory.elastic.hertz.Ellipse`.

    across: whether the strip's width runs across the rail (s) instead of along it (x). approach:
    of the points one `datum` (mm) below and above the contact; a half-plane has no other.
    """

    strip: Strip
    length: float
    across: bool
    datum: float
    approach: float

    @property
    def half_width(self) -> float:
        """Half width of the strip, mm."""
        return self.strip.b

    @property
    def a(self) -> float:
        """Half extent along the rail, mm."""
        return self.length / 2 if self.across else self.half_width

    @property
    def b(self) -> float:
        """Half extent across the rail, mm."""
        return self.half_width if self.across else self.length / 2

    @property
    def p0(self) -> float:
        """Largest pressure, MPa."""
        return self.strip.p0

    @property
    def p_mean(self) -> float:
        """Mean pressure, MPa: pi/4 of the largest."""
        return self.strip.p_mean

    @property
    def load(self) -> float:
        """Normal force on the whole contact length, N."""
        return self.strip.load_per_length * self.length

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E*, MPa: 1/E* is the sum of (1 - nu^2)/E of both bodies."""
        return self.strip.contact_modulus

    @property
    def area(self) -> float:
        """Area of the patch, half width times two times contact length, mm2."""
        return 2 * self.half_width * self.length

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Contact pressure in MPa at x along and y across the rail (mm, broadcast against each
        other), zero outside of the strip.
        """
        across, along = (y, x) if self.across else (x, y)
        inside = np.abs(np.asarray(along)) <= self.length / 2
        return np.asarray(self.strip.pressure(across) * inside)


def contact(
    curvature: float,
    moduli: tuple[float, float],
    poisson: tuple[float, float],
    *,
    length: float,
    across: bool,
    load: float | None = None,
    approach: float | None = None,
) -> LineContact:
    """Line contact under a load (N) or, where that is None, an approach (mm) of the datum points,
    which lie one relative radius 1/curvature from the contact.

    moduli, poisson: E (MPa) and nu of both bodies. ValueError: see `theory.elastic.hertz`.
    """
    datum = 1 / curvature
    modulus = contact_modulus(moduli[0], poisson[0], moduli[1], poisson[1])

    def under(load: float) -> LineContact:
        strip = line_contact(curvature, modulus, load / length)
        centre = np.zeros(1)
        sunk = sum(
            float(displacement(strip, centre, centre, e, nu, datum)[0, 1])
            for e, nu in zip(moduli, poisson, strict=True)
        )
        return LineContact(strip, length, across, datum, sunk)

    if load is not None:
        return under(load)
    target = float(approach or 0.0)
    # The approach grows with the load until the half width is of the order of the radius.
    largest = math.log(modulus * length / curvature / 10)
    log_load = brentq(lambda v: under(math.exp(v)).approach - target, largest - 40, largest)
    return under(math.exp(log_load))


def stress(strip: Strip, poisson: float, t: ArrayLike, depth: ArrayLike) -> Array:
    """(n, 4) stresses across (tt), normal (nn), shear (tn, n upwards) and out of plane, MPa.

    tt = -(2/pi)(... ) from the potential: nn = (psi_d - d psi_dd)/pi, tt = (psi_d + d psi_dd)/pi,
    tn = d psi_td/pi with psi_t - i psi_d = -F(zeta) (Johnson, 2.23, as Love's potentials).
    """
    t, depth = np.broadcast_arrays(np.asarray(t, float), np.asarray(depth, float))
    zeta, root = _coordinates(strip, t, depth)
    F = np.pi * strip.p0 * strip.b / (zeta + root)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(depth > 0, -F / root, 0.0)  # dF/dzeta
    psi_d, psi_dd, psi_td = F.imag, slope.real, slope.imag
    nn, tt = (psi_d - depth * psi_dd) / np.pi, (psi_d + depth * psi_dd) / np.pi
    return np.column_stack([tt, nn, depth * psi_td / np.pi, poisson * (tt + nn)])


def displacement(
    strip: Strip, t: ArrayLike, depth: ArrayLike, young: float, poisson: float, datum: float
) -> Array:
    """(n, 2) displacement (outwards along t, into the body) in mm, zero at t = 0, depth = datum.

    Love's potentials for a line load: u_t = -(d psi_t + (1 - 2 nu) psi1_t)/(2 pi G) and inwards
    (2 (1 - nu) psi - d psi_d)/(2 pi G), psi = -Re int p ln(zeta - t) dt, psi1_t its conjugate.
    An infinite modulus gives no displacement.
    """
    points = np.concatenate([np.ravel(t), [0.0]]), np.concatenate([np.ravel(depth), [datum]])
    zeta, root = _coordinates(strip, *points)
    F = np.pi * strip.p0 * strip.b / (zeta + root)
    log = strip.load_per_length * (
        zeta / (zeta + root) - 0.5 + np.log((zeta + root) / 2)
    )  # int p ln(zeta - t) dt
    sideways = log.imag - strip.load_per_length * np.pi / 2
    scale = (1 + poisson) / (np.pi * young)  # 1/(2 pi G)
    u = scale * (points[1] * F.real + (1 - 2 * poisson) * sideways)
    down = scale * (-2 * (1 - poisson) * log.real - points[1] * F.imag)
    return np.column_stack([u[:-1], down[:-1] - down[-1]])


def hertz_displacement(contact: LineContact, points: Array, young: float, poisson: float) -> Array:
    """Displacement (n, 3) of a half-plane under a line contact, mm, at points (n, 3) in space with
    z <= 0: the function `displacement` in axes of the rail.
    """
    side = 1 if contact.across else 0
    flat = displacement(
        contact.strip, points[:, side], -points[:, 2], young, poisson, contact.datum
    )
    moved = np.zeros_like(points)
    moved[:, side], moved[:, 2] = flat[:, 0], -flat[:, 1]
    return moved


def _coordinates(strip: Strip, t: Array, depth: Array) -> tuple[NDArray, NDArray]:
    """zeta and the branch of sqrt(zeta^2 - w^2) that behaves like zeta far away."""
    zeta = t + 1j * (np.maximum(depth, 0.0) + 0.0)
    return zeta, np.sqrt(zeta - strip.b) * np.sqrt(zeta + strip.b)


def axis_stress(line: LineContact, poisson: float, depth: ArrayLike) -> Array:
    """s_x, s_y, s_z (n, 3) below the middle of the strip, x along the rail and y across it."""
    found = line_axis_stress(line.strip, poisson, depth)
    return found if line.across else found[:, [1, 0, 2]]


def axis_extrema(line: LineContact, poisson: float) -> AxisExtrema:
    """Largest shear (0.300 p0 at 0.786 w for nu = 0.3) and von Mises stress on the axis."""

    def highest(invariant: object) -> tuple[float, float]:
        def value(depth: float) -> float:
            normal = axis_stress(line, poisson, depth)
            return float(invariant(np.hstack([normal, np.zeros_like(normal)]))[0])  # type: ignore

        depths = line.half_width * np.linspace(0.0, 3.0, 301)
        top = int(np.argmax([value(depth) for depth in depths]))
        bounds = depths[max(top - 1, 0)], depths[min(top + 1, 300)]
        best = minimize_scalar(
            lambda depth: -value(depth), bounds=bounds, method="bounded",
            options={"xatol": 1e-10 * line.half_width},
        )  # fmt: skip
        if value(0.0) >= -best.fun:
            return value(0.0), 0.0
        return -float(best.fun), float(best.x)

    return AxisExtrema(*highest(max_shear), *highest(von_mises))


def cylinder_approach(strip: Strip, radius: float, young: float, poisson: float) -> float:
    """Approach of a cylinder's axis to the contact, mm, when the other side carries the same load:
    F' (1 - nu^2)/(pi E) (2 ln(4 R/w) - 1), F' in N/mm, 0 for a rigid one (Johnson, 5.58).

    Roark's Formulas have 2/3 + 2 ln(2 R/w) in the bracket, 0.28 more.
    """
    scale = strip.load_per_length * (1 - poisson**2) / (math.pi * young)
    return scale * (2 * math.log(4 * radius / strip.b) - 1)
