"""No number of others is left out: each family of data/friction.json has its test, each entry an id
of its own, its source and error."""

import json
import re
from pathlib import Path

from friction_data import ENTRIES, PATH


def test_tests_of_the_theory_name_every_entry() -> None:
    """By how its id begins."""
    files = Path(__file__).with_name("friction").glob("test_*.py")
    starts = re.findall(r'named\("(\w+)"\)', "".join(file.read_text() for file in files))
    assert [name for name in ENTRIES if not name.startswith(tuple(starts))] == []
    assert [start for start in starts if not any(name.startswith(start) for name in ENTRIES)] == []


def test_every_entry_says_where_it_is_from_and_how_far_it_holds() -> None:
    assert all(entry["source"] and entry["estimated_error"] for entry in ENTRIES.values())


def test_no_entry_hides_another() -> None:
    assert len(json.loads(PATH.read_text(encoding="utf-8"))["entries"]) == len(ENTRIES)
