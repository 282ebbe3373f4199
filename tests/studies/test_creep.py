"""The study of creep curves on its two quick points."""

import csv

from railhead import study


def test_the_study_writes_its_curve_and_its_page(tmp_path) -> None:
    folder, page = study.run("creep", tmp_path / "creep", quick=True)
    rows = list(csv.DictReader((folder / "creep.csv").open(encoding="utf-8")))
    methods = {row["by"] for row in rows}
    assert methods == {"railhead", "boundary elements", "FASTSIM", "linear theory"}
    own, exact = (
        [float(row["force_along"]) for row in rows if row["by"] == by]
        for by in ("railhead", "boundary elements")
    )
    assert len(own) == 2 and own[0] < own[1] < 1
    for one, other in zip(own, exact, strict=True):
        assert abs(one - other) < 0.02
    for picture in ("creep.png", "friction_axes.png"):
        assert (folder / picture).stat().st_size > 10_000
    assert "at most" in page and "Newton steps" in page
