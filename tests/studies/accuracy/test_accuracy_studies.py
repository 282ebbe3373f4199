"""Error envelopes, families of scenes, and the twist of a rail, as the studies measure them."""

import pytest

from railhead.planning.references import rail_twist
from studies.accuracy import calibrate as measured
from studies.accuracy import error_bounds, families


def test_estimates_hold_in_random_sections() -> None:
    """The small version of `railhead study error-bounds`."""
    records = [
        record
        for name in ("plane strain", "meridian")
        for index, scene in zip(range(3), families.scenes(name, 77), strict=False)
        for record in error_bounds.measure(name, scene, error_bounds.asked(name, index))
    ]
    found = error_bounds.verdict(records)
    assert len({record["scene"] for record in records}) == 6
    assert found["estimated"] == 1.0
    assert found["holds"] >= 0.95 and found["worst"] < 1.5


@pytest.mark.slow
def test_a_whole_rail_twists_as_the_plan_expects() -> None:
    """Head at the wheel, of a mesh as `railhead study calibrate` measures it on."""
    solved = measured.solved("54E1", "0")
    angle, _ = measured.turn(solved)
    planned = solved.plan
    assert rail_twist.twist(planned.contact, planned.hertz) == pytest.approx(angle, rel=0.1)
