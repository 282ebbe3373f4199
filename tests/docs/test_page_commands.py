"""Commands that stand in pages as lines of their own: all run, on a coarse mesh without pictures,
with one pass in the place of ten on a coarser one; sweeps are planned, studies are those of
tests/studies/. Those of the README are planned in every run of the tests."""

import re
import shlex
import shutil
from pathlib import Path

import command
import pytest

from railhead.cli import study

ROOT = Path(__file__).parents[2]
LINE = re.compile(r"^    (?:\.venv/bin/)?railhead (.+?)(?:\s+#.*)?$", re.MULTILINE)
COARSE = ("--no-pictures", "--set")
FEWER = {"rolling.passes=10": "rolling.passes=1"}
SHORTER = {"wheelset.shift=0:10:0.5mm": "wheelset.shift=0:10:5mm"}


def commands(page: Path) -> list[list[str]]:
    """The words of each command of a page."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    return [[FEWER.get(word, word) for word in shlex.split(line)] for line in LINE.findall(text)]


PAGES = [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
         if commands(page)]  # fmt: skip


def files(folder: Path) -> None:
    """The files that commands of pages name."""
    block = re.search(r'(?ms)^    load = "25 kN"\n.*?(?=\n\n)', (ROOT / "README.md").read_text())
    (folder / "my_scene.toml").write_text(re.sub(r"(?m)^    ", "", block[0]))
    shutil.copyfile(ROOT / "examples" / "worn_60e1.csv", folder / "worn.csv")
    (folder / "positions.csv").write_text("wheelset.shift [mm],wheelset.yaw [mrad]\n0,0\n2,1\n")


@pytest.mark.parametrize("words", commands(ROOT / "README.md"), ids=" ".join)
def test_commands_of_the_readme_are_accepted(words: list[str], here: Path) -> None:
    files(here)
    first, *others = [SHORTER.get(word, word) for word in words]
    assert command.status("plan" if first in ("run", "sweep") else first, *others) == 0


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page_run(page: Path, tmp_path: Path) -> None:
    files(tmp_path)
    for first, *others in commands(page):
        if first == "study":
            study.canonical(others[0])
            continue
        if first == "sweep":
            first = "plan"
        size = f"mesh.patch_size={4 if 'rolling.passes=1' in others else 1.5}"
        given = (*COARSE, size) if first == "run" and "--accuracy" not in others else ()
        done = command.process(first, *others, *given, cwd=tmp_path)
        good = (0, 1) if given else (0,)  # a coarse mesh may fail a check
        assert done.returncode in good and "NOT WRITTEN" not in done.stderr, (others, done.stderr)
        assert done.stdout


def test_pages_with_commands_are_found() -> None:
    assert {"README", "files", "friction", "passes", "profiles", "report", "sweeps"} <= {
        page.stem for page in PAGES
    }
    assert len(commands(ROOT / "README.md")) >= 4
    assert sum(len(commands(page)) for page in PAGES) > 25
