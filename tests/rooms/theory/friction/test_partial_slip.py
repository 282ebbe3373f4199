"""Exact partial slip: reference numbers and limits of Carter, and of Cattaneo and Mindlin."""

import numpy as np
import pytest
from carter import Carter
from friction_data import named

from railhead.theory.elastic.hertz import Strip, contact_modulus, line_contact
from railhead.theory.friction import partial_slip


def strip_of(entry) -> Strip:
    modulus = contact_modulus(entry["E_MPa"], entry["nu"], entry["E_MPa"], entry["nu"])
    return line_contact(1 / entry["R_relative_mm"], modulus, entry["load_N"] / entry["length_mm"])


@pytest.mark.parametrize("entry", named("carter"))
def test_a_strip_that_rolls_has_carter_s_creepage_and_stick(entry) -> None:
    strip = strip_of(entry)
    rolled = Carter(strip, entry["mu"], entry["Q_over_muP"])
    a = entry["half_width_a_mm"]
    assert (rolled.creepage, rolled.stick_half_width / a) == pytest.approx(
        (entry["creepage_xi"], entry["stick_half_width_over_a"]), rel=1e-9
    )
    centre = entry["stick_centre_over_a_towards_leading_edge"]
    assert rolled.stick_centre / a == pytest.approx(centre, rel=1e-9)
    back = partial_slip.carter_share(strip, entry["mu"], entry["creepage_xi"])
    assert back == pytest.approx(entry["Q_over_muP"], rel=1e-9)


@pytest.mark.parametrize("share", [-1.0, -0.5, 0.3, 0.96])
def test_the_traction_adds_up_to_the_force(share: float) -> None:
    strip = line_contact(1 / 420, 1.1e5, 1500.0)
    rolled = Carter(strip, 0.3, share)
    x = strip.b * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20001))
    q = rolled.traction(x)
    assert np.sum((q[1:] + q[:-1]) / 2 * np.diff(x)) == pytest.approx(share * 450.0, rel=1e-6)
    assert np.abs(q).max() <= 0.3 * strip.p0 * (1 + 1e-12)
    trailing = x < rolled.stick_centre - rolled.stick_half_width
    np.testing.assert_allclose(q[trailing], np.sign(share) * 0.3 * strip.pressure(x[trailing]))
    assert np.sign(rolled.creepage) == np.sign(share)


def test_a_creepage_of_full_slip_makes_the_whole_limit() -> None:
    strip = line_contact(1 / 420, 1.1e5, 1500.0)
    assert partial_slip.carter_share(strip, 0.3, 1.0) == 1.0
    assert partial_slip.carter_share(strip, 0.3, -1.0) == -1.0


G, POISSON = 207000 / 2.6, 0.3


@pytest.mark.parametrize("entry", named("mindlin_ellipse"))
def test_an_ellipse_shifts_and_sticks_as_mindlin_says_both_ways(entry) -> None:
    a, b, N = entry["a_mm"], entry["b_mm"], entry["P_N"]
    compliance = partial_slip.initial_compliance(a, b, G, POISSON)[entry["direction"] == "y"]
    known = partial_slip.CattaneoMindlin(entry["mu"] * N, compliance)
    Q = entry["Q_over_muP"] * known.limit
    stated = entry["initial_tangential_compliance_mm_per_N"]
    assert (compliance, known.approach(Q)) == pytest.approx(
        (stated, entry["tangential_approach_mm"]), rel=1e-9
    )
    assert known.stick_ratio(Q) == pytest.approx(entry["stick_axes_over_contact_axes"], rel=1e-12)


@pytest.mark.parametrize("entry", named("cattaneo_strip"))
def test_a_strip_sticks_as_cattaneo_says(entry) -> None:
    ratio = partial_slip.strip_stick_ratio(entry["Q_over_muP"])
    assert ratio == pytest.approx(entry["stick_half_width_over_a"], rel=1e-12)


def test_forces_below_zero_or_beyond_the_limit_are_refused() -> None:
    known = partial_slip.CattaneoMindlin(100.0, 1e-6)
    for call in (
        lambda: known.approach(101.0),
        lambda: known.approach(-1.0),
        lambda: partial_slip.strip_stick_ratio(1.1),
        lambda: partial_slip.strip_stick_ratio(-0.1),
    ):
        with pytest.raises(ValueError):
            call()
