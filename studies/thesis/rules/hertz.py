"""Claims 1, 30 to 59: Hertz's formulas, what goes into them, and the numbers (4.3 and 5)."""

import math

import numpy as np
from scipy.integrate import quad

from railhead.theory.elastic.hertz import Ellipse, general_orientation, point_contact
from studies.thesis.claims import (
    Check,
    Facts,
    Finding,
    Grade,
    Rule,
    grade_number,
    itself,
    number,
    statement,
)
from studies.thesis.formulas import (
    exact_coefficients,
    hertz_coefficients,
    table_5_3,
    thesis_contact,
)

STANDARD_GRAVITY = 9.80665
AXLE_LOAD = 22.5e3 * STANDARD_GRAVITY  # N, of a UIC54 main line
PRINTED_LOAD = 25000.0  # N
STRENGTH = {"normal": (700, 900, 880), "hard": (900, 1200, 1175)}  # thesis; EN 13674-1 minimum, MPa
CURVE_ANGLE = 0.00165  # rad, between wheel and rail, of chapter 5.3
PRINTED_B = (
    hertz_coefficients(80.4)[1]
    * 1e3
    * math.cbrt(3 * math.pi * PRINTED_LOAD * 2 * 1.4e-12 / (4 * 2.86))
)  # mm, b from the numbers that chapter 5.3 prints


def under(contact: Ellipse, load: float) -> Ellipse:
    """The contact of the same bodies under another load in N."""
    return point_contact(contact.curvature_x, contact.curvature_y, contact.contact_modulus, load)


def principal_curvatures(facts: Facts) -> tuple[tuple[float, float], tuple[float, float]]:
    """(1/R_1, 1/R_2) of the wheel and of the rail, 1/mm."""
    return (facts.ellipse.curvature_x, 0.0), (0.0, facts.ellipse.curvature_y)


def exact_k(facts: Facts, angle: float) -> tuple[float, float]:
    """K_3 and K_4: half the sum and half the difference of the relative curvatures, 1/mm, by the
    eigenvalues of the curvature tensor; angle: between the principal planes of both bodies, rad."""
    found = general_orientation(*principal_curvatures(facts), angle)
    along, across = found.curvature_x, found.curvature_y
    return (along + across) / 2, (across - along) / 2


def theta(k3: float, k4: float) -> float:
    """The angle whose cosine is K_4/K_3, degrees."""
    return math.degrees(math.acos(k4 / k3))


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


def semi_axes(facts: Facts) -> Finding:
    """Eqs 4.35 and 4.36 with exact m and n."""
    c, route = facts.ellipse, facts.route
    m, n = exact_coefficients(route.theta_deg)
    base = math.cbrt(3 * c.load / (4 * c.contact_modulus * route.k3))
    return Finding(
        [
            number("a with exact m", m * base, c.a, "mm", facts.fe.get("a")),
            number("b with exact n", n * base, c.b, "mm", facts.fe.get("b")),
        ]
    )


def range_of_theta(facts: Facts) -> Finding:
    """K_4 >= 0, so theta ends at 90 degrees."""
    end = float(table_5_3()[0, -1])
    return Finding(
        [number("largest theta, deg", "180", 90.0)],
        f"Table 5.3 ends at {end:g} degrees, so nothing follows from it.",
        effect=abs(end - 90.0),
    )


def difference_of_curvatures(facts: Facts) -> Finding:
    """Eq 4.38 at three angles."""
    curvatures = principal_curvatures(facts)
    return Finding(
        [
            number(
                f"K4 at {angle} rad",
                thesis_contact(*curvatures, 1e5, PRINTED_LOAD, angle).k4,
                exact_k(facts, angle)[1],
                "1/mm",
            )
            for angle in (0.1, 0.4, 1.0)
        ]
    )


def orientation(facts: Facts) -> Finding:
    """The longer semi-axis lies along the smaller relative curvature, both ways round."""
    c = facts.ellipse
    turned = point_contact(c.curvature_y, c.curvature_x, c.contact_modulus, 1.0)
    return Finding(
        [
            statement("1/R along < across", "a > b", c.a / c.b, c.a > c.b),
            statement("1/R along > across", "a < b", turned.a / turned.b, turned.a < turned.b),
        ]
    )


