"""Formulas of spheres that yield, as evaluated by others."""

import json
from pathlib import Path

import pytest

from studies.mechanics.plasticity import jackson_green, kogut_etsion, residual_depth

FILE = Path(__file__).parents[1] / "rooms" / "theory" / "data" / "plasticity.json"
DATA = json.loads(FILE.read_text())["literature"]
STRAIN = 480 / (207e3 / (1 - 0.3**2))


@pytest.mark.parametrize("load", ["2", "5", "20", "100"])
def test_formulas_of_a_sphere(load: str) -> None:
    """The mean pressures differ by the yield pressure that the reference takes for both."""
    jackson = jackson_green(float(load), 0.3, STRAIN)
    kogut = kogut_etsion(float(load), 0.3)
    for (*sizes, pressure), name in ((jackson, "jackson_green_2005"), (kogut, "kogut_etsion_2002")):
        exact = DATA[name]["at_load_over_first_yield"][load]
        assert sizes == pytest.approx(
            [exact["approach_over_omega_c"], exact["radius_over_a_c"]], rel=2e-3
        )
        assert pressure == pytest.approx(exact["mean_pressure_over_yield"], rel=6e-3)
    left = DATA["etsion_2005_residual"]["residual_over_omega_c_at_load_over_first_yield"][load]
    assert residual_depth(kogut[0]) == pytest.approx(left, rel=0.02)


def test_below_first_yield_all_is_hertz() -> None:
    for found in (jackson_green(0.5, 0.3, STRAIN), kogut_etsion(0.5, 0.3)):
        assert found[:2] == pytest.approx((0.5 ** (2 / 3), 0.5 ** (1 / 3)))
    assert residual_depth(0.8) == 0
