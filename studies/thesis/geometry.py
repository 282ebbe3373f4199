"""Claims 3 to 29: rotations, surfaces and the position of the contact (chapters 3, 4.1 and 4.2 of
the thesis). Its equations as printed, the correct ones beside them, and the rules of the claims.

Angles are in radians: yaw (varphi, about z), bank (phi, about x), pitch (theta, about y). `printed`
and names ending in `_printed` hold what the thesis prints. The rail is a crown z = f(s2) swept
along x; the wheel turns a profile of radius g(s1) about an axle along y, and its lowest point is at
s2 = pi.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from studies.thesis.claims import ClaimCheck, Finding, Rule, equation, number, statement
from studies.thesis.facts import Facts

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
    """Normal (3,) of the wheel by eq 4.26, as printed."""
    c, s = _pair(s2)
    return g(s1) * np.array([s, -derivative(g, s1), -c])


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

    a2, a3, b2, b3: their coefficients.
    numerator: numerator of s2r in eq 4.31.
    s1w: s1w solved from the two equations.
    s1w_printed: s1w by eq 4.33, NaN where that is 0/0.
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
    """Cosine and sine."""
    return float(np.cos(angle)), float(np.sin(angle))


YAW, BANK, PITCH = 0.3, 0.2, 0.15  # rad, angles at which equations are evaluated
RAIL_RADIUS, WHEEL_RADIUS, CONE, HALF_AXLE = 300.0, 420.0, 1 / 20, 750.0  # mm
S1, S2 = 755.0, math.radians(170)  # a point of the wheel
C2, SIN2 = math.cos(S2), math.sin(S2)
STEPS = np.linspace(0.05, 0.6, 12)
ANGLES = [(float(yaw), float(bank)) for yaw in STEPS for bank in STEPS]  # rad
PRINTED, LEVEL = printed(YAW, BANK, PITCH), printed(0.0, 0.0)
Z, X, Y, T1, T2 = (PRINTED[name] for name in ("3.5", "3.6", "3.7", "3.21 t1", "3.21 t2"))
NO_PITCH = printed(YAW, BANK)["3.12"]
SPIRAL = 0.0, 50.0, 0.002, 0.009  # start and end, mm; curvatures there, 1/mm
REDUCED = [reduced_equations(*pair, HALF_AXLE) for pair in ANGLES]


def crown(y: float) -> float:
    """A crown of one radius: height z in mm at y in mm."""
    return math.sqrt(RAIL_RADIUS**2 - y**2) - RAIL_RADIUS


def cone(s1: float) -> float:
    """Radius of a conical tread in mm at s1 in mm; the nominal radius at s1 = L."""
    return WHEEL_RADIUS - CONE * (s1 - HALF_AXLE)


def wheel(s1: float, s2: float) -> Array:
    """Point (3,) of the wheel, mm, at its parameters s1 and s2 by eqs 3.27 and 4.14: the axle is
    the line x = z = 0."""
    c, s = _pair(s2)
    return np.array([cone(s1) * s, s1 - HALF_AXLE, cone(s1) * c])


def rail(s1: float, s2: float) -> Array:
    """Point (3,) of the rail, mm, without rotation: the crown's point carried s1 along the rail."""
    return np.array([s1, s2, crown(s2)])


def proper(matrix: Array) -> ClaimCheck:
    """Check whether a matrix (3, 3) keeps lengths and is right-handed."""
    skew, det = float(np.abs(matrix.T @ matrix - np.eye(3)).max()), float(np.linalg.det(matrix))
    shown = f"det {det:.3g}, A'A - I {skew:.2g}"
    return statement("rotation", shown, "det 1, A'A - I 0", skew < 1e-12 and abs(det - 1) < 1e-12)


def turn(axis: str, printed: Array, exact: Array, note: str = "") -> Rule:
    """Rule of a printed rotation about one axis."""
    return lambda f: Finding([proper(printed), equation(f"about {axis}", printed, exact)], note)


def product(printed: Array, exact: Array, note: str = "") -> Rule:
    """Rule of a printed product of rotations against the product of the printed factors."""
    return lambda f: Finding(
        [equation("product of the printed factors", printed, exact), proper(printed)], note
    )


