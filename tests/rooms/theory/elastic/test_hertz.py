"""Hertz point and line contact: reference numbers, limits, symmetries and wrong input."""

import math

import numpy as np
import pytest
from scipy.special import elliprd, roots_legendre

from railhead.theory.elastic.hertz import (
    Ellipse,
    contact_modulus,
    line_contact,
    point_contact,
    point_contact_from_approach,
)

RATIOS = [1e-9, 1e-6, 1e-3, 0.3, 0.999999, 1.0, 1.0000001, 4.0, 1e6]


def test_thesis_case_is_exact(reference, thesis_ellipse: Ellipse) -> None:
    exact = reference["exact"]
    assert thesis_ellipse.contact_modulus == pytest.approx(exact["E_star_MPa"], rel=1e-11)
    for name, key in (
        ("a", "a_mm"),
        ("b", "b_mm"),
        ("p0", "p0_MPa"),
        ("p_mean", "p_mean_MPa"),
        ("approach", "approach_mm"),
    ):
        assert getattr(thesis_ellipse, name) == pytest.approx(exact[key], rel=1e-11), name
    assert thesis_ellipse.area == pytest.approx(exact["area_mm2"], rel=2e-10)  # ten digits given
    ratio = thesis_ellipse.b / thesis_ellipse.a
    assert ratio == pytest.approx(exact["axis_ratio_b_over_a"], rel=1e-11)


def test_axes_pressure_and_approach_of_other_loads_are_exact(reference) -> None:
    modulus = reference["exact"]["E_star_MPa"]
    for row in reference["load_table"]:
        contact = point_contact(1 / 420, 1 / 300, modulus, row["F_N"])
        computed = (contact.a, contact.b, contact.p0, contact.approach)
        expected = [row[key] for key in ("a_mm", "b_mm", "p0_MPa", "approach_mm")]
        np.testing.assert_allclose(computed, expected, rtol=5e-8)  # eight digits given


def test_circular_limit_is_the_sphere() -> None:
    radius, modulus, load = 250.0, 1.1e5, 4e4
    contact = point_contact(1 / radius, 1 / radius, modulus, load)
    a = math.cbrt(3 * load * radius / (4 * modulus))
    assert (contact.a, contact.b, contact.approach) == pytest.approx(
        (a, a, a * a / radius), rel=1e-14
    )


@pytest.mark.parametrize("offset", [1e-14, 1e-11, 1e-8, 1e-5])
def test_near_circular_ratio_follows_its_series(offset: float) -> None:
    contact = point_contact(1 + offset, 1.0, 1e5, 1e3)
    assert contact.b / contact.a - 1 == pytest.approx(2 / 3 * offset, rel=offset, abs=4e-15)


@pytest.mark.parametrize(
    ("curvature_ratio", "axis_ratio"),
    [  # 40-digit root of R_D(0, k^2, 1)/R_D(0, 1, k^2)
        (0.7, 0.788483351600568756),
        (1e-3, 0.0147335131549467225),
        (1e-6, 0.000345950038447739219),
        (1e-9, 9.13252969756335697e-6),
    ],
)
def test_axis_ratio_to_twelve_digits(curvature_ratio: float, axis_ratio: float) -> None:
    contact = point_contact(curvature_ratio, 1.0, 1e5, 1e3)
    assert contact.b / contact.a == pytest.approx(axis_ratio, rel=1e-12)


@pytest.mark.parametrize("ratio", RATIOS)
def test_both_curvatures_are_flattened(ratio: float) -> None:
    contact = point_contact(ratio * 1e-3, 1e-3, 1.1e5, 4e4)
    a2, b2 = contact.a**2, contact.b**2
    scale = 4e4 / (math.pi * 1.1e5)
    assert (scale * elliprd(0, b2, a2), scale * elliprd(0, a2, b2)) == pytest.approx(
        (ratio * 1e-3, 1e-3), rel=1e-12
    )


@pytest.mark.parametrize("ratio", RATIOS)
def test_exchanged_curvatures_exchange_the_axes(ratio: float) -> None:
    contact = point_contact(ratio * 1e-3, 1e-3, 1.1e5, 4e4)
    turned = point_contact(1e-3, ratio * 1e-3, 1.1e5, 4e4)
    assert (turned.a, turned.b) == pytest.approx((contact.b, contact.a), rel=2e-14)
    assert (turned.p0, turned.approach) == pytest.approx((contact.p0, contact.approach), rel=2e-14)
    assert (contact.a > contact.b) == (ratio < 1)


