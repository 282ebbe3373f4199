"""Claims 3 to 17: rotations, tangents and surfaces (chapter 3)."""

import math

import numpy as np
from scipy.integrate import quad

from studies.thesis import geometry
from studies.thesis.claims import Check, Facts, Finding, Rules, equation, number, statement

rules = Rules()
YAW, BANK, PITCH = 0.3, 0.2, 0.15  # rad, angles at which equations are evaluated
RAIL_RADIUS, WHEEL_RADIUS, CONE, HALF_AXLE = 300.0, 420.0, 1 / 20, 750.0  # mm
S1, S2 = 755.0, math.radians(170)  # a point of the wheel


def crown(y: float) -> float:
    """A crown of one radius, z(y)."""
    return math.sqrt(RAIL_RADIUS**2 - y**2) - RAIL_RADIUS


def cone(s1: float) -> float:
    """Radius of a conical tread at s1; the nominal one at s1 = L."""
    return WHEEL_RADIUS - CONE * (s1 - HALF_AXLE)


def wheel(s1: float, s2: float) -> geometry.Array:
    """Point of the wheel."""
    return geometry.wheel_point_printed(cone, HALF_AXLE, s1, s2)


def rail(s1: float, s2: float) -> geometry.Array:
    """Point of the rail, not turned."""
    return geometry.rail_point(crown, s1, s2)


def proper(what: str, matrix: geometry.Array) -> Check:
    """Whether a matrix keeps lengths and is right-handed."""
    skew = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    det = float(np.linalg.det(matrix))
    shown = f"det {det:.3g}, A'A - I {skew:.2g}"
    return statement(what, shown, "det 1, A'A - I 0", skew < 1e-12 and abs(det - 1) < 1e-12)


@rules(3)
def rotation_about_z(facts: Facts) -> Finding:
    """Eq 3.5."""
    printed = geometry.rotation_z_printed(YAW)
    return Finding(
        [proper("rotation", printed), equation("about z", printed, geometry.rotation(yaw=YAW))]
    )


@rules(4)
def rotation_about_x(facts: Facts) -> Finding:
    """Eq 3.6."""
    printed = geometry.rotation_x_printed(BANK)
    return Finding(
        [proper("rotation", printed), equation("about x", printed, geometry.rotation(bank=BANK))],
        "A turn by zero must change nothing; this one mirrors x, and turns y and z the wrong way.",
    )


@rules(5)
def rotation_about_y(facts: Facts) -> Finding:
    """Eq 3.7."""
    printed = geometry.rotation_y_printed(PITCH)
    return Finding(
        [proper("rotation", printed), equation("about y", printed, geometry.rotation(pitch=PITCH))]
    )


def factors() -> tuple[geometry.Array, geometry.Array, geometry.Array]:
    """The three printed factors of eq 3.9."""
    return (
        geometry.rotation_z_printed(YAW),
        geometry.rotation_x_printed(BANK),
        geometry.rotation_y_printed(PITCH),
    )


@rules(6)
def two_factors(facts: Facts) -> Finding:
    """Eq 3.8 against eq 3.9."""
    z, x, y = factors()
    return Finding([equation("eq 3.8 = eq 3.9", x @ y, z @ x @ y)], "A slip: eq 3.9 has all three.")


@rules(7)
def product_zx(facts: Facts) -> Finding:
    """Eq 3.10."""
    z, x, _ = factors()
    printed = geometry.rotation_zx_printed(YAW, BANK)
    return Finding(
        [equation("product of the printed factors", printed, z @ x), proper("rotation", printed)],
        "Multiplied correctly, but the mirror image of eq 3.6 stays in.",
    )


@rules(8)
def product_zxy(facts: Facts) -> Finding:
    """Eqs 3.11, 3.12."""
    z, x, y = factors()
    printed = geometry.rail_rotation_printed(YAW, BANK, PITCH)
    return Finding(
        [
            equation("product of the printed factors", printed, z @ x @ y),
            proper("rotation", printed),
        ]
    )


@rules(9)
def heading(facts: Facts) -> Finding:
    """Eqs 3.13 to 3.17, on a helix: radius 1/C, grade theta."""
    curvature, grade, turn = 1 / RAIL_RADIUS, PITCH, 0.7
    radius = 1 / curvature
    rate = math.tan(grade) * radius  # rise per radian

    def speed(angle: float) -> float:
        velocity = [-radius * math.sin(angle), radius * math.cos(angle), rate]
        return float(np.linalg.norm(velocity))

    arc = quad(speed, 0, turn)[0]
    return Finding([number("heading along a helix, rad", curvature * math.cos(grade) * arc, turn)])


