"""No number of others is left out: each family of data/friction.json has its test, each entry its
source and error."""

from friction_data import ENTRIES

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
    left = [e["id"] for e in ENTRIES if not e["id"].startswith(tuple(HELD))]
    idle = [start for start in HELD if not any(e["id"].startswith(start) for e in ENTRIES)]
    assert (left, idle) == ([], [])


def test_every_entry_says_where_it_is_from_and_how_far_it_holds() -> None:
    assert all(entry["source"] and entry["estimated_error"] for entry in ENTRIES)
