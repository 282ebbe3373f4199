"""Formulas, rotations, tangents and contact equations of the thesis beside the correct ones."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies.thesis import geometry
from studies.thesis.facts import (
    TABLE_5_3,
    exact_coefficients,
    hertz_coefficients,
    thesis_axis_stress,
    thesis_contact,
)
from studies.thesis.geometry import CONE, HALF_AXLE, RAIL_RADIUS, cone, crown, rail, wheel

WHEEL, RAIL = (1 / 420, 0.0), (0.0, 1 / 300)


def test_printed_semi_axes_and_pressure(reference) -> None:
    chain = reference["thesis_chain"]
    k3, k4, k_wheel_and_rail = 0.00286, 4.76e-4, 2.8e-6  # as the thesis rounds them
    found = thesis_contact((k3 - k4, 0), (0, k3 + k4), 1 / (math.pi * k_wheel_and_rail), 25000)
    base = chain["base_length_mm"]
    assert (found.k3, found.k4) == pytest.approx((k3, k4), rel=1e-14)
    assert found.a == pytest.approx(found.m * base, rel=1e-14)
    assert found.b == pytest.approx(found.n * base, rel=1e-14)
    assert found.p0 == pytest.approx(3 * 25000 / (2 * math.pi * found.a * found.b), rel=1e-14)
    assert round(found.a, 2) == chain["a_printed"]
    assert math.floor(100 * found.b) / 100 == chain["b_printed"]  # the thesis truncated it
    m, n = (round(value, 3) for value in hertz_coefficients(80.4))  # the thesis rounds these, too
    assert m * base == pytest.approx(chain["a_mm_unrounded"], rel=1e-14)
    assert n * base == pytest.approx(chain["b_mm_unrounded"], rel=1e-14)


def test_equations_5_2_and_5_3(reference) -> None:
    rows, inputs = reference["axis_table"], reference["axis_extrema_thesis_formula"]
    depth = [row["z_mm"] for row in rows]
    expected = [
        (row["thesis_sigma_r"], row["thesis_sigma_r"], row["thesis_sigma_z"]) for row in rows
    ]
    found = thesis_axis_stress(inputs["pmax"], inputs["a"], 0.3, depth)
    np.testing.assert_allclose(found, expected, rtol=1e-11)


def test_exact_coefficients_of_table_5_3(reference) -> None:
    rows = reference["table_5_3"]
    for row in rows:
        expected = (row["m_exact"], row["n_exact"])
        assert exact_coefficients(row["theta_deg"]) == pytest.approx(expected, rel=1e-8)
    assert TABLE_5_3.T.tolist() == [
        [row["theta_deg"], row["m_thesis"], row["n_thesis"]] for row in rows
    ]


angles = st.floats(-1.2, 1.2)
moderate = st.floats(0.02, 0.7)


@given(angles, angles, angles)
def test_correct_rotation_is_proper_and_the_printed_one_a_reflection(yaw, bank, pitch) -> None:
    correct = geometry.rotation(yaw, bank, pitch)
    matrices = geometry.printed(yaw, bank, pitch)
    printed = matrices["3.5"] @ matrices["3.6"] @ matrices["3.7"]
    for matrix, det in ((correct, 1), (printed, -1)):
        np.testing.assert_allclose(matrix.T @ matrix, np.eye(3), atol=1e-14)
        assert np.linalg.det(matrix) == pytest.approx(det, abs=1e-13)


@given(st.floats(700, 800), st.floats(0, 6))
def test_correct_wheel_tangents_are_derivatives_and_the_printed_ones_not(s1, s2) -> None:
    c, s, g = math.cos(s2), math.sin(s2), cone(s1)
    t1, t2 = geometry.tangents(wheel, s1, s2)
    np.testing.assert_allclose(t1, [-CONE * s, 1, -CONE * c], atol=1e-8)
    np.testing.assert_allclose(t2, [g * c, 0, -g * s], atol=1e-7)
    printed = geometry.wheel_tangents_printed(cone, s1, s2)
    assert abs(printed[1] @ [0, 1, 0] - t2[1]) == pytest.approx(1, abs=1e-7)
    assert printed[0][2] == pytest.approx(-t1[2], abs=1e-8)


@given(moderate, moderate, st.floats(100, 2000))
def test_equation_4_31_has_a_numerator_of_zero_for_every_geometry(yaw, bank, half_axle) -> None:
    found = geometry.reduced_equations(yaw, bank, half_axle)
    scale = half_axle * abs(found.a2 * found.b2)
    assert abs(found.numerator) <= 1e-14 * scale + 1e-300
    assert found.s1w == pytest.approx(half_axle, rel=1e-9)


@given(moderate, moderate)
def test_printed_equations_against_substitution_into_4_21(yaw, bank) -> None:
    """Which coefficients of eqs 4.23 and 4.25 follow from eq 4.21: all but b3 and a3."""
    tangents = [geometry.printed(yaw, bank)[f"3.21 {name}"] for name in ("t1", "t2")]

    def both(kc: float, ks: float, s1w: float, s2r: float) -> list[float]:
        r = geometry.difference_printed(yaw, bank, HALF_AXLE, (kc, ks, s1w + HALF_AXLE), s2r)
        return [float(t @ r) for t in tangents]

    printed = geometry.reduced_equations(yaw, bank, HALF_AXLE)
    assert both(0, 0, 1, 0) == pytest.approx([printed.b2, printed.a2], abs=1e-12)
    assert both(1, 0, 0, 0) == pytest.approx(geometry.angle_coefficients(yaw, bank), abs=1e-13)
    assert both(0, 1, 0, 0) == pytest.approx([0, 0], abs=1e-13)
    b3, a3 = both(0, 0, 0, 1)
    assert abs(b3 - printed.b3) > 1e-3 * bank
    assert abs(a3 - printed.a3) > 1e-3 * bank**2


def test_all_five_conditions_hold_only_where_the_bodies_touch() -> None:
    y = -RAIL_RADIUS * CONE / math.hypot(1, CONE)
    s1, axle = HALF_AXLE + y, crown(y) + cone(HALF_AXLE + y)

    def residuals(place: float, angle: float, height: float) -> geometry.Array:
        def raised(s: float, turn: float) -> geometry.Array:
            return wheel(s, turn) + np.array([0, 0, axle + height])

        return geometry.contact_residuals(rail, raised, (0.0, place), (s1 + place - y, angle))

    np.testing.assert_allclose(residuals(y, math.pi, 0.0), 0, atol=1e-9)
    assert abs(residuals(y, math.pi, 0.1)[4]) > 0.09  # a gap
    assert abs(residuals(0.0, math.pi, 0.0)[2]) > 0.04  # the centre line: slopes differ
    assert abs(residuals(y, math.pi / 2, 0.0)[3]) > 0.99  # eq 4.30
