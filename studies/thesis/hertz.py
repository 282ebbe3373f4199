"""Claims 1, 30 to 59: Hertz's formulas, what goes into them, and the numbers (4.3 and 5)."""

import math

import numpy as np
from scipy.integrate import quad

from railhead.theory.elastic.hertz import point_contact
from studies.thesis.claims import (
    ClaimCheck,
    Finding,
    Grade,
    Rule,
    grade_number,
    itself,
    number,
    statement,
)
from studies.thesis.facts import (
    LOAD,
    TABLE_5_3,
    WHEEL,
    Facts,
    exact_coefficients,
    hertz_coefficients,
    thesis_contact,
)

STRENGTH = {"normal": (700, 900, 880), "hard": (900, 1200, 1175)}  # thesis; EN 13674-1 minimum, MPa
CURVE_ANGLE = 0.00165  # rad, between wheel and rail, of chapter 5.3
PRINTED_B = (
    hertz_coefficients(80.4)[1] * 1e3 * math.cbrt(3 * math.pi * LOAD * 2 * 1.4e-12 / (4 * 2.86))
)  # mm, b from the numbers that chapter 5.3 prints


def semi_axes(facts: Facts) -> Finding:
    """Semi-axes by eqs 4.35 and 4.36 with exact m and n against exact Hertz."""
    c, route = facts.ellipse, facts.route
    m, n = exact_coefficients(route.theta_deg)
    base = math.cbrt(3 * c.load / (4 * c.contact_modulus * route.k3))
    return Finding(
        [
            number("a with exact m", m * base, c.a, "mm", facts.fe.get("a")),
            number("b with exact n", n * base, c.b, "mm", facts.fe.get("b")),
        ]
    )


def orientation(facts: Facts) -> Finding:
    """Whether the longer semi-axis lies along the smaller relative curvature, both ways round."""
    c = facts.ellipse
    turned = point_contact(c.curvature_y, c.curvature_x, c.contact_modulus, 1.0)
    return Finding(
        [
            statement("1/R along < across", "a > b", c.a / c.b, c.a > c.b),
            statement("1/R along > across", "a < b", turned.a / turned.b, turned.a < turned.b),
        ]
    )


def strength(name: str, low: float, high: float, least: float) -> ClaimCheck:
    """Check whether a range of tensile strengths contains the least of EN 13674-1, MPa."""
    inside = max(grade_number(low, least), Grade.CLOSE) if low <= least <= high else Grade.FAILS
    return ClaimCheck(f"{name} quality", f"{low}-{high}", f">= {least}", inside, "MPa")


def curved_change(thesis: float, index: int, unit: str, note: str) -> Rule:
    """Rule of a printed change of K4 (index 1) or theta (2) from straight track to wheel and rail
    at CURVE_ANGLE; note: a remark with a place for the value."""

    def rule(facts: Facts) -> Finding:
        found = facts.at_angle(CURVE_ANGLE)
        straight = (facts.route.k4, facts.route.theta_deg)[index - 1]
        return Finding(
            [number("change from straight track", thesis, found[index] - straight, unit)],
            note.format(found[index]),
            effect=abs(found[3] / facts.ellipse.p0 - 1),
        )

    return rule


def table(facts: Facts) -> Finding:
    """All 23 rows of table 5.3 against exact Hertz: checks of the worst m and the worst n."""
    exact = np.transpose([exact_coefficients(theta) for theta in TABLE_5_3[0]])
    errors = np.abs(TABLE_5_3[1:] / exact - 1)
    checks = [
        number(
            f"{name} at {TABLE_5_3[0, worst]:g} deg, the worst of {exact.shape[1]} rows",
            float(TABLE_5_3[i + 1, worst]),
            float(exact[i, worst]),
        )
        for i, (name, worst) in enumerate(zip("mn", errors.argmax(axis=1), strict=True))
    ]
    return Finding(checks, f"From 1 degree on, within {float(errors[:, 1:].max()):.2%}.")


def inverse_proportion(facts: Facts) -> Finding:
    """Whether p0 falls with the semi-axes: at one load, and where the load makes them grow."""
    c = facts.ellipse
    softer = point_contact(c.curvature_x, c.curvature_y, c.contact_modulus / 2, c.load)
    ratio = facts.under(8 * c.load).p0 / c.p0
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
    """Whether the pressure is zero on the edge of the patch and beyond."""
    c, t = facts.ellipse, np.linspace(0, 2 * math.pi, 9)
    beyond = c.pressure(np.outer((1, 1.5), c.a * np.cos(t)), np.outer((1, 1.5), c.b * np.sin(t)))
    share = float(beyond.max()) / c.p0
    return Finding([statement("p / p0 on the edge and beyond", 0.0, share, share < 1e-7)])


