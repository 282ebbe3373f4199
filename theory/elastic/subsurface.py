"""Stresses below a frictionless Hertz contact, for the half-space z <= 0 under the patch.

Stresses are in MPa, tension positive, in columns xx, yy, zz, xy, xz, yz; points and depths in mm.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from railhead.theory.elastic.hertz import Ellipse, Strip
from railhead.theory.elastic.potential import EllipsoidPotential

Array = NDArray[np.float64]


class Potential(Protocol):
    """Derivatives of the potentials psi and psi1 of a pressure (see `potential`), arrays (n,)."""

    @property
    def psi_z(self) -> Array:
        """psi_z, MPa."""
        ...

    @property
    def depth_times_hessian(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """z times psi_xx, psi_yy, psi_zz, psi_xy, psi_xz, psi_yz, MPa."""
        ...

    @property
    def log_hessian(self) -> tuple[Array, Array, Array]:
        """psi1_xx, psi1_yy, psi1_xy, MPa."""
        ...


@dataclass(frozen=True)
class AxisExtrema:
    """Largest shear and von Mises stress on the axis in MPa, and their depths in mm."""

    tau_max: float
    tau_max_depth: float
    von_mises_max: float
    von_mises_max_depth: float


def stress(contact: Ellipse, poisson: float, points: ArrayLike) -> Array:
    """Stress (n, 6) at points (n, 3) with z <= 0, below, beside or on the patch.

    The potentials are closed forms; the relative error is that of rounding. ValueError: a point
    above the surface, or another shape.
    """
    return love(contact_potential(contact, points), poisson)


def love(potential: Potential, poisson: float) -> Array:
    """Stress (n, 6) from the potentials of a pressure.

    Love's formulas (Johnson, Contact Mechanics, 3.2), in depth z and up to the factor 2 pi:
    s_x = 2 nu psi_z - z psi_xx - (1 - 2 nu) psi1_xx, s_y alike, s_z = psi_z - z psi_zz,
    s_xy = -z psi_xy - (1 - 2 nu) psi1_xy, s_xz = -z psi_xz, s_yz = -z psi_yz.
    """
    z_xx, z_yy, z_zz, z_xy, z_xz, z_yz = potential.depth_times_hessian
    log_xx, log_yy, log_xy = potential.log_hessian
    free = 1 - 2 * poisson
    columns = (
        2 * poisson * potential.psi_z - z_xx - free * log_xx,
        2 * poisson * potential.psi_z - z_yy - free * log_yy,
        potential.psi_z - z_zz,
        -z_xy - free * log_xy,
        z_xz,  # the shears on horizontal planes change sign from depth to height
        z_yz,
    )
    return np.asarray(np.column_stack(columns) / (2 * np.pi))


def axis_stress(contact: Ellipse, poisson: float, depth: ArrayLike) -> Array:
    """s_x, s_y, s_z as (n, 3) on the z axis at depths (n,) >= 0; these are principal stresses.

    `stress` on the axis, where it reduces to Thomas and Hoersch (Univ. Illinois Bull. 212, 1930).
    ValueError: a negative depth.
    """
    return stress(contact, poisson, _on_axis(depth))[:, :3]


def surface_centre_stress(contact: Ellipse, poisson: float) -> Array:
    """s_x, s_y, s_z as (3,) at the centre of the patch (Johnson, Contact Mechanics, 4.32):
    s_x = -p0 (2 nu + (1 - 2 nu) b/(a + b)), s_y with a for b, s_z = -p0."""
    a, b, free = contact.a, contact.b, 1 - 2 * poisson
    s_x, s_y = (2 * poisson + free * side / (a + b) for side in (b, a))
    return -contact.p0 * np.array([s_x, s_y, 1.0])


def axis_extrema(contact: Ellipse, poisson: float) -> AxisExtrema:
    """Maxima over depth of max shear and von Mises stress on the z axis.

    Slender patches have one maximum below and another near or at the surface, which wins when
    Poisson's ratio is small: the axis is sampled first, then the best sample is refined by bounded
    optimisation, to about 1e-8 of the depth. A maximum at the surface itself is met to 1e-6.
    """
    fractions = np.concatenate(([0.0], np.geomspace(1e-6, 2, 200)))
    depths = min(contact.a, contact.b) * fractions
    samples = stress(contact, poisson, _on_axis(depths))

    def highest(invariant: Callable[[Array], Array]) -> tuple[float, float]:
        def negative(depth: float) -> float:
            return -float(invariant(stress(contact, poisson, _on_axis(depth)))[0])

        i = int(np.argmax(invariant(samples)))
        bounds = depths[max(i - 1, 0)], depths[min(i + 1, len(depths) - 1)]
        best = minimize_scalar(
            negative, bounds=bounds, method="bounded", options={"xatol": 1e-9 * bounds[1]}
        )
        return -float(best.fun), float(best.x)

    return AxisExtrema(*highest(max_shear), *highest(von_mises))


def line_axis_stress(strip: Strip, poisson: float, depth: ArrayLike) -> Array:
    """s_x, s_y, s_z as (n, 3) below the middle of a strip along x, in plane strain.

    With R = sqrt(b^2 + z^2): s_y = -p0 b^3/(R (R + z)^2), s_z = -p0 b/R, s_x = nu (s_y + s_z)
    (Johnson, Contact Mechanics, 4.46, multiplied out against cancellation). ValueError: a negative
    depth.
    """
    z = -_on_axis(depth)[:, 2]
    R = np.hypot(strip.b, z)
    s_y = -strip.p0 * strip.b**3 / (R * (R + z) ** 2)
    s_z = -strip.p0 * strip.b / R
    return np.column_stack((poisson * (s_y + s_z), s_y, s_z))


def principal(s: Array) -> Array:
    """Principal stresses (n, 3), descending, of stresses (n, 6)."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(s, dtype=float), -1, 0)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.asarray(np.linalg.eigvalsh(np.moveaxis(tensor, -1, 0))[:, ::-1])


