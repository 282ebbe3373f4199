"""What tractions do to the steel, from numbers made by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from railhead.postprocess.findings import Peak
from railhead.postprocess.friction import wear_and_shakedown, wear_number

MU = 0.4
SHIFT = {"poisson": 0.3, "rolling": False, "line": False}


def result(
    used: float,
    pressure: float,
    von_mises: float,
    depth: float = 2.0,
    local: float | None = None,
    mu: float = MU,
    mean: float = MU,
) -> tuple[SimpleNamespace, dict]:
    """1000 N on 4 x 5 mm, half of the forces across; local: largest traction over pressure. mean:
    the coefficient."""
    force = used * 1000 / math.sqrt(2)
    patch = SimpleNamespace(a=5.0, b=4.0, area=60.0, max_pressure=pressure)
    largest = {"rail": SimpleNamespace(von_mises=Peak(von_mises, depth, (0.0, 0.0, 0.0)))}
    forces = {
        "force_along_N": force,
        "force_across_N": -force,
        "limit_N": mu * 1000,
        "coefficient": mean,
        "t_gamma_N": 120.0,
        "traction_max_MPa": pressure * (used if local is None else local),
    }
    return SimpleNamespace(patch=patch, largest=largest), forces


def test_forces_of_both_ways_make_the_coefficient() -> None:
    found = wear_and_shakedown(
        *result(0.3, 900.0, 560.0), None, poisson=0.3, rolling=True, line=True
    )
    assert (found["traction_coefficient"], found["t_gamma_over_area_MPa"]) == pytest.approx(
        (0.3, 2.0)
    )
    assert found["wear_regime"] == "mild"
    assert found["first_yield_p0_over_k"] == pytest.approx(math.sqrt(3) * 900 / 560)
    assert not {"p0_over_k", "surface_fatigue_index", "shakedown"} & found.keys()


@pytest.mark.parametrize(
    "used, ratio, line, state",
    [
        (0.1, 2.7, True, "elastic"),
        (0.1, 3.4, True, "shakes down"),
        (0.1, 3.7, True, "ratchets"),
        (0.1, 3.7, False, "open"),  # above a line's limit, the surface holds
        (0.1, 4.7, False, "ratchets"),  # above a circle's without friction
        (0.36, 2.9, False, "ratchets"),  # FI = 0.36 - 1/2.9
        (0.36, 2.7, False, "open"),
        (0.36, 2.7, True, "ratchets"),  # below k/friction, but von Mises' limit is 2.55
    ],
)
def test_the_place_in_the_map_is_said(used: float, ratio: float, line: bool, state: str) -> None:
    """All of the patch slips."""
    k = 300.0
    hardest = ratio * k / 1.6 * (1.3 if used > 0.2 else 1.0)  # first yield at p0/k = 2.77, and 2.13
    given = result(used, ratio * k, hardest, mu=used, mean=used)
    found = wear_and_shakedown(*given, k, poisson=0.3, rolling=True, line=line)
    assert (found["p0_over_k"], found["surface_fatigue_index"]) == pytest.approx(
        (ratio, used - 1 / ratio)
    )
    assert found["shakedown"] == state


def test_a_line_of_which_a_part_sticks_has_a_lower_limit_than_one_that_slips() -> None:
    """0.84 mu P at mu 0.4: 2.141; all of it slipping it is 2.316."""
    for used, limit in ((0.336, 2.141), (0.4, 2.316)):
        found = wear_and_shakedown(
            *result(used, 900.0, 560.0), None, poisson=0.3, rolling=True, line=True
        )
        assert found["shakedown_limit_p0_over_k"] == pytest.approx(limit, abs=2e-3)


def test_a_coefficient_of_what_slips_stands_in_for_the_mean() -> None:
    """0.336 under a coefficient of 0.4 where it slips, and 0.5 in the mean."""
    found, forces = result(0.336, 900.0, 560.0, mu=0.5, mean=0.5)
    forces["coefficient_slipping"] = MU
    found = wear_and_shakedown(found, forces, None, poisson=0.3, rolling=True, line=True)
    assert found["traction_coefficient"] == pytest.approx(0.336)
    assert found["shakedown_limit_p0_over_k"] == pytest.approx(2.141, abs=2e-3)


@pytest.mark.parametrize("line, used", [(True, 0.2), (False, 0.2), (False, 0.0)])
def test_a_traction_above_k_ratchets_whatever_the_force_is(line: bool, used: float) -> None:
    """A pure spin has no force at all; 3 k under 0.35 of the pressure are 1.05 k."""
    given = result(used, 900.0, 900.0, local=0.35, mu=0.5, mean=0.5)
    found = wear_and_shakedown(*given, 300.0, poisson=0.3, rolling=True, line=line)
    assert found["shakedown_limit_p0_over_k"] < 1 / 0.35
    assert found["surface_fatigue_index"] == pytest.approx(0.35 - 1 / 3)
    assert found["shakedown"] == "ratchets"


def test_a_shift_wears_nothing_and_has_a_hardest_place() -> None:
    found = wear_and_shakedown(*result(0.3, 900.0, 560.0, -0.3), 300.0, **SHIFT)
    assert found == {
        "von_mises_max_MPa": 560.0,
        "von_mises_max_depth_mm": 0.3,
        "von_mises_max_at": "surface",
    }
    deep = wear_and_shakedown(*result(0.3, 900.0, 560.0, 0.5), 300.0, **SHIFT)
    assert deep["von_mises_max_at"] == "below"


def test_the_wear_number_leaves_spin_out_and_is_that_of_one_patch() -> None:
    """Two patches of 1 MPa on discs of radius 1 that creep apart, 20 mm from each other."""
    t = np.linspace(-1, 1, 21)
    x, y = (each.ravel() for each in np.meshgrid(t, t))
    disc = np.column_stack([x, y, 0 * x])[np.hypot(x, y) < 1]
    points = np.concatenate([disc, disc + [0.0, 20.0, 0.0]])
    spin = np.cross([0.0, 0.0, 0.5], np.concatenate([disc, disc]))
    creepage = np.repeat([[1e-3, 0.0, 0.0], [0.0, 3e-3, 0.0]], len(disc), axis=0)
    traction = np.repeat([[0.2, 0.0, 0.0], [0.0, 0.3, 0.0]], len(disc), axis=0)
    weights = np.full(len(points), 0.01)
    found = SimpleNamespace(
        points=points,
        weights=weights,
        pressure=weights * 100,
        traction=traction,
        rigid_slip=creepage + spin,
    )
    number = wear_number(found, np.array([[0.0, 0.0, 0.0], [0.0, 20.0, 0.0]]))
    assert number == pytest.approx(0.01 * len(disc) * 0.3 * 3e-3)


def test_a_lubricated_flange_has_no_wear_regime_of_dry_discs() -> None:
    found = wear_and_shakedown(
        *result(0.1, 900.0, 560.0, mu=0.1, mean=0.1), None, poisson=0.3, rolling=True, line=True
    )
    assert "wear_regime" not in found and found["t_gamma_over_area_MPa"] == pytest.approx(2.0)
