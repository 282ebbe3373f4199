"""Kalker's linear coefficients and FASTSIM: reference numbers, published tables, limits."""

import math

import numpy as np
import pytest
from friction_data import named

from railhead.theory.friction.kalker import Coefficients, coefficients, fastsim
from railhead.theory.friction.rolling import Creepage

SLOW = pytest.mark.slow
QUICK = {"kalker_ab0.1_nu0", "kalker_ab0.1_nu0.3", "kalker_ab0.5_nu0.3", "kalker_ab1.251_nu0.3",
         "kalker_ab2_nu0", "kalker_ab5_nu0.3", "kalker_ab10_nu0", "kalker_ab10_nu0.3"}  # fmt: skip


def every_axis_ratio():
    entries = named("kalker")
    return [p if p.id in QUICK else pytest.param(*p.values, id=p.id, marks=SLOW) for p in entries]


@pytest.mark.parametrize("entry", every_axis_ratio())
def test_coefficients_are_kalker_s(entry) -> None:
    """Within the entry's own error; of the printed table within 1 % and half its last digit."""
    found = coefficients(entry["a_over_b"], entry["nu"])
    assert (found.c11, found.c22) == pytest.approx((entry["C11"], entry["C22"]), rel=5e-3)
    assert (found.c23, -found.c23, found.c33) == pytest.approx(
        (entry["C23"], entry["C32"], entry["C33"]), rel=1e-2
    )
    for key in ("C11", "C22", "C23"):
        if (printed := entry.get(f"published_{key}")) is not None:
            half_digit = 10.0 ** (math.floor(math.log10(printed)) - 2) / 2
            assert abs(getattr(found, key.lower()) - printed) <= 0.01 * printed + half_digit


def test_ratios_without_coefficients_are_refused() -> None:
    for ratio, poisson in ((0.01, 0.3), (1.0, 0.6), (math.nan, 0.3)):
        with pytest.raises(ValueError):
            coefficients(ratio, poisson)


def of(entry, linear: Coefficients, creepage: Creepage) -> np.ndarray:
    limit = entry["mu"] * entry["load_N"]
    G = entry["E_MPa"] / 2 / (1 + entry["nu"])
    return np.array(fastsim(entry["a_mm"], entry["b_mm"], limit, G, linear, creepage)[:3]) / limit


@pytest.fixture(scope="module")
def thesis_linear() -> Coefficients:
    return coefficients(4.336 / 3.465, 0.3)


@pytest.mark.parametrize("entry", named("curve"))
def test_fastsim_has_the_forces_of_another_fastsim(entry, thesis_linear: Coefficients) -> None:
    """Within 0.5 % of mu N of another FASTSIM. All patches have one axis ratio to 1e-4."""
    assert entry["a_mm"] / entry["b_mm"] == pytest.approx(4.336 / 3.465, rel=1e-3)
    creepage = Creepage(entry["xi_x"], entry["xi_y"], entry["phi_per_mm"])
    along, across, _ = of(entry, thesis_linear, creepage)
    assert (along, across) == pytest.approx(
        (entry["fastsim_Fx_over_muN"], entry["fastsim_Fy_over_muN"]), abs=5e-3
    )


@pytest.mark.parametrize(
    "creepage", [Creepage(along=1e-8), Creepage(across=1e-8), Creepage(spin=1e-9)]
)
def test_fastsim_begins_as_the_linear_theory(
    creepage: Creepage, thesis_linear: Coefficients
) -> None:
    """To 2 % with 80 strips: its steps are of first order."""
    forces = fastsim(4.336, 3.465, 7500.0, 79615.0, thesis_linear, creepage)[:2]
    expected = thesis_linear.forces(4.336, 3.465, 79615.0, creepage)[:2]
    np.testing.assert_allclose(forces, expected, rtol=0.02, atol=1e-12)


def test_fastsim_ends_at_the_limit(thesis_linear: Coefficients) -> None:
    """Along the rigid slip over the flexibilities, which leans from the slip itself."""
    forces = fastsim(4.336, 3.465, 7500.0, 79615.0, thesis_linear, Creepage(0.3, -0.4, 0.0))
    way = np.array([0.3 * thesis_linear.c11, -0.4 * thesis_linear.c22])
    np.testing.assert_allclose(forces[:2], 7500.0 * way / np.linalg.norm(way), rtol=1e-3)
    assert forces.stick_share == 0


def test_fastsim_slips_from_the_trailing_edge_on(thesis_linear: Coefficients) -> None:
    """A traction that grows linearly passes the bound's parabola one length from the trailing edge,
    the same on all strips; to the size of a step, 2 %."""
    xi, limit, a, b, G = 5e-4, 7500.0, 4.336, 3.465, 79615.0
    slope = xi * 3 * G * thesis_linear.c11 / (8 * a)  # of the traction along a strip
    behind = slope * math.pi * a**3 * b / (2 * limit)  # x + half = slope / (bound's curvature)
    y = b * (np.arange(4000) + 0.5) / 4000
    half = a * np.sqrt(1 - (y / b) ** 2)
    exact = np.sum(np.maximum(2 * half - behind, 0)) / np.sum(2 * half)
    found = fastsim(a, b, limit, G, thesis_linear, Creepage(along=xi))
    assert found.stick_share == pytest.approx(exact, abs=0.02)
