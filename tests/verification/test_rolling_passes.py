"""Passes of a wheel over a rail that yields, beside an independent program's numbers and laws."""

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from railhead.half_spaces import pass_contact
from railhead.postprocess.pass_rows import Passes
from railhead.run import passes_of_scene
from railhead.solver.material import Hardening, Material
from railhead.theory.elastic import hertz

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "rooms" / "theory" / "data" / "passes.json").read_text()
)
E, NU, Y = 207e3, 0.3, 480.0
SHEAR = Y / math.sqrt(3)
MODULUS = E / (1 - NU**2)  # of a rigid wheel


def rail(hardening: float) -> Material:
    """Rail steel with kinematic hardening (MPa), or without."""
    return Material(E, NU, Hardening.linear(Y, hardening, 1.0 if hardening else 0.0))


def line(ratio: float, *, keeps: bool, traction: float = 0.0) -> pass_contact.RollingContact:
    """A line contact with half width 1 and p0/k = ratio."""
    p0 = ratio * SHEAR
    return pass_contact.line_contact(
        1.0, math.pi * p0 / 2, 2 * p0 / MODULUS, MODULUS, keeps=keeps, slips=traction
    )


def rolls(block, contact: pass_contact.RollingContact, count: int) -> Passes:
    """Passes of a rail below the only patch of a contact."""
    return passes_of_scene.roll([pass_contact.Below(block, contact)], contact, count)[0]


@cache
def rolled(ratio: float, hardening: float, traction: float, *, count: int, keeps: bool = True):
    """Passes of a line contact, six elements on the half width (in contact four)."""
    block = passes_of_scene.rolling_block(
        rail(hardening), (1.0, 1.0), line=True, half=False, per_length=6 if keeps else 4
    )
    return rolls(block, line(ratio, keeps=keeps, traction=traction), count)


def test_below_the_limit_the_second_pass_does_not_yield_at_all():
    """By 2.5 %."""
    found = rolled(3.9, 0.0, 0.0, count=3)
    assert found.rows[0]["strain_increment_max"] > 5e-4
    assert [row["strain_increment_max"] for row in found.rows[1:]] == [0.0, 0.0]
    assert [row["iterations"] for row in found.rows[1:]] == [1, 1]
    assert found.verdict == "shakes down"


@pytest.mark.parametrize(
    "number",
    [0, *(pytest.param(number, marks=pytest.mark.slow) for number in (2, 3)), 5],
    ids=["3.6", "4.5", "5.0-hardens", "4.0-traction"],
)
def test_two_passes_of_a_line_are_those_of_another_program(number):
    case = REFERENCE["line"][number]
    found = rolled(case["p0_over_k"], case["H_over_E"] * E, case["traction"], count=2)
    high = case["p0_over_k"] >= 5
    for row, other, wide in zip(found.rows, case["passes"], (0.10, 0.15), strict=False):
        assert row["strain_increment_max"] == pytest.approx(
            other["dq"], rel=0.10 if high else 0.05, abs=1e-9
        )
        assert row["forward_mm"] == pytest.approx(other["forward"], rel=wide, abs=1e-4)
        assert row["shear_increment_max"] == pytest.approx(other["dgamma"], rel=wide)
        if row["place_mm"]:
            assert -row["place_mm"][1] == pytest.approx(other["z_dq"], abs=0.07)
    for column, name in enumerate(("sxx_min", "syy_min")):
        least = [state.stress[..., column].min() for state in found.sections]
        expected = [other[name] for other in case["passes"][:2]]
        assert least == pytest.approx(expected, rel=0.08 if high else 0.05)
        shown = [row[("residual_along_MPa", "residual_across_MPa")[column]] for row in found.rows]
        assert case["traction"] or shown == pytest.approx(least)  # with traction, a tension
    assert found.rows[0]["groove_mm"] == pytest.approx(case["passes"][0]["settle"], rel=0.05)


AF1 = Hardening.linear(400.0).cyclic([(4e4, 100.0)])
AF2 = Hardening.linear(250.0).cyclic([(6e4, 500.0), (1e4, 40.0)], isotropic=(60.0, 8.0))
#: Law, p0 (MPa), traction, number of passes, verdict; of an independent program: largest strain
#: increment, forward displacement and residual stress along at a depth of 0.5 after the last pass.
RECALLED = [
    (AF1, 1154.701, 0.0, 6, "ratchets", (0.0092414, -0.00069043, -294.47)),
    (AF1, 1039.23, 0.2, 20, "ratchets", (0.00343, 0.000759, -186.0)),
    (AF2, 1000.0, 0.0, 10, "not steady after 10 passes", (0.011366, -0.001926, -319.68)),
]