@rules(10)
def interpolation(facts: Facts) -> Finding:
    """Eqs 3.18, 3.19."""
    s0, s1, c0, c1 = 3.0, 53.0, 0.002, 0.009
    s = np.linspace(s0, s1, 5)
    printed = (c1 * (s - s0) - c0 * (s - s1)) / (s1 - s0)
    return Finding([equation("straight line between both ends", printed, np.linspace(c0, c1, 5))])


@rules(11)
def heading_of_a_spiral(facts: Facts) -> Finding:
    """Eq 3.20 against a quadrature of eq 3.19."""
    s0, s1, c0, c1, s = 0.0, 50.0, 0.002, 0.009, 40.0
    ramp = (c1 / 2 * (s - s0) ** 2 - c0 / 2 * (s - s1) ** 2) / (s1 - s0)
    printed, correct = (ramp + c0 / 2 * (s1 - s0) ** power for power in (2, 1))
    integral = quad(lambda t: (c1 * (t - s0) - c0 * (t - s1)) / (s1 - s0), s0, s)[0]
    return Finding(
        [number("heading after 40 m of a 50 m spiral, rad", printed, correct, ours=integral)],
        "The last term has the unit m instead of rad: its exponent must be 1. "
        "Without effect in chapter 5, where C0 = 0.",
    )


@rules(12)
def rail_tangents(facts: Facts) -> Finding:
    """Eq 3.21 against the columns of the matrix and against derivatives of the surface."""
    matrix = geometry.rail_rotation_printed(YAW, BANK, 0.0)
    printed = geometry.rail_tangents_printed(YAW, BANK)
    level = geometry.rail_tangents_printed(0.0, 0.0)
    true = geometry.tangents(rail, 0.0, 0.0)
    return Finding(
        [
            equation("t1 is column 1", printed[0], matrix[:, 0]),
            equation("t2 is column 2", printed[1], matrix[:, 1]),
            *(
                number(f"{name}: angle to the derivative of the surface, deg", _angle(*pair), 0.0)
                for name, pair in zip(("t1", "t2"), zip(level, true, strict=True), strict=True)
            ),
        ],
        "Eq 3.21 lists columns 2 and 3: t1 points across the rail, t2 along its normal.",
    )


@rules(13)
def lateral_integral(facts: Facts) -> Finding:
    """Eqs 3.22 to 3.24: a step of 10 mm across a level rail."""
    step = 10.0 * geometry.rail_tangents_printed(0.0, 0.0)[1]
    return Finding(
        [
            number("sideways move over 10 mm, mm", float(step[1]), 10.0),
            number("rise, mm", float(step[2]), crown(10.0)),
        ],
        "Integrating along the normal climbs vertically and never leaves the centre line.",
    )


@rules(14)
def revolution(facts: Facts) -> Finding:
    """Eq 3.27."""
    points = np.array([wheel(S1, angle) for angle in np.linspace(0, 6, 7)])
    radius = np.hypot(points[:, 0], points[:, 2])
    return Finding([equation("distance from the axle is g(s1)", radius, np.full(7, cone(S1)))])


def wheel_tangent(index: int) -> Finding:
    """Eqs 3.38, 3.40 against the derivative of eq 3.27."""
    c, s, slope = math.cos(S2), math.sin(S2), -CONE
    exact = ([slope * s, 1, slope * c], [cone(S1) * c, 0, -cone(S1) * s])[index]
    printed = geometry.wheel_tangents_printed(cone, S1, S2)[index]
    ours = geometry.tangents(wheel, S1, S2)[index]
    return Finding([equation("derivative of eq 3.27", printed, exact, ours)])


@rules(15)
def wheel_tangent_across(facts: Facts) -> Finding:
    """Eq 3.38."""
    return wheel_tangent(0)


@rules(16)
def wheel_tangent_around(facts: Facts) -> Finding:
    """Eq 3.40."""
    return wheel_tangent(1)


@rules(17)
def wheel_rotation(facts: Facts) -> Finding:
    """Eq 3.34: the text that was kept mixes the angles in columns 2 and 3."""
    product = (
        geometry.rotation_y_printed(PITCH)
        @ geometry.rotation_z_printed(YAW)
        @ geometry.rotation_x_printed(BANK)
    )
    c, s = math.cos(YAW), math.sin(YAW)
    column = [-c * math.cos(PITCH), -s, c * math.sin(PITCH)]
    return Finding(
        [equation("column 1", column, product[:, 0]), proper("rotation", product)],
        not_computable="the angles in columns 2 and 3 cannot be told apart in the text",
    )


def _angle(one: geometry.Array, other: geometry.Array) -> float:
    cosine = abs(one @ other) / np.linalg.norm(one) / np.linalg.norm(other)
    return math.degrees(math.acos(min(1.0, float(cosine))))
