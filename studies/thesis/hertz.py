"""Claims 1, 30 to 41 and 57 to 59: Hertz's formulas and what goes into them (4.3, 5)."""

import math

import numpy as np
from scipy.integrate import quad

from railhead.theory.elastic.hertz import Ellipse, general_orientation, point_contact
from studies.thesis.claims import (
    Check,
    Facts,
    Finding,
    Grade,
    Rules,
    grade_number,
    itself,
    number,
    statement,
)
from studies.thesis.formulas import exact_coefficients, table_5_3, thesis_contact

rules = Rules()
STANDARD_GRAVITY = 9.80665
AXLE_LOAD = 22.5e3 * STANDARD_GRAVITY  # N, of a UIC54 main line
PRINTED_LOAD = 25000.0  # N
STRENGTH = {"normal": (700, 900, 880), "hard": (900, 1200, 1175)}  # thesis; EN 13674-1 minimum, MPa


def under(contact: Ellipse, load: float) -> Ellipse:
    """The same bodies under another load in N."""
    return point_contact(contact.curvature_x, contact.curvature_y, contact.contact_modulus, load)


def principal_curvatures(facts: Facts) -> tuple[tuple[float, float], tuple[float, float]]:
    """(1/R_1, 1/R_2) of the wheel and of the rail, 1/mm."""
    return (facts.ellipse.curvature_x, 0.0), (0.0, facts.ellipse.curvature_y)


@rules(1)
def sphere(facts: Facts) -> Finding:
    """The shape of this contact."""
    contact = facts.ellipse
    return Finding(
        [
            number("p0 by Hertz", contact.p0, facts.boundary_element_p0, "MPa", facts.fe.get("p0")),
            number("b/a of a sphere on a sphere or plane", 1.0, contact.b / contact.a),
        ],
        "Hertz covers any two quadratic surfaces; these are crossed cylinders. "
        "Exact here: boundary elements on the profiles.",
    )


@rules(30)
def semi_ellipsoid(facts: Facts) -> Finding:
    """Eq 4.34 carries the load: in r of the stretched ellipse, dA = 2 pi a b r dr."""
    c = facts.ellipse
    carried = quad(lambda r: 2 * math.pi * c.a * c.b * r * float(c.pressure(r * c.a, 0)), 0, 1)[0]
    peak = 3 * c.load / (2 * math.pi * c.a * c.b)
    return Finding(
        [
            number("load carried, N", carried, c.load),
            number("p0, MPa", peak, c.p0, ours=facts.fe.get("p0")),
        ]
    )


@rules(31)
def semi_axes(facts: Facts) -> Finding:
    """Eqs 4.35, 4.36 with exact m and n."""
    c, route = facts.ellipse, facts.route
    m, n = exact_coefficients(route.theta_deg)
    base = math.cbrt(3 * c.load / (4 * c.contact_modulus * route.k3))
    return Finding(
        [
            number("a with exact m", m * base, c.a, "mm", facts.fe.get("a")),
            number("b with exact n", n * base, c.b, "mm", facts.fe.get("b")),
        ]
    )


@rules(32)
def range_of_theta(facts: Facts) -> Finding:
    """K_4 >= 0, so theta ends at 90 degrees."""
    largest = math.degrees(math.acos(0.0))
    table_end = float(table_5_3()[0, -1])
    return Finding(
        [number("largest theta, deg", "180", largest)],
        f"Table 5.3 ends at {table_end:g} degrees, so nothing follows from it.",
        effect=abs(table_end - largest),
    )


@rules(33)
def sum_of_curvatures(facts: Facts) -> Finding:
    """Eq 4.37."""
    found = general_orientation(*principal_curvatures(facts), 0.4)
    exact = (found.curvature_x + found.curvature_y) / 2
    return Finding([number("K3", facts.route.k3, exact, "1/mm")])


@rules(34)
def difference_of_curvatures(facts: Facts) -> Finding:
    """Eq 4.38 at three angles, against the eigenvalues of the curvature tensor."""
    curvatures = principal_curvatures(facts)
    checks = []
    for angle in (0.1, 0.4, 1.0):
        found = general_orientation(*curvatures, angle)
        k4 = thesis_contact(*curvatures, 1e5, PRINTED_LOAD, angle).k4
        exact = (found.curvature_y - found.curvature_x) / 2
        checks.append(number(f"K4 at {angle} rad", k4, exact, "1/mm"))
    return Finding(checks)