def directions(s: Array) -> Array:
    """Unit vectors (n, 3, 3): the k-th row is that of the k-th principal stress of (n, 6)."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(s, dtype=float), -1, 0)
    tensor = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)
    return np.asarray(np.linalg.eigh(tensor)[1].transpose(0, 2, 1)[:, ::-1])


def max_shear(s: Array) -> Array:
    """Largest shear stress (n,), half the difference of the outer principal stresses (n, 6)."""
    ordered = principal(s)
    return np.asarray((ordered[:, 0] - ordered[:, 2]) / 2)


def von_mises(s: Array) -> Array:
    """Von Mises stress (n,) of stresses (n, 6), sqrt(3 J_2)."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(s, dtype=float), -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(normal / 2 + 3 * (xy**2 + xz**2 + yz**2)))


def contact_potential(contact: Ellipse, points: ArrayLike) -> EllipsoidPotential:
    """Potentials of the contact pressure at points (n, 3) in mm with z <= 0; the rounding of a
    surface point (1e-9 of the patch) is forgiven. ValueError: a point above, or another shape."""
    xyz = np.asarray(points, dtype=float)
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError(f"points must have the shape (n, 3), got {xyz.shape}")
    if np.any(xyz[:, 2] > 1e-9 * min(contact.a, contact.b)):
        raise ValueError(f"points must lie at z <= 0, got z = {xyz[:, 2].max()} mm")
    x, y, z = xyz.T
    return EllipsoidPotential(contact.a, contact.b, contact.p0, x, y, np.maximum(-z, 0))


def _on_axis(depth: ArrayLike) -> Array:
    """Points (n, 3) on the z axis at the given depths."""
    depths = np.atleast_1d(np.asarray(depth, dtype=float))
    if np.any(depths < 0):
        raise ValueError(f"depth must not be negative, got {depths.min()} mm")
    return np.column_stack((np.zeros_like(depths), np.zeros_like(depths), -depths))
