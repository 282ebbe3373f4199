"""Files and tests that pages name exist; every room is installed; former names are kept."""

import re
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

import railhead

ROOT = Path(__file__).parents[2]
FILE = re.compile(r"`((?:\w+/)+\w+\.py|(?:\w+/)*data/\w+\.\w+)`")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_that_a_page_names_exists(page: Path) -> None:
    """Its path begins at the checkout or at the package railhead."""
    named = set(FILE.findall(page.read_text(encoding="utf-8")))
    roots = ROOT, ROOT / "railhead"
    assert {each for each in named if not any((root / each).is_file() for root in roots)} == set()


def test_every_test_that_holds_a_claim_exists_and_runs_by_default() -> None:
    page = (ROOT / "docs" / "verification.md").read_text("utf-8")
    claims = [
        re.findall(r"\[(test_\w+)\]\(\.\./(tests/[\w/]+\.py)\)", row)
        for row in page.partition("\n## What `make test` leaves")[0].splitlines()
        if re.match(r"\| (?!Claim )", row)
    ]
    assert len(claims) == 42 and all(claims)
    for name, file in (each for row in claims for each in row):
        before, found, _ = (ROOT / file).read_text(encoding="utf-8").partition(f"def {name}(")
        assert found, (name, file)
        assert "\n@pytest.mark.slow" not in before[before.rindex("\n\n\n") :], name


def test_every_folder_of_modules_is_named_once_where_the_package_is_built() -> None:
    """An older environment still finds a folder whose name was lost; a new one does not."""
    setuptools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = [
        ".".join([name, *module.parent.relative_to(ROOT / place).parts])
        for name, place in setuptools["package-dir"].items()
        for module in (ROOT / place).rglob("__init__.py")
    ]
    assert sorted(setuptools["packages"]) == sorted(folders)


@pytest.mark.parametrize("former", railhead._MOVED)
def test_a_module_that_moved_is_found_by_its_former_name(former: str, monkeypatch) -> None:
    monkeypatch.delitem(sys.modules, former, raising=False)
    present = railhead._MOVED[former]
    with pytest.warns(DeprecationWarning, match=f"{former} is now called {present}"):
        assert import_module(former) is import_module(present)
    assert import_module(present).__name__ == present
    with pytest.raises(ModuleNotFoundError):
        import_module(f"{former}_no")


def test_units_are_parsed_by_their_former_name() -> None:
    from railhead.display import Units

    assert Units.parse("mm,kN,MPa").unit("N") == "kN"
