"""Claims 60, 69, 70, 75, 76 and 78 to 89: method, figures and conclusions (5.4 to 7)."""

import math

import numpy as np

from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies.thesis.claims import (
    CLOSE_CURVE,
    EXACT,
    Check,
    Facts,
    Finding,
    Grade,
    Rules,
    itself,
    number,
    statement,
)
from studies.thesis.formulas import thesis_axis_stress
from studies.thesis.hertz import AXLE_LOAD, PRINTED_LOAD, under
from studies.thesis.stresses import P0, A, exact_stress

rules = Rules()
YIELD = (480.0, 520.0)  # MPa, of R260 rail steel
CAPACITY = (600.0, 800.0)  # MPa, the range the thesis takes from Pau et al. (2002)


def mises(contact: Ellipse, poisson: float) -> float:
    """Largest von Mises stress on the axis, MPa."""
    return subsurface.axis_extrema(contact, poisson).von_mises_max


@rules(60)
def tensile_load(facts: Facts) -> Finding:
    """The least pressure anywhere, in and around the patch."""
    c = facts.ellipse
    x, y = np.meshgrid(np.linspace(0, 2 * c.a, 41), np.linspace(0, 2 * c.b, 41))
    least = float(c.pressure(x, y).min())
    return Finding(
        [statement("least contact pressure", "negative", least, least < 0, "MPa")],
        "Nothing holds the wheel down on the rail: contact can only press.",
    )


@rules(69)
def node_to_node(facts: Facts) -> Finding:
    """Other approaches: boundary elements, and finite elements with non-matching meshes."""
    off = abs(facts.boundary_element_p0 / facts.ellipse.p0 - 1)
    return Finding(
        [
            statement("p0 without nodes in contact: off by", "inappropriate", off, off > 0.01,
                      ours=f"{facts.fe['p0_error']:.2g}" if facts.fe else None)
        ],
        "Exact here: boundary elements. Node-to-node contact needs matching meshes and forbids "
        "sliding; surface-to-surface, mortar and Nitsche's method are standard.",
    )  # fmt: skip


@rules(70)
def conformal(facts: Facts) -> Finding:
    """Patch over radius at the true angle, 180 degrees."""
    share = facts.ellipse.a * facts.ellipse.curvature_x
    return Finding(
        [statement("a / R at 180 deg", "conformal", share, share > 0.1)],
        "The statement rests on eq 4.30 (see 27). Conformal means: as wide as the radii.",
    )


@rules(75)
def capacity(facts: Facts) -> Finding:
    """Pressure under a real wheel."""
    real = under(facts.ellipse, AXLE_LOAD / 2)
    return Finding(
        [
            statement(
                f"p0 under {AXLE_LOAD / 2000:.1f} kN", "600-800", real.p0,
                CAPACITY[0] <= real.p0 <= CAPACITY[1], "MPa", facts.fe.get("p0_axle"),
            )
        ],
        "Pau et al. name 600-800 MPa as the pressures of their tests, not as a limit.",
    )  # fmt: skip


@rules(76)
def along_the_major_axis(facts: Facts) -> Finding:
    """Fig 6.4."""
    values = ", ".join(f"{facts.ellipse.pressure(s * facts.ellipse.a, 0):.1f}" for s in (0, 0.5, 1))
    return Finding(
        [],
        f"p0 sqrt(1 - x^2/a^2): {values} MPa at 0, a/2, a. Drawn above.",
        "the picture is missing from the text",
    )


@rules(78)
def stress_with_depth(facts: Facts) -> Finding:
    """Fig 6.7: the formulas behind it over three semi-axes of depth."""
    depth = np.linspace(0, 3 * facts.ellipse.a, 61)
    exact = subsurface.axis_stress(facts.ellipse, facts.poisson, depth)
    off = np.abs(thesis_axis_stress(P0, A, facts.poisson, depth) - exact).max(axis=0)
    checks = []
    for name, value in zip(("s_x", "s_y", "s_z"), off / facts.ellipse.p0, strict=True):
        grade = Grade.HOLDS if value <= EXACT else Grade.FAILS
        grade = Grade.CLOSE if EXACT < value <= CLOSE_CURVE else grade
        checks.append(
            Check(f"{name}: largest difference of the curves, of p0", float(value), 0.0, grade)
        )
    return Finding(checks, "Judged by the formulas: the picture is missing from the text.")


@rules(79)
def pressure_over_load(facts: Facts) -> Finding:
    """Fig 6.8."""
    c = facts.ellipse
    note = f"p0 = {c.p0:.2f} MPa (F / 25 kN)^(1/3). Drawn above."
    return Finding([], note, "the picture is missing from the text")


