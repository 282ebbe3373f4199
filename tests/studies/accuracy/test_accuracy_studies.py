"""Error envelopes, families of scenes, twist of a rail, and effects, as studies measure them."""

import json
from itertools import product

from railhead.planning import error_envelopes
from studies.accuracy import calibrate, effects, error_bounds, families


def test_laws_are_as_the_study_writes_them() -> None:
    """Families, their settings, ranges of meshes and quantities, and what is added by hand."""
    kept, said = error_envelopes._laws(), {"command": "railhead study calibrate"}
    known = {
        part: (where, recipe.resolutions)
        for name, recipe in families.RECIPES.items() if recipe.resolutions
        for part, where in families.parts(name).items()
    }  # fmt: skip
    assert kept.keys() == {"seed", "load_steps", "friction", "families"} | said.keys()
    assert [*kept["families"]] == [*known]
    for name, entry in kept["families"].items():
        row = {"scene": "", "error": 1e-3, "reading": 1e-4, "overlap": 0.0, "scale": 1.0}
        rows = [row | {"quantity": q, "n": n} for q, n in product(entry["laws"], known[name][1])]
        fitted = json.loads(json.dumps(calibrate.fit(name, rows, *known[name])))
        assert entry.keys() == fitted.keys()
        for key in entry.keys() - {"scenes", "laws", "reading", "overlap"}:
            assert entry[key] == fitted[key], (name, key)
        for key in ("laws", "reading", "overlap"):
            assert entry[key].keys() == fitted[key].keys(), (name, key)
    rubs = families.BESIDE["rubbing lines"]
    assert kept["friction"]["resolution"] == [rubs.resolutions[0], rubs.resolutions[-2]]
    assert kept["friction"]["where"] == families.DEFAULT | rubs.where
    steps = [(each["line"], each["overload"]) for each in kept["load_steps"]]
    assert steps == [(line, most) for line, _, _, most in calibrate.STEPPED]


def test_estimates_hold_in_random_sections() -> None:
    """The small version of `railhead study error-bounds`."""
    records = [
        record
        for name in ("plane strain", "meridian")
        for index, scene in zip(range(3), families.scenes(name, 77), strict=False)
        for record in error_bounds.measure(name, scene, error_bounds.asked(name, index))
    ]
    found = error_bounds.verdict(records)
    assert len({record["scene"] for record in records}) == 6 and found["estimated"] == 1.0
    assert found["holds"] >= 0.95 and found["worst"] < 1.5


def run(effect: str, on: bool, change: float) -> dict:
    return {
        "scene": "made_up",
        "effect": effect,
        "on": on,
        "called_for": not on,
        "accuracy": 0.01,
        "unknowns": 100,
        "seconds": 2.0,
        "p_max": 1.0,
        "area": 1.0,
        "tau_max": 1.0,
        "approach": 1.0,
        "change_p_max": change,
        "change_area": 0.0,
        "change_tau_max": 0.0,
        "change_approach": 0.0,
    }


def test_verdict_names_what_was_wrongly_left_out() -> None:
    fine = [
        run("", True, 0.0),
        run("symmetry_x", False, 0.002),
        run("rail_section", False, 0.05),
    ]
    assert effects.wrong(fine) == [] and effects.verdict(fine).startswith("Yes: of 1 effects")
    told = effects.verdict([run("", True, 0.0), run("far_field", False, 0.001)])
    assert "0 change p_max" in told and "less:\n\n- `far_field`" in told  # kept without need
    bad = [*fine, run("plasticity", True, 0.03), run("symmetry_y", False, -0.02)]
    assert [row["effect"] for row in effects.wrong(bad)] == ["plasticity", "symmetry_y"]
    assert effects.verdict(bad).startswith("**No.**")


def test_what_the_scene_switched_off_is_no_fault_of_the_plan() -> None:
    overruled = {**run("plasticity", True, 0.3), "called_for": True}
    assert effects.wrong([run("", True, 0.0), overruled]) == []
    told = effects.verdict([run("", True, 0.0), run("friction", True, 0.001), overruled])
    assert told.startswith("Yes: of 1 effects")
    assert "`plasticity` of made_up. The scene switches it off. It would change 30 %." in told