def curvature(s: float) -> float:
    """Eq 3.19: linear between both ends of the spiral, 1/mm."""
    s0, s1, c0, c1 = SPIRAL
    return (c1 * (s - s0) - c0 * (s - s1)) / (s1 - s0)


def heading(s: float, exponent: int) -> float:
    """Eq 3.20 in rad, with an exponent of its last term, at s from the start of the spiral."""
    s0, s1, c0, c1 = SPIRAL
    ramp = (c1 / 2 * (s - s0) ** 2 - c0 / 2 * (s - s1) ** 2) / (s1 - s0)
    return ramp + c0 / 2 * (s1 - s0) ** exponent


def off_tangent(name: str, index: int) -> ClaimCheck:
    """Check of the angle of a tangent of eq 3.21 to the derivative of the rail's surface, degrees;
    name: 't1' or 't2', index: of the derivative."""
    one, other = LEVEL[f"3.21 {name}"], tangents(rail, 0.0, 0.0)[index]
    cosine = abs(one @ other) / np.linalg.norm(one) / np.linalg.norm(other)
    angle = math.degrees(math.acos(min(1.0, float(cosine))))
    return number(f"{name}: angle to the derivative of the surface, deg", angle, 0.0)


def wheel_tangent(index: int, exact: list[float]) -> Rule:
    """Rule of eq 3.38 (index 0) or 3.40 (1) against the derivative of eq 3.27."""
    printed = wheel_tangents_printed(cone, S1, S2)[index]
    ours = tangents(wheel, S1, S2)[index]
    return lambda f: Finding([equation("derivative of eq 3.27", printed, exact, ours)])


def contact_conditions(facts: Facts) -> Finding:
    """Whether eqs 4.1 to 4.4 hold at the true contact of a 1:20 cone on a crown of one radius, and
    exclude a gap of 1 mm there."""
    y = -RAIL_RADIUS * CONE / math.hypot(1, CONE)
    s1 = HALF_AXLE + y
    height = np.array([0.0, 0.0, crown(y) + cone(s1)])
    normal = np.array([0.0, y, math.sqrt(RAIL_RADIUS**2 - y**2)]) / RAIL_RADIUS
    touching, apart = (
        contact_residuals(
            rail,
            lambda s, t, lift=lift: wheel(s, t) + height + lift * normal,  # type: ignore[misc]
            (0.0, y),
            (s1, math.pi),
        )[:4]
        for lift in (0.0, 1.0)
    )
    left = float(np.abs(apart).max())
    return Finding(
        [
            equation("hold where the bodies touch", touching, np.zeros(4)),
            statement("exclude a gap of 1 mm", "yes", f"residual {left:.0e}", left > 1e-6),
        ],
        "A fifth condition is missing, n.r = 0, with the height of the axle as fifth unknown.",
    )


def constant_coefficients(facts: Facts) -> Finding:
    """Whether the factors of k cos(s2w) in eqs 4.23 and 4.25 follow from eq 4.21, and depend on the
    angles."""
    r = difference_printed(YAW, BANK, HALF_AXLE, (1.0, 0.0, HALF_AXLE), 0.0)
    printed = angle_coefficients(YAW, BANK)
    spread = float(np.ptp([angle_coefficients(*pair) for pair in ANGLES], axis=0).max())
    return Finding(
        [
            equation("follow from eq 4.21", printed, [float(t @ r) for t in (T1, T2)]),
            statement("depend on the angles", "yes", f"spread {spread:.0e}", spread > 1e-9),
        ],
        f"A^2 + m^2 = B^2 + n^2 = 1 makes them {abs(printed[0]):.0f} and {printed[1]:.0f}.",
    )