def rail_steel(facts: Facts) -> Finding:
    """Tensile strength beside the least of EN 13674-1: R260 880 MPa, R350HT 1175 MPa."""
    checks = []
    for name, (low, high, least) in STRENGTH.items():
        inside = max(grade_number(low, least), Grade.CLOSE) if low <= least <= high else Grade.FAILS
        checks.append(Check(f"{name} quality", f"{low}-{high}", f">= {least}", inside, "MPa"))
    return Finding(checks, "The ranges contain the least strengths of R260 and R350HT.")


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


def axle_load(facts: Facts) -> Finding:
    """Against the 22.5 t of a main line."""
    real = under(facts.ellipse, AXLE_LOAD / 2)
    return Finding(
        [number("axle load", "25000", AXLE_LOAD, "N")],
        f"25 kN is 2.55 t. Half of 22.5 t is {AXLE_LOAD / 2000:.1f} kN a wheel: p0 "
        f"{real.p0:.0f} MPa, {2 * real.a:.1f} x {2 * real.b:.1f} mm. 25 t were meant, perhaps.",
    )


def wheel_load(facts: Facts) -> Finding:
    """A wheel carries half of the axle load."""
    half = under(facts.ellipse, PRINTED_LOAD / 2)
    return Finding(
        [itself("F_n from the printed axle load", "25000", PRINTED_LOAD / 2, "N")],
        f"Taken literally: p0 {half.p0:.2f} MPa, a {half.a:.3f} mm, b {half.b:.3f} mm.",
    )


def curved(facts: Facts) -> tuple[float, float, float]:
    """Exact K_4 in 1/mm, theta in degrees and p0 in MPa with wheel and rail at CURVE_ANGLE."""
    found = general_orientation(*principal_curvatures(facts), CURVE_ANGLE)
    c = facts.ellipse
    contact = point_contact(found.curvature_x, found.curvature_y, c.contact_modulus, c.load)
    k4 = exact_k(facts, CURVE_ANGLE)[1]
    return k4, theta(facts.route.k3, k4), contact.p0


def curved_change(
    facts: Facts, thesis: float, index: int, straight: float, unit: str, note: str
) -> Finding:
    """A printed change from straight track against that of `curved`, by its index there."""
    found = curved(facts)
    return Finding(
        [number("change from straight track", thesis, found[index] - straight, unit)],
        note.format(found[index]),
        effect=abs(found[2] / facts.ellipse.p0 - 1),
    )


def largest_pressure(facts: Facts) -> Finding:
    """p_max, and what its rounded b makes of it."""
    unrounded = 3 * PRINTED_LOAD / (2 * math.pi * 4.34 * round(PRINTED_B, 2))
    return Finding(
        [number("p_max", "794.9", facts.ellipse.p0, "MPa", facts.fe.get("p0"))],
        f"Two roundings cancel: with b rounded to 3.47 mm it would be {unrounded:.1f} MPa.",
    )


def table(facts: Facts) -> Finding:
    """All 23 rows of table 5.3."""
    rows = np.array([(*row, *exact_coefficients(row[0])) for row in table_5_3().T])
    errors = rows[:, 1:3] / rows[:, 3:] - 1
    checks = []
    for i, name in enumerate(("m", "n")):
        worst = int(np.argmax(np.abs(errors[:, i])))
        what = f"{name} at {rows[worst, 0]:g} deg, the worst of {len(rows)} rows"
        checks.append(number(what, float(rows[worst, i + 1]), float(rows[worst, i + 3])))
    return Finding(checks, f"From 1 degree on, within {float(np.abs(errors[1:]).max()):.2%}.")


def inverse_proportion(facts: Facts) -> Finding:
    """p0 against the semi-axes at one load, and over loads."""
    c = facts.ellipse
    softer = point_contact(c.curvature_x, c.curvature_y, c.contact_modulus / 2, c.load)
    ratio = under(c, 8 * c.load).p0 / c.p0
    same_load = softer.p0 * softer.a * softer.b / (c.p0 * c.a * c.b)
    doubled = "p0 with a and b doubled by the load"
    return Finding(
        [
            number("p0 a b, one load, softer bodies", 1.0, same_load),
            statement(doubled, "x 1/4", f"x {ratio:.3g}", ratio < 1),
        ],
        "At a fixed load; with the load, both grow as its cube root.",
    )


