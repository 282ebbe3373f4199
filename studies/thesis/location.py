"""Claims 18 to 29: the position of the contact (chapters 4.1 and 4.2)."""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from studies.thesis import geometry
from studies.thesis.claims import Facts, Finding, Rules, equation, number, statement
from studies.thesis.surfaces import (
    BANK,
    CONE,
    HALF_AXLE,
    RAIL_RADIUS,
    S1,
    S2,
    YAW,
    cone,
    crown,
    factors,
    proper,
    rail,
    wheel,
)

rules = Rules()
STEPS = np.linspace(0.05, 0.6, 12)
ANGLES = [(float(yaw), float(bank)) for yaw in STEPS for bank in STEPS]  # rad


@rules(18)
def convex(facts: Facts) -> Finding:
    """Principal radii of wheel and rail."""
    radius, convex_from = facts.profiles["s1002_radius"], facts.profiles["s1002_convex_from"]
    return Finding(
        [
            statement(
                "cylinder or cone on R300", "convex", "convex", facts.ellipse.curvature_y > 0
            ),
            statement("S1002 at its rolling circle", "> 0", radius, radius > 0, "mm"),
        ],
        f"The S1002 tread is hollow there and convex only beyond y = {convex_from:+.1f} mm.",
    )


@rules(19)
def hertz_assumptions(facts: Facts) -> Finding:
    """Patch small against the radii, small strain."""
    contact = facts.ellipse
    shares = (
        ("a / R_wheel", contact.a * contact.curvature_x),
        ("b / R_crown", contact.b * contact.curvature_y),
        ("p0 / E*", contact.p0 / contact.contact_modulus),
    )
    return Finding(
        [statement(what, "small", share, share < 0.05) for what, share in shares],
        f"They fail at the gauge corner: b / R13 = {contact.b / 13:.2f}.",
    )


@rules(20)
def contact_conditions(facts: Facts) -> Finding:
    """Eqs 4.1 to 4.4 at the true contact of a 1:20 cone on a crown of one radius."""
    y = -RAIL_RADIUS * CONE / math.hypot(1, CONE)
    s1 = HALF_AXLE + y
    axle = crown(y) + cone(s1)

    def lifted(by: float) -> geometry.Array:
        normal = np.array([0.0, y, math.sqrt(RAIL_RADIUS**2 - y**2)]) / RAIL_RADIUS

        def raised(s: float, angle: float) -> geometry.Array:
            return wheel(s, angle) + np.array([0.0, 0.0, axle]) + by * normal

        return geometry.contact_residuals(rail, raised, (0.0, y), (s1, math.pi))

    touching, apart = lifted(0.0), lifted(1.0)
    return Finding(
        [
            equation("hold where the bodies touch", touching[:4], np.zeros(4)),
            statement(
                "exclude a gap of 1 mm",
                "yes",
                f"residual {np.abs(apart[:4]).max():.0e}",
                bool(np.abs(apart[:4]).max() > 1e-6),
            ),
        ],
        "A fifth condition is missing, n.r = 0, with the height of the axle as fifth unknown.",
    )


@rules(21)
def straight_rail(facts: Facts) -> Finding:
    """Eq 4.6 on a level rail, 10 mm from the centre line."""
    point = 10.0 * geometry.rail_tangents_printed(0.0, 0.0)[1]
    return Finding(
        [equation("point of the crown at s2 = 10 mm", point, rail(0.0, 10.0))],
        "The rail is a straight line along its own normal: the crown never enters.",
    )


@rules(22)
def level_rail_matrix(facts: Facts) -> Finding:
    """Eq 4.8 against eq 3.10."""
    printed = geometry.level_rail_rotation_printed(YAW, BANK)
    return Finding(
        [
            equation("eq 3.10 of the thesis", printed, geometry.rotation_zx_printed(YAW, BANK)),
            proper("rotation", printed),
        ]
    )


@rules(23)
def level_wheel_matrix(facts: Facts) -> Finding:
    """Eq 4.13 against eqs 3.30 and 3.31."""
    z, x, _ = factors()
    printed = geometry.level_wheel_rotation_printed(YAW, BANK)
    return Finding(
        [equation("product of the printed factors", printed, z @ x), proper("rotation", printed)]
    )


@rules(24)
def wheel_point(facts: Facts) -> Finding:
    """Eq 4.18, row 2, against eq 4.17."""
    factor = math.cos(YAW) * math.cos(BANK)
    row_18, row_17 = (factor * (s - HALF_AXLE) for s in (S2, S1))
    return Finding([number("term of row 2, mm", row_18, row_17)], "s2w (an angle) for s1w: a slip.")


