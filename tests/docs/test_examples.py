"""Each script of examples/ is run, and a number of it is held against a closed form."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.slow
def test_two_blocks_press_as_hertz_says() -> None:
    """Blocks of 12 mm under a patch of radius 2.5 mm stay within 1 % of half-spaces."""
    names = runpy.run_path(str(EXAMPLES / "two_blocks.py"))
    points, pressure, solution = names["solve"]()
    _, largest = names["hertz"]()
    radius = np.linalg.norm(points[:, :2], axis=1)
    assert pressure[radius.argmin()] == pytest.approx(largest, rel=0.01)
    assert solution.load == pytest.approx(5000.0, rel=1e-6)
