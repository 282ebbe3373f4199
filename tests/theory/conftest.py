"""Reference numbers and the contacts that the tests of the closed forms share."""

import json
from pathlib import Path
from typing import Any

import pytest

from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact


@pytest.fixture(scope="session")
def reference() -> dict[str, Any]:
    """Exact numbers of the thesis case, a 30-digit Hertz evaluation; N, mm, MPa."""
    path = Path(__file__).parent / "data" / "hertz_thesis.json"
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return data


@pytest.fixture(scope="session")
def thesis_ellipse() -> Ellipse:
    """Wheel R 420 mm on rail crown R 300 mm, both steel (207 GPa, 0.3), 25 kN."""
    return point_contact(1 / 420, 1 / 300, contact_modulus(207000, 0.3, 207000, 0.3), 25000)
