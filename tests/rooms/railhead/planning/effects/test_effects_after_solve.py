"""After the solve the same indicators are evaluated on what was found."""

import json
from dataclasses import replace

import command
import matplotlib.image
import pytest
from solved import draw_only, solved

from railhead.planning import effects
from railhead.planning import simulation_plan as planning
from railhead.planning.effects import in_words, interface
from railhead.postprocess.pictures import diagrams
from railhead.results.report import terminal
from railhead.scene import catalogue
from railhead.scene.scene import SceneError


def after(case: str, *assignments: str) -> dict:
    return solved(case, *assignments).summary["effects_after"]


def test_needed_effects_are_named_in_table_summary_and_pictures(here, monkeypatch, capsys) -> None:
    """Loaded past yield, with friction called for, on a rail that twists."""
    keys = "mesh.patch_size=1.7 rail.inclination=1:40 friction.coefficient=0.3"
    choice = [f"--set={key}" for key in f"{keys} friction.tangential_load=9kN".split()]
    choice += [f"--without={name}" for name in ("plasticity", "friction", "rail_section")]
    draw_only(monkeypatch, "pressure")
    # A warning is no failure.
    assert command.status("run", "uic54_22t5_axle", *choice) == 0
    printed = capsys.readouterr().out
    folder = here / "results" / "uic54_22t5_axle"
    summary = json.loads((folder / "summary.json").read_text())
    found = summary["effects_after"]
    needed = {name for name, each in found.items() if each["needed"]}
    assert needed == {"plasticity", "friction", "rail_section"}
    for name in needed:
        told = f"Left out: {in_words(name)}; {found[name]['why']}."
        assert told in " ".join(printed.split())
    assert printed.startswith("Left out: steel that yields; the steel would yield")
    assert "overstates pressure" in found["plasticity"]["why"]
    assert summary["plan"]["effects"]["plasticity"]["override"] is True
    picture = matplotlib.image.imread(folder / "pressure.png")
    assert picture.shape[0] > 4.5 * diagrams.DPI  # three lines more


@pytest.fixture(scope="module")
def thesis():
    return solved("uic54_thesis", "mesh.patch_size=1.2")


def again(result, *assignments: str) -> dict:
    """The indicators of another scene on the same solution."""
    plan, found = result.plan, result.findings
    scene = plan.scene.replace(assignments)
    contact = replace(plan.contact, scene=scene)
    return effects.check(replace(plan.context, scene=scene, contact=contact), found)


def test_yield_is_judged_by_the_stress_that_was_found(thesis) -> None:
    stress = thesis.summary["result"]["stress"]
    body, peak = stress["von_mises_max_body"], stress["von_mises_max_MPa"]
    for share, yields in ((1.001, False), (0.999, True)):
        found = again(thesis, f"{body}.yield_stress={share * peak!r}")["plasticity"]
        assert found.needed is yields


def test_without_a_yield_stress_it_is_said_that_steel_would_yield(thesis) -> None:
    after = thesis.summary["effects_after"]["plasticity"]
    assert not after["needed"] and after["notable"]
    assert "R260 would yield here: von Mises" in after["why"]
    soft = again(thesis, "rail.young_modulus=1000", "wheel.young_modulus=1000")["plasticity"]
    assert not soft.notable and soft.why == "no yield stress is given"
    text = " ".join(terminal.recorded(thesis.show).export_text().split())
    assert "plasticity: no steel is given; R260 would yield here" in text


def test_a_patch_at_the_edge_of_the_tread_is_named(thesis) -> None:
    b = thesis.findings.patch.b
    for width, near in ((2.1 * b, True), (2.3 * b, False)):
        found = again(thesis, f"wheel.width={width!r}")["inside_the_bodies"]
        assert found.needed is near and ("the edge carries load" in found.why) is near


HOT = [
    "friction.coefficient=0.3", "rolling.creepage_along=3%", "rolling.speed=30", "load=600kN",
    "rail.yield_stress=400", "mesh.patch_size=1",
]  # fmt: skip


def planned(*assignments: str) -> planning.Plan:
    return planning.make(catalogue.find("long_roller").replace(assignments))


def test_what_is_called_for_and_left_out_fails_first_unless_a_person_overrules_it() -> None:
    """A strip beyond first yield. 157 K by the heat equation if its slip were even: it is more
    behind the middle."""
    result = solved("long_roller", *HOT)
    checks = result.summary["checks"]
    assert checks["failed"][0] == "effects_left_out" and checks["effects_left_out"] == 2
    limit, reason = checks["limits"]["effects_left_out"]
    assert limit == 0 and "plasticity: the steel would yield" in reason
    assert "give rolling.passes" in reason
    advice = "--without plasticity --without passes"
    assert checks["advice"]["effects_left_out"].startswith(advice)
    rises = result.summary["result"]["friction"]["temperature_rise_max_K"]
    assert 157 < rises["rail"] < 1.03 * 157
    plan = result.plan
    assert "rolling is solved elastically" in plan.effects["plasticity"].why
    accepted = {
        name: replace(each, override=name in ("plasticity", "passes"))
        for name, each in plan.effects.items()
    }
    assert effects.left_out(accepted, result.mesh_solution.after) == {}


def test_heat_is_called_for_where_steel_rolls_at_a_speed() -> None:
    gentle = [each for each in HOT if "yield" not in each]
    plan = planned(*gentle, "rail.yield_stress=560")
    heat = plan.effects["heat"]
    assert heat.called_for and heat.on and "roughness" in plan.effects["friction"].why
    slow = planned(*(each for each in gentle if "speed" not in each), "rolling.speed=none")
    assert not slow.effects["heat"].called_for
    other = planned(*gentle, "wheel.young_modulus=70000").effects["heat"]
    assert not other.called_for and "not known for this material" in other.why


def test_heat_of_meshed_unlike_solids_is_told_by_a_formula() -> None:
    keys = "friction.coefficient=0.3", "wheel.poisson_ratio=0.2", "rolling.creepage_along=3%"
    scene = catalogue.find("hertz_ellipse").replace([*keys, "rolling.speed=60"])
    heat = planning.make(scene).effects["heat"]
    assert heat.called_for and not heat.on and "flash temperature up to" in heat.why
    slow = planning.make(scene.replace(["rolling.speed=1"])).effects["heat"]
    assert not slow.called_for and "100 K matter" in slow.why
    with pytest.raises(
        SceneError, match="no temperature is simulated with meshed bodies of unlike"
    ):
        planning.make(scene.replace(["effects.heat=on"]))


def test_no_temperature_is_signed_of_a_body_that_is_no_steel() -> None:
    keys = "wheel.young_modulus=3000", "rail.extent=half-space", "effects.finite_bodies=off"
    assert after("long_roller", *HOT[:3], *keys)["heat"]["why"] == interface.UNKNOWN


def test_half_spaces_check_the_elastic_answer_of_bodies_that_would_yield() -> None:
    off = "effects.plasticity=off"
    summary = solved("hertz_ellipse", "rail.yield_stress=300", off, "mesh.patch_size=1").summary
    assert summary["plan"]["chosen"] == ["plasticity"]
    assert "second_opinion_max_MPa" in summary["checks"] and summary["checks"]["passed"]
