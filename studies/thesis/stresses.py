"""Claims 2, 61 to 68, 71 to 74 and 77: stresses on the patch and below it (5.4, 6)."""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse, point_contact
from studies.thesis.claims import EXACT, Facts, Finding, Rules, number, statement
from studies.thesis.formulas import Array, thesis_axis_stress

rules = Rules()
P0, A = 794.9, 4.34  # MPa, mm, as printed: what the thesis puts into eqs 5.2 and 5.3


def thesis_stress(facts: Facts, depth: float) -> tuple[float, float]:
    """s_x = s_y and s_z in MPa by eqs 5.2 and 5.3 with the printed p_max and a."""
    s_x, _, s_z = thesis_axis_stress(P0, A, facts.poisson, depth)[0]
    return float(s_x), float(s_z)


def exact_stress(facts: Facts, depth: float) -> Array:
    """s_x, s_y, s_z (3,) in MPa on the axis."""
    return np.asarray(subsurface.axis_stress(facts.ellipse, facts.poisson, depth)[0])


def edge_stress(contact: Ellipse, poisson: float) -> Array:
    """Stresses (2, 6) at the ends of both semi-axes."""
    return subsurface.stress(contact, poisson, [[contact.a, 0, 0], [0, contact.b, 0]])


def circular(contact: Ellipse) -> Ellipse:
    """A circular contact of the same bodies' mean curvature."""
    mean = (contact.curvature_x + contact.curvature_y) / 2
    return point_contact(mean, mean, contact.contact_modulus, contact.load)


@rules(2)
def tension(facts: Facts) -> Finding:
    """Where the contact stresses are tensile."""
    edge = float(subsurface.principal(edge_stress(facts.ellipse, facts.poisson)).max())
    centre = float(exact_stress(facts, 0.0).max())
    return Finding(
        [
            statement("largest stress on the edge", "tensile", edge, edge > 0, "MPa"),
            statement(
                "largest stress at the centre",
                "tensile",
                centre,
                centre > 0,
                "MPa",
                facts.fe.get("s_x"),
            ),
        ],
        f"Tension is highest on the edge, {edge / facts.ellipse.p0:.3f} p0; below, all is pressed.",
    )


@rules(61)
def equal_stresses(facts: Facts) -> Finding:
    """s_x over s_y at the centre and where the shear is largest."""
    depth = subsurface.axis_extrema(facts.ellipse, facts.poisson).tau_max_depth
    top, below = exact_stress(facts, 0.0), exact_stress(facts, depth)
    fe = facts.fe
    ours = fe["s_x"] / fe["s_y"] if fe else None
    return Finding(
        [
            number("s_x / s_y at the centre", 1.0, float(top[0] / top[1]), ours=ours),
            number(f"s_x / s_y, {depth:.3f} mm deep", 1.0, float(below[0] / below[1])),
        ],
        f"{top[0]:.1f} and {top[1]:.1f} MPa at the centre. Only a circular patch makes them equal.",
    )


def formula(facts: Facts, component: int) -> Finding:
    """Eq 5.2 (component 0, s_x and s_y) or 5.3 (1, s_z), on a circular patch and on this one."""
    column = 2 * component
    c = circular(facts.ellipse)
    depth = np.linspace(0, 3 * c.a, 31)
    printed = thesis_axis_stress(c.p0, c.a, facts.poisson, depth)[:, column]
    exact = subsurface.axis_stress(c, facts.poisson, depth)[:, column]
    off = float(np.abs(printed - exact).max()) / c.p0
    checks = [statement("circular patch: off by, of p0", 0.0, off, off < 1e-9)]
    for share in (0.5, 1.0):
        depth_here = share * facts.ellipse.a
        thesis, true = thesis_stress(facts, depth_here)[component], exact_stress(facts, depth_here)
        names = ("s_x", "s_y") if component == 0 else ("s_z",)
        for name, value in zip(names, true[column : column + len(names)], strict=True):
            ours = facts.fe.get(f"{name} at {share:g} a")
            checks.append(number(f"{name} at z = {share:g} a", thesis, float(value), "MPa", ours))
    return Finding(checks, "A formula for circles, used with the longer semi-axis as radius.")


@rules(62)
def equation_5_2(facts: Facts) -> Finding:
    """Eq 5.2."""
    return formula(facts, 0)


@rules(63)
def equation_5_3(facts: Facts) -> Finding:
    """Eq 5.3."""
    return formula(facts, 1)


@rules(64)
def shear_plane(facts: Facts) -> Finding:
    """Shear on planes through s_x, turned from s_z: largest at 45 degrees."""
    depth = subsurface.axis_extrema(facts.ellipse, facts.poisson).tau_max_depth
    _, s_y, s_z = exact_stress(facts, depth)
    best = minimize_scalar(
        lambda angle: -abs((s_y - s_z) * math.sin(angle) * math.cos(angle)),
        bounds=(0, math.pi / 2), method="bounded", options={"xatol": 1e-9},
    )  # fmt: skip
    return Finding([number("angle to s_3, deg", "45", math.degrees(best.x))])