@rules(35)
def orientation(facts: Facts) -> Finding:
    """The longer semi-axis lies along the smaller relative curvature, both ways round."""
    contact = facts.ellipse
    turned = point_contact(contact.curvature_y, contact.curvature_x, contact.contact_modulus, 1.0)
    return Finding(
        [
            statement("1/R along < across", "a > b", contact.a / contact.b, contact.a > contact.b),
            statement("1/R along > across", "a < b", turned.a / turned.b, turned.a < turned.b),
        ]
    )


@rules(36)
def rail_steel(facts: Facts) -> Finding:
    """Tensile strength beside the least of EN 13674-1: R260 880 MPa, R350HT 1175 MPa."""
    checks = []
    for name, (low, high, least) in STRENGTH.items():
        inside = max(grade_number(low, least), Grade.CLOSE) if low <= least <= high else Grade.FAILS
        checks.append(Check(f"{name} quality", f"{low}-{high}", f">= {least}", inside, "MPa"))
    return Finding(checks, "The ranges contain the least strengths of R260 and R350HT.")


@rules(37)
def crown_radius(facts: Facts) -> Finding:
    """The crown of 54E1."""
    profile = facts.profiles
    share = profile["crown_half_width"] / profile["head_half_width"]
    return Finding(
        [
            number("crown radius", "300", profile["crown_radius"], "mm"),
            number("share of the head's width with that radius", 1.0, share),
        ],
        f"R300 ends at {profile['crown_half_width']:.3f} mm from the centre; R80 and R13 follow.",
    )


@rules(38)
def axle_load(facts: Facts) -> Finding:
    """Against the 22.5 t of a main line."""
    real = under(facts.ellipse, AXLE_LOAD / 2)
    return Finding(
        [number("axle load", "25000", AXLE_LOAD, "N")],
        f"25 kN is 2.55 t. Half of 22.5 t is {AXLE_LOAD / 2000:.1f} kN a wheel: p0 "
        f"{real.p0:.0f} MPa, {2 * real.a:.1f} x {2 * real.b:.1f} mm. 25 t were meant, perhaps.",
    )


@rules(39)
def wheel_load(facts: Facts) -> Finding:
    """A wheel carries half of the axle load."""
    half = under(facts.ellipse, PRINTED_LOAD / 2)
    return Finding(
        [itself("F_n from the printed axle load", "25000", PRINTED_LOAD / 2, "N")],
        f"Taken literally: p0 {half.p0:.2f} MPa, a {half.a:.3f} mm, b {half.b:.3f} mm.",
    )


@rules(40)
def wheel_mass(facts: Facts) -> Finding:
    """No formula uses it."""
    return Finding([], not_computable="what weighs 64 kg is not said, and no formula uses it")


@rules(41)
def elastic_constants(facts: Facts) -> Finding:
    """Common values of steel."""
    return Finding(
        [
            statement("E", 207.0, "205 to 210", 205 <= 207 <= 210, "GPa"),
            number("nu", "0.3", facts.poisson),
        ]
    )


@rules(57)
def major_axis(facts: Facts) -> Finding:
    """Along the rail."""
    c, fe = facts.ellipse, facts.fe
    ours = fe["a"] / fe["b"] if fe else None
    return Finding([statement("a / b", "> 1", c.a / c.b, c.a > c.b, ours=ours)])


@rules(58)
def inverse_proportion(facts: Facts) -> Finding:
    """p0 against the semi-axes at one load, and over loads."""
    contact = facts.ellipse
    softer = point_contact(
        contact.curvature_x, contact.curvature_y, contact.contact_modulus / 2, contact.load
    )
    heavier = under(contact, 8 * contact.load)
    same_load = softer.p0 * softer.a * softer.b / (contact.p0 * contact.a * contact.b)
    return Finding(
        [
            number("p0 a b, one load, softer bodies", 1.0, same_load),
            statement("p0 with a and b doubled by the load", "x 1/4",
                      f"x {heavier.p0 / contact.p0:.3g}", heavier.p0 < contact.p0),
        ],
        "At a fixed load; with the load, both grow as its cube root.",
    )  # fmt: skip


@rules(59)
def vanishes(facts: Facts) -> Finding:
    """Pressure on and beyond the edge."""
    c = facts.ellipse
    t = np.linspace(0, 2 * math.pi, 9)
    beyond = c.pressure(np.outer((1, 1.5), c.a * np.cos(t)), np.outer((1, 1.5), c.b * np.sin(t)))
    share = float(beyond.max()) / c.p0
    return Finding([statement("p / p0 on the edge and beyond", 0.0, share, share < 1e-7)])