def vanishes(facts: Facts) -> Finding:
    """Pressure on and beyond the edge."""
    c = facts.ellipse
    t = np.linspace(0, 2 * math.pi, 9)
    beyond = c.pressure(np.outer((1, 1.5), c.a * np.cos(t)), np.outer((1, 1.5), c.b * np.sin(t)))
    share = float(beyond.max()) / c.p0
    return Finding([statement("p / p0 on the edge and beyond", 0.0, share, share < 1e-7)])


RULES: dict[int, Rule] = {
    1: lambda facts: Finding(
        [
            number(
                "p0 by Hertz",
                facts.ellipse.p0,
                facts.boundary_element_p0,
                "MPa",
                facts.fe.get("p0"),
            ),
            number("b/a of a sphere on a sphere or plane", 1.0, facts.ellipse.b / facts.ellipse.a),
        ],
        "Hertz covers any two quadratic surfaces; these are crossed cylinders. "
        "Exact here: boundary elements on the profiles.",
    ),
    30: semi_ellipsoid,
    31: semi_axes,
    32: range_of_theta,
    33: lambda facts: Finding([number("K3", facts.route.k3, exact_k(facts, 0.4)[0], "1/mm")]),
    34: difference_of_curvatures,
    35: orientation,
    36: rail_steel,
    37: crown_radius,
    38: axle_load,
    39: wheel_load,
    40: lambda facts: Finding(
        [], not_computable="what weighs 64 kg is not said, and no formula uses it"
    ),
    41: lambda facts: Finding(
        [
            statement("E", 207.0, "205 to 210", 205 <= 207 <= 210, "GPa"),
            number("nu", "0.3", facts.poisson),
        ]
    ),
    # K = (1 - nu^2)/(pi E), half of 1/(pi E*)
    42: lambda facts: Finding(
        [number("K", "1.4e-12", 1e-6 / (2 * math.pi * facts.ellipse.contact_modulus), "m^2/N")]
    ),
    43: lambda facts: Finding([number("K3", "0.00286", exact_k(facts, 0.0)[0], "1/mm")]),
    44: lambda facts: Finding([number("K4", "4.76e-4", exact_k(facts, 0.0)[1], "1/mm")]),
    45: lambda facts: Finding([number("C1", "0.0033", 1 / 300, "1/m")]),
    46: lambda facts: Finding(
        [
            number("heading after 1 m, rad", "0.00165", 1 / 600),
            number("wheel to rail, axle steered radially, rad", "0.00165", 0.0),
        ],
        "The heading of the track turns with it; wheel and rail are skewed by the angle of attack.",
    ),
    47: lambda facts: curved_change(
        facts,
        4.77e-4 - 4.76e-4,
        0,
        facts.route.k4,
        "1/mm",
        "K4 is {:.6g}/mm. The printed change is one of rounding.",
    ),
    48: lambda facts: Finding([number("theta", "80.4", theta(*exact_k(facts, 0.0)), "deg")]),
    49: lambda facts: curved_change(
        facts, 80.39 - 80.4, 1, facts.route.theta_deg, "deg", "theta is {:.6g} degrees."
    ),
    50: lambda facts: Finding(
        [number("p0 curved / straight", 1.0, curved(facts)[2] / facts.ellipse.p0)]
    ),
    51: lambda facts: Finding([number("m", "1.123", exact_coefficients(facts.route.theta_deg)[0])]),
    52: lambda facts: Finding([number("n", "0.897", exact_coefficients(facts.route.theta_deg)[1])]),
    53: lambda facts: Finding([number("a", "4.34", facts.ellipse.a, "mm", facts.fe.get("a"))]),
    54: lambda facts: Finding(
        [
            number("b", "3.46", facts.ellipse.b, "mm", facts.fe.get("b")),
            itself("b from its own n, F, K and K3", "3.46", PRINTED_B, "mm"),
        ],
        f"Its own numbers round to {PRINTED_B:.2f}.",
    ),
    55: largest_pressure,
    56: table,
    57: lambda facts: Finding(
        [
            statement(
                "a / b",
                "> 1",
                facts.ellipse.a / facts.ellipse.b,
                facts.ellipse.a > facts.ellipse.b,
                ours=facts.fe["a"] / facts.fe["b"] if facts.fe else None,
            )
        ]
    ),
    58: inverse_proportion,
    59: vanishes,
}
