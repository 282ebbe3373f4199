"""The basis in the cells."""

import numpy as np
import pytest

from railhead.solver.space.cells import inverse


@pytest.mark.parametrize("rows", [2, 3])
def test_inverses_and_determinants_are_those_of_lapack(rows: int) -> None:
    matrices = np.random.default_rng(3).normal(size=(50, rows, rows))
    matrices[0] = np.diag([1e-3, 1.0, 50.0][:rows])  # of a stretched cell
    inverses, determinants = inverse(matrices)
    assert inverses == pytest.approx(np.linalg.inv(matrices), rel=1e-10)
    assert determinants == pytest.approx(np.linalg.det(matrices), rel=1e-10)
