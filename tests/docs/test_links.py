"""Links of pages lead to files and headings that exist; each page is on a shelf of the site."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted(DOCS.glob("*.md"))]


def prose(page: Path) -> str:
    """The text without its code."""
    return re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def anchors(page: Path) -> set[str]:
    """The names that its headings have in links."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each.strip().lower()).replace(" ", "-") for each in headings}


def dead(page: Path):
    """Targets of its links that lead nowhere; those to other hosts are not followed."""
    for target in re.findall(r"\]\(([^()\s]+)\)|src=\"([^\"]+)\"", prose(page)):
        path, _, anchor = "".join(target).partition("#")
        file = page.parent / path if path else page
        if re.match(r"\w+:", path):
            continue
        if not file.is_file() or (anchor and anchor not in anchors(file)):
            yield "".join(target)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_link_of_a_page_is_dead(page: Path) -> None:
    assert list(dead(page)) == []


def test_dead_links_are_found(tmp_path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# One, `two`\n[a](none.md) [b](#one-two) [c](#three) [d](page.md#one-two)\n")
    assert list(dead(page)) == ["none.md", "#three"]


def test_every_page_is_in_the_list_and_on_a_shelf() -> None:
    listed = set(re.findall(r"\]\(([\w-]+)\.md\)", (DOCS / "README.md").read_text("utf-8")))
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    shelved = {
        path.stem
        for entry in re.findall(r"^[\w*-]+$", index, re.MULTILINE)
        for path in DOCS.glob(f"{entry}.md")
    }
    assert listed == shelved == {page.stem for page in DOCS.glob("*.md")} - {"README", "index"}
