"""What the tolerance of Newton's method does to the answer."""

import pytest

import railhead as rh
from railhead.planning import plan as planning
from railhead.run.estimates import RESIDUAL_FACTOR
from railhead.run.quantities import numeric_values
from tests.solved import solved

SCENES = [
    ("hertz_ellipse", "mesh.patch_size=1"),
    ("uic54_thesis",),
    ("two_cylinders",),
    ("hertz_ellipse", "mesh.patch_size=1", "wheel.young_modulus=inf"),
    ("hertz_ellipse", "mesh.patch_size=1", "load=none", "approach=0.05"),
    ("hertz_ellipse", "mesh.patch_size=1", "solver.method=penalty"),
]


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: " ".join(scene))
def test_a_loose_tolerance_moves_no_quantity_beyond_its_estimate(scene: tuple[str, ...]) -> None:
    loose = solved(*scene, "solver.tolerance=1e-3")
    tight = solved(*scene, "solver.tolerance=1e-9")
    residual = loose.summary["newton"]["history"][-1]["residual"]
    assert residual > 1e-6
    exact = numeric_values(tight.summary["result"])
    for key, value in numeric_values(loose.summary["result"]).items():
        assert value == pytest.approx(exact[key], rel=RESIDUAL_FACTOR * residual), key


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: " ".join(scene))
def test_forces_balance_at_any_tolerance(scene: tuple[str, ...]) -> None:
    loose = solved(*scene, "solver.tolerance=1e-3")
    assert loose.summary["checks"]["force_balance"] < 1e-11


def test_the_residual_is_a_part_of_the_estimate() -> None:
    parts = solved("hertz_ellipse", "solver.tolerance=1e-3").summary["accuracy"]["parts"]["a_mm"]
    residual = solved("hertz_ellipse", "solver.tolerance=1e-3").summary["newton"]["history"][-1]
    assert parts["algebraic"] == pytest.approx(RESIDUAL_FACTOR * residual["residual"])


def test_the_plan_asks_for_a_fiftieth_of_the_smallest_envelope() -> None:
    plan = planning.make(rh.find("hertz_ellipse"))
    n = plan.forecast.minor / plan.patch_size
    assert plan.newton_tolerance == min(plan.family.mesh(key, n) for key in plan.family.laws) / 50
    keys = "rail.yield_stress=400", "effects.plasticity=on"
    yielding = planning.make(rh.find("hertz_ellipse").replace(keys))
    assert yielding.newton_tolerance == 1e-6