@pytest.mark.parametrize("ratio", RATIOS)
def test_approach_and_load_are_inverse(ratio: float) -> None:
    by_load = point_contact(ratio * 1e-3, 1e-3, 1.1e5, 4e4)
    by_approach = point_contact_from_approach(ratio * 1e-3, 1e-3, 1.1e5, by_load.approach)
    assert (by_approach.load, by_approach.a, by_approach.p0) == pytest.approx(
        (4e4, by_load.a, by_load.p0), rel=1e-13
    )


def test_stiffness_is_three_halves_of_load_over_approach(thesis_ellipse: Ellipse) -> None:
    c, step = thesis_ellipse, 1e-4
    more, less = (
        point_contact(c.curvature_x, c.curvature_y, c.contact_modulus, c.load * factor)
        for factor in (1 + step, 1 - step)
    )
    slope = (more.load - less.load) / (more.approach - less.approach)
    assert slope == pytest.approx(1.5 * c.load / c.approach, rel=1e-8)


def test_pressure_integral_is_the_load(thesis_ellipse: Ellipse) -> None:
    c = thesis_ellipse
    node, weight = roots_legendre(20)
    phi = np.pi / 4 * (node + 1)
    theta = np.arange(8) * np.pi / 4
    radius = np.sin(phi)[:, None]
    p = c.pressure(c.a * radius * np.cos(theta), c.b * radius * np.sin(theta))
    jacobian = c.a * c.b * np.sin(phi) * np.cos(phi) * np.pi / 4 * weight
    assert np.sum(p * jacobian[:, None]) * np.pi / 4 == pytest.approx(c.load, rel=1e-13)


def test_pressure_vanishes_outside(thesis_ellipse: Ellipse) -> None:
    c = thesis_ellipse
    assert c.pressure(0, 0) == c.p0
    assert np.all(c.pressure([1.01 * c.a, 0, -9], [0, 1.01 * c.b, 9]) == 0)


def test_line_contact_of_a_cylinder_and_its_load() -> None:
    strip = line_contact(1 / 420, 1.1e5, 1e3)
    assert strip.p0 == pytest.approx(math.sqrt(1e3 * 1.1e5 / (math.pi * 420)), rel=1e-14)
    phi = (np.arange(64) + 0.5) * np.pi / 64  # the cosine substitution integrates it exactly
    load = np.sum(strip.pressure(strip.b * np.cos(phi)) * strip.b * np.sin(phi)) * np.pi / 64
    assert load == pytest.approx(1e3, rel=1e-13)
    assert strip.p_mean == pytest.approx(np.pi / 4 * strip.p0, rel=1e-14)


@pytest.mark.parametrize("axis_ratio", [1e-1, 1e-2, 1e-3, 1e-4])
def test_line_limit_of_the_point_contact(axis_ratio: float) -> None:
    k2 = axis_ratio**2
    curvature_ratio = elliprd(0, k2, 1) / elliprd(0, 1, k2)
    contact = point_contact(curvature_ratio * 1e-2, 1e-2, 1.1e5, 4e4)
    strip = line_contact(1e-2, 1.1e5, math.pi / 2 * contact.b * contact.p0)
    order = k2 * math.log(4 / axis_ratio)
    assert contact.b / contact.a == pytest.approx(axis_ratio, rel=1e-12)
    assert (contact.b, contact.p0) == pytest.approx((strip.b, strip.p0), rel=order)


def test_contact_modulus_with_a_rigid_body() -> None:
    assert contact_modulus(207000, 0.3, math.inf, 0.3) == pytest.approx(207000 / 0.91, rel=1e-15)
    assert contact_modulus(7e4, 0.33, 2e5, 0.28) == contact_modulus(2e5, 0.28, 7e4, 0.33)


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("position", "name"),
    [(0, "curvature_x"), (1, "curvature_y"), (2, "contact_modulus"), (3, "load")],
)
def test_point_contact_refuses(wrong: float, position: int, name: str) -> None:
    arguments = [1e-3, 1e-3, 1e5, 1e3]
    arguments[position] = wrong
    with pytest.raises(ValueError, match=f"{name} must be positive and finite"):
        point_contact(*arguments)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: point_contact_from_approach(1e-3, 1e-3, 1e5, -0.1), "approach must be positive"),
        (lambda: line_contact(1e-3, 1e5, 0), "load_per_length must be positive"),
        (lambda: line_contact(0.0, 1e5, 10.0), "curvature"),
        (lambda: contact_modulus(-1, 0.3, 1, 0.3), "Young's modulus must be positive"),
        (lambda: contact_modulus(1, 0.3, 1, 0.51), r"Poisson's ratio must lie in \(-1, 0.5\]"),
        (lambda: contact_modulus(math.inf, 0.3, math.inf, 0.3), "one body must be elastic"),
    ],
)
def test_other_wrong_input_is_refused(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
