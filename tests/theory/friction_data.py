"""Entries of data/friction.json, numbers of others with their sources and errors."""

import json
from pathlib import Path
from typing import Any

import pytest

PATH = Path(__file__).parent / "data" / "friction.json"
ENTRIES: list[dict[str, Any]] = json.loads(PATH.read_text(encoding="utf-8"))["entries"]


def named(start: str) -> list[Any]:
    """Those whose id starts so, with their ids, for pytest."""
    found = [entry for entry in ENTRIES if entry["id"].startswith(start)]
    return [pytest.param(entry, id=entry["id"]) for entry in found]
