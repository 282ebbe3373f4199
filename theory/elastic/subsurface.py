"""Stresses below a frictionless Hertz contact, for the half-space z <= 0 under the patch.

Stresses are in MPa, tension positive, in columns xx, yy, zz, xy, xz, yz; points and depths in mm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from railhead.theory.elastic.hertz import Ellipse, Strip
from railhead.theory.elastic.potential import EllipsoidPotential

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AxisExtrema:
    """Largest stresses on the normal below the centre of a patch.

    tau_max: largest shear stress, MPa.
    tau_max_depth: its depth, mm.
    von_mises_max: largest von Mises stress, MPa.
    von_mises_max_depth: its depth, mm.
    """

    tau_max: float
    tau_max_depth: float
    von_mises_max: float
    von_mises_max_depth: float


def stress(contact: Ellipse, poisson: float, points: ArrayLike) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, of a half-space under Hertz pressure at
    points (n, 3), z <= 0, mm, below, beside or on the patch.

    The potentials are closed forms; the relative error is that of rounding. ValueError: a point
    above the surface, or another shape.
    """
    potential = contact_potential(contact, points)
    return love(
        potential.gradient[2], potential.depth_times_hessian, potential.log_hessian, poisson
    )


def love(
    psi_z: Array, depth_times_hessian: Sequence[Array], log_hessian: Sequence[Array], poisson: float
) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, from derivatives of the potentials psi =
    int p/rho dA and psi1 = int p ln(rho + z) dA of a pressure p; rho is the distance, z the depth.

    psi_z: (n,). depth_times_hessian: z psi_xx, psi_yy, psi_zz, psi_xy, psi_xz, psi_yz, each (n,).
    log_hessian: psi1_xx, psi1_yy, psi1_xy, each (n,). All in MPa.
    Love's formulas (Johnson, Contact Mechanics, 3.2), in depth z and up to the factor 2 pi: s_x = 2
    nu psi_z - z psi_xx - (1 - 2 nu) psi1_xx, s_y the same with y for x, s_z = psi_z - z psi_zz,
    s_xy = -z psi_xy - (1 - 2 nu) psi1_xy, s_xz = -z psi_xz, s_yz = -z psi_yz.
    """
    z_xx, z_yy, z_zz, z_xy, z_xz, z_yz = depth_times_hessian
    log_xx, log_yy, log_xy = log_hessian
    free = 1 - 2 * poisson
    columns = (
        2 * poisson * psi_z - z_xx - free * log_xx,
        2 * poisson * psi_z - z_yy - free * log_yy,
        psi_z - z_zz,
        -z_xy - free * log_xy,
        z_xz,  # the shears on horizontal planes change sign from depth to height
        z_yz,
    )
    return np.asarray(np.column_stack(columns) / (2 * np.pi))


def axis_stress(contact: Ellipse, poisson: float, depth: ArrayLike) -> Array:
    """Normal stresses s_x, s_y, s_z (n, 3), MPa, on the z axis below the centre of the patch at
    depths (n,) >= 0, mm. They are principal stresses.

    On the axis the stress reduces to Thomas and Hoersch (Univ. Illinois Bull. 212, 1930).
    ValueError: a negative depth.
    """
    return stress(contact, poisson, _on_axis(depth))[:, :3]


def axis_extrema(contact: Ellipse, poisson: float) -> AxisExtrema:
    """Largest shear and largest von Mises stress on the z axis below the patch, MPa, with their
    depths, mm.

    Slender patches have one maximum below and another near or at the surface, which is larger when
    Poisson's ratio is small. The axis is sampled first, then the best sample is refined by bounded
    optimisation, to about 1e-8 of the depth. A maximum at the surface itself is met to 1e-6.
    """
    smaller = min(contact.a, contact.b)
    return extrema(lambda depth: stress(contact, poisson, _on_axis(depth)), smaller)


def extrema(stress_at: Callable[[ArrayLike], Array], half_width: float) -> AxisExtrema:
    """Largest shear and largest von Mises stress on the normal below the centre of a patch, MPa,
    with their depths, mm, down to twice the smaller half width (mm) of the patch.

    stress_at: depths (n,) in mm -> stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa.
    """
    depths = half_width * np.concatenate(([0.0], np.geomspace(1e-6, 2, 200)))
    samples = stress_at(depths)

    def highest(invariant: Callable[[Array], Array]) -> tuple[float, float]:
        """Largest value (MPa) of a stress invariant on the axis, and its depth (mm)."""
        i = int(np.argmax(invariant(samples)))
        bounds = depths[max(i - 1, 0)], depths[min(i + 1, len(depths) - 1)]
        best = minimize_scalar(
            lambda depth: -float(invariant(stress_at(depth))[0]),
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-9 * bounds[1]},
        )
        return -float(best.fun), float(best.x)

    return AxisExtrema(*highest(max_shear), *highest(von_mises))


def line_axis_stress(strip: Strip, poisson: float, depth: ArrayLike) -> Array:
    """Normal stresses s_x, s_y, s_z (n, 3), MPa, at depths (n,), mm, below the middle of a strip
    along x, in plane strain.

    With b the half width, z the depth and R = sqrt(b^2 + z^2): s_y = -p0 b^3/(R (R + z)^2), s_z =
    -p0 b/R, s_x = nu (s_y + s_z) (Johnson, Contact Mechanics, 4.46, multiplied out against
    cancellation). ValueError: a negative depth.
    """
    z = -_on_axis(depth)[:, 2]
    R = np.hypot(strip.b, z)
    s_y = -strip.p0 * strip.b**3 / (R * (R + z) ** 2)
    s_z = -strip.p0 * strip.b / R
    return np.column_stack((poisson * (s_y + s_z), s_y, s_z))


def _tensors(s: Array) -> Array:
    """Symmetric tensors (n, 3, 3) of stresses (n, 6) with columns xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(s, dtype=float), -1, 0)
    return np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)


