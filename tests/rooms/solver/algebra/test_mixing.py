"""Anderson's mixing."""

import numpy as np

from railhead.solver.algebra.mixing import Anderson


def test_a_linear_fixed_point_is_met_where_plain_iterations_diverge():
    rng = np.random.default_rng(3)
    matrix = rng.normal(0.0, 1.0, (5, 5))
    shift = rng.normal(0.0, 1.0, 5)
    fixed = np.linalg.solve(np.eye(5) - matrix, shift)
    assert np.abs(np.linalg.eigvals(matrix)).max() > 1  # x <- g(x) diverges
    mixing, x = Anderson(depth=10), np.zeros(5)
    for _ in range(12):
        x = mixing.next(x, matrix @ x + shift)
    assert np.abs(x - fixed).max() < 1e-4 * np.abs(fixed).max()
