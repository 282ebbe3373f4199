"""Power laws and Pareto fronts of series of runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def power_law(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """(c, n) of y = c x^n by least squares of log y over log x; x and y positive, two or more.

    ValueError: fewer than two different x, or a value that is not positive.
    """
    if len(set(x)) < 2 or min(*x, *y) <= 0:
        raise ValueError(f"no power law through x = {list(x)}, y = {list(y)}")
    exponent, intercept = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(intercept)), float(exponent)


def pareto(cost: Sequence[float], error: Sequence[float]) -> NDArray[np.intp]:
    """Indices, by growing cost, of the points that no other point beats in cost and in error."""
    order = np.lexsort((error, cost))
    best = np.minimum.accumulate(np.asarray(error, dtype=float)[order])
    falls = np.concatenate([[True], np.diff(best) < 0])
    return np.asarray(order[falls])
