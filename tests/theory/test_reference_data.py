"""No number of others is left out: each family of data/friction.json has its test, each entry an id
of its own, its source and error."""

import json

from friction_data import ENTRIES, PATH

HELD = {
    "mindlin_sphere": "test_cattaneo, test_rolling",
    "mindlin_ellipse": "test_cattaneo, test_rolling",
    "cattaneo_strip": "test_cattaneo",
    "carter": "test_carter",
    "kalker": "test_kalker",
    "curve": "test_rolling, test_kalker",
    "mises": "test_sliding",
    "contact_program": "test_rolling",
    "contact_shipped": "test_rolling",
}
"""Where the entries are that begin so."""


def test_every_entry_is_held_against_the_theory() -> None:
    left = [name for name in ENTRIES if not name.startswith(tuple(HELD))]
    idle = [start for start in HELD if not any(name.startswith(start) for name in ENTRIES)]
    assert (left, idle) == ([], [])


def test_every_entry_says_where_it_is_from_and_how_far_it_holds() -> None:
    assert all(entry["source"] and entry["estimated_error"] for entry in ENTRIES.values())


def test_no_entry_hides_another() -> None:
    assert len(json.loads(PATH.read_text(encoding="utf-8"))["entries"]) == len(ENTRIES)
