"""Whether passes are called for, what they leave out, and what is refused."""

import re
from functools import partial
from types import SimpleNamespace

import pytest
from one_line import refusal

import railhead as rh
from railhead.planning import effects
from railhead.planning import simulation_plan as planning
from railhead.results.report import terminal

LINE = rh.find("long_roller").replace(
    load="1400 kN", rail={"extent": "half-space", "yield_stress": 480.0}
)
SLIPS = "rail.yield_stress=800 friction.coefficient=0.3 rolling.creepage_along=10%"
ROLLS = {"friction": {"coefficient": 0.3}, "rolling": {"force_along": "140 kN"}}


def left_out(scene: rh.Scene) -> set[str]:
    """Names of the effects that the plan of a scene leaves out."""
    return set(effects.left_out(planning.make(scene).effects, {}))


def test_what_rolls_and_yields_names_the_key_until_it_is_given():
    rolls = LINE.replace(**ROLLS)
    plan = planning.make(rolls)
    assert "passes" in left_out(rolls) and "give rolling.passes" in plan.effects["passes"].why
    assert left_out(rolls.replace(["rolling.passes=3"])) == set()
    assert left_out(LINE) == set()  # nothing rolls
    assert left_out(rolls.replace(["effects.plasticity=off"])) == set()
    elastic = rolls.replace(["load=200kN", "rolling.force_along=20kN"])
    assert left_out(elastic) == set()  # nothing yields


def test_with_passes_the_bodies_are_pressed_elastically_and_nothing_else_changes():
    plan = planning.make(LINE.replace(["rolling.passes=3"]))
    assert plan.effects["plasticity"].called_for and not plan.effects["plasticity"].on
    printed = terminal.recorded(partial(terminal.show_plan, plan)).export_text()
    assert "in the passes of" in printed and "though called for" not in printed
    off = planning.make(LINE.replace(["rolling.passes=3", "effects.passes=off"]))
    assert off.effects["plasticity"].on and not off.effects["passes"].on
    assert plan.unknowns == off.unknowns


def test_the_indicator_is_held_against_yield_and_shakedown():
    why = planning.make(LINE.replace(["rolling.passes=3"])).effects["passes"].why
    assert "p0/k = 4.74" in why and "first yield 3.11" in why and "shakedown limit 4" in why
    rolls = planning.make(LINE.replace(**ROLLS).replace(["rolling.passes=3"]))
    assert "shakedown limit 3.6" in rolls.effects["passes"].why
    hard = ["rolling.passes=3", "rail.hardening_modulus=6210", "rail.kinematic_fraction=1"]
    kinematic = planning.make(LINE.replace(**ROLLS).replace(hard))
    assert "shakedown limit 4.01 at" in kinematic.effects["passes"].why
    slips = planning.make(LINE.replace(hard).replace(
        ["friction.coefficient=0.5", "rolling.creepage_along=10%", "load=500kN"]
    ))  # fmt: skip
    assert "shakedown limit 1.94 at Q/P = 0.5" in slips.effects["passes"].why


@pytest.mark.parametrize(
    ("keys", "on"),
    [
        ("", True),
        ("effects.plasticity_wheel=off", False),
        ("wheel.yield_stress=900", False),
        ("wheel.yield_stress=900 effects.plasticity_wheel=on", True),
        ("wheel.yield_stress=800", False),
        (f"wheel.yield_stress=800 {SLIPS}", True),
    ],
)
def test_a_wheel_yields_where_its_stress_passes_its_yield_stress_or_where_it_is_asked(keys, on):
    both = LINE.replace(["rolling.passes=3", "wheel.yield_stress=480", *keys.split()])
    assert planning.make(both).effects["plasticity_wheel"].on == on and left_out(both) == set()


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (["effects.deformable_wheel=off"], "give wheel.young_modulus=inf"),
        (["rail.yield_stress=none"], "rolling.passes: 3 .*the rail has no yield stress"),
        (["load=3000kN"], "rolling.passes: 3 .*no steady answer above 6;"),
        (["load=3000kN", "rail.hardening_modulus=0.001"], "p0/k is 6.94.*answer above 6;"),
        (["load=3000kN", "rail.hardening_modulus=1500"], "p0/k is 6.94.*answer above 6.56;"),
        (["load=2100kN", "rolling.pressure=hertz"], "rolling.passes: 3 .*answer above 5.5;"),
        (["load=800kN", "friction.coefficient=0.5", "rolling.creepage_along=10%"],
         "p0/k is 3.58, .*no steady answer above 2.2 at Q/P = 0.5; give"),
        (["load=7500kN", "rail.backstress=[[40000, 100]]"], "p0/k is 11.*answer above 10.8;"),
        (["load=3000kN", "rail.yield_stress=900", "wheel.yield_stress=480"],
         "p0/k is 6.94, and the wheel's flow curve has no steady answer above 6; give"),
        (["effects.plasticity_wheel=on"], "plasticity_wheel: 'on' .*a wheel without a yield"),
        (["rail.young_modulus=inf"], "rolling.passes: 3 .*the rail is rigid"),
        (["friction.coefficient=0.3", "friction.force_along=9kN"],
         "rolling.passes: 3 .*a force of .friction. shifts a wheel that rests"),
        (["rolling.passes=0"], "rolling.passes: 0 .*from 1 to 1000"),
        (["effects.plasticity=on"], "effects.plasticity: 'on' .*simulated in the passes"),
        (["wheel.rolling_radius=inf", "wheel.profile=arc", "wheel.transverse_radius=300",
              "rail.length=100"],
         "rolling.passes: 3 .*section across the way"),
    ],
)  # fmt: skip
def test_what_cannot_roll_is_refused_in_one_line(changes, text):
    rolls = LINE.replace(["rolling.passes=3"])
    assert re.search(text, refusal(lambda: planning.make(rolls.replace(changes))))


def test_hardening_has_an_answer_where_perfect_plasticity_has_none():
    scene = LINE.replace(["load=3000kN", "rail.hardening_modulus=6000", "rolling.passes=3"])
    assert planning.make(scene).effects["passes"].on


@pytest.mark.parametrize(("apart", "refused"), [(2.5, True), (4.5, False)])
def test_patches_that_roll_over_the_same_steel_are_refused(apart, refused, monkeypatch):
    """Two patches with half widths of 0.8 and 1.1 mm, of strips 2.2 times as wide."""
    scene = rh.find("s1002_60e1").replace(["rail.steel=R260", "rolling.passes=2"])
    context = planning.make(scene).context
    pair = context.half_spaces
    patches = [
        SimpleNamespace(centroid=(0.0, s), half_extents=(1.0, half))
        for s, half in ((3.0, 0.8), (3.0 - apart, 1.1))
    ]
    known = {name: getattr(pair.elastic, name) for name in ("max_pressure", "load")}
    monkeypatch.setitem(vars(pair), "elastic", SimpleNamespace(patches=patches, **known))
    if refused:
        said = refusal(lambda: effects.passes.decide_passes(context))
        assert "two patches roll over the same steel" in said
    else:
        assert effects.passes.decide_passes(context).on
