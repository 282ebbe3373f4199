"""Numbers and directions that parts of a model are given, checked."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from railhead.theory.array_types import Array

Direction = Sequence[float]


def unit(name: str, vector: Any) -> Array:
    """Unit vector along a direction (c,); raises ValueError for one without a length."""
    out = np.asarray(vector, float)
    length = np.linalg.norm(out)
    if not 0 < length < math.inf:
        raise ValueError(f"{name} must have a direction, not {vector!r}")
    return np.asarray(out / length)


def finite(owner: Any, name: str, given: Any, *shape: int) -> Array:
    """A number or, with a shape, an array that a part has. Raises ValueError for what is not finite
    and for another shape; owner, name: of the part and of its attribute, for the message.
    """
    out = np.asarray(given)
    if out.shape != shape or out.dtype.kind not in "iuf" or not np.isfinite(out).all():
        text = f"{owner}: {name} must be {math.prod(shape)} finite number(s)"
        raise ValueError(f"{text}, not {given!r:.60}")
    return out.astype(float)
