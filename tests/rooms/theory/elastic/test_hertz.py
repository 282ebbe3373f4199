"""Hertz point and line contact: reference numbers, limits, symmetries and wrong input."""

import math

import pytest
from scipy.special import elliprd

from railhead.theory.elastic.hertz import (
    Ellipse,
    contact_modulus,
    line_contact,
    point_contact,
    point_contact_from_approach,
)

ARGUMENTS = 1e-3, 1e-3, 1e5, 1e3
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


@pytest.mark.parametrize("offset", [1e-14, 1e-11, 1e-8, 1e-5])
def test_near_circular_ratio_follows_its_series(offset: float) -> None:
    contact = point_contact(1 + offset, 1.0, 1e5, 1e3)
    assert contact.b / contact.a - 1 == pytest.approx(2 / 3 * offset, rel=offset, abs=4e-15)


@pytest.mark.parametrize("ratio", RATIOS)
def test_both_curvatures_are_flattened(ratio: float) -> None:
    contact = point_contact(ratio * 1e-3, 1e-3, 1.1e5, 4e4)
    a2, b2 = contact.a**2, contact.b**2
    scale = 4e4 / (math.pi * 1.1e5)
    assert (scale * elliprd(0, b2, a2), scale * elliprd(0, a2, b2)) == pytest.approx(
        (ratio * 1e-3, 1e-3), rel=1e-12
    )


@pytest.mark.parametrize("ratio", RATIOS)
def test_approach_and_load_are_inverse(ratio: float) -> None:
    by_load = point_contact(ratio * 1e-3, 1e-3, 1.1e5, 4e4)
    by_approach = point_contact_from_approach(ratio * 1e-3, 1e-3, 1.1e5, by_load.approach)
    assert (by_approach.load, by_approach.a, by_approach.p0) == pytest.approx(
        (4e4, by_load.a, by_load.p0), rel=1e-13
    )


def test_contact_modulus_with_a_rigid_body() -> None:
    assert contact_modulus(207000, 0.3, math.inf, 0.3) == pytest.approx(207000 / 0.91, rel=1e-15)
    assert contact_modulus(7e4, 0.33, 2e5, 0.28) == contact_modulus(2e5, 0.28, 7e4, 0.33)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        *((lambda k=k, wrong=wrong: point_contact(*ARGUMENTS[:k], wrong, *ARGUMENTS[k + 1 :]),
           f"{name} must be positive and finite")
          for k, name in enumerate(("curvature_x", "curvature_y", "contact_modulus", "load"))
          for wrong in (0.0, -1.0, math.nan, math.inf)),
        (lambda: point_contact_from_approach(1e-3, 1e-3, 1e5, -0.1), "approach must be positive"),
        (lambda: line_contact(1e-3, 1e5, 0), "load_per_length must be positive"),
        (lambda: line_contact(0.0, 1e5, 10.0), "curvature"),
        (lambda: contact_modulus(-1, 0.3, 1, 0.3), "Young's modulus must be positive"),
        (lambda: contact_modulus(1, 0.3, 1, 0.51), r"Poisson's ratio must lie in \(-1, 0.5\]"),
        (lambda: contact_modulus(math.inf, 0.3, math.inf, 0.3), "one body must be elastic"),
    ],
)  # fmt: skip
def test_wrong_input_is_refused(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
