"""Pages that are programs: they run as printed, and say what they print."""

import ast
from pathlib import Path

import pages
import pytest

DOCS = Path(__file__).parents[2] / "docs"
NAMES = ["tutorial", "nitsche", "gallery"]
HOWTO = ["solver", *sorted(path.stem for path in DOCS.glob("howto-*.md"))]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*NAMES, *HOWTO, "contact-program"])
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
    nodes = ast.walk(ast.parse("".join(pages.blocks(DOCS / f"{name}.md"))))
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
    assert pages.unequal("", printed[0])
    assert pages.unsupported(page) == ["2.5"]


def test_shell_commands_that_fail_are_caught(here) -> None:
    page = here / "page.md"
    page.write_text("```sh\nls examples | grep two_blocks\nrailhead --version > version\n```\n")
    assert pages.run(page)[1] == ["two_blocks.py\n"] and (here / "version").read_text()
    page.write_text("```sh\nrailhead run no_such_case\n```\n")
    with pytest.raises(AssertionError, match="status 2: .*no_such_case"):
        pages.run(page)
