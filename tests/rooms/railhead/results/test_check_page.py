"""docs/howto-failed-checks.md has a section for each check that can fail, by its name."""

import re
from pathlib import Path

from railhead.meshing.bodies import BODY_NAMES
from railhead.results import checks
from railhead.results.report.html import CHECKS

DOCS = Path(__file__).parents[4] / "docs"
PAGE = DOCS / "howto-failed-checks.md"


def names() -> set[str]:
    """Names of all checks in the source; those of compared quantities are one."""
    source = Path(checks.__file__).read_text(encoding="utf-8")
    two = re.findall(r'_between\(\s*"(\w+)"', source)
    found = {f"{name}{end}" for name in two for end in ("", "_least")}
    for name in re.findall(r'name=f?"(?!{name})(.+?)"', source):
        name = name.replace("_{key}", "").replace("{SECOND}", checks.SECOND)
        found |= {name.replace("{BODY_NAMES[body]}", body) for body in BODY_NAMES.values()}
    return found


def test_every_check_has_a_section() -> None:
    sections = re.findall(r"^## (\w+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(sections) == sorted(names()) and len(sections) > 25


def test_the_list_of_checks_has_every_check() -> None:
    page = (DOCS / "checks.md").read_text(encoding="utf-8")
    assert [name for name in names() if name not in page] == []


def test_sections_begin_with_the_words_of_the_report() -> None:
    sections = dict(re.findall(r"^## (\w+)\n\n\*(.+?)\.\*", PAGE.read_text(), re.MULTILINE))
    assert CHECKS.keys() == {name for name in sections if not name.startswith(checks.SECOND)}
    for name in CHECKS:
        assert sections[name].casefold() == CHECKS[name].casefold(), name
