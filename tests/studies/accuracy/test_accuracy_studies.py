"""Error envelopes, families of scenes, and the twist of a rail, as the studies measure them."""

from itertools import islice

import pytest

from railhead.planning import error_envelopes
from railhead.planning import simulation_plan as planning
from railhead.planning.references import rail_twist
from studies.accuracy import calibrate as measured
from studies.accuracy import error_bounds, families


@pytest.mark.slow
def test_every_calibrated_family_holds_its_own_scenes_and_no_foreign_ones() -> None:
    for recipe in families.RECIPES:
        parts = set(families.parts(recipe))
        calibrated = set() if recipe == "outside" else parts
        drawn = islice(families.scenes(recipe, 3), 2 if len(parts) == 1 else 6)
        found = [error_envelopes.family(planning.make(scene).setting) for scene in drawn]
        assert {known.name for known in found if known} == calibrated
        assert all(found) is bool(calibrated)


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
@pytest.mark.parametrize("profile, inclination", [("54E1", "0"), ("60E1", "1:40")])
def test_a_whole_rail_twists_as_the_plan_expects(profile: str, inclination: str) -> None:
    """Head at the wheel, of a mesh as `railhead study calibrate` measures it on."""
    solved = measured.solved(profile, inclination)
    angle, _ = measured.turn(solved)
    planned = solved.plan
    assert rail_twist.twist(planned.contact, planned.hertz) == pytest.approx(angle, rel=0.1)
