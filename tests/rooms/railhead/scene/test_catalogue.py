"""Scenes survive a TOML file, and no file raises anything but SceneError."""

import math
import os
import re
from pathlib import Path

import pytest
import tomli_w
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from one_line import refusal

from railhead.scene.catalogue import portable, read_scene
from railhead.scene.keys import HALF_SPACE, without_keys
from railhead.scene.scene import Effects, Scene, SceneError

reusing_the_folder = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])

number = st.floats(min_value=1e-300, max_value=1e300)
radius = st.floats(1e-6, 1e9) | st.just(math.inf)
modulus = st.floats(1e-12, 1e15)
body = st.floats(1e-3, 1e6)
ratio = st.floats(0, 0.5, exclude_max=True)


def table(required, **optional):
    """Return a strategy of tables with some keys always and some keys sometimes."""
    return st.fixed_dictionaries(required, optional=optional)


def material(modulus: st.SearchStrategy[float]):
    return {"young_modulus": modulus, "poisson_ratio": ratio, "yield_stress": st.floats(1e-6, 1e9)}


rails = table(
    {"profile": st.sampled_from(["54E1", "60E1", "UIC54", "UIC60"])},
    extent=st.sampled_from(["head", "section", "half-space"]),
    inclination=st.floats(-0.2, 0.2),
    length=body,
    **material(modulus),
) | table(
    {"profile": st.just("arc"), "crown_radius": radius},
    extent=st.sampled_from(["head", "section"]),
    **material(modulus),
)
wheels = table(
    {"profile": st.sampled_from(["cylinder", "cone20", "cone40"])},
    rolling_radius=radius,
    width=body,
    rim_depth=body,
    **material(modulus | st.just(math.inf)),
) | table(
    {"profile": st.just("arc"), "transverse_radius": radius},
    **material(modulus | st.just(math.inf)),
)
rest = {
    "name": st.from_regex(r"[\w-][\w.-]{0,20}", fullmatch=True),
    "accuracy": st.floats(0.0005, 0.2),
    "budget": number,
    "rail": rails,
    "wheel": wheels,
    "wheelset": table({}, shift=st.floats(-30, 30)),
    "solver": table(
        {},
        method=st.sampled_from(["nitsche", "penalty"]),
        theta=st.sampled_from([None, 1, 0, -1]),
        gamma_factor=number,
        linear=st.sampled_from(["auto", "direct", "multigrid"]),
        max_newton=st.integers(1, 200),
    ),
    "mesh": table(
        {},
        cell=st.sampled_from(["tetrahedron", "hexahedron"]),
        order=st.sampled_from([1, 2]),
        patch_size=st.floats(1e-9, 1e6),
    ),
    "effects": table(
        {}, **dict.fromkeys(Effects.model_fields, st.sampled_from(["auto", "on", "off"]))
    ),
}


def size_or_accuracy(data: dict) -> dict:
    """An accuracy chooses the patch size itself, so the two are not given together; half-spaces
    take no sizes, the penalty method no theta."""
    if "accuracy" in data or "budget" in data:
        data.get("mesh", {}).pop("patch_size", None)
    if data.get("solver", {}).get("method") == "penalty":
        data["solver"].pop("theta", None)
    if data.get("rail", {}).get("extent") == "half-space":
        return without_keys(data, HALF_SPACE)
    return data


scenes = (
    (
        table({"load": st.floats(1e-40, 1e15)}, **rest)
        | table({"approach": st.floats(1e-21, 1e6)}, **rest)
    )
    .map(size_or_accuracy)
    .map(Scene.from_mapping)
)


CONCAVE = {"profile": "arc", "transverse_radius": -330}
RIGID = {"young_modulus": math.inf}


@given(scenes)
@example(Scene.from_mapping({"load": "25 kN", "rail": RIGID, "wheel": CONCAVE}))
@reusing_the_folder
def test_scene_survives_its_file(tmp_path: Path, scene: Scene) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(tomli_w.dumps(portable(scene)), encoding="utf-8")
    assert read_scene(path) == scene


