"""Claims 2 and 60 to 89: stresses, method, figures and conclusions (5.4 to 7)."""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies.thesis.claims import (
    CLOSE_CURVE,
    EXACT,
    ClaimCheck,
    Finding,
    Grade,
    Rule,
    itself,
    number,
    statement,
)
from studies.thesis.facts import LOAD, P0, WHEEL, YIELD, A, Facts, thesis_axis_stress

CAPACITY = (600.0, 800.0)  # MPa, the range the thesis takes from Pau et al. (2002)
NO_PICTURE = "the picture is missing from the text"


def tension(facts: Facts) -> Finding:
    """Where the contact stresses are tensile: at the ends of the semi-axes, and at the centre."""
    c, centre = facts.ellipse, float(facts.stress(0.0).max())
    ends = subsurface.stress(c, facts.poisson, [[c.a, 0, 0], [0, c.b, 0]])
    edge = float(subsurface.principal(ends).max())
    where, fe = "largest stress at the centre", facts.fe.get("s_x")
    return Finding(
        [
            statement("largest stress on the edge", "tensile", edge, edge > 0, "MPa"),
            statement(where, "tensile", centre, centre > 0, "MPa", fe),
        ],
        f"Tension is highest on the edge, {edge / c.p0:.3f} p0; below, all is pressed.",
    )


def equal_stresses(facts: Facts) -> Finding:
    """Whether s_x = s_y, by their ratio at the centre and where the shear is largest."""
    depth, fe = facts.extrema.tau_max_depth, facts.fe
    top, below = facts.stress(0.0), facts.stress(depth)
    ours = fe["s_x"] / fe["s_y"] if fe else None
    return Finding(
        [
            number("s_x / s_y at the centre", 1.0, float(top[0] / top[1]), ours=ours),
            number(f"s_x / s_y, {depth:.3f} mm deep", 1.0, float(below[0] / below[1])),
        ],
        f"{top[0]:.1f} and {top[1]:.1f} MPa at the centre. Only a circular patch makes them equal.",
    )


def formula(component: int, names: dict[str, int]) -> Rule:
    """Rule of eq 5.2 (component 0, s_x and s_y) or 5.3 (1, s_z), against exact stresses on a
    circular patch and on that of the case.

    names: index among s_x, s_y, s_z of each stress that the equation is for.
    """

    def rule(facts: Facts) -> Finding:
        c, column = facts.circle, 2 * component
        depths = np.linspace(0, 3 * c.a, 31)
        printed = thesis_axis_stress(c.p0, c.a, facts.poisson, depths)[:, column]
        exact = c.axis_stress(facts.poisson, depths)[:, column]
        off = float(np.abs(printed - exact).max()) / c.p0
        checks = [
            number(
                f"{name} at z = {share:g} a",
                facts.printed_stress(share * facts.ellipse.a)[component],
                float(facts.stress(share * facts.ellipse.a)[i]),
                "MPa",
                facts.fe.get(f"{name} at {share:g} a"),
            )
            for share in (0.5, 1.0)
            for name, i in names.items()
        ]
        return Finding(
            [statement("circular patch: off by, of p0", 0.0, off, off < 1e-9), *checks],
            "A formula for circles, used with the longer semi-axis as radius.",
        )

    return rule


