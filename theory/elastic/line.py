"""Line contact of two cylinders: pressure, stresses and displacements of the half-plane, exactly.

Plane strain; lengths in mm, load in N over a contact `length`, stresses in MPa. The half-plane's
points are given as t across the line of contact and depth >= 0, with zeta = t + i depth and
s = sqrt(zeta^2 - w^2), which is analytic there; F(zeta) = int p/(zeta - t) dt
= pi p0 w/(zeta + s) gives stresses and displacements (Johnson, Contact Mechanics, 2.7 and 4.2).
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from railhead.theory.array_types import Array, Complex
from railhead.theory.elastic.hertz import Ellipse, Strip, contact_modulus, line_contact
from railhead.theory.elastic.subsurface import AxisExtrema, extrema


@dataclass(frozen=True, kw_only=True)
class LineContact(Strip):
    """Hertz line contact over a finite length: a strip with the attributes and methods of
    `theory.elastic.hertz.Ellipse` but `gap`, `curvature_x` and `curvature_y`, and:

    length: length of the contact line, mm.
    across: whether the width of the strip runs across the rail (y) instead of along the rail (x).
    datum: depth of the points between which the approach is measured, mm, in each body.
    approach: approach of those points, mm, which depends on the datum. Points at infinity have no
        finite approach in plane strain.
    shape: of the contact.
    """

    shape: ClassVar[str] = "line"

    length: float
    across: bool
    datum: float
    approach: float

    @property
    def a(self) -> float:
        """Half extent along the rail, mm."""
        return self.length / 2 if self.across else self.half_width

    @property
    def b(self) -> float:
        """Half extent across the rail, mm."""
        return self.half_width if self.across else self.length / 2

    @property
    def half_lengths(self) -> tuple[float, float]:
        """Half lengths along and across the rail that a mesh must resolve, mm: the half width
        twice, never half the length.
        """
        return self.half_width, self.half_width

    @property
    def outline(self) -> Array:
        """(5, 2) corners (x, y) of the closed outline of the patch, mm."""
        return np.array([[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]]) * (self.a, self.b)

    @property
    def load(self) -> float:
        """Normal force on the whole contact length, N."""
        return self.load_per_length * self.length

    @property
    def area(self) -> float:
        """Area of the patch, 2 half widths times the contact length, mm2."""
        return 2 * self.half_width * self.length

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Contact pressure in MPa at x along and y across the rail from the middle of the strip
        (mm, broadcast against each other). Zero outside of the strip and beyond its ends.
        """
        across, along = (y, x) if self.across else (x, y)
        inside = np.abs(np.asarray(along)) <= self.length / 2
        return np.asarray(self.pressure_across(across) * inside)

    def axis_stress(self, poisson: float, depth: ArrayLike) -> Array:
        """Normal stresses along x (along the rail), y (across) and z, (n, 3), MPa, tension
        positive, at depths (n,), mm, below the middle of the strip. ValueError: a negative depth.
        """
        found = super().axis_stress(poisson, depth)
        return found if self.across else found[:, [1, 0, 2]]

    def axis_extrema(self, poisson: float) -> AxisExtrema:
        """Largest shear and largest von Mises stress below the middle of the strip, MPa, with their
        depths, mm. For nu = 0.3 the shear stress is 0.300 p0 at 0.786 half widths.
        """

        def stress_at(depth: ArrayLike) -> Array:
            """Stress (n, 6) on the axis at depths (n,), mm; the shears are zero."""
            normal = self.axis_stress(poisson, depth)
            return np.hstack([normal, np.zeros_like(normal)])

        return extrema(stress_at, self.half_width)

    def displacement(self, points: Array, young: float, poisson: float) -> Array:
        """Displacement (n, 3), mm, components x along the rail, y across, z up, of a half-plane
        under the pressure, at points (n, 3), z <= 0, mm, from the middle of the strip. young: MPa.
        Zero below the middle at the depth of the datum; nothing depends on the place along the
        line.
        """
        side = int(self.across)
        flat = displacement(self, points[:, side], -points[:, 2], young, poisson, self.datum)
        moved = np.zeros_like(points)
        moved[:, side], moved[:, 2] = flat[:, 0], -flat[:, 1]
        return moved


Hertz = Ellipse | LineContact
"""Hertz's point contact or line contact; `LineContact` says which attributes both have."""


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
    """Line contact under a normal force on the whole length (`load`, N) or, where that is None, an
    approach (mm) of the datum points. These lie one relative radius 1/curvature from the contact.
    Beside a load the approach has no effect.

    curvature: relative curvature across the line, 1/mm.
    moduli: Young's moduli of both bodies, MPa.
    poisson: Poisson's ratios of both bodies.
    length: length of the line, mm.
    across: whether the width of the strip runs across the rail.
    ValueError: a load, curvature or length that is not positive and finite; a modulus not above 0
        (infinite is rigid); a Poisson's ratio outside of (-1, 0.5]; two rigid bodies; an approach
        that no half width below the radius makes.
    """
    if not (0 < curvature < math.inf and 0 < length < math.inf):
        raise ValueError(f"curvature and length must be positive, got {curvature}, {length}")
    datum = 1 / curvature
    modulus = contact_modulus(moduli[0], poisson[0], moduli[1], poisson[1])

    def under(load: float) -> LineContact:
        """The line contact under a load in N."""
        strip = line_contact(curvature, modulus, load / length)
        centre = np.zeros(1)
        sunk = sum(
            float(displacement(strip, centre, centre, e, nu, datum)[0, 1])
            for e, nu in zip(moduli, poisson, strict=True)
        )
        return LineContact(**vars(strip), length=length, across=across, datum=datum, approach=sunk)

    if load is not None:
        return under(load)
    target = float(approach or 0.0)
    # The approach grows with the load until the half width is of the order of the radius.
    largest = math.log(modulus * length / curvature / 10)
    log_load = brentq(lambda v: under(math.exp(v)).approach - target, largest - 40, largest)
    return under(math.exp(log_load))