words = st.sampled_from(
    ["load", "approach", "rail", "wheel.profile", "[rail]", "[[rail]]", "[mesh]", "order", "=", "."]
    + ["{", "}", "[", "]", ",", "'", '"', "'''", "#", "inf", "nan", "true", "1", "1e999", "0xff"]
    + ["2012-06-01", "25kN", "'25 kN'", "'x.csv'", "\\u0000", "-"]
)


nearly_toml = st.lists(words | st.just("\n"), max_size=30).map(" ".join)


@given(st.binary() | (st.text() | nearly_toml).map(str.encode))
@reusing_the_folder
def test_no_content_raises_anything_but_scene_error(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "words.toml"
    path.write_bytes(content)
    try:
        assert isinstance(read_scene(path), Scene)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"load = ", "not valid TOML, which is UTF-8 text: Invalid value"),
        (b"load = 1\nload = 2", "Cannot overwrite a value"),
        (b"load = \xff", "decode byte 0xff in position 7"),
        (b"load = 1\x00", "not valid TOML"),
        (b"load = " + b"[" * 20000, "not valid TOML"),
        (b"load = " + b"9" * 5000, "not valid TOML"),
    ],
)
def test_broken_file_is_named_in_one_line(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    line = refusal(lambda: read_scene(path))
    assert line.startswith(f"{path}: ") and words in line


def test_what_is_no_file_is_named_in_one_line(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo.toml")
    for name in ("missing.toml", "new\nline.toml", "nul\0.toml", ".", "fifo.toml", "x" * 300):
        assert "is no file" in refusal(lambda name=name: read_scene(tmp_path / name))


def test_profile_path_starts_at_the_file(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "cases").mkdir()
    (here / "rail.csv").write_text("0,0\n")
    (here / "cases" / "wheel.csv").write_text("0,0\n")
    path = here / "cases" / "measured.toml"
    path.write_text("load = 1\nrail.profile = '../rail.csv'\nwheel.profile = 'wheel.csv'")
    scene = read_scene(Path("cases/measured.toml"))
    assert scene.rail.profile == str(here / "rail.csv")
    assert scene.wheel.profile == str(here / "cases" / "wheel.csv")
    monkeypatch.chdir("/")
    path.write_text(tomli_w.dumps(scene.model_dump(exclude_none=True)))
    assert read_scene(path) == scene


def test_another_profile_under_the_same_name_is_another_scene(tmp_path) -> None:
    """Else old numbers and new ones would stand in one table of a sweep that goes on."""
    places = set()
    for text in ("0,0\n", "0,1\n"):
        (tmp_path / "p.csv").write_text(text)
        scene = Scene(load=1, rail={"profile": str(tmp_path / "p.csv")})
        places.add(portable(scene)["rail"]["profile"])
    assert len(places) == 2 and all(re.fullmatch("input/.+/p.csv", each) for each in places)


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("thesis", "thesis"),
        ("my scene", "my_scene"),
        ("\u00e9", "\u00e9"),
        ("\u043c\u043e\u0439", "\u043c\u043e\u0439"),
        ("e\u0301t\u00e9", "\u00e9t\u00e9"),  # an accent of its own, as macOS writes
        ("<b> 1", "_b__1"),
        ("\u8f2a" * 60, "\u8f2a" * 33),  # of three bytes each
    ],
)
def test_a_scene_without_a_name_takes_the_letters_of_its_file(tmp_path, stem, name) -> None:
    path = tmp_path / f"{stem}.toml"
    path.write_text('load = "25 kN"', encoding="utf-8")
    assert read_scene(path).name == name
    path.write_text("\ufeffload = '25 kN'\r\nname = 'own'", encoding="utf-8")
    assert read_scene(str(path)) == Scene(load=25000, name="own")
