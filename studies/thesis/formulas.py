"""Contact ellipse and stresses by the formulas that the 2012 thesis prints.

These are table 5.3 and eqs 4.35 to 4.38, 5.2 and 5.3, kept to be compared with exact ones. The
coefficients are interpolated from a rounded table; the stresses below the surface are those of a
circular patch applied to an ellipse.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhead.theory.elastic.hertz import point_contact

Array = NDArray[np.float64]


TABLE_5_3 = np.loadtxt(
    Path(__file__).parent / "data" / "table_5_3.csv", delimiter=",", skiprows=1, unpack=True
)
"""Rows theta_deg, m, n of the printed table as (3, 23)."""


@dataclass(frozen=True)
class ThesisContact:
    """Semi-axes a (along x) and b (along y) in mm, peak pressure p0 in MPa, and the intermediate
    values k3, k4 in 1/mm, theta_deg, m, n; the thesis gives no approach."""

    a: float
    b: float
    p0: float
    k3: float
    k4: float
    theta_deg: float
    m: float
    n: float
    approach: None = None


def hertz_coefficients(theta_deg: float) -> tuple[float, float]:
    """m and n at theta in degrees, linear between the rows of table 5.3.

    ValueError: theta outside the table (0.5 to 90 degrees).
    """
    theta, m, n = TABLE_5_3
    if not theta[0] <= theta_deg <= theta[-1]:
        raise ValueError(f"theta must lie in [{theta[0]}, {theta[-1]}] deg, got {theta_deg}")
    return float(np.interp(theta_deg, theta, m)), float(np.interp(theta_deg, theta, n))


def exact_coefficients(theta_deg: float) -> tuple[float, float]:
    """m and n of eqs 4.35 and 4.36 from exact Hertz, for 0 < theta_deg <= 90.

    With cos(theta) = K_4/K_3 the relative curvatures are K_3 (1 -+ cos(theta)), here for K_3 = 1.
    ValueError: another angle.
    """
    if not 0 < theta_deg <= 90:
        raise ValueError(f"theta must lie in (0, 90] deg, got {theta_deg}")
    half = math.radians(theta_deg) / 2
    contact = point_contact(2 * math.sin(half) ** 2, 2 * math.cos(half) ** 2, 0.75, 1.0)
    return contact.a, contact.b


def thesis_contact(
    wheel: tuple[float, float],
    rail: tuple[float, float],
    contact_modulus: float,
    load: float,
    angle: float = 0.0,
) -> ThesisContact:
    """Contact ellipse by eqs 4.35 to 4.38, for a load in N and E* in MPa.

    `wheel` and `rail` hold (1/R_1, 1/R_2) in 1/mm, along x and along y; `angle` is the angle phi
    between their principal planes in radians. K_3 and K_4 are half the sum and half the (vector)
    difference of the curvatures, theta = arccos(K_4/K_3), and the semi-axes are m and n times
    (3 pi F (K_w + K_r)/(4 K_3))^(1/3), where K_w + K_r = 1/(pi E*). The longer axis lies across
    the larger relative curvature. ValueError: a load or modulus that is not positive, curvatures
    without a point contact, or theta outside table 5.3.
    """
    if not (0 < load < math.inf and 0 < contact_modulus < math.inf):
        raise ValueError(f"load and modulus must be positive, got {load} and {contact_modulus}")
    k3 = (sum(wheel) + sum(rail)) / 2
    d_wheel, d_rail = wheel[0] - wheel[1], rail[0] - rail[1]
    k4 = math.sqrt(d_wheel**2 + d_rail**2 + 2 * d_wheel * d_rail * math.cos(2 * angle)) / 2
    if not k3 > k4:
        raise ValueError(f"no point contact: K_3 = {k3} must exceed K_4 = {k4} (1/mm)")
    theta_deg = math.degrees(math.acos(k4 / k3))
    m, n = hertz_coefficients(theta_deg)
    base = math.cbrt(3 * load / (4 * contact_modulus * k3))
    a, b = (
        (m * base, n * base) if wheel[0] + rail[0] <= wheel[1] + rail[1] else (n * base, m * base)
    )
    return ThesisContact(a, b, 3 * load / (2 * math.pi * a * b), k3, k4, theta_deg, m, n)


def thesis_axis_stress(p0: float, a: float, poisson: float, depth: ArrayLike) -> Array:
    """s_x, s_y, s_z as (n, 3) in MPa at depths (n,) in mm, by eqs 5.2 and 5.3, with t = z/a:
    s_x = s_y = -p0 ((1 - t arctan(1/t)) (1 + nu) - 1/(2 (1 + t^2))), s_z = -p0/(1 + t^2)."""
    t = np.abs(np.atleast_1d(np.asarray(depth, dtype=float))) / a
    s_z = -p0 / (1 + t**2)
    s_x = -p0 * (1 - t * np.arctan2(1, t)) * (1 + poisson) - s_z / 2
    return np.column_stack((s_x, s_x, s_z))
