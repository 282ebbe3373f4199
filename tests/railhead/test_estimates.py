"""Accuracy on request: the bounds hold, the request is met or refused with a price."""

import json
from typing import NamedTuple

import numpy as np
import pytest

from cases import error_bounds
from railhead import accuracy, catalogue, machine, price, run
from railhead import plan as planning
from railhead.scene import SceneError


def test_resolution_meets_the_accuracy_a_priori() -> None:
    for laws in (accuracy.LINEAR, accuracy.QUADRATIC, accuracy.LOBED, accuracy.SECTION):
        for asked in (0.2, 0.05, 0.01, 0.002):
            n = accuracy.resolution(asked, laws)
            low, high = accuracy.RANGE
            assert low <= n <= high
            assert n == high or accuracy.expected(0.999 * n, laws) < asked  # not at it: rounding
            if accuracy.HEADROOM * accuracy.STEP * low < n < high:
                assert accuracy.expected(n, laws) == pytest.approx(accuracy.AIM * asked)


def test_bound_is_the_larger_of_experience_and_richardson() -> None:
    coarse = dict.fromkeys(accuracy.QUANTITIES, 1.0)
    same = accuracy.bounds(coarse, coarse, 1.6, 8.0, accuracy.QUADRATIC)
    for name, bound in same.items():
        assert bound == accuracy.MARGIN * accuracy.QUADRATIC[name](8.0)
    moved = accuracy.bounds(coarse, coarse | {"a_mm": 1.1}, 2.0, 8.0, accuracy.QUADRATIC)
    assert moved["a_mm"] == pytest.approx(1.25 * 0.1 / (2**2.5 - 1))


def test_bounds_hold_on_random_hertz_scenes() -> None:
    """The small version of `railhead study error-bounds`: seven scenes, three accuracies."""
    ratios = []
    for index, (scene, ratio) in enumerate(error_bounds.random_scenes(9, seed=5)):
        if scene.accuracy < 0.01:
            continue
        records = error_bounds.measure(index, scene, ratio)
        assert all(record.reached for record in records)
        assert max(record.bound for record in records) <= scene.accuracy
        ratios += [record.ratio for record in records]
    assert np.mean(np.array(ratios) <= 1) >= 0.95
    assert max(ratios) < 2
    assert np.median(1 / np.array(ratios)) < 5


def test_summary_tells_bound_levels_and_parts() -> None:
    summary = run.run(catalogue.find("uic54_thesis").replace(["accuracy=3%"])).summary
    found = summary["accuracy"]
    assert found["reached"] is True and summary["checks"]["passed"]
    assert set(found["bound"]) == set(accuracy.QUANTITIES)
    assert set(found["parts"]) == {
        "discretisation", "left_out", "contact_law", "newton", "geometry",
    }  # fmt: skip
    assert found["parts"]["geometry"] < 1e-3
    unknowns = [level["unknowns"] for level in found["levels"]]
    assert unknowns == sorted(unknowns) and len(unknowns) >= 2
    json.dumps(summary, allow_nan=False, default=str)


def test_a_budget_buys_what_it_can_and_says_what_was_too_dear(monkeypatch) -> None:
    monkeypatch.setattr(machine, "speed", lambda: 1.0)
    rich = run.run(catalogue.find("hertz_ellipse").replace(["budget=8s"])).summary
    poor = run.run(catalogue.find("hertz_ellipse").replace(["budget=4s"])).summary
    assert rich["accuracy"]["asked"] is None and rich["checks"]["passed"]
    assert max(rich["accuracy"]["bound"].values()) < max(poor["accuracy"]["bound"].values())
    dear = run.run(catalogue.find("hertz_ellipse").replace(["budget=4s", "accuracy=0.1%"]))
    found = dear.summary["accuracy"]
    assert not dear.passed
    assert found["reached"] is False and "budget" in found["reason"]
    assert found["would_cost"]["seconds"] > 1
    assert found["bound"]


def test_memory_is_guarded_before_the_next_mesh(monkeypatch) -> None:
    monkeypatch.setattr(machine, "free_memory", lambda: 500_000_000)
    result = run.run(catalogue.find("hertz_ellipse").replace(["accuracy=0.1%"]))
    assert not result.passed
    assert "memory" in result.summary["accuracy"]["reason"]


def test_price_grows_with_the_accuracy() -> None:
    plan = planning.make(catalogue.find("uic54_thesis"))
    needed = [accuracy.resolution(asked, plan.laws) for asked in (0.05, 0.01, 0.002)]
    prices = [price.price(plan, n) for n in needed]
    assert prices == sorted(prices)


def test_speed_is_measured_once_and_kept(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert not machine.known() and machine.speed() == 1.0
    factor = machine.measure()
    assert machine.known() and machine.speed() == factor
    assert 0.05 < factor < 20
    machine.cache_file().write_text("broken")
    assert machine.speed() == 1.0


@pytest.mark.parametrize("other", ["accuracy=1%", "budget=10 s"])
def test_patch_size_and_accuracy_exclude_each_other(other: str) -> None:
    with pytest.raises(SceneError, match="mesh.patch_size"):
        catalogue.find("hertz_ellipse").replace(["mesh.patch_size=1", other])


def test_a_last_mesh_is_compared_with_one_that_is_a_whole_step_coarser() -> None:
    class Mesh(NamedTuple):
        resolution: float

    def coarser(*resolutions: float) -> float:
        return run._coarser([Mesh(n) for n in resolutions]).resolution

    assert coarser(6.0, 9.6) == 6.0
    assert coarser(6.0, 9.6, 12.0) == 6.0
    assert coarser(6.0, 9.6, 16.0) == 9.6
    assert coarser(6.0, 7.5) == 6.0