@pytest.mark.parametrize(
    "case",
    [RECALLED[0], *(pytest.param(each, marks=pytest.mark.slow) for each in RECALLED[1:])],
    ids=["AF1", "AF1-traction", "AF2"],
)
def test_passes_with_back_stresses_are_those_of_another_program(case):
    """On six elements on the half width, within 2 %."""
    law, p0, slips, count, verdict, (strain, forward, along) = case
    block = passes_of_scene.rolling_block(
        Material(E, NU, law), (1.0, 1.0), line=True, half=False, per_length=6
    )
    contact = pass_contact.line_contact(
        1.0, math.pi * p0 / 2, 2 * p0 / MODULUS, MODULUS, keeps=True, slips=slips
    )
    found = rolls(block, contact, count)
    row, last = found.rows[-1], found.sections[-1]
    assert (
        row["strain_increment_max"],
        row["forward_mm"],
        np.interp(0.5, last.depth, last.below()[0][:, 0]),
    ) == pytest.approx((strain, forward, along), rel=0.02)
    assert found.verdict == verdict and found.converged
    if found.rate:
        assert found.rate["rule"] == "Armstrong and Frederick's rule"
        assert found.rate["estimate"] < 0.02
        assert found.rate["forward_mm_per_pass"] == row["forward_mm"]


def test_in_contact_the_resistance_is_what_yield_takes():
    found = rolled(4.5, 0.0, 0.0, count=3, keeps=False)
    assert found.energy_error < 0.03
    for row in found.rows:
        assert row["resistance_N"] == pytest.approx(row["work_N"] + row["stored_N"], rel=0.03)
    assert found.rows[0]["stored_N"] > 0.05 * found.rows[0]["work_N"]  # most of it in the first
    assert found.rows[2]["resistance_N"] == pytest.approx(found.rows[2]["work_N"], rel=0.03)
    given = rolled(4.5, 0.0, 0.0, count=1)
    strain = [each.rows[0]["strain_increment_max"] for each in (found, given)]
    assert strain[0] < 0.9 * strain[1]  # the groove carries
    assert found.rows[0]["lean_mm"] > 0.05
    p0 = 4.5 * SHEAR  # the load, pi p0/2, and its moment, over the radius
    moment = math.pi * p0 / 2 * found.rows[0]["lean_mm"] * 2 * p0 / MODULUS
    assert found.rows[0]["resistance_N"] == pytest.approx(moment, rel=0.02)
    assert given.rows[0]["lean_mm"] == pytest.approx(0.0, abs=1e-9)


LAWS = {
    "kinematic": Hardening.linear(Y, 6e3, 1.0),
    "recalled": Hardening.linear(400.0).cyclic([(4e4, 100.0)]),
}


def line_block(law: Hardening):
    """Block of a line contact with half width 1, four elements on it."""
    material = Material(E, NU, law)
    return passes_of_scene.rolling_block(
        material, (1.0, 1.0), line=True, half=False, per_length=3, reach=12
    )


@pytest.mark.parametrize(
    "law", [pytest.param(LAWS["kinematic"], marks=pytest.mark.slow), LAWS["recalled"]], ids=LAWS
)
def test_alike_bodies_that_both_yield_are_one_on_a_rigid_wheel_of_twice_the_radius(law):
    """By symmetry the plane of contact stays where it is: each body rolls over half of the gap."""
    block, p0 = line_block(law), 4.7 * SHEAR

    def contact(modulus: float) -> pass_contact.RollingContact:
        """The line with half width 1 and p0 of two bodies of this modulus E*."""
        return pass_contact.line_contact(
            1.0, math.pi * p0 / 2, 2 * p0 / modulus, modulus, keeps=False
        )

    both = contact(MODULUS / 2)
    below = [pass_contact.Below(block, both, wheel=wheel) for wheel in (False, True)]
    found = passes_of_scene.roll(below, both, 2)
    alone = rolls(block, contact(MODULUS), 2)
    assert found[0].energy_error == found[1].energy_error < 0.03
    for rail, wheel, one in zip(found[0].rows, found[1].rows, alone.rows, strict=True):
        for key in ("strain_increment_max", "forward_mm", "groove_mm", "pressure_max_MPa"):
            assert rail[key] == pytest.approx(wheel[key], rel=1e-9)
            assert rail[key] == pytest.approx(one[key], rel=2e-3, abs=1e-6)
        assert rail["resistance_N"] == pytest.approx(2 * one["resistance_N"], rel=2e-3)


