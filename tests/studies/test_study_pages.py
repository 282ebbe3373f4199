"""Power laws, Pareto fronts, error laws, and the pages of studies on made-up runs."""

import numpy as np
import pytest

from studies.accuracy import calibrate, error_bounds
from studies.tables import front


def test_pareto_front_keeps_what_no_other_beats() -> None:
    points = ((1, 9), (2, 5), (3, 6), (4, 1), (1, 8))
    rows = [{"seconds": seconds, "error": error} for seconds, error in points]
    assert front(rows) == [rows[4], rows[1], rows[3]]


def test_an_envelope_lies_above_all_errors_and_falls_as_they_do() -> None:
    n = np.repeat([3.0, 6.0, 12.0], 4)
    errors = np.tile([0.2, 0.5, 1.0, 0.7], 3) * 1e-2 * (6 / n) ** 2
    law = calibrate.envelope(n, errors)
    assert law.order == pytest.approx(2, abs=0.05)
    assert law.value == pytest.approx(calibrate.HEADROOM * 1e-2, rel=0.05)
    assert all(law(each) >= error for each, error in zip(n, errors, strict=True))


def test_a_law_leaves_out_what_the_overlap_and_the_reading_explain() -> None:
    def record(n: float, scene: str, over: float) -> dict:
        reading, rest = 1e-3 * (6 / n), 2e-3 * (6 / n) ** 2
        row = {"scene": scene, "n": n, "quantity": "max_MPa", "reading": reading, "scale": 1.0}
        return {**row, "error": 5 * over + reading + rest, "overlap": over}

    overs = {"a": 0.0, "b": 0.3}
    records = [record(n, k, v) for n in (3, 6) for k, v in overs.items()]
    entry = calibrate.fit("bodies", records, {}, (3.0, 6.0))
    assert entry["scenes"] == 2 and entry["overlap"]["max_MPa"] == pytest.approx(5, rel=0.05)
    value, order = entry["laws"]["max_MPa"]
    least, whole = calibrate.HEADROOM * 2e-3, calibrate.HEADROOM * calibrate.CHANCE * 3e-3
    assert least <= value <= whole and order > 1


def bound(scene: str, estimate: float | None, error: float, **changes) -> dict:
    fields = {
        "family": "ellipse",
        "scene": scene,
        "asked": None,
        "passed": True,
        "failed": "",
        "reached": None,
        "unknowns": 1,
        "meshes": 1,
        "seconds": 2.0,
        "price": 1.1,
        "quantity": "max_MPa",
        "estimate": estimate,
        "error": error,
    }
    return {**fields, **changes}


def test_verdict_on_estimates_counts_what_holds_and_what_is_missing() -> None:
    records = [
        bound("a", 0.01, 0.005),
        bound("b", 0.01, 0.02),
        bound("c", None, 0.5),
        bound("d", 0.01, 1e-9, passed=False, failed="accuracy"),
        bound("e", 0.01, 1.0, passed=False, failed="flux_rail"),
    ]
    verdict = error_bounds.verdict(records)
    assert verdict == {
        "holds": 0.5,
        "worst": 2.0,
        "effectivity": 1.25,
        "estimated": 0.8,
        "passed": 0.6,
    }
    text = error_bounds.page(records, ["profiles_3: not back after 600 s"])
    assert "| ellipse" in text and "| 50.0%" in text
    assert "Refused, and not judged: e (flux_rail)" in text
    assert "Gave nothing: profiles_3: not back after 600 s" in text
