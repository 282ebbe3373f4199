"""Carter's rolling strip: reference numbers, force of the traction, both signs."""

from typing import Any

import numpy as np
import pytest
from friction_data import named

from railhead.theory.elastic.hertz import Strip, contact_modulus, line_contact
from railhead.theory.friction.carter import Carter, from_creepage


def strip_of(entry: dict[str, Any]) -> Strip:
    modulus = contact_modulus(entry["E_MPa"], entry["nu"], entry["E_MPa"], entry["nu"])
    return line_contact(1 / entry["R_relative_mm"], modulus, entry["load_N"] / entry["length_mm"])


@pytest.mark.parametrize("entry", named("carter"))
def test_reference_numbers(entry: dict[str, Any]) -> None:
    strip = strip_of(entry)
    rolled = Carter(strip, entry["mu"], entry["Q_over_muP"])
    a = entry["half_width_a_mm"]
    assert rolled.creepage == pytest.approx(entry["creepage_xi"], rel=1e-9)
    assert rolled.stick_half_width / a == pytest.approx(entry["stick_half_width_over_a"], rel=1e-9)
    centre = entry["stick_centre_over_a_towards_leading_edge"]
    assert rolled.stick_centre / a == pytest.approx(centre, rel=1e-9)
    back = from_creepage(strip, entry["mu"], entry["creepage_xi"])
    assert back.share == pytest.approx(entry["Q_over_muP"], rel=1e-9)


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


def test_full_slip_and_more_than_the_limit() -> None:
    strip = line_contact(1 / 420, 1.1e5, 1500.0)
    assert from_creepage(strip, 0.3, 1.0).share == 1.0
    assert from_creepage(strip, 0.3, -1.0).share == -1.0
    with pytest.raises(ValueError):
        Carter(strip, 0.3, 1.01)
