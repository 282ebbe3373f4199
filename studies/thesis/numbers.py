"""Claims 42 to 56: the numbers of chapter 5.3."""

import math

import numpy as np

from railhead.theory.elastic.hertz import general_orientation, point_contact
from studies.thesis.claims import Facts, Finding, Rules, itself, number
from studies.thesis.formulas import exact_coefficients, hertz_coefficients, table_5_3
from studies.thesis.hertz import PRINTED_LOAD, principal_curvatures

rules = Rules()
CURVE_ANGLE = 0.00165  # rad, of chapter 5.3


@rules(42)
def material_constant(facts: Facts) -> Finding:
    """K = (1 - nu^2)/(pi E), half of 1/(pi E*)."""
    exact = 1e-6 / (2 * math.pi * facts.ellipse.contact_modulus)
    return Finding([number("K", "1.4e-12", exact, "m^2/N")])


@rules(43)
def k3(facts: Facts) -> Finding:
    """K_3."""
    c = facts.ellipse
    return Finding([number("K3", "0.00286", (c.curvature_x + c.curvature_y) / 2, "1/mm")])


@rules(44)
def k4(facts: Facts) -> Finding:
    """K_4 on straight track."""
    c = facts.ellipse
    return Finding([number("K4", "4.76e-4", (c.curvature_y - c.curvature_x) / 2, "1/mm")])


@rules(45)
def track_curvature(facts: Facts) -> Finding:
    """C_1 of a curve of 300 m."""
    return Finding([number("C1", "0.0033", 1 / 300, "1/m")])


@rules(46)
def track_angle(facts: Facts) -> Finding:
    """Heading after 1 m of the spiral; it is not the angle between wheel and rail."""
    return Finding(
        [
            number("heading after 1 m, rad", "0.00165", 1 / 600),
            number("wheel to rail, axle steered radially, rad", "0.00165", 0.0),
        ],
        "The heading of the track turns with it; wheel and rail are skewed by the angle of attack.",
    )


def curved(facts: Facts) -> tuple[float, float, float]:
    """Exact K_4, theta in degrees and p0 with wheel and rail turned by CURVE_ANGLE."""
    found = general_orientation(*principal_curvatures(facts), CURVE_ANGLE)
    k4 = (found.curvature_y - found.curvature_x) / 2
    contact = point_contact(
        found.curvature_x, found.curvature_y, facts.ellipse.contact_modulus, facts.ellipse.load
    )
    return k4, math.degrees(math.acos(k4 / facts.route.k3)), contact.p0


@rules(47)
def k4_curved(facts: Facts) -> Finding:
    """Its change from straight track."""
    k4, _, p0 = curved(facts)
    return Finding(
        [
            number("change from straight track", 4.77e-4 - 4.76e-4, k4 - facts.route.k4, "1/mm"),
        ],
        f"K4 is {k4:.6g}/mm. The printed change is one of rounding.",
        effect=abs(p0 / facts.ellipse.p0 - 1),
    )


@rules(48)
def theta(facts: Facts) -> Finding:
    """theta on straight track: cos(theta) = 1/6."""
    c = facts.ellipse
    ratio = (c.curvature_y - c.curvature_x) / (c.curvature_y + c.curvature_x)
    return Finding([number("theta", "80.4", math.degrees(math.acos(ratio)), "deg")])


@rules(49)
def theta_curved(facts: Facts) -> Finding:
    """Its change from straight track."""
    _, angle, p0 = curved(facts)
    return Finding(
        [number("change from straight track", 80.39 - 80.4, angle - facts.route.theta_deg, "deg")],
        f"theta is {angle:.6g} degrees.",
        effect=abs(p0 / facts.ellipse.p0 - 1),
    )


@rules(50)
def straight_as_curved(facts: Facts) -> Finding:
    """p0 on both."""
    return Finding([number("p0 curved / straight", 1.0, curved(facts)[2] / facts.ellipse.p0)])


@rules(51)
def coefficient_m(facts: Facts) -> Finding:
    """m."""
    return Finding([number("m", "1.123", exact_coefficients(facts.route.theta_deg)[0])])


@rules(52)
def coefficient_n(facts: Facts) -> Finding:
    """n."""
    return Finding([number("n", "0.897", exact_coefficients(facts.route.theta_deg)[1])])


@rules(53)
def semi_axis_a(facts: Facts) -> Finding:
    """a."""
    return Finding([number("a", "4.34", facts.ellipse.a, "mm", facts.fe.get("a"))])


def printed_b() -> float:
    """b in mm from the numbers that chapter 5.3 prints."""
    n = hertz_coefficients(80.4)[1]
    return n * 1e3 * math.cbrt(3 * math.pi * PRINTED_LOAD * 2 * 1.4e-12 / (4 * 2.86))


@rules(54)
def semi_axis_b(facts: Facts) -> Finding:
    """b, and the thesis's own arithmetic."""
    return Finding(
        [
            number("b", "3.46", facts.ellipse.b, "mm", facts.fe.get("b")),
            itself("b from its own n, F, K and K3", "3.46", printed_b(), "mm"),
        ],
        f"Its own numbers round to {printed_b():.2f}.",
    )


@rules(55)
def largest_pressure(facts: Facts) -> Finding:
    """p_max."""
    unrounded = 3 * PRINTED_LOAD / (2 * math.pi * 4.34 * round(printed_b(), 2))
    return Finding(
        [number("p_max", "794.9", facts.ellipse.p0, "MPa", facts.fe.get("p0"))],
        f"Two roundings cancel: with b rounded to 3.47 mm it would be {unrounded:.1f} MPa.",
    )


@rules(56)
def table(facts: Facts) -> Finding:
    """All 23 rows of table 5.3."""
    rows = np.array([(*row, *exact_coefficients(row[0])) for row in table_5_3().T])
    errors = {name: rows[:, i] / rows[:, i + 2] - 1 for i, name in ((1, "m"), (2, "n"))}
    checks = []
    for i, (name, error) in enumerate(errors.items(), start=1):
        worst = int(np.argmax(np.abs(error)))
        what = f"{name} at {rows[worst, 0]:g} deg, the worst of {len(rows)} rows"
        checks.append(number(what, float(rows[worst, i]), float(rows[worst, i + 2])))
    rest = max(float(np.abs(error[1:]).max()) for error in errors.values())
    return Finding(checks, f"From 1 degree on, within {rest:.2%}.")
