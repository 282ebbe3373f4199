"""Cattaneo and Mindlin: reference numbers, limits, histories."""

import math
from typing import Any

import pytest
from friction_data import named

from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.friction import cattaneo

G, POISSON = 207000 / 2.6, 0.3


@pytest.mark.parametrize("entry", named("mindlin_sphere"))
def test_a_sphere(entry: dict[str, Any]) -> None:
    limit = entry["mu"] * entry["P_N"]
    along, across = cattaneo.initial_compliance(entry["a_mm"], entry["a_mm"], G, POISSON)
    known, Q = cattaneo.CattaneoMindlin(limit, along), entry["Q_over_muP"] * limit
    assert along == pytest.approx(across, rel=1e-14)
    assert along == pytest.approx(entry["initial_tangential_compliance_mm_per_N"], rel=1e-12)
    assert known.stick_ratio(Q) == pytest.approx(entry["stick_radius_over_a"], rel=1e-12)
    assert known.approach(Q) == pytest.approx(entry["tangential_approach_mm"], rel=1e-12)


@pytest.mark.parametrize("entry", named("mindlin_ellipse"))
def test_an_ellipse_both_ways(entry: dict[str, Any]) -> None:
    a, b, N = entry["a_mm"], entry["b_mm"], entry["P_N"]
    contact = Ellipse(a, b, 3 * N / (2 * math.pi * a * b), 0.0, N, 1.0, 1.0, 1.0)
    across = entry["direction"] == "y"
    known = cattaneo.ellipse(contact, entry["mu"], G, POISSON, across=across)
    Q = entry["Q_over_muP"] * known.limit
    compliance = entry["initial_tangential_compliance_mm_per_N"]
    assert known.compliance == pytest.approx(compliance, rel=1e-9)
    assert known.approach(Q) == pytest.approx(entry["tangential_approach_mm"], rel=1e-9)
    assert known.stick_ratio(Q) == pytest.approx(entry["stick_axes_over_contact_axes"], rel=1e-12)


@pytest.mark.parametrize("entry", named("cattaneo_strip"))
def test_a_strip(entry: dict[str, Any]) -> None:
    share, back = (
        entry["Q_over_muP"],
        entry["stick_half_width_over_a_after_unloading_from_0p9_to_Q"],
    )
    ratio = cattaneo.strip_stick_ratio(share)
    assert ratio == pytest.approx(entry["stick_half_width_over_a"], rel=1e-12)
    if back is not None:
        assert cattaneo.strip_stick_ratio(share, largest=0.9) == pytest.approx(back, rel=1e-12)


def test_forces_out_of_range() -> None:
    known = cattaneo.CattaneoMindlin(100.0, 1e-6)
    for call in (
        lambda: known.approach(101.0),
        lambda: known.approach(-1.0),
        lambda: cattaneo.strip_stick_ratio(1.1),
        lambda: cattaneo.strip_stick_ratio(0.9, largest=0.5),
    ):
        with pytest.raises(ValueError):
            call()
