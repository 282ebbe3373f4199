"""Pages that are programs, scripts of examples/ and commands in pages: all run."""

import ast
import re
import runpy
import shlex
import shutil
from pathlib import Path

import command
import pages
import pytest

from railhead.cli import study

DOCS = Path(__file__).parents[2] / "docs"
NAMES = ["tutorial", "nitsche", "gallery"]
HOWTO = ["solver", *sorted(path.stem for path in DOCS.glob("howto-*.md"))]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*NAMES, *HOWTO, "contact-program", "hertz"])
def test_a_page_runs_and_prints_what_it_says(name: str, here) -> None:
    page = DOCS / f"{name}.md"
    said, printed = pages.stated(page), pages.run(page)[1]
    assert sum(map(bool, said)) >= (5 if name in NAMES else 1) and len(said) == len(printed)
    differences = [pages.unequal(*pair) for pair in zip(said, printed, strict=True)]
    assert not any(differences), differences
    assert name != "tutorial" or [path.name for path in here.iterdir()] == ["results"]
    for picture in pages.pictures(page):
        assert (here / picture).is_file() and (DOCS / name / picture).is_file()


@pytest.mark.parametrize("name", NAMES)
def test_what_a_page_imports_exists(name: str) -> None:
    nodes = ast.walk(ast.parse("".join(pages.blocks(DOCS / f"{name}.md", "python"))))
    lines = {ast.unparse(node) for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)}
    assert len(lines) > 0
    for line in lines:
        exec(line, {})


@pytest.mark.parametrize("name", NAMES + [page for page in HOWTO if "checks" not in page])
def test_numbers_of_the_prose_come_from_code_or_output(name: str) -> None:
    assert pages.unsupported(DOCS / f"{name}.md") == []


def test_pages_that_lie_are_caught(tmp_path) -> None:
    page = tmp_path / "page.md"
    page.write_text("It is 2.5 mm.\n\n```python\nprint(2.44)\n```\n\n```text\n2.43\n```\n")
    said, printed = pages.stated(page), pages.run(page)[1]
    assert not pages.unequal(said[0], printed[0])  # the last place may differ by one
    assert pages.unequal("2.42\n", printed[0]) and pages.unequal("2.44 mm\n", printed[0])
    assert pages.unequal("", printed[0]) and pages.unsupported(page) == ["2.5"]


EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.slow
def test_two_blocks_press_as_hertz_says(here: Path) -> None:
    """Blocks of 12 mm under a patch of radius 2.5 mm, half-spaces in Hertz's formula: near the axis
    to 0.5 %, the largest pressure to 3 %."""
    names = runpy.run_path(str(EXAMPLES / "two_blocks.py"))
    solution, pressure, largest = (names[name] for name in ("solution", "p", "P0"))
    assert solution.converged
    assert pressure[names["radius"].argmin()] == pytest.approx(largest, rel=0.005)
    assert pressure.max() == pytest.approx(largest, rel=0.03)
    assert 4 * solution.weights @ pressure == pytest.approx(5000.0, rel=1e-4)


ROOT = Path(__file__).parents[2]
LINE = re.compile(r"^    (?:\.venv/bin/)?railhead (.+?)(?:\s+#.*)?$", re.MULTILINE)
COARSE = ("--no-pictures", "--set")
FEWER = {"rolling.passes=10": "rolling.passes=1"}
SHORTER = {"wheelset.shift=0:10:0.5mm": "wheelset.shift=0:10:5mm"}


def commands(page: Path) -> list[list[str]]:
    """The words of each command of a page that comes to an end: a page in a browser does not."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    lines = [line for line in LINE.findall(text) if not line.startswith("page ")]
    return [[FEWER.get(word, word) for word in shlex.split(line)] for line in lines]


PAGES = [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
         if commands(page)]  # fmt: skip


def files(folder: Path) -> None:
    """The files that commands of pages name."""
    block = re.search(r'(?ms)^    load = "25 kN"\n.*?(?=\n\n)', (ROOT / "README.md").read_text())
    (folder / "my_scene.toml").write_text(re.sub(r"(?m)^    ", "", block[0]))
    shutil.copyfile(ROOT / "examples" / "worn_60e1.csv", folder / "worn.csv")
    (folder / "examples").symlink_to(ROOT / "examples")
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
            assert others[0].replace("-", "_") in study.modules()
            continue
        if any(word.endswith((".ban", ".whl")) for word in others):
            continue  # files of the reader
        if "--sample" in others:
            others[others.index("--sample") + 1] = "2"
        elif first == "sweep":
            first = "plan"
        size = f"mesh.patch_size={4 if 'rolling.passes=1' in others else 1.5}"
        given = (*COARSE, size) if first == "run" and "--accuracy" not in others else ()
        if first == "table":
            given = ("--cells", "12", "--accuracy", "20%")
        done = command.process(first, *others, *given, cwd=tmp_path)
        good = (0, 1) if given else (0,)  # a coarse mesh may fail a check
        assert done.returncode in good and "NOT WRITTEN" not in done.stderr, (others, done.stderr)
        assert done.stdout


def test_pages_with_commands_are_found() -> None:
    assert {"README", "friction", "passes", "profiles", "report", "sweeps"} <= {
        page.stem for page in PAGES
    }
    assert len(commands(ROOT / "README.md")) >= 4
    assert sum(len(commands(page)) for page in PAGES) > 25
