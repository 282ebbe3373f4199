"""docs/design.md names every module in its room."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
ROOMS = dict(re.findall(r"^    (\w+)/ +(.*?)(?=^    \w+/ |\n\n)", TEXT, re.M | re.S))
WITH_ROOMS_OF_THEIR_OWN = {"cases", "studies"}  # a case or study is found by its name


@pytest.mark.parametrize("room", sorted({*ROOMS} - {"tests"} - WITH_ROOMS_OF_THEIR_OWN))
def test_every_module_is_named_in_its_room(room: str) -> None:
    named = set(re.findall(r"\w+", ROOMS[room]))
    modules = {path.stem for path in (ROOT / room).rglob("*.py")} - {"__init__"}
    assert modules - named == set()


def test_every_study_is_named() -> None:
    named = set(re.findall(r"\w+", ROOMS["studies"]))
    found = {path.stem for path in (ROOT / "studies").iterdir() if path.stem != "__init__"}
    assert found - named - {"__pycache__"} == set()


def test_every_package_is_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    setup = project["tool"]["setuptools"]
    found = set()
    for package, room in setup["package-dir"].items():
        for marker in (ROOT / room).rglob("__init__.py"):
            found.add(".".join([package, *marker.parent.relative_to(ROOT / room).parts]))
    assert found == set(setup["packages"])
