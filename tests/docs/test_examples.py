"""Each script of examples/ is run, and a number of it is held against a closed form."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.slow
@pytest.mark.parametrize("given", [False, True])
def test_two_blocks_press_as_hertz_says(given: bool) -> None:
    """Blocks of 12 mm under a patch of radius 2.5 mm, half-spaces in Hertz's formula: near the axis
    to 0.5 %, the largest pressure to 3 %, with the gap of the curved mesh and with a given one."""
    names = runpy.run_path(str(EXAMPLES / "two_blocks.py"))

    def gap(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return (x[:, :2] ** 2).sum(axis=1) / 1000.0, np.tile([0.0, 0.0, 1.0], (len(x), 1))

    points, pressure, solution = names["solve"](*((np.inf, gap) if given else ()))
    _, largest = names["hertz"]()
    radius = np.linalg.norm(points[:, :2], axis=1)
    assert solution.converged
    assert pressure[radius.argmin()] == pytest.approx(largest, rel=0.005)
    assert pressure.max() == pytest.approx(largest, rel=0.03)
    assert 4 * solution.weights @ pressure == pytest.approx(5000.0, rel=1e-4)
