"""Stresses below a frictionless Hertz contact, for the half-space z <= 0 under the patch.

Stresses are in MPa, tension positive, in columns xx, yy, zz, xy, xz, yz; points and depths in mm.

They follow from potentials in closed form. For p = p0 sqrt(1 - x^2/a^2 - y^2/b^2) on the plane z =
0, and depth z >= 0 below it,

    psi  = int p / rho dA           psi1 = int p ln(rho + z) dA        d psi1 / dz = psi

give every displacement and stress of the half-space (Love, Phil. Trans. R. Soc. A 228, 1929;
Johnson, Contact Mechanics, 3.2). psi is the potential of a flattened ellipsoid, an integral over
the confocal ellipsoids w outside the one through the point, w = lambda. Integrating it once more
over z turns the integrals for psi1 into elementary ones. Here they are written so that no term is
divided by a^2 - b^2 and none tends to 0/0 at the surface: the circle, the patch, its edge and the
free surface need no special care.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar
from scipy.special import elliprd, elliprf

from railhead.theory.array_types import Array


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


@dataclass(frozen=True, kw_only=True)
class EllipsoidalPressure:
    """Pressure p0 sqrt(1 - (x/a)^2 - (y/b)^2) on an ellipse, with x along and y across the rail.

    a: semi-axis along x, along the rail, mm.
    b: semi-axis along y, across the rail, mm.
    p0: largest pressure, MPa.
    """

    a: float
    b: float
    p0: float

    @property
    def half_lengths(self) -> tuple[float, float]:
        """Semi-axes (a, b), mm: half lengths along and across the rail that a mesh must resolve."""
        return self.a, self.b

    def axis_stress(self, poisson: float, depth: ArrayLike) -> Array:
        """Normal stresses s_x, s_y, s_z (n, 3), MPa, on the z axis below the centre of the patch at
        depths (n,) >= 0, mm. They are principal stresses.

        On the axis the stress reduces to Thomas and Hoersch (Univ. Illinois Bull. 212, 1930).
        ValueError: a negative depth.
        """
        return stress(self, poisson, on_axis(depth))[:, :3]

    def axis_extrema(self, poisson: float) -> AxisExtrema:
        """Largest shear and largest von Mises stress on the z axis below the patch, MPa, with their
        depths, mm, down to twice the smaller semi-axis.

        Slender patches have one maximum below and another near or at the surface, which is larger
        when Poisson's ratio is small. The axis is sampled first, then the best sample is refined by
        bounded optimisation, to about 1e-8 of the depth. A maximum at the surface itself is met to
        1e-6.
        """
        smaller = min(self.a, self.b)
        return extrema(lambda depth: stress(self, poisson, on_axis(depth)), smaller)


def stress(contact: EllipsoidalPressure, poisson: float, points: ArrayLike) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, of a half-space under Hertz pressure at
    points (n, 3), z <= 0, mm, below, beside or on the patch, from its centre; z is the height.

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
    the unit vector of the k-th principal stress, largest first, with either sign.
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


def contact_potential(contact: EllipsoidalPressure, points: ArrayLike) -> EllipsoidPotential:
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


def on_axis(depth: ArrayLike) -> Array:
    """Points (n, 3) on the z axis at depths (n,) >= 0, mm. ValueError: a negative depth."""
    depths = np.atleast_1d(np.asarray(depth, dtype=float))
    if np.any(depths < 0):
        raise ValueError(f"depth must not be negative, got {depths.min()} mm")
    return np.column_stack((np.zeros_like(depths), np.zeros_like(depths), -depths))


class EllipsoidPotential:
    """The potential psi = int p/rho dA with its derivatives, and the derivatives of psi1 = int p
    ln(rho + z) dA, at n points, of the pressure p = p0 sqrt(1 - x^2/a^2 - y^2/b^2). rho is the
    distance, z the depth; a may be the smaller semi-axis.

    x, y, depth: coordinates of the points from the centre of the patch, (n,), mm.
    c: a^2 - b^2, mm2, negative where a < b.
    strength: pi p0 a b, N.
    lam: parameter lambda of the confocal ellipsoid through each point, (n,), mm2; 0 on the patch.
    A, B: a^2 + lambda and b^2 + lambda, (n,), mm2.
    root_AB: sqrt(A B), (n,), mm2.
    s: depth/sqrt(lambda), (n,): p/p0 on the patch, 0 on the surface beside it.
    """

    def __init__(self, a: float, b: float, p0: float, x: Array, y: Array, depth: Array) -> None:
        """a, b: semi-axes, mm; p0: largest pressure, MPa; x, y, depth: points (n,), mm."""
        self.x, self.y, self.depth = x, y, depth
        self.c = a * a - b * b
        self.strength = np.pi * p0 * a * b
        self.lam = _confocal(a, b, x, y, depth)
        self.A, self.B = a * a + self.lam, b * b + self.lam
        self.root_AB = np.sqrt(self.A * self.B)
        # s = depth / sqrt(lambda), which is p/p0 inside the patch and 0 on the free surface
        on_patch = self.lam == 0
        flat = np.sqrt(np.maximum(1 - x * x / self.A - y * y / self.B, 0))
        self.s = np.where(on_patch, flat, depth / np.sqrt(np.where(on_patch, 1, self.lam)))

    @cached_property
    def psi(self) -> Array:
        """The potential psi, (n,), N/mm."""
        I_a, I_b, z_I_z = self._confocal_integrals
        moments = self.x**2 * I_a + self.y**2 * I_b + self.depth * z_I_z
        return np.asarray(self.strength * (elliprf(self.A, self.B, self.lam) - moments / 2))

    @cached_property
    def gradient(self) -> tuple[Array, Array, Array]:
        """Derivatives psi_x, psi_y, psi_z, each (n,), MPa; z is the depth."""
        I_a, I_b, z_I_z = self._confocal_integrals
        return (
            -self.strength * self.x * I_a,
            -self.strength * self.y * I_b,
            -self.strength * z_I_z,
        )

    @property
    def depth_times_hessian(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Depth times psi_xx, psi_yy, psi_zz, psi_xy, psi_xz, psi_yz, each (n,), MPa. Bounded at
        the edge of the patch.
        """
        I_a, I_b, _ = self._confocal_integrals
        u, v = self.x / self.A, self.y / self.B
        steepness = self.lam * (u * u + v * v) + self.s**2
        layer = 2 * self.s / (self.root_AB * np.where(steepness > 0, steepness, 1))
        flat, steep = layer * self.lam, layer * self.s * np.sqrt(self.lam)
        xx = self.strength * (u * u * flat - self.depth * I_a)
        yy = self.strength * (v * v * flat - self.depth * I_b)
        xy, xz, yz = (self.strength * w for w in (u * v * flat, u * steep, v * steep))
        return xx, yy, -xx - yy, xy, xz, yz

    @cached_property
    def log_gradient(self) -> tuple[Array, Array]:
        """Derivatives psi1_x, psi1_y, each (n,), N/mm."""
        I_a, I_b, _ = self._confocal_integrals
        M_a, M_b, N, J_xx, J_yy = self._elementary_integrals
        K_x, K_y = (M_a - self.y**2 * N - J_xx) / 2, (M_b - self.x**2 * N - J_yy) / 2
        return (
            self.strength * self.x * (K_x - self.depth * I_a),
            self.strength * self.y * (K_y - self.depth * I_b),
        )

    @cached_property
    def log_hessian(self) -> tuple[Array, Array, Array]:
        """Second derivatives psi1_xx, psi1_yy, psi1_xy, each (n,), MPa."""
        I_a, I_b, _ = self._confocal_integrals
        _, _, N, J_xx, J_yy = self._elementary_integrals
        return (
            -self.strength * (J_xx + self.depth * I_a),
            -self.strength * (J_yy + self.depth * I_b),
            -self.strength * self.x * self.y * N,
        )

    @cached_property
    def _confocal_integrals(self) -> tuple[Array, Array, Array]:
        """I_a, I_b and z I_z, each (n,): integrals over w > lambda of 1/((a^2 + w) D), 1/((b^2 + w)
        D) and z/(w D), D = sqrt((a^2 + w)(b^2 + w) w). The sum I_a + I_b + I_z is 2/D(lambda),
        which yields I_z.
        """
        I_a = 2 / 3 * elliprd(self.B, self.lam, self.A)
        I_b = 2 / 3 * elliprd(self.A, self.lam, self.B)
        return I_a, I_b, self.s * (2 / self.root_AB - np.sqrt(self.lam) * (I_a + I_b))

    @cached_property
    def _elementary_integrals(self) -> tuple[Array, Array, Array, Array, Array]:
        """M_a, M_b, N, J_xx, J_yy: with A = a^2 + w, B = b^2 + w and q = AB - x^2 B - y^2 A, the
        integrals over w > lambda of 1/A, 1/B, 1/AB, x^2/A^2 - q/(A^2 B), y^2/B^2 - q/(A B^2), each
        over sqrt(q)."""
        x2, y2 = self.x**2, self.y**2
        r = self.s * self.root_AB
        xi, eta = 1 / (self.A + r), 1 / (self.B + r)
        X = xi**3 * _arctan_remainder(-self.c * x2 * xi**2)
        Y = eta**3 * _arctan_remainder(self.c * y2 * eta**2)
        M_a, M_b = 2 * (xi + self.c * x2 * X), 2 * (eta - self.c * y2 * Y)
        N = 2 * (xi * eta - x2 * X - y2 * Y)
        skew = x2 * x2 * X - y2 * y2 * Y
        J_xx = 2 * (skew - r / self.A * eta * (1 - x2 * xi))
        J_yy = 2 * (-skew - r / self.B * xi * (1 - y2 * eta))
        return M_a, M_b, N, J_xx, J_yy


