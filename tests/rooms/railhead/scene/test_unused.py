"""Every key of a scene is used or refused, whatever its kind: none is silently ignored."""

import dataclasses
import math
from functools import lru_cache

import numpy as np
import pytest

from railhead.contact import plane_section
from railhead.contact.closed_forms import hertz_contact
from railhead.contact.plane_section import SectionContact
from railhead.meshing.bodies import RAIL
from railhead.planning import simulation_plan
from railhead.run import model_setup
from railhead.scene import catalogue, keys
from railhead.scene.scene import Scene, SceneError

BALL = {"rail": {"profile": "arc", "crown_radius": math.inf},
        "wheel": {"profile": "arc", "rolling_radius": 300, "transverse_radius": 300}}  # fmt: skip
ROLLER = {"rail": {"profile": "arc", "crown_radius": math.inf},
          "wheel": {"rolling_radius": 50, "width": 60}}  # fmt: skip
BAR = {"rail": {"length": 100}, "wheel": {"rolling_radius": math.inf}}
#: By kind of UNUSED_KEYS (solids have none): a scene of it.
SCENES = {
    "half_space": {},
    "half_space_along": ROLLER,
    "half_space_across": BAR,
    "plane_along": ROLLER,
    "plane_across": BAR,
    "axisymmetric": BALL,
    "solid": {"rail": {"profile": "arc", "crown_radius": 80}},
    "solid on a track": {"rail": {"gauge": 1435}},
}
#: Another value than the default of each key about bodies and where they stand.
KEYS = {
    "rail.inclination": 0.01, "rail.gauge": 1437, "rail.length": 90, "rail.depth": 45,
    "rail.width": 50, "wheel.width": 44, "wheel.rim_depth": 22, "wheel.segment_length": 70,
    "wheelset.shift": 0.5, "wheelset.yaw": 0.002, "wheelset.back_to_back": 1359,
    "wheel.tape_circle": 71,
    "rail.young_modulus": 2e5, "rail.poisson_ratio": 0.2, "wheel.young_modulus": 2e5,
    "wheel.poisson_ratio": 0.2, "rail.gauge_height": 13, "wheelset.roll": 0.001,
    "wheelset.side": "left", "wheelset.other_rail": "60E1", "wheelset.other_wheel": "cone20",
    "wheelset.other_radius": 418,
    "rail.surface": {"kind": "cosine", "length": 30.0, "amplitude": 0.05},
    "wheel.surface": {"kind": "flat", "length": 30.0, "depth": 0.1},
}  # fmt: skip
MIDDLE = ("wheelset.back_to_back", "wheel.tape_circle")  # where wheels stand upright at any
ALIKE = ("wheelset.side", "wheelset.other_rail")


def scene(kind: str, **keys) -> Scene:
    data = {"load": 5000.0, **{k: dict(v) for k, v in SCENES[kind].items()}}
    if kind.startswith("half_space"):
        keys["rail.extent"] = "half-space"
    for key, value in keys.items():
        section, leaf = key.split(".")
        data.setdefault(section, {})[leaf] = value
    return Scene.from_mapping(data)


def numbers(value) -> list[float]:
    """All numbers in nested dataclasses and containers."""
    if dataclasses.is_dataclass(value):
        return numbers([getattr(value, field.name) for field in dataclasses.fields(value)])
    if isinstance(value, dict):
        return numbers(list(value.values()))
    if isinstance(value, list | tuple):
        return [each for inner in value for each in numbers(inner)]
    if isinstance(value, np.ndarray):
        return [float(each) for each in value.ravel()]
    return [float(value)] if isinstance(value, int | float) else []


def solved(made: simulation_plan.Plan) -> list[float]:
    """All numbers that meshing and solver get."""
    flat = isinstance(made.contact, SectionContact)
    bodies = [
        (body.section, body.tag, body.pose, 0.0 if flat else body.reach) for body in made.parts()
    ]
    x, y = (c.ravel() for c in np.meshgrid(np.linspace(-4, 4, 5), np.linspace(-4, 4, 5)))
    heights = np.full(len(x), made.contact.touch.z)
    gap, normal = made.contact.gap(RAIL)(np.column_stack([x, y + made.contact.touch.y, heights]))
    length = made.contact.dimension.length if flat else 0.0
    materials = model_setup.materials(made)
    hertz = hertz_contact(made.scene, made.contact)
    where = made.contact.origin, made.patch_size, made.planes
    return numbers([bodies, gap, normal, length, *materials.values(), hertz, where])


@lru_cache
def plain(name: str) -> list[float]:
    """The same of a scene without further keys."""
    return solved(simulation_plan.make(scene(name)))


def kind(given: Scene) -> str:
    if given.rail.extent == "half-space":
        return given._half_space
    return plane_section.choose(given).kind


@pytest.mark.parametrize("name", SCENES)
def test_scenes_are_of_their_kind(name: str) -> None:
    assert kind(scene(name)) == name.split()[0]


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("name", SCENES)
def test_a_key_is_used_or_refused(name: str, key: str) -> None:
    if (name == "solid" and key in MIDDLE) or (name.startswith("solid") and key in ALIKE):
        pytest.skip("an upright cylinder touches the top of any rail, on either side")
    try:
        found = solved(simulation_plan.make(scene(name, **{key: KEYS[key]})))
    except SceneError as error:
        (line,) = str(error).splitlines()
        if name != "axisymmetric" and key in keys.UNUSED_KEYS.get(name, ("", ()))[1]:
            value = KEYS[key]["kind"] if key.endswith("surface") else KEYS[key]
            assert line.startswith(f"{key}: {value!r} is not allowed")
        assert key.split(".")[1].split("_")[0] in line  # by this rule or by another one
        return
    assert found != plain(name)


def test_a_long_narrow_contact_with_yaw_is_solid() -> None:
    keys = {"rail.crown_radius": 1e6, "rail.width": 10.0, "wheel.width": 10.0}
    assert kind(scene("plane_along", **keys)) == "plane_along"
    assert kind(scene("plane_along", **keys, **{"wheelset.yaw": 0.002})) == "solid"


@pytest.mark.parametrize("name", catalogue.shipped())
def test_shipped_cases_stay_valid_between_half_spaces_too(name: str) -> None:
    case = catalogue.find(name)
    simulation_plan.make(case)
    if name == "s1002_60e1":
        return
    half = case.replace(["rail.extent=half-space"])
    assert keys.set_but_unused(half, half._half_space) == []
    assert half.replace(["rail.extent=half-space"]) == half


def test_set_half_space_drops_only_what_was_not_asked_for() -> None:
    solid = scene("solid on a track", **{"wheelset.shift": 0.5, "wheel.rim_depth": 40})
    half = solid.replace(["rail.extent=half-space"])
    assert (half.rail.gauge, half.wheelset.shift, half.wheel.rim_depth) == (None, 0.0, None)
    with pytest.raises(SceneError, match=r"^wheelset.shift: 0.5 is not allowed; a point contact"):
        solid.replace(["rail.extent=half-space", "wheelset.shift=0.5"])
    with pytest.raises(SceneError, match=r"^wheelset.shift: "):
        half.replace(["wheelset.shift=0.5"])
    roller = scene("plane_along", **{"wheel.width": 50, "wheel.rim_depth": 20})
    half = roller.replace(["rail.extent=half-space"])
    assert (half.wheel.width, half.wheel.rim_depth) == (50, None)
