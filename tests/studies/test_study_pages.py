"""Power laws, Pareto fronts, and the page of accuracy_cost on made-up runs."""

import pytest

from railhead.studies.accuracy_cost import page as accuracy_page
from railhead.studies.tables import table
from railhead.studies.trends import pareto, power_law


def run(method: str, element: str, n: float, seconds: float, error: float, **changes: object):
    row = {
        "case": "made_up", "method": method, "element": element, "asked": None,
        "elements_per_semi_axis": n, "patch_size_mm": 4.0 / n, "unknowns": 100,
        "seconds": seconds, "seconds_solve": seconds / 2, "newton_iterations": 3,
        "linear_iterations": 30, "converged": True, "failure": "", "reached": None,
        "error": error, "error_all": error, "error_a": error / 2, "error_approach": error,
        "error_tau_max": error,
    }  # fmt: skip
    return {**row, **changes}


def test_power_law_is_found_exactly() -> None:
    x = [1.0, 2.0, 5.0, 9.0]
    assert power_law(x, [3 * v**-1.7 for v in x]) == pytest.approx((3.0, -1.7))


@pytest.mark.parametrize("x, y", [([1.0, 1.0], [1.0, 2.0]), ([1.0, 2.0], [0.0, 1.0])])
def test_no_power_law_without_two_points_or_with_zero(x, y) -> None:
    with pytest.raises(ValueError, match="no power law"):
        power_law(x, y)


def test_pareto_front_keeps_what_no_other_beats() -> None:
    assert list(pareto([1, 2, 3, 4, 1], [9, 5, 6, 1, 8])) == [4, 1, 3]


def test_factor_ten_rival_and_orders_are_read_from_the_runs() -> None:
    rows = [
        run("nitsche", "tetrahedron 2", 2, 1.0, 1e-1),
        run("nitsche", "tetrahedron 2", 4, 3.0, 1e-2),
        run("nitsche", "tetrahedron 2", 8, 9.0, 1e-3),
        run("penalty", "hexahedron 1", 4, 2.0, 5e-2),
        run("penalty", "hexahedron 1", 8, 20.0, 2e-2),
    ]
    text = accuracy_page.page(rows, 1000)
    assert "costs a factor 3.0 in time" in text
    assert "none as quick" in text and "| 50.0 " in text
    assert accuracy_page.orders(rows)["made_up", "nitsche", "tetrahedron 2"] == pytest.approx(
        3.32, abs=0.01
    )
    assert "Nothing: every run converged." in text


def test_failed_runs_are_named_and_kept_out_of_the_fits() -> None:
    rows = [
        run("nitsche", "tetrahedron 2", 2, 1.0, 1e-1),
        run("nitsche", "tetrahedron 2", 4, 1.0, 5.0, converged=False, failure="too many steps"),
    ]
    text = accuracy_page.page(rows, 1000)
    assert "- `made_up`, nitsche, tetrahedron 2, b/4: too many steps" in text
    assert accuracy_page.orders(rows) == {}
    assert "fewer than two runs" in text


def test_table_is_padded_markdown() -> None:
    lines = ["| a   | long   |", "|-----|--------|", "| x   | 1      |"]
    assert table(("a", "long"), [("x", 1)]).splitlines() == lines
