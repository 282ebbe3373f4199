"""Hertz contact: patch, pressure and approach of two elastic bodies, frictionless.

Lengths are in mm, forces in N, stresses and moduli in MPa, curvatures in 1/mm. The x axis runs
along the rail and y across it; a is always the semi-axis along x and b the one along y, whichever
is larger. Elliptic integrals are taken in Carlson's symmetric forms R_D and R_F, which lose no
digits near the circle and need no case distinction between a > b and a < b.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import elliprd, elliprf

from railhead.theory.array_types import Array
from railhead.theory.elastic import halfspace
from railhead.theory.elastic.subsurface import EllipsoidalPressure, on_axis


@dataclass(frozen=True, kw_only=True)
class Ellipse(EllipsoidalPressure):
    """Hertz point contact of two elastic bodies, with the pressure's attributes a, b, p0 and:

    approach: approach of distant points of the bodies, mm.
    load: normal force, N.
    contact_modulus: E*, MPa; 1/E* is the sum of (1 - nu^2)/E of both bodies.
    curvature_x: relative curvature along x, 1/mm.
    curvature_y: relative curvature along y, 1/mm.
    """

    approach: float
    load: float
    contact_modulus: float
    curvature_x: float
    curvature_y: float

    @property
    def shape(self) -> str:
        """Shape of the patch: 'circular' or 'elliptic'."""
        return "circular" if math.isclose(self.a, self.b, rel_tol=1e-6) else "elliptic"

    @property
    def outline(self) -> Array:
        """(181, 2) points (x, y) of the closed outline of the patch, mm."""
        angle = np.linspace(0, 2 * np.pi, 181)
        return np.column_stack((self.a * np.cos(angle), self.b * np.sin(angle)))

    def displacement(self, points: Array, young: float, poisson: float) -> Array:
        """Displacement (n, 3), mm, components x, y, z (z up), of the half-space z <= 0 under the
        pressure, at points (n, 3), mm, from the centre of the patch; zero at infinity. young: MPa.
        """
        return halfspace.hertz_displacement(self, points, young, poisson)

    def gap(self, x: Array, y: Array) -> Array:
        """Gap of the undeformed surfaces, mm, at x along and y across the rail from the first
        contact (mm, broadcast against each other).
        """
        return (self.curvature_x * x**2 + self.curvature_y * y**2) / 2

    @property
    def area(self) -> float:
        """Patch area pi a b in mm^2."""
        return math.pi * self.a * self.b

    @property
    def p_mean(self) -> float:
        """Mean pressure load / area in MPa, two thirds of the peak."""
        return self.load / self.area

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Contact pressure p0 sqrt(1 - (x/a)^2 - (y/b)^2), MPa, zero outside; x, y in mm from the
        centre, broadcast.
        """
        inside = 1 - (np.asarray(x) / self.a) ** 2 - (np.asarray(y) / self.b) ** 2
        return np.asarray(self.p0 * np.sqrt(np.maximum(inside, 0)))


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Hertz line contact of two elastic bodies. y is the distance across the line from its middle,
    whichever way the line lies on the rail.

    half_width: across the line, mm.
    p0: largest pressure, MPa.
    load_per_length: load per length of the line, N/mm.
    contact_modulus: E*, MPa; 1/E* is the sum of (1 - nu^2)/E of both bodies.
    curvature: relative curvature across the line, 1/mm.
    """

    half_width: float
    p0: float
    load_per_length: float
    contact_modulus: float
    curvature: float

    @property
    def p_mean(self) -> float:
        """Mean pressure, MPa: pi/4 of the largest."""
        return self.load_per_length / (2 * self.half_width)

    def axis_stress(self, poisson: float, depth: ArrayLike) -> Array:
        """Normal stresses s_x, s_y, s_z (n, 3), MPa, at depths (n,), mm, below the middle of the
        strip, in plane strain. The line of contact lies along x here.

        With b the half width, z the depth and R = sqrt(b^2 + z^2): s_y = -p0 b^3/(R (R + z)^2), s_z
        = -p0 b/R, s_x = nu (s_y + s_z) (Johnson, Contact Mechanics, 4.46, multiplied out against
        cancellation). ValueError: a negative depth.
        """
        z = -on_axis(depth)[:, 2]
        b = self.half_width
        R = np.hypot(b, z)
        s_y = -self.p0 * b**3 / (R * (R + z) ** 2)
        s_z = -self.p0 * b / R
        return np.column_stack((poisson * (s_y + s_z), s_y, s_z))

    def pressure_across(self, y: ArrayLike) -> Array:
        """Contact pressure p0 sqrt(1 - (y/b)^2), MPa, zero outside; y in mm, b the half width."""
        inside = 1 - (np.asarray(y) / self.half_width) ** 2
        return np.asarray(self.p0 * np.sqrt(np.maximum(inside, 0)))


def contact_modulus(young_1: float, poisson_1: float, young_2: float, poisson_2: float) -> float:
    """Contact modulus E*, MPa: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 (Johnson, Contact
    Mechanics, 4.2).

    young_1, young_2: Young's moduli, MPa; math.inf is a rigid body. poisson_1, poisson_2: Poisson's
        ratios. ValueError: a modulus that is not positive, a Poisson ratio outside (-1, 0.5], or
        two rigid bodies.
    """
    for young, poisson in ((young_1, poisson_1), (young_2, poisson_2)):
        if not young > 0:
            raise ValueError(f"Young's modulus must be positive, got {young}")
        if not -1 < poisson <= 0.5:
            raise ValueError(f"Poisson's ratio must lie in (-1, 0.5], got {poisson}")
    if math.isinf(young_1) and math.isinf(young_2):
        raise ValueError("at least one body must be elastic, both moduli are infinite")
    return 1 / ((1 - poisson_1**2) / young_1 + (1 - poisson_2**2) / young_2)


def point_contact(
    curvature_x: float, curvature_y: float, contact_modulus: float, load: float
) -> Ellipse:
    """Hertz ellipse under a normal force F (`load`, N), for the gap curvature_x x^2/2 + curvature_y
    y^2/2 (curvatures in 1/mm, contact modulus E* in MPa).

    With k = b/a the pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) flattens that gap when curvature_x =
    F/(pi E* a^3) R_D(0, k^2, 1) and curvature_y = F/(pi E* a^3) R_D(0, 1, k^2), and the approach is
    3F/(2 pi E* a) R_F(0, 1, k^2) (Johnson, Contact Mechanics, 4.26 to 4.28, with the elliptic
    integrals in Carlson's forms). ValueError: an argument that is not positive and finite.
    """
    _require_positive(load=load, contact_modulus=contact_modulus)
    k = _axis_ratio(curvature_x, curvature_y)
    a = math.cbrt(load * elliprd(0, k * k, 1) / (math.pi * contact_modulus * curvature_x))
    approach = 3 * load * elliprf(0, 1, k * k) / (2 * math.pi * contact_modulus * a)
    p0 = 3 * load / (2 * math.pi * a * a * k)
    return Ellipse(
        a=a,
        b=k * a,
        p0=p0,
        approach=approach,
        load=load,
        contact_modulus=contact_modulus,
        curvature_x=curvature_x,
        curvature_y=curvature_y,
    )


def point_contact_from_approach(
    curvature_x: float, curvature_y: float, contact_modulus: float, approach: float
) -> Ellipse:
    """Hertz ellipse for the gap curvature_x x^2/2 + curvature_y y^2/2 (curvatures in 1/mm, contact
    modulus E* in MPa) at a given approach of distant points in mm.

    The load follows from the equations of `point_contact`. ValueError: an argument that is not
    positive and finite.
    """
    _require_positive(approach=approach, contact_modulus=contact_modulus)
    k = _axis_ratio(curvature_x, curvature_y)
    flatness = elliprd(0, k * k, 1)
    a = math.sqrt(2 * approach * flatness / (3 * curvature_x * elliprf(0, 1, k * k)))
    load = math.pi * contact_modulus * curvature_x * a**3 / flatness
    return point_contact(curvature_x, curvature_y, contact_modulus, load)


def pressure_rise(along: float, across: float, a: float, b: float) -> float:
    """Relative rise v of Hertz's largest pressure under the same force, where the surfaces get
    additional curvatures along a and along b; the area is divided by 1 + v. At most half of a
    curvature is taken away.

    along, across: over F/(pi E*), 1/mm^3, means of the bodies weighted by their compliance. a, b:
        semi-axes of the patch, mm.
    """
    own = np.array(halfspace.own_curvatures(a, b))
    x, y = np.maximum(own + [along, across], own / 2)
    more = point_contact(float(x), float(y), 1 / math.pi, 1.0)  # F/(pi E*) = 1
    return more.p0 * 2 * math.pi * a * b / 3 - 1


def line_contact(curvature: float, contact_modulus: float, load_per_length: float) -> Strip:
    """Hertz line contact: half width b = sqrt(4 F'/(pi E* curvature)), largest pressure p0 = 2
    F'/(pi b), with the load per length F' (N/mm), the contact modulus E* (MPa) and the relative
    curvature (1/mm).

    Johnson, Contact Mechanics, 4.43 and 4.45. ValueError: an argument that is not positive and
    finite.
    """
    _require_positive(
        curvature=curvature, contact_modulus=contact_modulus, load_per_length=load_per_length
    )
    b = math.sqrt(4 * load_per_length / (math.pi * contact_modulus * curvature))
    p0 = 2 * load_per_length / (math.pi * b)
    return Strip(
        half_width=b,
        p0=p0,
        load_per_length=load_per_length,
        contact_modulus=contact_modulus,
        curvature=curvature,
    )


def _axis_ratio(curvature_x: float, curvature_y: float) -> float:
    """Axis ratio k = b/a of Hertz's ellipse: root of curvature_x / curvature_y = R_D(0, k^2, 1) /
    R_D(0, 1, k^2).
    """
    _require_positive(curvature_x=curvature_x, curvature_y=curvature_y)
    target = math.log(curvature_x / curvature_y)

    def residual(log_k: float) -> float:
        """Logarithm of the ratio of both R_D minus that of the curvatures, at log k."""
        k2 = math.exp(2 * log_k)
        return math.log(elliprd(0, k2, 1) / elliprd(0, 1, k2)) - target

    reach = abs(target) + 1
    return math.exp(brentq(residual, -reach, reach, xtol=1e-15, rtol=1e-15))


def _require_positive(**values: float) -> None:
    """Raise ValueError for a value that is not positive and finite; names are for the message."""
    for name, value in values.items():
        if not (value > 0 and math.isfinite(value)):
            raise ValueError(f"{name} must be positive and finite, got {value}")
