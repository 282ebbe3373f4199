"""The load of first yield: plan and solution have one number for it."""

import pytest
from solved import solved

import railhead as rh
from railhead.planning import simulation_plan as planning

ELASTIC = ["effects.finite_bodies=off", "effects.plasticity=off"]


def test_at_the_load_of_first_yield_of_two_patches_the_largest_stress_is_the_yield_stress() -> None:
    """Beside a jump of contact, where stresses do not grow as the cube root of the load. The steel
    of the wheel does not count, as R260 yields first."""
    scene = rh.find("s1002_60e1").replace(["wheelset.shift=5", *ELASTIC])
    over = planning.make(scene).context.overload
    first = solved(scene.replace([f"load={scene.load / over}"]))
    assert first.stress.von_mises_max == pytest.approx(scene.rail.first_yield, rel=5e-3)
    whole = solved(scene).stress.von_mises_max / scene.rail.first_yield
    assert abs(whole**3 / over - 1) > 0.05


def test_where_the_patch_is_hertzs_the_load_of_first_yield_is_exact() -> None:
    context = planning.make(rh.find("uic54_22t5_axle").replace(ELASTIC)).context
    exact = context.hertz.axis_extrema(context.scene.rail.poisson_ratio).von_mises_max
    assert context.overload == pytest.approx((exact / 472) ** 3)