def test_the_wheel_has_its_own_steel_and_the_reversed_tractions():
    """Under a kept pressure a wheel yields as a rail of its steel that is pulled the other way."""
    soft, hard = LAWS["recalled"], LAWS["kinematic"]
    contact = line(4.2, keeps=True, traction=0.15)
    below = [
        pass_contact.Below(line_block(law), contact, wheel=wheel)
        for law, wheel in ((hard, False), (soft, True))
    ]
    found = passes_of_scene.roll(below, contact, 1)
    for each, law, traction in zip(found, (hard, soft), (0.15, -0.15), strict=True):
        alone = rolls(line_block(law), line(4.2, keeps=True, traction=traction), 1)
        for row, one in zip(each.rows, alone.rows, strict=True):
            for key in ("strain_increment_max", "forward_mm", "groove_mm", "traction_work_N"):
                assert row[key] == pytest.approx(one[key], rel=2e-3, abs=1e-6), key
    forward = [each.rows[0]["forward_mm"] for each in found]
    assert forward[0] > 0 > forward[1]  # each surface is dragged by the other


def test_without_yield_the_contact_is_the_elastic_one():
    found = rolled(3.0, 0.0, 0.0, count=1, keeps=False)
    assert found.verdict == "elastic"
    contact = line(3.0, keeps=False)
    (patch,) = contact.pressed([np.zeros_like(contact.patches[0].gap)], ())
    assert found.rows[0]["pressure_max_MPa"] == pytest.approx(patch.pressure.max(), rel=1e-8)
    assert found.rows[0]["pressure_max_MPa"] == pytest.approx(3.0 * SHEAR, rel=2e-3)


def test_a_longer_block_changes_nothing():
    found = []
    for reach in (15, 45):
        block = passes_of_scene.rolling_block(
            rail(0.0), (1.0, 1.0), line=True, half=False, per_length=4, reach=reach
        )
        found.append(rolls(block, line(4.2, keeps=True), 1).rows[0])
    for key, share in (
        ("strain_increment_max", 0.005), ("forward_mm", 0.01), ("residual_along_MPa", 0.01),
    ):  # fmt: skip
        assert found[1][key] == pytest.approx(found[0][key], rel=share)


def test_half_the_tolerance_changes_nothing():
    found = []
    for tolerance in (1e-4, 5e-5):
        block = passes_of_scene.rolling_block(
            rail(0.0), (1.0, 1.0), line=True, half=False, per_length=4, reach=20
        )
        block = replace(block, tolerance=tolerance)
        found.append(rolls(block, line(4.5, keeps=False), 1).rows)
    for one, other in zip(*found, strict=True):
        assert one["iterations"] < other["iterations"]
        for key in ("strain_increment_max", "forward_mm", "groove_mm", "residual_along_MPa"):
            assert other[key] == pytest.approx(one[key], rel=5e-3), key


def ellipse() -> hertz.Ellipse:
    """Ellipse with half lengths 1 along and 0.7995 across and p0 = 5 k, of two elastic bodies."""
    modulus, ratio = MODULUS / 2, 0.7995

    def made(across: float) -> hertz.Ellipse:
        """Ellipse of curvatures 1 along and `across`."""
        return hertz.point_contact(1.0, across, modulus, 1.0)

    across = brentq(lambda each: made(each).b / made(each).a - ratio, 0.5, 2.0)
    one = made(across)
    scale = 5 * SHEAR / one.p0 * one.a  # p0 ~ (load curvature^2)^(1/3), a ~ (load/curvature)^(1/3)
    return hertz.point_contact(scale, scale * across, modulus, scale / one.a**3)


@pytest.mark.slow
def test_an_ellipse_in_contact_yields_half_as_much_and_shakes_down():
    exact = ellipse()
    assert (exact.a, exact.p0 / SHEAR) == pytest.approx((1.0, 5.0))
    half_lengths = exact.a, exact.b
    contact = pass_contact.ellipse_contact(exact, keeps=False)
    block = passes_of_scene.rolling_block(rail(10e3), half_lengths, line=False, half=True)
    found = rolls(block, contact, 3)
    first, other = found.rows[0], REFERENCE["ellipse"]["contact"][0]
    assert (first["strain_increment_max"], first["groove_mm"]) == pytest.approx(
        (other["dq"], other["groove"]), rel=0.15
    )
    assert first["residual_along_MPa"] == pytest.approx(other["sxx_min"], rel=0.05)
    assert found.verdict == "shakes down"


def test_yield_beyond_the_region_that_is_followed_is_told(monkeypatch):
    monkeypatch.setitem(passes_of_scene.DEEP, True, 1.0)
    block = passes_of_scene.rolling_block(
        rail(0.0), (1.0, 1.0), line=True, half=False, per_length=3, reach=12
    )
    assert rolls(block, line(4.2, keeps=True), 1).rim > 0.01
