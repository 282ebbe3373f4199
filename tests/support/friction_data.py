"""Entries of theory/data/friction.json, numbers of others with their sources and errors, for the
tests of theory and solver alike."""

import json
from pathlib import Path

import pytest

PATH = Path(__file__).parents[1] / "rooms" / "theory" / "data" / "friction.json"
ENTRIES = {entry["id"]: entry for entry in json.loads(PATH.read_text(encoding="utf-8"))["entries"]}


def named(start: str):
    """Those whose id starts so, with their ids, for pytest."""
    return [pytest.param(entry, id=key) for key, entry in ENTRIES.items() if key.startswith(start)]