def displacement(
    strip: Strip, t: ArrayLike, depth: ArrayLike, young: float, poisson: float, datum: float
) -> Array:
    """Displacement (n, 2), mm, along t and into the body, of the half-plane under a strip; zero at
    t = 0, depth = datum.

    t, depth, datum: mm; young: MPa. Love's potentials for a line load: u_t = -(d psi_t + (1 - 2 nu)
        psi1_t)/(2 pi G) and inwards (2 (1 - nu) psi - d psi_d)/(2 pi G), psi = -Re int p ln(zeta -
        t) dt, psi1_t its conjugate. An infinite modulus gives no displacement.
    """
    points = np.concatenate([np.ravel(t), [0.0]]), np.concatenate([np.ravel(depth), [datum]])
    zeta, root = _coordinates(strip, *points)
    F = np.pi * strip.p0 * strip.half_width / (zeta + root)
    log = strip.load_per_length * (
        zeta / (zeta + root) - 0.5 + np.log((zeta + root) / 2)
    )  # int p ln(zeta - t) dt
    sideways = log.imag - strip.load_per_length * np.pi / 2
    scale = (1 + poisson) / (np.pi * young)  # 1/(2 pi G)
    u = scale * (points[1] * F.real + (1 - 2 * poisson) * sideways)
    down = scale * (-2 * (1 - poisson) * log.real - points[1] * F.imag)
    return np.column_stack([u[:-1], down[:-1] - down[-1]])


def _coordinates(strip: Strip, t: Array, depth: Array) -> tuple[Complex, Complex]:
    """zeta = t + i depth and the root sqrt(zeta^2 - b^2) that tends to zeta far away; b is the half
    width of the strip. Arrays of complex numbers.
    """
    zeta = t + 1j * (np.maximum(depth, 0.0) + 0.0)
    return zeta, np.sqrt(zeta - strip.half_width) * np.sqrt(zeta + strip.half_width)


def cylinder_approach(strip: Strip, radius: float, young: float, poisson: float) -> float:
    """Approach (mm) of the axis of an elastic cylinder to the contact: F' (1 - nu^2)/(pi E) (2 ln(4
    R/b) - 1), with F' the load per length in N/mm and b the half width (Johnson, 5.58). The
    opposite side of the cylinder carries the same load.

    radius: R in mm; young: E in MPa, infinite for a rigid cylinder, which gives 0. Roark's Formulas
        have 2/3 + 2 ln(2 R/b) in the bracket, 0.28 more.
    """
    scale = strip.load_per_length * (1 - poisson**2) / (math.pi * young)
    return scale * (2 * math.log(4 * radius / strip.half_width) - 1)


class Strips:
    """Stresses of the half-plane at n points below m strips side by side, each with a constant
    pressure and traction. With F(zeta) = int p/(zeta - t) dt at zeta = x + i d, and G the same of
    the traction, the stresses are (Johnson, Contact Mechanics, 2.5)

        xx = (Im F + d Re F' - 2 Re G + d Im G')/pi      zz = (Im F - d Re F' - d Im G')/pi
        xz = (d Im F' - Im G - d Re G')/pi               yy = nu (xx + zz)

    at x across the strips and the depth d.

    poisson: Poisson's ratio.
    """

    def __init__(self, edges: Array, x: Array, depth: Array, poisson: float) -> None:
        """edges: ends of the strips (m + 1,), ascending, mm; x, depth: of the points (n,), mm, at a
        depth above 0.
        """
        self.poisson, self._depth = poisson, depth
        zeta = (x + 1j * depth)[:, None] - edges
        self._log, self._slope = np.log(zeta), 1 / zeta

    def stress(self, pressure: Array, traction: Array | None = None) -> Array:
        """Stress (n, 4), columns xx, yy, zz, xz (z upwards), MPa, tension positive. pressure:
        (m,), MPa. traction: (m,) on the half-plane along +x, MPa; None: zero.
        """
        F, slope = self._potential(pressure)
        d = self._depth
        xx, zz, xz = F.imag + d * slope.real, F.imag - d * slope.real, d * slope.imag
        if traction is not None:
            G, bent = self._potential(traction)
            xx += -2 * G.real + d * bent.imag
            zz += -d * bent.imag
            xz += -G.imag - d * bent.real
        columns = [xx, self.poisson * (xx + zz), zz, xz]
        return np.asarray(np.column_stack(columns) / np.pi, dtype=np.float64)

    def _potential(self, values: Array) -> tuple[Complex, Complex]:
        """int v/(zeta - t) dt and its derivative by zeta at the points, each (n,), of values v (m,)
        on the strips.
        """
        jumps = np.diff(values, prepend=0.0, append=0.0).astype(np.complex128)
        return self._log @ jumps, self._slope @ jumps
