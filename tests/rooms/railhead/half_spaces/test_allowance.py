"""What half-spaces cannot know: the named parts, for contacts that have them and others."""

import pytest
from solved import planned

from railhead.cases.s1002_60e1 import SCENE as MANCHESTER
from railhead.half_spaces.allowance import Allowance, allowance
from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.scene import catalogue


def allowed(scene, twist: float = 0.0) -> dict[str, Allowance]:
    plan = planned(scene)
    return allowance(plan.context.half_spaces, plan.deformable, twist)


def thesis(*assignments: str) -> dict[str, Allowance]:
    return allowed(catalogue.find("uic54_thesis").replace(assignments))


def test_small_patch_in_large_bodies_needs_next_to_nothing() -> None:
    for each in thesis().values():
        assert 0 < each["total"] < 1e-3 and each["share"] == each["twist"] == 0


@pytest.mark.parametrize(
    ("key", "thick", "thin"),
    [
        ("wheel.rim_depth", 20, 10),
        ("wheel.width", 40, 20),
        ("rail.depth", 20, 10),
        ("rail.width", 40, 20),
    ],
)
def test_finite_bodies_are_felt_as_the_cube_of_patch_over_size(
    key: str, thick: float, thin: float
) -> None:
    block = ("rail.profile=arc", "rail.crown_radius=300", "rail.depth=1000", "rail.width=120")
    block += ("wheel.rim_depth=400", "wheel.width=120", "load=5kN")
    far, thicker, thinner = (
        thesis(*block, *more)["max_MPa"]["size"]
        for more in ((), (f"{key}={thick}",), (f"{key}={thin}",))
    )
    assert (thinner - far) / (thicker - far) == pytest.approx(8, rel=0.1)


def test_a_rim_of_3_mm_is_noticed() -> None:
    """Finite elements: 14 % more pressure than half-spaces."""
    assert thesis("wheel.rim_depth=3")["max_MPa"]["size"] > 0.14


def test_the_gauge_corner_of_a_standard_rail_is_no_free_edge() -> None:
    """Its side goes on below the profile: finite elements of five flanges differ by 0.011 at most,
    and an edge where the profile ends would say 0.031 here."""
    assert allowed(MANCHESTER.replace(["wheelset.shift=7"]))["max_MPa"]["size"] < 0.003


def test_only_several_patches_share() -> None:
    one, two = (allowed(MANCHESTER.replace([f"wheelset.shift={shift}"])) for shift in (2, 5))
    for key in ("max_MPa", "area_mm2"):
        assert one[key]["share"] == 0 and 0 < two[key]["share"] < 0.01


def test_several_patches_are_allowed_what_each_of_them_is() -> None:
    """At 5 mm the smaller patch, in a steeper place, has the larger pressure: its normals count for
    the pressure, and for the area by a fifth."""
    two = allowed(MANCHESTER.replace(["wheelset.shift=5"]))
    assert two["area_mm2"]["conformity"] < 0.6 * two["max_MPa"]["conformity"]


def test_conformity_grows_with_the_square_of_the_patch() -> None:
    small, large = (
        allowed(MANCHESTER.replace(["wheelset.shift=6", f"load={load}"])) for load in ("1kN", "8kN")
    )
    ratio = large["max_MPa"]["conformity"] / small["max_MPa"]["conformity"]
    assert ratio == pytest.approx(4, rel=0.25)


def test_a_twist_counts_where_it_changes_the_patch() -> None:
    scene = catalogue.find("cone20_uninclined_uic54").replace(["load=110kN"])
    change = planning.make(scene).context.twist_change
    assert change > 0.01 and allowed(scene, change)["max_MPa"]["twist"] == change


@pytest.mark.slow
def test_a_head_on_its_own_turns_and_changes_the_pressure_as_foreseen() -> None:
    """The 22.5 t axle beside the web of a head without one: half-spaces are 1.7 % too high."""
    choice = ["rail.inclination=1:40", "effects.rail_section=off", "effects.plasticity=off"]
    summary = pipeline.run(catalogue.find("uic54_22t5_axle").replace(choice)).summary
    assert summary["half_space"]["allowance"]["max_MPa"]["twist"] == pytest.approx(0.018, rel=0.15)
    ratio = summary["result"]["pressure"]["max_MPa"] / summary["half_space"]["pressure"]["max_MPa"]
    assert ratio == pytest.approx(1 - 0.017, abs=0.004) and summary["checks"]["passed"]
