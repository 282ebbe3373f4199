"""The study of friction on its quick points, and its page on made-up ones."""

import os

import pytest
from csv_rows import rows

from railhead.cli import study
from studies.mechanics import creep
from studies.mechanics import creep_runs as changes


@pytest.mark.slow
def test_the_study_writes_its_tables_its_pictures_and_its_page(tmp_path) -> None:
    folder, text = study.run("creep", tmp_path / "creep", quick=True)
    points = rows(folder / "creep.csv")
    assert {row["by"] for row in points} == {"railhead", *creep.METHODS}
    own, exact = (
        [float(row["force_along"]) for row in points if row["by"] == by]
        for by in ("railhead", "boundary elements")
    )
    assert len(own) == 2 and own[0] < own[1] < 1
    for one, other in zip(own, exact, strict=True):
        assert abs(one - other) < 0.02
    (cost,) = rows(folder / "creep_costs.csv")
    assert float(cost["sampled_s"]) > 0 and float(cost["point_s"]) > 0
    (left,) = rows(folder / "creep_left_out.csv")
    assert float(left["pressure_MPa"]) == pytest.approx(float(left["plain_pressure_MPa"]), rel=0.01)
    assert float(left["von_mises_MPa"]) > 1.01 * float(left["plain_von_mises_MPa"])
    slid = [row for row in rows(folder / "creep_sliding.csv") if row["coefficient"] == "0.3"]
    found, below, surface = (
        next(float(row["von_mises"]) for row in slid if row["by"] == by)
        for by in ("railhead", "below", "surface")
    )
    assert found == pytest.approx(max(below, surface), rel=0.005)
    assert {"creep.png", "creep_sliding.png", "friction_axes.png"} <= set(os.listdir(folder))
    assert "Full sliding" in text and "boundary elements" in text


def test_the_page_says_the_largest_distance_and_ratios() -> None:
    names = (
        "case",
        "along",
        "across",
        "spin",
        "by",
        "force_along",
        "force_across",
        "stick",
    )
    points = [
        dict(zip(names, ("made_up", 1e-3, 0.0, 0.0, by, force, across, 0.5), strict=True))
        for by, force, across in (
            ("railhead", 0.5, 0.03),
            ("boundary elements", 0.54, 0.0),
            ("FASTSIM", 0.5, 0.02),
            ("linear theory", 0.9, 0.0),
        )
    ]
    cost = {"case": "made_up", "model": "half", "unknowns": 10}
    cost |= {"built": 1.0, "pressed": 2.0, "sampled": 6.0, "point": 0.5}
    slid = [
        {"case": "made_up", "coefficient": mu, "by": by, "von_mises": stress, "depth": 0.1}
        for mu in (0.0, 0.2, 0.4)
        for by, stress in (("railhead", 0.6), ("below", 0.6), ("surface", 0.3 + mu))
    ]
    text = creep.page(points, [cost], [], slid)
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()]
    assert ["made_up", "5 %", "1 %"] in rows
    assert ["made_up", "half", "10", "3.0", "0.25", "3.2"] in rows
    assert "above a coefficient of 0.300" in text
    assert changes.crossover(slid) == pytest.approx(0.3)
