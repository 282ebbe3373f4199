"""Displacements of the elastic half-space z <= 0 under a load that presses it in -z.

Points are (n, 3) in mm, displacements (n, 3) in mm with the components x, y, z (z up), and zero at
infinity. An infinite Young's modulus gives no displacement.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.subsurface import contact_potential, half_space_points

Array = NDArray[np.float64]


def boussinesq_displacement(points: ArrayLike, load: float, young: float, poisson: float) -> Array:
    """Displacement (n, 3), mm, components x, y, z (z up), at points (n, 3), z <= 0, under a point
    force of `load` N at the origin that acts in -z. young: MPa.

    With depth z, rho the distance and G the shear modulus (Johnson, Contact Mechanics, 3.18): u_x =
    F/(4 pi G) (x z/rho^3 - (1 - 2 nu) x/(rho (rho + z))), u_y the same with y for x, and downwards
    F/(4 pi G) (z^2/rho^3 + 2 (1 - nu)/rho). ValueError: a point above the surface, at the origin,
    or another shape.
    """
    xyz, rho = _from_origin(points)
    depth = -xyz[:, 2]
    radial = depth / rho**3 - (1 - 2 * poisson) / (rho * (rho + depth))
    down = depth**2 / rho**3 + 2 * (1 - poisson) / rho
    scale = load * (1 + poisson) / (2 * np.pi * young)
    return scale * np.column_stack((radial * xyz[:, 0], radial * xyz[:, 1], -down))


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
    xyz, rho = _from_origin(points)
    x, y = xyz[:, 1 if across else 0], xyz[:, 0 if across else 1]
    depth, free = -xyz[:, 2], 1 - 2 * poisson
    sum_ = rho + depth
    along = 1 / rho + x**2 / rho**3 + free * (1 / sum_ - x**2 / (rho * sum_**2))
    aside = x * y * (1 / rho**3 - free / (rho * sum_**2))
    down = x * (depth / rho**3 + free / (rho * sum_))
    scale = load * (1 + poisson) / (2 * np.pi * young)
    columns = (aside, along, -down) if across else (along, aside, -down)
    return scale * np.column_stack(columns)


def _from_origin(points: ArrayLike) -> tuple[Array, Array]:
    """Points (n, 3) as an array and their distances (n,) from the origin, mm. ValueError: a point
    above the surface, at the origin, or another shape.
    """
    xyz = half_space_points(points)
    rho = np.linalg.norm(xyz, axis=1)
    if np.any(rho == 0):
        raise ValueError("points must lie away from the point force at the origin")
    return xyz, rho


def hertz_displacement(contact: Ellipse, points: ArrayLike, young: float, poisson: float) -> Array:
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
