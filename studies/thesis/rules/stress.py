"""Claims 2 and 60 to 89: stresses, method, figures and conclusions (5.4 to 7)."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies.thesis.claims import (
    CLOSE_CURVE,
    EXACT,
    Check,
    Finding,
    Grade,
    Rule,
    itself,
    number,
    statement,
)
from studies.thesis.facts import LOAD, P0, WHEEL, YIELD, A, Facts
from studies.thesis.formulas import thesis_axis_stress

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
    """s_x over s_y at the centre and where the shear is largest."""
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
    """Eq 5.2 (component 0, s_x and s_y) or 5.3 (1, s_z), on a circular patch and on this one.

    names: index among s_x, s_y, s_z of each stress that the equation is for.
    """

    def rule(facts: Facts) -> Finding:
        c, column = facts.circle, 2 * component
        depths = np.linspace(0, 3 * c.a, 31)
        printed = thesis_axis_stress(c.p0, c.a, facts.poisson, depths)[:, column]
        exact = subsurface.axis_stress(c, facts.poisson, depths)[:, column]
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
    """Shear on planes through s_x, turned from s_z: largest at 45 degrees."""
    _, s_y, s_z = facts.stress(facts.extrema.tau_max_depth)
    best = minimize_scalar(
        lambda angle: -abs((s_y - s_z) * math.sin(angle) * math.cos(angle)),
        bounds=(0, math.pi / 2),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return Finding([number("angle to s_3, deg", "45", math.degrees(best.x))])


def surface_shear(facts: Facts) -> Finding:
    """Largest shear at the centre of the patch."""
    (s_x, s_z), tau = facts.printed_stress(0.0), facts.surface_shear
    return Finding(
        [number("tau at the centre", 0.0, tau, "MPa", facts.fe.get("tau_surface"))],
        f"{tau / facts.ellipse.p0:.4f} p0; its own formulas give {(s_x - s_z) / 2:.2f} MPa.",
    )


def shear_depth(facts: Facts) -> Finding:
    """Depth of the largest shear."""
    c, depth, ours = facts.ellipse, facts.extrema.tau_max_depth, facts.fe.get("tau_depth")
    return Finding(
        [
            statement("below the surface", "yes", depth, depth > 0, "mm", ours),
            number("depth", "2.17", depth, "mm", ours),
        ],
        f"{depth / c.a:.4f} a or {depth / c.b:.4f} b; eqs 5.2 and 5.3 have it at "
        f"{facts.printed_shear[0] / A:.4f} a.",
    )


def shear_from_first_two(facts: Facts) -> Finding:
    """Half of s_1 - s_2 where the shear is largest."""
    s_x, s_y, _ = facts.stress(facts.extrema.tau_max_depth)
    half, ours = abs(float(s_x - s_y)) / 2, facts.fe.get("tau_max")
    return Finding(
        [number("tau_max", half, facts.extrema.tau_max, "MPa", ours)],
        "It is (s_1 - s_3)/2. With s_1 = s_2, as the thesis has it, its recipe would give 0.",
    )


def node_to_node(facts: Facts) -> Finding:
    """Other approaches: boundary elements, and finite elements with non-matching meshes."""
    off = abs(facts.boundary_element_p0 / facts.ellipse.p0 - 1)
    ours = f"{facts.fe['p0_error']:.2g}" if facts.fe else None
    what = "p0 without nodes in contact: off by"
    return Finding(
        [statement(what, "inappropriate", off, off > 0.01, ours=ours)],
        "Exact here: boundary elements. Node-to-node contact needs matching meshes and forbids "
        "sliding; surface-to-surface, mortar and Nitsche's method are standard.",
    )


def growth_of_the_point(facts: Facts) -> Finding:
    """A circular patch of finite size."""
    c = facts.circle
    s_x, s_y, _ = subsurface.axis_stress(c, facts.poisson, 0.0)[0]
    apart = abs(float(s_x - s_y)) / c.p0
    return Finding(
        [statement(f"s_x - s_y over p0, circle of {c.a:.2f} mm", "not 0", apart, apart > EXACT)],
        "The ellipse parts them, not the size of the patch.",
    )


def pressure_with_depth(facts: Facts) -> Finding:
    """s_z on the axis."""
    depth = np.linspace(0, 5 * facts.ellipse.a, 101)
    s_z = subsurface.axis_stress(facts.ellipse, facts.poisson, depth)[:, 2]
    falls = bool(np.all(np.diff(np.abs(s_z)) < 0))
    ours = -facts.fe["s_z"] if facts.fe else None
    return Finding(
        [statement("|s_z| at the surface", "largest", float(-s_z[0]), falls, "MPa", ours)]
    )


def highest_in_the_outer_layer(facts: Facts) -> Finding:
    """Where von Mises stress and shear are largest."""
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


def along_the_major_axis(facts: Facts) -> Finding:
    """Fig 6.4."""
    c = facts.ellipse
    values = ", ".join(f"{c.pressure(share * c.a, 0):.1f}" for share in (0, 0.5, 1))
    note = f"p0 sqrt(1 - x^2/a^2): {values} MPa at 0, a/2, a. Drawn above."
    return Finding([], note, NO_PICTURE)


def stress_with_depth(facts: Facts) -> Finding:
    """Fig 6.7: the formulas behind it over three semi-axes of depth."""
    depth = np.linspace(0, 3 * facts.ellipse.a, 61)
    exact = subsurface.axis_stress(facts.ellipse, facts.poisson, depth)
    off = np.abs(thesis_axis_stress(P0, A, facts.poisson, depth) - exact).max(axis=0)
    checks = []
    for name, value in zip(("s_x", "s_y", "s_z"), off / facts.ellipse.p0, strict=True):
        close = Grade.CLOSE if value <= CLOSE_CURVE else Grade.FAILS
        what = f"{name}: largest difference of the curves, of p0"
        checks.append(Check(what, float(value), 0.0, Grade.HOLDS if value <= EXACT else close))
    return Finding(checks, "Judged by the formulas: the picture is missing from the text.")


def figure(note: Callable[[Ellipse], str], why: str = NO_PICTURE) -> Rule:
    """The rule of a figure that cannot be judged; note: what it should show."""
    return lambda f: Finding([], note(f.ellipse), why)


def larger_ellipse(facts: Facts) -> Finding:
    """Peak stress of a patch grown by the load."""
    ratio = facts.under(2 * facts.ellipse.load).p0 / facts.ellipse.p0
    return Finding(
        [statement("p0 when the load doubles", "decreases", f"x {ratio:.3f}", ratio < 1)],
        "Mistaken for the distance from the centre, with which the stresses do fall.",
    )


def uniform(facts: Facts) -> Finding:
    """Mean over peak, and the edge."""
    c, fe = facts.ellipse, facts.fe
    ours, edge = fe["p_mean"] / fe["p0"] if fe else None, float(c.pressure(c.a, 0))
    return Finding(
        [
            number("mean over largest pressure", 1.0, c.p_mean / c.p0, ours=ours),
            statement("p / p0 on the edge", "finite", edge / c.p0, edge > 0),
        ]
    )


def tensile_load(facts: Facts) -> Finding:
    """The least pressure anywhere, in and around the patch."""
    c = facts.ellipse
    x, y = np.meshgrid(np.linspace(0, 2 * c.a, 41), np.linspace(0, 2 * c.b, 41))
    least = float(c.pressure(x, y).min())
    return Finding(
        [statement("least contact pressure", "negative", least, least < 0, "MPa")],
        "Nothing holds the wheel down on the rail: contact can only press.",
    )


def nail(facts: Facts, what: str, size: float, key: str) -> Check:
    """A side of the patch in mm; nails of fingers are about 5 to 15 mm wide."""
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


def yields(facts: Facts, contact: Ellipse, key: str) -> Check:
    """The largest von Mises stress of a contact against the yield stress of R260."""
    value = subsurface.axis_extrema(contact, facts.poisson).von_mises_max
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
    65: surface_shear,
    66: shear_depth,
    # The thesis draws it and does not print it
    67: lambda f: Finding(
        [number("tau_max", f.printed_shear[1], f.extrema.tau_max, "MPa", f.fe.get("tau_max"))]
    ),
    68: shear_from_first_two,
    69: node_to_node,
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
    72: growth_of_the_point,
    73: pressure_with_depth,
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
    76: along_the_major_axis,
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
    79: figure(lambda c: f"p0 = {c.p0:.2f} MPa (F / 25 kN)^(1/3). Drawn above."),
    80: figure(lambda c: f"a = {c.a:.4f} mm (F / 25 kN)^(1/3). Drawn above."),
    81: figure(
        lambda c: (
            f"With the load, p0 = {c.p0 / c.a:.2f} MPa/mm a grows; at one load and shape, "
            f"p0 = {c.p0 * c.a**2:.0f} N/a^2 falls. Both are drawn above."
        ),
        "the text does not say what changes the radius",
    ),
    82: lambda f: Finding([], not_computable="no quantity and no source are given"),
    83: larger_ellipse,
    84: uniform,
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
