"""Rolling radii over the shift, and the equivalent conicity: closed forms and motions."""

import math

import numpy as np
import pytest

from railhead.contact.conicity import equivalent_conicity


def swing(amplitude: float, shifts: np.ndarray, differences: np.ndarray) -> float:
    """Equivalent conicity of a rolling radius difference."""
    return equivalent_conicity(amplitude, shifts, 460 + differences, 460 + 0 * differences)


def test_the_equivalent_conicity_is_that_of_the_motion() -> None:
    """Of cones their own; of D = 2 k y^3 the closed form by the beta function; a wheelset that is
    driven outward does not swing."""
    y = np.linspace(-10.0, 10.0, 801)
    assert swing(6.0, y, 0.1 * y) == pytest.approx(0.05, rel=1e-5)
    half = math.gamma(0.25) * math.gamma(0.5) / math.gamma(0.75) / 4  # of du/sqrt(1 - u^4), 0 to 1
    exact = math.pi**2 / 8 * 0.001 * 6.0**2 / half**2
    assert swing(6.0, y, 2e-3 * y**3) == pytest.approx(exact, rel=1e-4)
    assert math.isnan(swing(6.0, y, -0.1 * y))
    assert math.isnan(swing(0.0, y, 0.1 * y))
    short = y[y <= 5.0]
    assert math.isnan(swing(6.0, short, 0.1 * short))
