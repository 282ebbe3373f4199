"""Pages of friction and passes on made-up rows."""

import matplotlib.image
import pytest

from studies.mechanics import creep, passes
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


def rolled(traction: str) -> list[dict]:
    """Three passes of a made-up axle."""
    keys = "strain", "strain_max", "forward", "groove", "pressure", "along", "across"
    return [
        {"traction": traction, "pass": n, **dict.fromkeys(keys, 0.5**n), "groove": 15.0 + n}
        for n in (1, 2, 3)
    ]


def after(what: str, **changes: object) -> dict:
    """What stays after a made-up run."""
    row = {
        "what": what,
        "pressure": 1000.0,
        "strain": 0.01,
        "groove": 20.0,
        "von_mises": 300.0,
        "seconds": 100.0,
        "verdict": "shakes down",
        "words": "shakes down: made up",
        "unknowns": 1234,
        "passed": True,
    }
    return row | changes


def place(share: float, law: str, verdict: str) -> dict:
    """A made-up place of the map."""
    return {
        "traction": 0.1,
        "law": law,
        "limit": 3.564,
        "ratio": 3.564 * share,
        "share": share,
        "strain": 1e-4,
        "forward_over_width": 2e-3,
        "verdict": verdict,
    }


def test_the_page_says_what_leaving_out_costs_and_which_verdicts_are_wrong():
    others = [after("elastic", pressure=1200.0), after("pressed once", strain=0.005, groove=40.0)]
    points = [
        place(0.9, "perfect", "shakes down"),
        place(0.9, "kinematic", "shakes down"),
        place(1.1, "perfect", "undecided"),
        place(1.1, "kinematic", "closed cycles"),
    ]
    ends = [after("20 passes, free"), after("20 passes, driven", passed=False)]
    text = passes.page(rolled("free"), ends, others, points)
    assert "the elastic pressure is 20 % above" in text
    assert "0.50 of the plastic strain and a pit of 2.00 times" in text
    assert "on the right side of the limit at all 2 places" in text
    assert text.count("A check did not pass") == 1
    points[2]["verdict"] = "shakes down"
    text = passes.page(rolled("free"), ends, others, points)
    assert "at 1 of 2 places: Q/P 0.1, 1.1 of the limit (shakes down)" in text


def test_a_picture_shows_both_tractions(tmp_path):
    path = tmp_path / "passes.png"
    points = [place(0.9, "perfect", "shakes down"), place(1.1, "perfect", "ratchets")]
    passes.draw([*rolled("free"), *rolled("driven")], points, path)
    assert matplotlib.image.imread(path).std() > 0.02
