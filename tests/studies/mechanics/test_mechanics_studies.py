"""Pages of friction and passes on made-up rows."""

import pytest

from studies.mechanics import creep
from studies.mechanics import creep_runs as changes


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
    falling = [
        {"speed": speed, "creepage": 0.01, "by": by, "force": force, "least": 0.2}
        for speed, by, force in (
            (5.0, "upwards", 0.9), (5.0, "downwards", 0.93), (5.0, "railhead", 0.91),
            (10.0, "upwards", 0.8), (10.0, "downwards", 0.8),
        )
    ]  # fmt: skip
    text = creep.page(points, [cost], [], slid, falling)
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()]
    assert ["made_up", "5 %", "1 %"] in rows
    assert ["made_up", "half", "10", "3.0", "0.25", "3.2"] in rows
    assert "above a coefficient of 0.300" in text
    assert ["creepage", "finite elements, 5 m/s", "5 m/s", "10 m/s"] in rows
    assert ["0.01", "0.9100", "0.9000", "0.8000"] in rows and "differ by 0.03 at most" in text
    assert changes.crossover(slid) == pytest.approx(0.3)
