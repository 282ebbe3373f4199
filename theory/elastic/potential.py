"""Potentials of a semi-ellipsoidal pressure on a half-space, in closed form.

For p = p0 sqrt(1 - x^2/a^2 - y^2/b^2) on the plane z = 0, and depth z >= 0 below it,

    psi  = int p / rho dA           psi1 = int p ln(rho + z) dA        d psi1 / dz = psi

give every displacement and stress of the half-space (Love, Phil. Trans. R. Soc. A 228, 1929;
Johnson, Contact Mechanics, 3.2). psi is the potential of a flattened ellipsoid, an integral over
the confocal ellipsoids w outside the one through the point, w = lambda. Integrating it once more
over z turns the integrals for psi1 into elementary ones. Here they are written so that no term is
divided by a^2 - b^2 and none tends to 0/0 at the surface: the circle, the patch, its edge and the
free surface need no special care.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import elliprd, elliprf

Array = NDArray[np.float64]


class EllipsoidPotential:
    """Derivatives of the potentials psi = int p/rho dA and psi1 = int p ln(rho + z) dA at n points,
    of the pressure p = p0 sqrt(1 - x^2/a^2 - y^2/b^2); rho is the distance.

    x, y, depth: coordinates of the points, (n,), mm.
    c: a^2 - b^2, mm2.
    strength: pi p0 a b, N.
    lam: parameter lambda of the confocal ellipsoid through each point, (n,), mm2.
    A, B: a^2 + lambda and b^2 + lambda, (n,), mm2.
    root_AB: sqrt(A B), (n,), mm2.
    s: depth/sqrt(lambda); p/p0 inside the patch, (n,).
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