@rules(25)
def wheel_normal(facts: Facts) -> Finding:
    """Eq 4.26 against the cross product of the tangents."""
    c, s, k = math.cos(S2), math.sin(S2), cone(S1)
    printed = geometry.wheel_normal_printed(cone, S1, S2)
    ours = np.cross(*geometry.tangents(wheel, S1, S2)[::-1])
    return Finding([equation("t2 x t1", printed, [k * s, k * CONE, k * c], ours)])


@rules(26)
def angle_coefficients(facts: Facts) -> Finding:
    """Factors of k cos(s2w) in eqs 4.23, 4.25."""
    r = geometry.difference_printed(YAW, BANK, HALF_AXLE, (1.0, 0.0, HALF_AXLE), 0.0)
    ours = [float(t @ r) for t in geometry.rail_tangents_printed(YAW, BANK)]
    printed = geometry.angle_coefficients(YAW, BANK)
    values = np.array([geometry.angle_coefficients(*pair) for pair in ANGLES])
    spread = float(np.ptp(values, axis=0).max())
    return Finding(
        [
            equation("follow from eq 4.21", printed, ours),
            statement("depend on the angles", "yes", f"spread {spread:.0e}", spread > 1e-9),
        ],
        f"A^2 + m^2 = B^2 + n^2 = 1 makes them {abs(printed[0]):.0f} and {printed[1]:.0f}.",
    )


@rules(27)
def wheel_angle(facts: Facts) -> Finding:
    """Eq 4.30: height of the wheel's point at s2w = 90 degrees above its lowest one."""
    heights = [wheel(S1, angle)[2] for angle in (math.pi / 2, math.pi)]
    lowest = minimize_scalar(lambda angle: wheel(S1, angle)[2], bounds=(0, 2 * math.pi))
    return Finding(
        [
            number("angle of the contact, deg", "90", 180.0, ours=math.degrees(lowest.x)),
            number("height over the lowest point, mm", float(heights[0] - heights[1]), 0.0),
        ],
        "With the rail's normal in the place of a tangent, eq 4.27 asks the wheel's normal to be "
        "level: a point at the height of the axle. The correct tangent gives sin(s2w) = 0.",
    )


@rules(28)
def rail_position(facts: Facts) -> Finding:
    """Eqs 4.31, 4.32 beside the wheel lowered on the real profile."""
    largest = max(
        abs(geometry.reduced_equations(*pair, HALF_AXLE).numerator) / HALF_AXLE for pair in ANGLES
    )
    b3 = geometry.reduced_equations(YAW, BANK, HALF_AXLE).b3
    step = geometry.difference_printed(YAW, BANK, HALF_AXLE, (0.0, 0.0, HALF_AXLE), 1.0)
    substituted = float(geometry.rail_tangents_printed(YAW, BANK)[0] @ step)
    upright, tilted = (facts.profiles[f"y cone20 {name}"] for name in ("0", "1:40"))
    return Finding(
        [
            statement(
                "numerator of eq 4.31 is a result",
                "yes",
                f"{largest:.0e} at any angle",
                largest > 1e-9,
            ),
            number("1:20 cone, 54E1 upright", "0", upright, "mm"),
            number("1:20 cone, 54E1 inclined 1:40", "0", tilted, "mm"),
        ],
        "p1 = L a2 and p2 = L b2 make it L a2 b2 - L b2 a2. A 1:20 cone does touch a rail "
        f"inclined 1:20 at {abs(facts.profiles['y cone20 1:20']):.2f} mm: the cone is level there. "
        f"Nor does b3 follow from eq 4.21: {b3:.3f} as printed, {substituted:.3f} by substitution.",
    )


@rules(29)
def wheel_position(facts: Facts) -> Finding:
    """Eq 4.33 at many angles; where yaw and bank are equal it is 0 / 0."""
    pairs = [(yaw, bank) for yaw, bank in ANGLES if yaw != bank]
    found = [geometry.reduced_equations(*pair, HALF_AXLE).s1w_printed for pair in pairs]
    spread = float(np.ptp(found)) / HALF_AXLE
    return Finding(
        [statement("depends on the angles", "yes", f"L within {spread:.0e}", spread > 1e-6)],
        "The same identity leaves s1w = L: the middle of the tread, whatever the angles.",
    )
