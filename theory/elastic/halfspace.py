"""Displacements of the elastic half-space z <= 0 under a load that presses it in -z or a tangential
force, and what bodies that end add to them.

Points are (n, 3) in mm, displacements (n, 3) in mm with the components x, y, z (z up), and zero at
infinity. An infinite Young's modulus gives no displacement.

What a half-space leaves out: under a force F, a body that ends a distance away moves by that of a
half-space and a smooth rest. Over the patch the rest is a rigid motion, which changes the approach
alone, and a curvature, which adds to the relative curvature of the bodies.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad
from scipy.special import elliprd, elliprf

from railhead.theory.array_types import Array
from railhead.theory.elastic.subsurface import (
    EllipsoidalPressure,
    contact_potential,
    half_space_points,
)


def mirrored(points: Array, *, upwards: bool) -> tuple[Array, Array]:
    """Points (n, 3), mm, of a body at the plane z = 0 as those of the half-space z <= 0, and the
    signs (3,) that transform a displacement back. upwards: whether the body lies above the plane
    and is mirrored at it. Points that are then above the plane are moved onto it.
    """
    mirror = np.array([1.0, 1.0, -1.0 if upwards else 1.0])
    lower = points * mirror
    lower[:, 2] = lower[:, 2].clip(max=0.0)
    return lower, mirror


def cerruti_displacement(
    points: ArrayLike, load: float, young: float, poisson: float, *, across: bool = False
) -> Array:
    """Displacement (n, 3), mm, components x, y, z (z up), at points (n, 3), z <= 0, under a
    tangential point force of `load` N at the origin along x, or with `across` along y. young:
    MPa.

    With depth z, rho the distance and G the shear modulus (Johnson, Contact Mechanics, 3.74 and
    following): u_x = Q/(4 pi G) (1/rho + x^2/rho^3 + (1 - 2 nu) (1/(rho + z) - x^2/(rho (rho +
    z)^2))), u_y = Q/(4 pi G) x y (1/rho^3 - (1 - 2 nu)/(rho (rho + z)^2)), and downwards Q/(4 pi G)
    x (z/rho^3 + (1 - 2 nu)/(rho (rho + z))). ValueError: a point above the surface, at the origin,
    or another shape.
    """
    xyz = half_space_points(points)
    rho = np.linalg.norm(xyz, axis=1)
    if np.any(rho == 0):
        raise ValueError("points must lie away from the point force at the origin")
    x, y = xyz[:, 1 if across else 0], xyz[:, 0 if across else 1]
    depth, free = -xyz[:, 2], 1 - 2 * poisson
    sum_ = rho + depth
    along = 1 / rho + x**2 / rho**3 + free * (1 / sum_ - x**2 / (rho * sum_**2))
    aside = x * y * (1 / rho**3 - free / (rho * sum_**2))
    down = x * (depth / rho**3 + free / (rho * sum_))
    scale = load * (1 + poisson) / (2 * np.pi * young)
    columns = (aside, along, -down) if across else (along, aside, -down)
    return scale * np.column_stack(columns)


def hertz_displacement(
    contact: EllipsoidalPressure, points: ArrayLike, young: float, poisson: float
) -> Array:
    """Displacement (n, 3), mm, components x, y, z (z up), at points (n, 3), z <= 0, under the Hertz
    pressure of an ellipse. young: MPa.

    Love's formulas with the closed potentials (Johnson, Contact Mechanics, 3.2), with depth z and
    shear modulus G: u_x = -(z psi_x + (1 - 2 nu) psi1_x)/(4 pi G), u_y the same with y for x, and
    downwards (2 (1 - nu) psi - z psi_z)/(4 pi G). Exact up to rounding. ValueError: a point above
    the surface, or another shape.
    """
    potential = contact_potential(contact, points)
    psi_x, psi_y, psi_z = potential.gradient
    log_x, log_y = potential.log_gradient
    down = 2 * (1 - poisson) * potential.psi - potential.depth * psi_z
    sideways = (
        -potential.depth * psi - (1 - 2 * poisson) * log
        for psi, log in ((psi_x, log_x), (psi_y, log_y))
    )
    scale = (1 + poisson) / (2 * np.pi * young)
    return scale * np.column_stack((*sideways, -down))


REACH = 40.0  # of the integrals below; the integrands fall as exp(-2 u)


def held_below(depth: float, poisson: float) -> float:
    """Curvature (1/mm^3, over F (1 - nu^2)/(pi E)) of the surface that the rigid base under a layer
    adds, under a point force F on a layer of thickness `depth` (mm) bonded to that base.

    The layer moves by F (1 - nu^2)/(pi E H) int L(u) J0(u r/H) du, with H the thickness, L = (2 k
    sinh 2u - 4u) / (2 k cosh 2u + 1 + k^2 + 4 u^2) and k = 3 - 4 nu (P. Meijers, Applied Scientific
    Research 18, 1968; L = 1 is Boussinesq's half-space), so the curvature is int (1 - L) u^2 du /
    (2 H^3).
    """
    k = 3 - 4 * poisson

    def rest(u: float) -> float:
        """The integrand (1 - L(u)) u^2."""
        e = math.exp(-2 * u)  # scaled by it, nothing overflows
        above = k * (1 - e * e) - 4 * u * e
        below = k * (1 + e * e) + (1 + k * k + 4 * u * u) * e
        return (1 - above / below) * u * u

    return float(quad(rest, 0, REACH)[0]) / (2 * depth**3)


def free_edge(distance: float, poisson: float) -> float:
    """Curvature (1/mm^3, over F (1 - nu^2)/(pi E)) of the surface that a free edge at right angles
    adds, under a force F at a distance D (mm) from the edge: psi/(4 D^3) towards the edge, and
    -psi/(8 D^3) along it.

    The edge acts as a force psi F at the mirrored place, whose displacement falls as 1/r; psi is
    that of `image_force` (R. Guilbault, Journal of Tribology 133, 2011).
    """
    return image_force(poisson) / (4 * distance**3)


def image_force(poisson: float) -> float:
    """Force at the mirrored place that stands for a free edge, over the real force: Guilbault's psi
    = 1.29 - (0.08 - 0.5 nu)/(1 - nu).
    """
    return 1.29 - (0.08 - 0.5 * poisson) / (1 - poisson)


def own_curvatures(a: float, b: float) -> tuple[float, float]:
    """Curvatures of the surface along a and along b under Hertz's pressure on an ellipse, over
    F/(pi E*): R_D(0, b^2, a^2) and R_D(0, a^2, b^2), 1/mm^3 (from Johnson, Contact Mechanics,
    3.41). a, b: semi-axes, mm.
    """
    return float(elliprd(0, b * b, a * a)), float(elliprd(0, a * a, b * b))


def own_approach(a: float, b: float) -> float:
    """Approach of two half-spaces under Hertz's pressure on an ellipse, over F/(pi E*): 3/2 R_F(0,
    a^2, b^2), 1/mm; semi-axes a and b in mm.
    """
    return 1.5 * float(elliprf(0, a * a, b * b))
