"""docs/design.md names every module in its room, docs/verification.md tests that are run."""

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


def test_a_claim_is_held_by_a_test_of_the_default_run() -> None:
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    held = re.findall(r"\[(test_\w+)\]\(\.\./(tests/\S+\.py)\)", page.split("## ")[0])
    assert len(held) >= 15
    for name, file in held:
        found = re.search(
            rf"((?:^@.*\n(?:^[ )\]].*\n)*)*)^def {name}\(", (ROOT / file).read_text("utf-8"), re.M
        )
        assert found and "@pytest.mark.slow" not in found[1], name
