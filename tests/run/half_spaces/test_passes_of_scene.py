"""Passes of shipped scenes on real profiles, with and without friction."""

import pytest
from solved import scene_of

from railhead.results import pipeline

FAST = ("effects.finite_bodies=off", "wheel.steel=none", "mesh.patch_size=4", "rolling.passes=1")


@pytest.mark.slow
def test_a_real_pair_rolls_with_and_without_friction():
    """Two elements on a half length, answered by half-spaces."""
    free = pipeline.run(scene_of("uic54_22t5_axle", *FAST))
    rubs = pipeline.run(
        scene_of("uic54_22t5_axle", *FAST, "friction.coefficient=0.3", "rolling.force_along=10kN")
    )
    for result in (free, rubs):
        checks = result.summary["checks"]
        assert checks["passes_energy"] < 0.03 and checks["passes_converged"] == 0
        assert checks["effects_left_out"] == 0
    first, other = (each.summary["result"]["passes"][0] for each in (free, rubs))
    assert first["strain_increment_max"] == pytest.approx(0.0068, rel=0.2)
    assert first["groove_mm"] == pytest.approx(0.016, rel=0.15)
    assert first["traction_work_N"] == 0 < other["traction_work_N"]
    assert other["forward_mm"] > 1.1 * first["forward_mm"]  # dragged along