def shear_plane(facts: Facts) -> Finding:
    """Angle to s_3 at which the shear on planes through the direction of s_x is largest, against 45
    degrees."""
    _, s_y, s_z = facts.stress(facts.extrema.tau_max_depth)
    best = minimize_scalar(
        lambda angle: -abs((s_y - s_z) * math.sin(angle) * math.cos(angle)),
        bounds=(0, math.pi / 2),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return Finding([number("angle to s_3, deg", "45", math.degrees(best.x))])


def circle_difference(facts: Facts) -> float:
    """|s_x - s_y| over p0 at the centre of a circular patch of the bodies' mean curvature."""
    s_x, s_y, _ = facts.circle.axis_stress(facts.poisson, 0.0)[0]
    return abs(float(s_x - s_y)) / facts.circle.p0


def falls_with_depth(facts: Facts) -> bool:
    """Whether |s_z| falls all along the axis, down to five semi-axes."""
    depth = np.linspace(0, 5 * facts.ellipse.a, 101)
    s_z = facts.ellipse.axis_stress(facts.poisson, depth)[:, 2]
    return bool(np.all(np.diff(np.abs(s_z)) < 0))


def highest_in_the_outer_layer(facts: Facts) -> Finding:
    """Depths of the largest von Mises stress and shear, against the surface."""
    found, fe = facts.extrema, facts.fe
    top = np.append(facts.stress(0.0), np.zeros(3))[None]
    mises, shear = "depth of the largest von Mises stress", "depth of the largest shear"
    return Finding(
        [
            number(mises, 0.0, found.von_mises_max_depth, "mm", fe.get("mises_depth")),
            number(shear, 0.0, found.tau_max_depth, "mm", fe.get("tau_depth")),
        ],
        f"Von Mises: {float(subsurface.von_mises(top)[0]):.1f} MPa at the surface, "
        f"{found.von_mises_max:.1f} MPa below. Only "
        "s_z and the pressure are highest in the outer layer.",
    )


def stress_with_depth(facts: Facts) -> Finding:
    """Largest differences of the curves of figure 6.7, drawn by the thesis's formulas, from exact
    stresses, down to three semi-axes."""
    depth = np.linspace(0, 3 * facts.ellipse.a, 61)
    exact = facts.ellipse.axis_stress(facts.poisson, depth)
    off = np.abs(thesis_axis_stress(P0, A, facts.poisson, depth) - exact).max(axis=0)
    checks = []
    for name, value in zip(("s_x", "s_y", "s_z"), off / facts.ellipse.p0, strict=True):
        close = Grade.CLOSE if value <= CLOSE_CURVE else Grade.FAILS
        what = f"{name}: largest difference of the curves, of p0"
        checks.append(ClaimCheck(what, float(value), 0.0, Grade.HOLDS if value <= EXACT else close))
    return Finding(checks, "Judged by the formulas: the picture is missing from the text.")


def tensile_load(facts: Facts) -> Finding:
    """Whether the least pressure anywhere, in and around the patch, is tensile."""
    c = facts.ellipse
    x, y = np.meshgrid(np.linspace(0, 2 * c.a, 41), np.linspace(0, 2 * c.b, 41))
    least = float(c.pressure(x, y).min())
    return Finding(
        [statement("least contact pressure", "negative", least, least < 0, "MPa")],
        "Nothing holds the wheel down on the rail: contact can only press.",
    )


def nail(facts: Facts, what: str, size: float, key: str) -> ClaimCheck:
    """Check whether a side of the patch, `size` mm, is as wide as a fingernail, 5 to 15 mm; key: of
    the semi-axis in `Facts.fe`."""
    ours = 2 * facts.fe[key] if facts.fe else None
    return statement(f"{what} of the patch", "5-15", size, 5 <= size <= 15, "mm", ours)


def least_shear(facts: Facts) -> Finding:
    """Largest shear at the centre against the least on the axis and on both semi-axes."""
    c = facts.ellipse
    ends = np.array([[0, 0, -3 * c.a], [c.a, 0, 0], [0, c.b, 0]])
    points = np.concatenate([np.linspace(0, 1, 41)[:, None] * end for end in ends])
    least = float(subsurface.max_shear(subsurface.stress(c, facts.poisson, points)).min())
    return Finding(
        [number("shear at the centre, as the least of all", facts.surface_shear, least, "MPa")],
        "Least of the axis and of both semi-axes. The largest one lies below the centre.",
    )


def yields(facts: Facts, contact: Ellipse, key: str) -> ClaimCheck:
    """Check whether the largest von Mises stress of a contact is below the yield stress of R260;
    key: of that stress in `Facts.fe`."""
    value = contact.axis_extrema(facts.poisson).von_mises_max
    what = f"largest von Mises stress at {contact.load / 1000:.4g} kN"
    limit, ours = f"< {YIELD[1]:g}", facts.fe.get(key)
    return statement(what, limit, value, value < YIELD[1], "MPa", ours)


RULES: dict[int, Rule] = {
    2: tension,
    60: tensile_load,
    61: equal_stresses,
    62: formula(0, {"s_x": 0, "s_y": 1}),
    63: formula(1, {"s_z": 2}),
    64: shear_plane,
    65: lambda f: Finding(
        [number("tau at the centre", 0.0, f.surface_shear, "MPa", f.fe.get("tau_surface"))],
        f"{f.surface_shear / f.ellipse.p0:.4f} p0; its own formulas give "
        f"{(f.printed_stress(0.0)[0] - f.printed_stress(0.0)[1]) / 2:.2f} MPa.",
    ),
    66: lambda f: Finding(
        [
            statement(
                "below the surface",
                "yes",
                f.extrema.tau_max_depth,
                f.extrema.tau_max_depth > 0,
                "mm",
                f.fe.get("tau_depth"),
            ),
            number("depth", "2.17", f.extrema.tau_max_depth, "mm", f.fe.get("tau_depth")),
        ],
        f"{f.extrema.tau_max_depth / f.ellipse.a:.4f} a or "
        f"{f.extrema.tau_max_depth / f.ellipse.b:.4f} b; eqs 5.2 and 5.3 have it at "
        f"{f.printed_shear[0] / A:.4f} a.",
    ),
    # The thesis draws it and does not print it
    67: lambda f: Finding(
        [number("tau_max", f.printed_shear[1], f.extrema.tau_max, "MPa", f.fe.get("tau_max"))]
    ),
    # Half of s_1 - s_2 where the shear is largest
    68: lambda f: Finding(
        [
            number(
                "tau_max",
                abs(float(np.subtract(*f.stress(f.extrema.tau_max_depth)[:2]))) / 2,
                f.extrema.tau_max,
                "MPa",
                f.fe.get("tau_max"),
            )
        ],
        "It is (s_1 - s_3)/2. With s_1 = s_2, as the thesis has it, its recipe would give 0.",
    ),
    # Other approaches: boundary elements, and finite elements with non-matching meshes
    69: lambda f: Finding(
        [
            statement(
                "p0 without nodes in contact: off by",
                "inappropriate",
                abs(f.boundary_element_p0 / f.ellipse.p0 - 1),
                abs(f.boundary_element_p0 / f.ellipse.p0 - 1) > 0.01,
                ours=f"{f.fe['p0_error']:.2g}" if f.fe else None,
            )
        ],
        "Exact here: boundary elements. Node-to-node contact needs matching meshes and forbids "
        "sliding; surface-to-surface, mortar and Nitsche's method are standard.",
    ),
    # Patch over radius at the true angle, 180 degrees
    70: lambda f: Finding(
        [
            statement(
                "a / R at 180 deg",
                "conformal",
                f.ellipse.a * f.ellipse.curvature_x,
                f.ellipse.a * f.ellipse.curvature_x > 0.1,
            )
        ],
        "The statement rests on eq 4.30 (see 27). Conformal means: as wide as the radii.",
    ),
    # An ellipse has two planes of symmetry, too
    71: lambda f: Finding(
        [
            number(
                "s_x / s_y with two planes of symmetry",
                1.0,
                float(f.stress(0.0)[0] / f.stress(0.0)[1]),
            )
        ],
        "Rotational symmetry is needed.",
    ),
    # A circular patch of finite size
    72: lambda f: Finding(
        [
            statement(
                f"s_x - s_y over p0, circle of {f.circle.a:.2f} mm",
                "not 0",
                circle_difference(f),
                circle_difference(f) > EXACT,
            )
        ],
        "The ellipse parts them, not the size of the patch.",
    ),
    73: lambda f: Finding(
        [
            statement(
                "|s_z| at the surface",
                "largest",
                -float(f.stress(0.0)[2]),
                falls_with_depth(f),
                "MPa",
                -f.fe["s_z"] if f.fe else None,
            )
        ]
    ),
    74: highest_in_the_outer_layer,
    75: lambda f: Finding(
        [
            statement(
                f"p0 under {WHEEL / 1000:.1f} kN",
                "600-800",
                f.real.p0,
                CAPACITY[0] <= f.real.p0 <= CAPACITY[1],
                "MPa",
                f.fe.get("p0_axle"),
            )
        ],
        "Pau et al. name 600-800 MPa as the pressures of their tests, not as a limit.",
    ),
    76: lambda f: Finding(
        [],
        "p0 sqrt(1 - x^2/a^2): "
        + ", ".join(f"{f.ellipse.pressure(x * f.ellipse.a, 0):.1f}" for x in (0, 0.5, 1))
        + " MPa at 0, a/2, a. Drawn above.",
        NO_PICTURE,
    ),
    # Eq 5.3 read along the radius instead of the depth
    77: lambda f: Finding(
        [
            number(
                f"-s_z on the surface at x = {share:g} a",
                -f.printed_stress(share * A)[1],
                float(f.ellipse.pressure(share * f.ellipse.a, 0)),
                "MPa",
                f.fe.get(f"p at {share:g} a"),
            )
            for share in (0.5, 1.0)
        ],
        "Eqs 5.2 and 5.3 are functions of the depth.",
    ),
    78: stress_with_depth,
    79: lambda f: Finding(
        [], f"p0 = {f.ellipse.p0:.2f} MPa (F / 25 kN)^(1/3). Drawn above.", NO_PICTURE
    ),
    80: lambda f: Finding(
        [], f"a = {f.ellipse.a:.4f} mm (F / 25 kN)^(1/3). Drawn above.", NO_PICTURE
    ),
    81: lambda f: Finding(
        [],
        f"With the load, p0 = {f.ellipse.p0 / f.ellipse.a:.2f} MPa/mm a grows; at one load and "
        f"shape, p0 = {f.ellipse.p0 * f.ellipse.a**2:.0f} N/a^2 falls. Both are drawn above.",
        "the text does not say what changes the radius",
    ),
    82: lambda f: Finding([], not_computable="no quantity and no source are given"),
    # Peak stress of a patch grown by the load
    83: lambda f: Finding(
        [
            statement(
                "p0 when the load doubles",
                "decreases",
                f"x {f.under(2 * f.ellipse.load).p0 / f.ellipse.p0:.3f}",
                f.under(2 * f.ellipse.load).p0 < f.ellipse.p0,
            )
        ],
        "Mistaken for the distance from the centre, with which the stresses do fall.",
    ),
    84: lambda f: Finding(
        [
            number(
                "mean over largest pressure",
                1.0,
                f.ellipse.p_mean / f.ellipse.p0,
                ours=f.fe["p_mean"] / f.fe["p0"] if f.fe else None,
            ),
            statement(
                "p / p0 on the edge",
                "finite",
                float(f.ellipse.pressure(f.ellipse.a, 0)) / f.ellipse.p0,
                bool(f.ellipse.pressure(f.ellipse.a, 0) > 0),
            ),
        ]
    ),
    85: lambda f: Finding(
        [number("mean pressure", "794.9", f.ellipse.p_mean, "MPa", f.fe.get("p_mean"))],
        "794.9 MPa is the peak; the mean is two thirds of it.",
    ),
    86: lambda f: Finding([itself("load of one wheel", "25000", LOAD / 2, "N")], "See 39."),
    87: lambda f: Finding(
        [
            nail(f, "length", 2 * f.ellipse.a, "a"),
            nail(f, "width", 2 * f.ellipse.b, "b"),
        ],
        f"Area {math.pi * f.ellipse.a * f.ellipse.b:.2f} mm^2.",
    ),
    88: least_shear,
    89: lambda f: Finding(
        [yields(f, f.ellipse, "mises_max"), yields(f, f.real, "mises_axle")],
        f"R260 yields at {YIELD[0]:g} to {YIELD[1]:g} MPa. 25 kN is at the limit, a real wheel "
        "far beyond it.",
    ),
}
