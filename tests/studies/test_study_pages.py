"""Power laws, Pareto fronts, error laws, and the pages of studies on made-up runs."""

import numpy as np
import pytest

from studies.accuracy import calibrate, error_bounds
from studies.cost import accuracy_cost
from studies.cost import ranks as ranks_study
from studies.tables import front, wrapped


def run(method: str, element: str, n: float, seconds: float, error: float, **changes: object):
    row = {
        "case": "made_up",
        "method": method,
        "element": element,
        "asked": None,
        "elements_per_semi_axis": n,
        "patch_size_mm": 4.0 / n,
        "unknowns": 100,
        "seconds": seconds,
        "newton_iterations": 3,
        "linear_iterations": 30,
        "converged": True,
        "failure": "",
        "reached": None,
        "error": error,
        "error_all": error,
        "error_a": error / 2,
        "error_approach": error,
        "error_tau_max": error,
    }
    return {**row, **changes}


def test_pareto_front_keeps_what_no_other_beats() -> None:
    points = ((1, 9), (2, 5), (3, 6), (4, 1), (1, 8))
    rows = [{"seconds": seconds, "error": error} for seconds, error in points]
    assert front(rows) == [rows[4], rows[1], rows[3]]


def test_factor_ten_rival_and_orders_are_read_from_the_runs() -> None:
    rows = [
        run("nitsche", "tetrahedron 2", 2, 1.0, 1e-1),
        run("nitsche", "tetrahedron 2", 4, 3.0, 1e-2),
        run("nitsche", "tetrahedron 2", 8, 9.0, 1e-3),
        run("penalty", "hexahedron 1", 4, 2.0, 5e-2),
        run("penalty", "hexahedron 1", 8, 20.0, 2e-2),
    ]
    text = accuracy_cost.page(rows, 1000)
    assert "takes 3.0 times as long" in text and "none as quick" in text and "| 50.0 " in text
    assert accuracy_cost.orders(rows)["made_up", "nitsche", "tetrahedron 2"] == pytest.approx(
        3.32, abs=0.01
    )
    assert "Nothing: every run converged." in text


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


def test_ranks_page_forecasts_what_is_shared_and_what_is_not() -> None:
    """Amdahl: of 10 s two take 6, so that 8 are shared; what takes longer with two is not."""
    one, two = (
        {"unknowns": 1000, "ranks": ranks, "newton_iterations": 3, "linear_iterations": 20}
        | {"whole": whole}
        | dict(zip(ranks_study.PARTS, parts, strict=True))
        for ranks, whole, parts in (
            (1, 15.0, (2.0, 3.0, 0.0, 10.0, 0.0)),
            (2, 12.0, (3.0, 3.0, 0.0, 6.0, 0.0)),
        )
    )
    parts = ranks_study.forecast(one, two, 8)
    assert parts == {"start": 2.0, "mesh": 3.0, "assemble": 0.0, "solve": 3.0, "postprocess": 0.0}
    text = ranks_study.page([one, two])
    row = next(line for line in text.splitlines() if line.startswith("| 8 "))
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells == ["8", "2.0", "3.0", "0.0", "3.0", "0.0", "8.0", "1.9"]


def test_prose_is_broken_and_stays_what_it_was() -> None:
    item = "- " + 30 * "a word - " + "1. end"
    kept = f"# {50 * 'title '}\n\n| {50 * 'cell | '}\n\n```text\n{150 * 'x'}\n```\n"
    page = f"{40 * 'prose '}\n{40 * 'more '}\n\n{item}\n{item}\n\nshort\nlines\n\n{kept}"
    broken = wrapped(page)
    assert broken.split() == page.split() and broken.endswith(kept)
    prose = broken.removesuffix(kept).splitlines()
    assert max(map(len, prose)) <= 120 and sum(line.startswith(("- ", "1.")) for line in prose) == 2
    assert "short\nlines\n" in broken and wrapped(broken) == broken