def _arctan_remainder(t: Array) -> Array:
    """(1 - arctan(sqrt t)/sqrt t)/t for t > -1, by Carlson's R_D; 1/3 at t = 0."""
    return np.asarray(elliprd(1 + t, 1 + t, 1) / 3)


def _confocal(a: float, b: float, x: Array, y: Array, depth: Array) -> Array:
    """Largest root of x^2/(a^2 + lam) + y^2/(b^2 + lam) + z^2/lam = 1; exactly 0 on the patch.

    lam times the equation is convex in lam, so Newton's method from the upper bound
    x^2 + y^2 + z^2 falls monotonically on the root.
    """
    x2, y2, z2 = x * x, y * y, depth * depth
    on_patch = (depth == 0) & (x2 / a**2 + y2 / b**2 <= 1)
    lam = np.where(on_patch, 0, x2 + y2 + z2)
    for _ in range(100):
        A, B = a * a + lam, b * b + lam
        Q = 1 - x2 / A - y2 / B
        slope = Q + lam * (x2 / A**2 + y2 / B**2)
        step = np.where(on_patch, 0, (lam * Q - z2) / np.where(on_patch, 1, slope))
        lam = np.maximum(lam - step, 0)
        if np.all(np.abs(step) <= 1e-14 * lam):
            break
    return np.asarray(lam)