@rules(80)
def radius_over_load(facts: Facts) -> Finding:
    """Fig 6.9."""
    note = f"a = {facts.ellipse.a:.4f} mm (F / 25 kN)^(1/3). Drawn above."
    return Finding([], note, "the picture is missing from the text")


@rules(81)
def pressure_over_radius(facts: Facts) -> Finding:
    """Fig 6.10."""
    c = facts.ellipse
    return Finding(
        [],
        f"With the load, p0 = {c.p0 / c.a:.2f} MPa/mm a grows; at one load and shape, "
        f"p0 = {c.p0 * c.a**2:.0f} N/a^2 falls. Both are drawn above.",
        "the text does not say what changes the radius",
    )


@rules(82)
def causes(facts: Facts) -> Finding:
    """No quantity."""
    return Finding([], not_computable="no quantity and no source are given")


@rules(83)
def larger_ellipse(facts: Facts) -> Finding:
    """Peak stress of a patch grown by the load."""
    larger = under(facts.ellipse, 2 * facts.ellipse.load)
    ratio = larger.p0 / facts.ellipse.p0
    return Finding(
        [statement("p0 when the load doubles", "decreases", f"x {ratio:.3f}", ratio < 1)],
        "Mistaken for the distance from the centre, with which the stresses do fall.",
    )


@rules(84)
def uniform(facts: Facts) -> Finding:
    """Mean over peak, and the edge."""
    c, fe = facts.ellipse, facts.fe
    return Finding(
        [
            number("mean over largest pressure", 1.0, c.p_mean / c.p0,
                   ours=fe["p_mean"] / fe["p0"] if fe else None),
            statement("p / p0 on the edge", "finite", float(c.pressure(c.a, 0)) / c.p0,
                      float(c.pressure(c.a, 0)) > 0),
        ]
    )  # fmt: skip


@rules(85)
def average(facts: Facts) -> Finding:
    """Mean pressure."""
    return Finding(
        [number("mean pressure", "794.9", facts.ellipse.p_mean, "MPa", facts.fe.get("p_mean"))],
        "794.9 MPa is the peak; the mean is two thirds of it.",
    )


@rules(86)
def single_wheel(facts: Facts) -> Finding:
    """A wheel carries half of the axle load."""
    return Finding(
        [itself("load of one wheel", "25000", PRINTED_LOAD / 2, "N")],
        "See 39.",
    )


@rules(87)
def finger_nail(facts: Facts) -> Finding:
    """Size of the patch; nails of fingers are about 5 to 15 mm wide."""
    c, fe = facts.ellipse, facts.fe
    return Finding(
        [
            statement(f"{what} of the patch", "5-15", 2 * axis, 5 <= 2 * axis <= 15, "mm",
                      2 * fe[key] if fe else None)
            for what, axis, key in (("length", c.a, "a"), ("width", c.b, "b"))
        ],
        f"Area {math.pi * c.a * c.b:.2f} mm^2.",
    )  # fmt: skip


@rules(88)
def least_shear(facts: Facts) -> Finding:
    """Largest shear at the centre against the least on the axis and on the patch."""
    c = facts.ellipse
    centre = float(np.ptp(exact_stress(facts, 0.0))) / 2
    steps = np.linspace(0, 1, 41)
    zero = np.zeros_like(steps)
    points = np.concatenate(
        [
            np.column_stack(columns)
            for columns in ((zero, zero, -3 * c.a * steps), (c.a * steps, zero, zero),
                            (zero, c.b * steps, zero))
        ]
    )  # fmt: skip
    least = float(subsurface.max_shear(subsurface.stress(c, facts.poisson, points)).min())
    return Finding(
        [number("shear at the centre, as the least of all", centre, least, "MPa")],
        "Least of the axis and of both semi-axes. The largest one lies below the centre.",
    )


@rules(89)
def elastic(facts: Facts) -> Finding:
    """Von Mises stress against the yield stress of R260."""
    real = under(facts.ellipse, AXLE_LOAD / 2)
    return Finding(
        [
            statement(
                f"largest von Mises stress at {contact.load / 1000:.4g} kN",
                f"< {YIELD[1]:g}",
                mises(contact, facts.poisson),
                mises(contact, facts.poisson) < YIELD[1],
                "MPa",
                facts.fe.get(key),
            )
            for contact, key in ((facts.ellipse, "mises_max"), (real, "mises_axle"))
        ],
        f"R260 yields at {YIELD[0]:g} to {YIELD[1]:g} MPa. 25 kN is at the limit, a real wheel "
        "far beyond it.",
    )