def principal(s: Array) -> Array:
    """Principal stresses (n, 3), largest first, of stresses (n, 6) with columns xx, yy, zz, xy, xz,
    yz.
    """
    return np.asarray(np.linalg.eigvalsh(_tensors(s))[:, ::-1])


def directions(s: Array) -> Array:
    """Principal directions (n, 3, 3) of stresses (n, 6), columns xx, yy, zz, xy, xz, yz: row k is
    the unit vector of the k-th principal stress, largest first.
    """
    return np.asarray(np.linalg.eigh(_tensors(s))[1].transpose(0, 2, 1)[:, ::-1])


def max_shear(s: Array) -> Array:
    """Largest shear stress (n,), half the difference of the largest and the smallest principal
    stress, of stresses (n, 6) with columns xx, yy, zz, xy, xz, yz.
    """
    ordered = principal(s)
    return np.asarray((ordered[:, 0] - ordered[:, 2]) / 2)


def von_mises(s: Array) -> Array:
    """Von Mises stress (n,) of stresses (n, 6) with columns xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(s, dtype=float), -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(normal / 2 + 3 * (xy**2 + xz**2 + yz**2)))


def contact_potential(contact: Ellipse, points: ArrayLike) -> EllipsoidPotential:
    """Potentials of the Hertz pressure of an ellipse at points (n, 3), z <= 0, mm. A z above 0 by
    up to 1e-9 of the smaller semi-axis counts as 0. ValueError: a point above the surface, or
    another shape.
    """
    x, y, z = half_space_points(points, 1e-9 * min(contact.a, contact.b)).T
    return EllipsoidPotential(contact.a, contact.b, contact.p0, x, y, np.maximum(-z, 0))


def half_space_points(points: ArrayLike, highest: float = 0.0) -> Array:
    """The points as an array (n, 3), mm. ValueError: another shape, or a point with z above
    `highest` (mm).
    """
    xyz = np.asarray(points, dtype=float)
    if xyz.ndim != 2 or xyz.shape[1] != 3 or np.any(xyz[:, 2] > highest):
        raise ValueError(f"points must be (n, 3) at z <= 0, got the shape {xyz.shape}")
    return xyz


def _on_axis(depth: ArrayLike) -> Array:
    """Points (n, 3) on the z axis at depths (n,) >= 0, mm. ValueError: a negative depth."""
    depths = np.atleast_1d(np.asarray(depth, dtype=float))
    if np.any(depths < 0):
        raise ValueError(f"depth must not be negative, got {depths.min()} mm")
    return np.column_stack((np.zeros_like(depths), np.zeros_like(depths), -depths))
