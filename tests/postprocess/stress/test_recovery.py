"""Recovered stresses of fields whose stress is known."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from railhead.postprocess.stress.recovery import Recovery

YOUNG, POISSON = 207000.0, 0.3
LAME = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)


def recovery(fields: Any) -> Recovery:
    fields = replace(fields, lame=np.tile(LAME, (len(fields.cells), 1)))
    return Recovery(fields, np.flatnonzero(fields.body == 1))


@pytest.mark.parametrize("cut", [True, False])
@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_linear_stress_is_recovered_exactly(
    blocks: Callable[..., Any], cell: str, cut: bool
) -> None:
    """u = (x z, y z, z^2), symmetric about x = 0 and y = 0, inside, on a face and on the axis."""
    fields = blocks(cell, 2, cut=cut).fields
    x, y, z = fields.points.T
    found = recovery(replace(fields, displacement=1e-4 * np.column_stack([x * z, y * z, z * z])))
    points = np.array([[1.0, 2.0, -3.0], [2.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
    x, y, z = points.T
    lam, mu = LAME
    zero = np.zeros(3)
    strain = np.column_stack([z, z, 2 * z, zero, x / 2, y / 2])
    exact = 1e-4 * (lam * 4 * z[:, None] * [1, 1, 1, 0, 0, 0] + 2 * mu * strain)
    assert found.at(points) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    for point, expected in zip(points, exact, strict=True):
        around = found.around(point)
        assert around(points) == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())
        assert around(point[None])[0] == pytest.approx(expected, abs=1e-9 * np.abs(exact).max())
