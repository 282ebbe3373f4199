"""docs/howto-failed-checks.md has a section for each check that can fail, by its name."""

import ast
import re
from pathlib import Path

from railhead.meshing.bodies import BODY_NAMES
from railhead.results import checks
from railhead.results.report.html import CHECKS

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "howto-failed-checks.md"


def names() -> set[str]:
    """Names of all checks in the source; those of compared quantities are one."""
    found = set()
    for call in ast.walk(ast.parse(Path(checks.__file__).read_text(encoding="utf-8"))):
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "_between":
            found |= {ast.literal_eval(call.args[0]), f"{ast.literal_eval(call.args[0])}_least"}
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Check":
            (name,) = (word.value for word in call.keywords if word.arg == "name")
            text = re.sub(r"^f?['\"]|['\"]$", "", ast.unparse(name))
            text = text.replace("{SECOND}", checks.SECOND)
            if text in ("name", "{name}_least"):
                continue  # of `_between`
            if text.endswith("{key}"):
                text = checks.SECOND
            bodies = [text.replace("{BODY_NAMES[body]}", body) for body in BODY_NAMES.values()]
            found |= set(bodies)
    return found


def test_every_check_has_a_section() -> None:
    page = PAGE.read_text(encoding="utf-8")
    sections = re.findall(r"^## (\w+)$", page, re.MULTILINE)
    assert sorted(sections) == sorted(names()) and len(sections) > 25


def test_the_list_of_checks_has_every_check() -> None:
    page = (DOCS / "checks.md").read_text(encoding="utf-8")
    assert [name for name in names() if name not in page] == []


def test_sections_begin_with_the_words_of_the_report() -> None:
    sections = dict(re.findall(r"^## (\w+)\n\n\*(.+?)\.\*", PAGE.read_text(), re.MULTILINE))
    assert CHECKS.keys() == {name for name in sections if not name.startswith(checks.SECOND)}
    for name in CHECKS:
        assert sections[name].casefold() == CHECKS[name].casefold(), name
