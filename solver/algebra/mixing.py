"""Anderson's mixing of a fixed point (J. Assoc. Comput. Mach. 12, 1965): least squares over the
last residuals."""

import numpy as np

from railhead.theory.array_types import Array


class Anderson:
    """Anderson's acceleration of a fixed point x = g(x). It remembers the last iterates, and `next`
    gives the next one.

    depth: largest number of earlier iterates that are mixed.
    """

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self._values: list[Array] = []
        self._residuals: list[Array] = []

    def next(self, x: Array, value: Array) -> Array:
        """Next iterate (n,) after x (n,) with value = g(x) (n,)."""
        self._values.append(value.copy())
        self._residuals.append(value - x)
        self._values = self._values[-self.depth - 1 :]
        self._residuals = self._residuals[-self.depth - 1 :]
        if len(self._values) == 1:
            return value
        last = self._residuals[-1]
        steps = np.array([last - each for each in self._residuals[:-1]])
        gram = steps @ steps.T
        gram += 1e-12 * np.trace(gram) / len(gram) * np.eye(len(gram))
        share = np.linalg.solve(gram, steps @ last)
        moved = np.array([value - each for each in self._values[:-1]])
        return np.asarray(value - share @ moved)
