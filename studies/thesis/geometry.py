"""Chapters 3 and 4 of the thesis: its equations as printed, and the correct ones beside them.

Angles are in radians: yaw (varphi, about z), bank (phi, about x), pitch (theta, about y). `printed`
and names ending in `_printed` hold what the thesis prints. The rail is a crown z = f(s2) swept
along x; the wheel turns a profile of radius g(s1) about an axle along y, and its lowest point is at
s2 = pi.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
Curve = Callable[[float], float]
STEP = 1e-4  # of a central difference, times the size of the argument or 1


def rotation(yaw: float = 0.0, bank: float = 0.0, pitch: float = 0.0) -> Array:
    """Proper rotation A = A_yaw A_bank A_pitch about z, x and y, (3, 3), the order of eq 3.9."""
    return np.asarray(Rotation.from_euler("ZXY", [yaw, bank, pitch]).as_matrix())


def printed(yaw: float, bank: float, pitch: float = 0.0) -> dict[str, Array]:
    """What the thesis prints at three angles, by the number of its equation.

    Matrices (3, 3): 3.5 (turn about z), 3.6 = 3.31 (about x, with i'.i = -1), 3.7 = 3.29 (about y),
    3.10 (its first factor), 3.12 (= 3.11 = 4.7, with the second column of 3.12), 4.8 (the rail's
    without pitch), 4.13 (the wheel's without pitch). Tangents (3,): 3.21 t1 (along), 3.21 t2
    (across).
    """
    (m, A), (n, B), (c, s) = _pair(yaw), _pair(bank), _pair(pitch)
    along, across = [-A * n, m * n, -B], [-A * B, m * B, n]
    level = [[-m, -A * n, -A * B], [A, m * n, m * B], [0, -B, n]]
    rows = {
        "3.5": [[m, -A, 0], [A, m, 0], [0, 0, 1]],
        "3.6": [[-1, 0, 0], [0, n, B], [0, -B, n]],
        "3.7": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "3.10": [level[0], [-A, m * n, m * B], level[2]],
        "3.12": [
            [-m * c + A * B * s, -A * n, -m * s - A * B * c],
            [A * c + s * m * s, m * n, -A * s + m * B * c],
            [B * s, -B, n * c],
        ],
        "4.8": level,
        "4.13": [[-m, -m * B, -A * B], [-A, m * n, m * B], level[2]],
        "3.21 t1": along,
        "3.21 t2": across,
    }
    return {equation: np.array(values) for equation, values in rows.items()}


def wheel_tangents_printed(g: Curve, s1: float, s2: float) -> tuple[Array, Array]:
    """t1 of eq 3.38 (across) and t2 of eq 3.40 (around the axle)."""
    c, s = _pair(s2)
    slope = derivative(g, s1)
    return np.array([slope * s, 1, -slope * c]), np.array([g(s1) * c, 1, g(s1) * s])


def wheel_normal_printed(g: Curve, s1: float, s2: float) -> Array:
    """n of eq 4.26."""
    c, s = _pair(s2)
    return g(s1) * np.array([s, -derivative(g, s1), -c])


def wheel_point_printed(g: Curve, half_axle: float, s1: float, s2: float) -> Array:
    """Eqs 3.27 and 4.14: the axle is the line x = z = 0."""
    c, s = _pair(s2)
    return np.array([g(s1) * s, -half_axle + s1, g(s1) * c])


def rail_point(f: Curve, s1: float, s2: float, matrix: Array | None = None) -> Array:
    """Point of the rail: the crown's point (0, s2, f(s2)) carried s1 along the rail, turned."""
    point = np.array([s1, s2, f(s2)])
    return point if matrix is None else matrix @ point


def tangents(surface: Callable[[float, float], Array], s1: float, s2: float) -> tuple[Array, Array]:
    """d/ds1 and d/ds2 of a surface by central differences: what a tangent vector is."""
    return (
        derivative(lambda t: surface(t, s2), s1),
        derivative(lambda t: surface(s1, t), s2),
    )


def derivative(function: Callable[[float], Array | float], at: float) -> Array:
    """Central difference of fourth order."""
    h = STEP * max(1.0, abs(at))
    near = np.asarray(function(at + h)) - np.asarray(function(at - h))
    far = np.asarray(function(at + 2 * h)) - np.asarray(function(at - 2 * h))
    return np.asarray((8 * near - far) / (12 * h))


class Reduced(NamedTuple):
    """The two equations to which the thesis reduces its contact conditions once cos(s2w) = 0:
    b2 s1w + b3 s2r = p2 and a2 s1w + a3 s2r = p1, where p1 = L a2 and p2 = L b2.

    numerator: of s2r in eq 4.31; s1w: solved from the two equations;
    s1w_printed: by eq 4.33, nan where that is 0/0.
    """

    a2: float
    a3: float
    b2: float
    b3: float
    numerator: float
    s1w: float
    s1w_printed: float


def reduced_equations(yaw: float, bank: float, half_axle: float) -> Reduced:
    """Coefficients of eqs 4.23 and 4.25 as printed, and what follows; half_axle: L in mm."""
    (m, A), (n, B) = _pair(yaw), _pair(bank)
    a2 = m * A * B**2 + m**2 * B * n - B * n
    b2 = A * B * m * n + m**2 * n**2 + B**2
    b3 = A**2 * B * (1 - m**2 * n) - A**2 * n**2 * B + A**2 * B * m * n
    b3 -= m**3 * n**2 * B + m**2 * n**2 * B + m * B**3 + B * n**2
    a3 = 2 * m * A**2 * B**2 - A**2 * B**2 * n * m - m**3 * B**2 * n
    a3 += -(m**2) * B**2 * n + B**2 * m * n + n**3
    p1, p2, denominator = half_axle * a2, half_axle * b2, a2 * b3 - a3 * b2
    s1w = (p1 * b3 - p2 * a3) / denominator
    above = p1 * (a2 * b3 + a3 * b2) - (p1 * b2 * a3 + a3 * a2 * p2)
    return Reduced(a2, a3, b2, b3, a2 * p2 - b2 * p1, s1w, above / (a2 * denominator or np.nan))


def angle_coefficients(yaw: float, bank: float) -> tuple[float, float]:
    """Factors of k cos(s2w) in eqs 4.23 and 4.25, which the thesis carries along as unknowns."""
    (m, A), (n, B) = _pair(yaw), _pair(bank)
    return A**2 * B * n + m**2 * n * B - B * n, A**2 * B**2 + m**2 * B**2 + n**2


def difference_printed(
    yaw: float, bank: float, half_axle: float, wheel: tuple[float, float, float], s2r: float
) -> Array:
    """r of eq 4.21 with the slip of its second row mended (s1w, not s2w); wheel: k cos(s2w),
    k sin(s2w) and s1w."""
    (m, A), (n, B), (kc, ks, s1w) = _pair(yaw), _pair(bank), wheel
    across = s1w - half_axle
    return np.array(
        [
            -m * ks - m * B * across - A * B * kc + (-m * A * B + m * A * B * n + A * B * n) * s2r,
            -A * ks + m * n * across + m * B * kc + (A**2 * B - m**2 * n * B - m * n * B) * s2r,
            -B * across + n * kc + (m * B**2 - n**2) * s2r,
        ]
    )


def contact_residuals(
    rail: Callable[[float, float], Array],
    wheel: Callable[[float, float], Array],
    at_rail: tuple[float, float],
    at_wheel: tuple[float, float],
) -> Array:
    """(5,) t1r.r, t2r.r, t1w.n, t2w.n (eqs 4.1 to 4.4) and n.r, which the thesis leaves out.

    r is the wheel's point less the rail's, n the rail's normal; the tangents are unit derivatives
    of the surfaces. All five vanish where the surfaces touch; four of them also do at a distance.
    """
    t1r, t2r, t1w, t2w = (
        t / np.linalg.norm(t) for t in (*tangents(rail, *at_rail), *tangents(wheel, *at_wheel))
    )
    n = np.cross(t1r, t2r)
    r = wheel(*at_wheel) - rail(*at_rail)
    return np.array([t1r @ r, t2r @ r, t1w @ n, t2w @ n, n @ r])


def _pair(angle: float) -> tuple[float, float]:
    return float(np.cos(angle)), float(np.sin(angle))