RULES: dict[int, Rule] = {
    1: lambda f: Finding(
        [
            number("p0 by Hertz", f.ellipse.p0, f.boundary_element_p0, "MPa", f.fe.get("p0")),
            number("b/a of a sphere on a sphere or plane", 1.0, f.ellipse.b / f.ellipse.a),
        ],
        "Hertz covers any two quadratic surfaces; these are crossed cylinders. "
        "Exact here: boundary elements on the profiles.",
    ),
    # Eq 4.34 carries the load: in r of the stretched ellipse, dA = 2 pi a b r dr
    30: lambda f: Finding(
        [
            number(
                "load carried, N",
                2
                * math.pi
                * f.ellipse.a
                * f.ellipse.b
                * quad(lambda r: r * float(f.ellipse.pressure(r * f.ellipse.a, 0)), 0, 1)[0],
                f.ellipse.load,
            ),
            number(
                "p0, MPa",
                3 * f.ellipse.load / (2 * math.pi * f.ellipse.a * f.ellipse.b),
                f.ellipse.p0,
                ours=f.fe.get("p0"),
            ),
        ]
    ),
    31: semi_axes,
    # K_4 >= 0, so theta ends at 90 degrees
    32: lambda f: Finding(
        [number("largest theta, deg", "180", 90.0)],
        f"Table 5.3 ends at {TABLE_5_3[0, -1]:g} degrees, so nothing follows from it.",
        effect=abs(float(TABLE_5_3[0, -1]) - 90.0),
    ),
    33: lambda f: Finding([number("K3", f.route.k3, f.at_angle(0.4)[0], "1/mm")]),
    34: lambda f: Finding(
        [
            number(
                f"K4 at {angle} rad",
                thesis_contact(*f.curvatures, 1e5, LOAD, angle).k4,
                f.at_angle(angle)[1],
                "1/mm",
            )
            for angle in (0.1, 0.4, 1.0)
        ]
    ),
    35: orientation,
    36: lambda f: Finding(
        [strength(name, *values) for name, values in STRENGTH.items()],
        "The ranges contain the least strengths of R260 and R350HT.",
    ),
    37: lambda f: Finding(
        [
            number("crown radius", "300", f.profiles["crown_radius"], "mm"),
            number(
                "share of the head's width with that radius",
                1.0,
                f.profiles["crown_half_width"] / f.profiles["head_half_width"],
            ),
        ],
        f"R300 ends at {f.profiles['crown_half_width']:.3f} mm from the centre; "
        "R80 and R13 follow.",
    ),
    38: lambda f: Finding(
        [number("axle load", "25000", 2 * WHEEL, "N")],
        f"25 kN is 2.55 t. Half of 22.5 t is {WHEEL / 1000:.1f} kN a wheel: p0 "
        f"{f.real.p0:.0f} MPa, {2 * f.real.a:.1f} x {2 * f.real.b:.1f} mm. "
        "25 t were meant, perhaps.",
    ),
    39: lambda f: Finding(
        [itself("F_n from the printed axle load", "25000", LOAD / 2, "N")],
        "Taken literally: p0 {0.p0:.2f} MPa, a {0.a:.3f} mm, b {0.b:.3f} mm.".format(
            f.under(LOAD / 2)
        ),
    ),
    40: lambda f: Finding(
        [], not_computable="what weighs 64 kg is not said, and no formula uses it"
    ),
    41: lambda f: Finding(
        [
            statement("E", 207.0, "205 to 210", 205 <= 207 <= 210, "GPa"),
            number("nu", "0.3", f.poisson),
        ]
    ),
    # K = (1 - nu^2)/(pi E), half of 1/(pi E*)
    42: lambda f: Finding(
        [number("K", "1.4e-12", 1e-6 / (2 * math.pi * f.ellipse.contact_modulus), "m^2/N")]
    ),
    43: lambda f: Finding([number("K3", "0.00286", f.at_angle(0.0)[0], "1/mm")]),
    44: lambda f: Finding([number("K4", "4.76e-4", f.at_angle(0.0)[1], "1/mm")]),
    45: lambda f: Finding([number("C1", "0.0033", 1 / 300, "1/m")]),
    46: lambda f: Finding(
        [
            number("heading after 1 m, rad", "0.00165", 1 / 600),
            number("wheel to rail, axle steered radially, rad", "0.00165", 0.0),
        ],
        "The heading of the track turns with it; wheel and rail are skewed by the angle of attack.",
    ),
    47: curved_change(
        4.77e-4 - 4.76e-4, 1, "1/mm", "K4 is {:.6g}/mm. The printed change is one of rounding."
    ),
    48: lambda f: Finding([number("theta", "80.4", f.at_angle(0.0)[2], "deg")]),
    49: curved_change(80.39 - 80.4, 2, "deg", "theta is {:.6g} degrees."),
    50: lambda f: Finding(
        [number("p0 curved / straight", 1.0, f.at_angle(CURVE_ANGLE)[3] / f.ellipse.p0)]
    ),
    51: lambda f: Finding([number("m", "1.123", exact_coefficients(f.route.theta_deg)[0])]),
    52: lambda f: Finding([number("n", "0.897", exact_coefficients(f.route.theta_deg)[1])]),
    53: lambda f: Finding([number("a", "4.34", f.ellipse.a, "mm", f.fe.get("a"))]),
    54: lambda f: Finding(
        [
            number("b", "3.46", f.ellipse.b, "mm", f.fe.get("b")),
            itself("b from its own n, F, K and K3", "3.46", PRINTED_B, "mm"),
        ],
        f"Its own numbers round to {PRINTED_B:.2f}.",
    ),
    # p_max, and what its rounded b makes of it
    55: lambda f: Finding(
        [number("p_max", "794.9", f.ellipse.p0, "MPa", f.fe.get("p0"))],
        "Two roundings cancel: with b rounded to 3.47 mm it would be "
        f"{3 * LOAD / (2 * math.pi * 4.34 * round(PRINTED_B, 2)):.1f} MPa.",
    ),
    56: table,
    57: lambda f: Finding(
        [
            statement(
                "a / b",
                "> 1",
                f.ellipse.a / f.ellipse.b,
                f.ellipse.a > f.ellipse.b,
                ours=f.fe["a"] / f.fe["b"] if f.fe else None,
            )
        ]
    ),
    58: inverse_proportion,
    59: vanishes,
}