def rail_position(facts: Facts) -> Finding:
    """Position on the rail by eqs 4.31 and 4.32 against a wheel lowered on the real profile."""
    largest = max(abs(each.numerator) for each in REDUCED) / HALF_AXLE
    b3 = reduced_equations(YAW, BANK, HALF_AXLE).b3
    step = difference_printed(YAW, BANK, HALF_AXLE, (0.0, 0.0, HALF_AXLE), 1.0)
    upright, tilted, level = (facts.profiles[f"y cone20 {i}"] for i in ("0", "1:40", "1:20"))
    shown = f"{largest:.0e} at any angle"
    return Finding(
        [
            statement("numerator of eq 4.31 is a result", "yes", shown, largest > 1e-9),
            number("1:20 cone, 54E1 upright", "0", upright, "mm"),
            number("1:20 cone, 54E1 inclined 1:40", "0", tilted, "mm"),
        ],
        "p1 = L a2 and p2 = L b2 make it L a2 b2 - L b2 a2. A 1:20 cone does touch a rail "
        f"inclined 1:20 at {abs(level):.2f} mm: the cone is level there. Nor does b3 follow from "
        f"eq 4.21: {b3:.3f} as printed, {float(T1 @ step):.3f} by substitution.",
    )


LOWEST = minimize_scalar(lambda angle: wheel(S1, angle)[2], bounds=(0, 2 * math.pi))
S1W = [r.s1w_printed for r, (yaw, bank) in zip(REDUCED, ANGLES, strict=True) if yaw != bank]
SPREAD = float(np.ptp(S1W)) / HALF_AXLE
"""Of s1w by eq 4.33 over all angles but equal ones, for which it is 0/0; over L."""
RULES: dict[int, Rule] = {
    3: turn("z", Z, rotation(yaw=YAW)),
    4: turn(
        "x",
        X,
        rotation(bank=BANK),
        "A turn by zero must change nothing; this one mirrors x, and turns y and z the wrong way.",
    ),
    5: turn("y", Y, rotation(pitch=PITCH)),
    6: lambda f: Finding(
        [equation("eq 3.8 = eq 3.9", X @ Y, Z @ X @ Y)], "A slip: eq 3.9 has all three."
    ),
    7: product(
        PRINTED["3.10"],
        Z @ X,
        "Multiplied correctly, but the mirror image of eq 3.6 stays in.",
    ),
    8: product(PRINTED["3.12"], Z @ X @ Y),
    # Eqs 3.13 to 3.17: curvature times cos(grade) times the arc length of a helix, turned 0.7 rad
    9: lambda f: Finding(
        [
            number(
                "heading along a helix, rad",
                math.cos(PITCH)
                / RAIL_RADIUS
                * quad(lambda t: RAIL_RADIUS * math.hypot(1.0, math.tan(PITCH)), 0, 0.7)[0],
                0.7,
            )
        ]
    ),
    10: lambda f: Finding(
        [
            equation(
                "straight line between both ends",
                [curvature(s) for s in np.linspace(*SPIRAL[:2], 5)],
                np.linspace(*SPIRAL[2:], 5),
            )
        ]
    ),
    # Eq 3.20, the integral of eq 3.19, with both exponents of its last term
    11: lambda f: Finding(
        [
            number(
                "heading after 40 m of a 50 m spiral, rad",
                heading(40.0, 2),
                heading(40.0, 1),
                ours=quad(curvature, SPIRAL[0], 40.0)[0],
            )
        ],
        "The last term has the unit m instead of rad: its exponent must be 1. "
        "Without effect in chapter 5, where C0 = 0.",
    ),
    # Eq 3.21 against the columns of the matrix and against derivatives of the surface
    12: lambda f: Finding(
        [
            equation("t1 is column 1", T1, NO_PITCH[:, 0]),
            equation("t2 is column 2", T2, NO_PITCH[:, 1]),
            off_tangent("t1", 0),
            off_tangent("t2", 1),
        ],
        "Eq 3.21 lists columns 2 and 3: t1 points across the rail, t2 along its normal.",
    ),
    13: lambda f: Finding(
        [
            number("sideways move over 10 mm, mm", float(10.0 * LEVEL["3.21 t2"][1]), 10.0),
            number("rise, mm", float(10.0 * LEVEL["3.21 t2"][2]), crown(10.0)),
        ],
        "Integrating along the normal climbs vertically and never leaves the centre line.",
    ),
    # Eq 3.27: points of the wheel
    14: lambda f: Finding(
        [
            equation(
                "distance from the axle is g(s1)",
                [math.hypot(*wheel(S1, angle)[[0, 2]]) for angle in np.linspace(0, 6, 7)],
                np.full(7, cone(S1)),
            )
        ]
    ),
    15: wheel_tangent(0, [-CONE * SIN2, 1, -CONE * C2]),
    16: wheel_tangent(1, [cone(S1) * C2, 0, -cone(S1) * SIN2]),
    # Eq 3.34: the text that was kept mixes the angles in columns 2 and 3
    17: lambda f: Finding(
        [
            equation(
                "column 1",
                [
                    -math.cos(YAW) * math.cos(PITCH),
                    -math.sin(YAW),
                    math.cos(YAW) * math.sin(PITCH),
                ],
                (Y @ Z @ X)[:, 0],
            ),
            proper(Y @ Z @ X),
        ],
        not_computable="the angles in columns 2 and 3 cannot be told apart in the text",
    ),
    18: lambda f: Finding(
        [
            statement("cylinder or cone on R300", "convex", "convex", f.ellipse.curvature_y > 0),
            statement(
                "S1002 at its rolling circle",
                "> 0",
                f.profiles["s1002_radius"],
                f.profiles["s1002_radius"] > 0,
                "mm",
            ),
        ],
        "The S1002 tread is hollow there and convex only beyond "
        f"y = {f.profiles['s1002_convex_from']:+.1f} mm.",
    ),
    # Patch small against the radii, small strain
    19: lambda f: Finding(
        [
            statement(what, "small", share, share < 0.05)
            for what, share in (
                ("a / R_wheel", f.ellipse.a * f.ellipse.curvature_x),
                ("b / R_crown", f.ellipse.b * f.ellipse.curvature_y),
                ("p0 / E*", f.ellipse.p0 / f.ellipse.contact_modulus),
            )
        ],
        f"They fail at the gauge corner: b / R13 = {f.ellipse.b / 13:.2f}.",
    ),
    20: contact_conditions,
    21: lambda f: Finding(
        [equation("point of the crown at s2 = 10 mm", 10.0 * LEVEL["3.21 t2"], rail(0.0, 10.0))],
        "The rail is a straight line along its own normal: the crown never enters.",
    ),
    22: lambda f: Finding(
        [equation("eq 3.10 of the thesis", PRINTED["4.8"], PRINTED["3.10"]), proper(PRINTED["4.8"])]
    ),
    23: product(PRINTED["4.13"], Z @ X),
    24: lambda f: Finding(
        [
            number(
                "term of row 2, mm",
                math.cos(YAW) * math.cos(BANK) * (S2 - HALF_AXLE),
                math.cos(YAW) * math.cos(BANK) * (S1 - HALF_AXLE),
            )
        ],
        "s2w (an angle) for s1w: a slip.",
    ),
    25: lambda f: Finding(
        [
            equation(
                "t2 x t1",
                wheel_normal_printed(cone, S1, S2),
                cone(S1) * np.array([SIN2, CONE, C2]),
                np.cross(*tangents(wheel, S1, S2)[::-1]),
            )
        ]
    ),
    26: constant_coefficients,
    # Eq 4.30, and the height of the wheel's point at s2w = 90 degrees above its lowest one
    27: lambda f: Finding(
        [
            number("angle of the contact, deg", "90", 180.0, ours=math.degrees(LOWEST.x)),
            number(
                "height over the lowest point, mm",
                float(wheel(S1, math.pi / 2)[2] - wheel(S1, math.pi)[2]),
                0.0,
            ),
        ],
        "With the rail's normal in the place of a tangent, eq 4.27 asks the wheel's normal to be "
        "level: a point at the height of the axle. The correct tangent gives sin(s2w) = 0.",
    ),
    28: rail_position,
    # Eq 4.33 at many angles
    29: lambda f: Finding(
        [statement("depends on the angles", "yes", f"L within {SPREAD:.0e}", SPREAD > 1e-6)],
        "The same identity leaves s1w = L: the middle of the tread, whatever the angles.",
    ),
}
