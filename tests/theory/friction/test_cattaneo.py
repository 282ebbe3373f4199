"""Cattaneo and Mindlin: reference numbers, limits, histories."""

import math
from typing import Any

import numpy as np
import pytest
from friction_data import named

from railhead.theory.elastic.hertz import Ellipse, line_contact
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
    assert known.energy_per_cycle(Q) == pytest.approx(
        entry["dissipated_energy_per_cycle_Nmm"], rel=1e-9
    )
    assert known.unloading_approach(0, Q) == pytest.approx(
        entry["unloaded_to_zero_residual_approach_mm"], rel=1e-9
    )


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
    strip = line_contact(1 / 420, 1.1e5, 1500.0)
    y = strip.b * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20001))
    q = cattaneo.strip_traction(strip, 0.3, share, y)
    force = float(np.sum((q[1:] + q[:-1]) / 2 * np.diff(y)))
    assert force == pytest.approx(share * 0.3 * 1500.0, rel=1e-6)


def test_the_cycle_closes_and_its_area_is_the_energy() -> None:
    known, Q = cattaneo.CattaneoMindlin(7500.0, 1.3e-6), 6000.0
    assert known.unloading_approach(Q, Q) == pytest.approx(known.approach(Q), rel=1e-12)
    assert known.unloading_approach(-Q, Q) == pytest.approx(-known.approach(Q), rel=1e-12)
    force = Q * np.cos(np.linspace(0, np.pi, 4001))
    shift = np.array([known.unloading_approach(each, Q) for each in force])
    area = 2 * float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(shift)))
    # The way back is the way there, turned: a cycle encloses twice its distance to the mean line.
    assert abs(area) == pytest.approx(known.energy_per_cycle(Q), rel=1e-5)


def test_forces_out_of_range() -> None:
    known = cattaneo.CattaneoMindlin(100.0, 1e-6)
    for call in (
        lambda: known.approach(101.0),
        lambda: known.approach(-1.0),
        lambda: known.unloading_approach(60.0, 50.0),
        lambda: cattaneo.strip_stick_ratio(1.1),
        lambda: cattaneo.strip_stick_ratio(0.9, largest=0.5),
    ):
        with pytest.raises(ValueError):
            call()