@rules(65)
def surface_shear(facts: Facts) -> Finding:
    """Largest shear at the centre of the patch."""
    s_x, s_z = thesis_stress(facts, 0.0)
    tau = float(np.ptp(exact_stress(facts, 0.0))) / 2
    return Finding(
        [number("tau at the centre", 0.0, tau, "MPa", facts.fe.get("tau_surface"))],
        f"{tau / facts.ellipse.p0:.4f} p0; its own formulas give {(s_x - s_z) / 2:.2f} MPa.",
    )


@rules(66)
def shear_depth(facts: Facts) -> Finding:
    """Depth of the largest shear."""
    c = facts.ellipse
    depth = subsurface.axis_extrema(c, facts.poisson).tau_max_depth
    ours = facts.fe.get("tau_depth")
    return Finding(
        [
            statement("below the surface", "yes", depth, depth > 0, "mm", ours),
            number("depth", "2.17", depth, "mm", ours),
        ],
        f"{depth / c.a:.4f} a or {depth / c.b:.4f} b; eqs 5.2 and 5.3 have it at "
        f"{thesis_shear(facts)[0] / A:.4f} a.",
    )


def thesis_shear(facts: Facts) -> tuple[float, float]:
    """Depth in mm and value in MPa of the largest shear by eqs 5.2 and 5.3."""

    def negative(depth: float) -> float:
        s_x, s_z = thesis_stress(facts, depth)
        return (s_z - s_x) / 2

    best = minimize_scalar(negative, bounds=(0, A), method="bounded", options={"xatol": 1e-9})
    return float(best.x), -float(best.fun)


@rules(67)
def shear_value(facts: Facts) -> Finding:
    """Largest shear by eqs 5.2 and 5.3, which the thesis draws and does not print."""
    exact = subsurface.axis_extrema(facts.ellipse, facts.poisson).tau_max
    thesis = thesis_shear(facts)[1]
    return Finding([number("tau_max", thesis, exact, "MPa", facts.fe.get("tau_max"))])


@rules(68)
def shear_from_first_two(facts: Facts) -> Finding:
    """Half of s_1 - s_2 where the shear is largest."""
    extrema = subsurface.axis_extrema(facts.ellipse, facts.poisson)
    s_x, s_y, _ = exact_stress(facts, extrema.tau_max_depth)
    half = abs(float(s_x - s_y)) / 2
    return Finding(
        [number("tau_max", half, extrema.tau_max, "MPa", facts.fe.get("tau_max"))],
        "It is (s_1 - s_3)/2. With s_1 = s_2, as the thesis has it, its recipe would give 0.",
    )


@rules(71)
def two_planes(facts: Facts) -> Finding:
    """An ellipse has two planes of symmetry, too."""
    s_x, s_y, _ = exact_stress(facts, 0.0)
    return Finding(
        [number("s_x / s_y with two planes of symmetry", 1.0, float(s_x / s_y))],
        "Rotational symmetry is needed.",
    )


@rules(72)
def growth_of_the_point(facts: Facts) -> Finding:
    """A circular patch of finite size."""
    c = circular(facts.ellipse)
    s_x, s_y, _ = subsurface.axis_stress(c, facts.poisson, 0.0)[0]
    apart = abs(float(s_x - s_y)) / c.p0
    return Finding(
        [statement(f"s_x - s_y over p0, circle of {c.a:.2f} mm", "not 0", apart, apart > EXACT)],
        "The ellipse parts them, not the size of the patch.",
    )


@rules(73)
def pressure_with_depth(facts: Facts) -> Finding:
    """s_z on the axis."""
    depth = np.linspace(0, 5 * facts.ellipse.a, 101)
    s_z = subsurface.axis_stress(facts.ellipse, facts.poisson, depth)[:, 2]
    falls = bool(np.all(np.diff(np.abs(s_z)) < 0))
    return Finding(
        [
            statement("|s_z| at the surface", "largest", float(-s_z[0]), falls, "MPa",
                      -facts.fe["s_z"] if facts.fe else None)
        ]
    )  # fmt: skip


@rules(74)
def highest_in_the_outer_layer(facts: Facts) -> Finding:
    """Where von Mises stress and shear are largest."""
    found = subsurface.axis_extrema(facts.ellipse, facts.poisson)
    top = np.append(exact_stress(facts, 0.0), np.zeros(3))[None]
    surface = float(subsurface.von_mises(top)[0])
    return Finding(
        [
            number("depth of the largest von Mises stress", 0.0, found.von_mises_max_depth, "mm",
                   facts.fe.get("mises_depth")),
            number("depth of the largest shear", 0.0, found.tau_max_depth, "mm",
                   facts.fe.get("tau_depth")),
        ],
        f"Von Mises: {surface:.1f} MPa at the surface, {found.von_mises_max:.1f} MPa below. Only "
        "s_z and the pressure are highest in the outer layer.",
    )  # fmt: skip


@rules(77)
def depth_for_radius(facts: Facts) -> Finding:
    """Eq 5.3 read along the radius instead of the depth."""
    c = facts.ellipse
    return Finding(
        [
            number(f"-s_z on the surface at x = {share:g} a", -thesis_stress(facts, share * A)[1],
                   float(c.pressure(share * c.a, 0)), "MPa", facts.fe.get(f"p at {share:g} a"))
            for share in (0.5, 1.0)
        ],
        "Eqs 5.2 and 5.3 are functions of the depth.",
    )  # fmt: skip
