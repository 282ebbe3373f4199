"""What the rules of the claims compute with: formulas as the 2012 thesis prints them, exact Hertz
contact, the profiles, finite elements.

The printed formulas are table 5.3 and eqs 4.35 to 4.38, 5.2 and 5.3. Their coefficients are
interpolated from a rounded table; their stresses below the surface are those of a circular patch
applied to an ellipse.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from railhead.contact import closed_forms, solid
from railhead.geometry import profiles
from railhead.geometry.placement import ProfilePair
from railhead.geometry.wheelset import WheelsetOnTrack
from railhead.scene.scene import Scene
from railhead.theory.bem import pressure_solver
from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse, point_contact

LOAD, P0, A = 25000.0, 794.9, 4.34  # N, MPa, mm as printed; P0 and A go into eqs 5.2 and 5.3
WHEEL = 22.5e3 * 9.80665 / 2  # N, of half a 22.5 t axle, as on a UIC54 main line
YIELD = (480.0, 520.0)  # MPa, of R260 rail steel
TREADS, INCLINATIONS = ("cylinder", "cone40", "cone20"), {"0": 0.0, "1:40": 1 / 40, "1:20": 1 / 20}
Array = NDArray[np.float64]


TABLE_5_3 = np.loadtxt(
    Path(__file__).parent / "data" / "table_5_3.csv", delimiter=",", skiprows=1, unpack=True
)
"""Rows theta_deg, m, n of the printed table as (3, 23)."""


@dataclass(frozen=True)
class ThesisContact:
    """Contact ellipse by the formulas of the thesis.

    a: semi-axis along x, mm.
    b: semi-axis along y, mm.
    p0: largest pressure, MPa.
    k3: half the sum of the relative curvatures, 1/mm.
    k4: half their difference, 1/mm.
    theta_deg: angle with cosine k4 / k3, degrees.
    m: coefficient of the semi-axis a.
    n: coefficient of the semi-axis b.
    """

    a: float
    b: float
    p0: float
    k3: float
    k4: float
    theta_deg: float
    m: float
    n: float


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
    """
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
    the larger relative curvature. ValueError: theta outside table 5.3.
    """
    k3 = (sum(wheel) + sum(rail)) / 2
    d_wheel, d_rail = wheel[0] - wheel[1], rail[0] - rail[1]
    k4 = math.sqrt(d_wheel**2 + d_rail**2 + 2 * d_wheel * d_rail * math.cos(2 * angle)) / 2
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


@dataclass(frozen=True)
class Facts:
    """Exact Hertz contact and the thesis's route for its case, and what follows from them.

    ellipse: exact Hertz contact.
    poisson: Poisson's ratio.
    route: contact by the formulas of the thesis.
    profiles: numbers of the rail and wheel profiles, see `profile_facts`.
    boundary_element_p0: largest pressure in MPa on the profiles, by boundary elements.
    fe: finite-element results by name (empty: none were made).
    """

    ellipse: Ellipse
    poisson: float
    route: ThesisContact
    profiles: Mapping[str, float]
    boundary_element_p0: float
    fe: Mapping[str, float] = field(default_factory=dict)

    def under(self, load: float) -> Ellipse:
        """The contact of the same bodies under another load in N."""
        c = self.ellipse
        return point_contact(c.curvature_x, c.curvature_y, c.contact_modulus, load)

    @cached_property
    def real(self) -> Ellipse:
        """Exact Hertz contact under the load WHEEL."""
        return self.under(WHEEL)

    @cached_property
    def circle(self) -> Ellipse:
        """A circular contact of the same bodies' mean curvature."""
        mean = (self.ellipse.curvature_x + self.ellipse.curvature_y) / 2
        return point_contact(mean, mean, self.ellipse.contact_modulus, self.ellipse.load)

    @property
    def curvatures(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(1/R_1, 1/R_2) of the wheel and of the rail, 1/mm."""
        return (self.ellipse.curvature_x, 0.0), (0.0, self.ellipse.curvature_y)

    def at_angle(self, angle: float) -> tuple[float, float, float, float]:
        """K_3 and K_4 (half the sum and half the difference of the relative curvatures, 1/mm, by
        the eigenvalues of the curvature tensor), theta in degrees with cosine K_4 over the route's
        K_3, and p0 in MPa; angle: between the principal planes of both bodies, rad."""
        wheel, rail = map(np.diag, self.curvatures)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        smaller, larger = map(float, np.linalg.eigvalsh(wheel + turn @ rail @ turn.T))
        k3, k4 = (larger + smaller) / 2, (larger - smaller) / 2
        c = self.ellipse
        contact = point_contact(smaller, larger, c.contact_modulus, c.load)
        return k3, k4, math.degrees(math.acos(k4 / self.route.k3)), contact.p0

    def stress(self, depth: float) -> Array:
        """Exact s_x, s_y, s_z (3,) in MPa on the axis at a depth in mm."""
        return np.asarray(self.ellipse.axis_stress(self.poisson, depth)[0])

    def printed_stress(self, depth: float) -> tuple[float, float]:
        """s_x = s_y and s_z in MPa by eqs 5.2 and 5.3 with the printed p_max and a."""
        s_x, _, s_z = thesis_axis_stress(P0, A, self.poisson, depth)[0]
        return float(s_x), float(s_z)

    @cached_property
    def extrema(self) -> subsurface.AxisExtrema:
        """Largest shear and von Mises stresses on the axis, with their depths."""
        return self.ellipse.axis_extrema(self.poisson)

    @cached_property
    def surface_shear(self) -> float:
        """Largest shear stress at the centre of the patch, MPa."""
        return float(np.ptp(self.stress(0.0))) / 2

    @cached_property
    def printed_shear(self) -> tuple[float, float]:
        """Depth in mm and value in MPa of the largest shear by eqs 5.2 and 5.3."""
        best = minimize_scalar(
            lambda depth: float(np.subtract(*self.printed_stress(depth)[::-1])) / 2,
            bounds=(0, A),
            method="bounded",
            options={"xatol": 1e-9},
        )
        return float(best.x), -float(best.fun)


def facts(scene: Scene) -> Facts:
    """Exact and printed contact of a scene, without finite elements."""
    contact = solid.locate(scene)
    ellipse = closed_forms.ellipse(scene, contact)
    curvatures = (ellipse.curvature_x, 0.0), (0.0, ellipse.curvature_y)
    numerical = pressure_solver.solve_developed(
        contact.half_space_gap,
        ellipse.contact_modulus,
        [((0.0, 0.0), (2 * ellipse.a, 2 * ellipse.b))],
        np.zeros_like,
        load=ellipse.load,
        split=False,
    )
    return Facts(
        ellipse,
        scene.rail.poisson_ratio,
        thesis_contact(*curvatures, ellipse.contact_modulus, ellipse.load),
        profile_facts(),
        numerical.max_pressure,
    )


def profile_facts() -> dict[str, float]:
    """Where treads touch the rail (y in its own section, mm), the crown, the S1002 tread."""
    found = {}
    for tread in TREADS:
        wheel = profiles.cone(profiles.CONES[tread], solid.TREAD_HALF_WIDTH, tread)
        for name, slope in INCLINATIONS.items():
            pair = ProfilePair(profiles.rail_head("54E1", slope), wheel, 420.0)
            touch = WheelsetOnTrack(right=pair, left=pair).place().right.touches[0]
            angle = math.atan(slope)
            found[f"y {tread} {name}"] = touch.y * math.cos(angle) + touch.z * math.sin(angle)
    head, s1002 = profiles.rail_head("54E1"), profiles.s1002()
    hollow = np.flatnonzero(s1002.curvature(np.arange(0.0, 30.0, 0.01)) < 0)[-1] / 100
    return found | {
        "crown_radius": 1 / float(head.curvature(0.0)),
        "crown_half_width": head.joints[len(head.joints) // 2],
        "head_half_width": head.domain[1],
        "s1002_radius": 1 / float(s1002.curvature(0.0)),
        "s1002_convex_from": float(hollow),
    }
