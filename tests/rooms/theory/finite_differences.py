"""Derivatives of sampled fields, to hold closed forms against the equations of elasticity."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def jacobian(field, points: Array, step: float) -> Array:
    """d field_i / d x_j as (n, components, 3), by fourth-order central differences."""
    columns = []
    for axis in np.eye(3):
        ahead, behind = field(points + step * axis), field(points - step * axis)
        far_ahead, far_behind = field(points + 2 * step * axis), field(points - 2 * step * axis)
        columns.append((8 * (ahead - behind) - (far_ahead - far_behind)) / (12 * step))
    return np.stack(columns, axis=-1)
