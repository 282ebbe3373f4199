"""Outline, area, half lengths and peak of a patch whose p^2 is known everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import contourpy
import numpy as np

from railhead.postprocess.findings import Array
from railhead.postprocess.patch.reconstruct import SquaredPressure

GRID = 400  # lines each way: zeros of a parabola are found to 4e-6 of its width


@dataclass(frozen=True)
class PatchShape:
    """outlines: closed curves (k, 2) of (x, s), mm, holes included; area mm2; half lengths a along
    x, b along s, mm; peak MPa, at top (x, s)."""

    outlines: list[Array]
    area: float
    a: float
    b: float
    peak: float
    top: tuple[float, float] = (0.0, 0.0)


def outline_shape(square: SquaredPressure) -> PatchShape:
    """Where F > 0. The border of the box counts as outside: the surface ends there."""
    x, s = (np.linspace(low, high, GRID, dtype=np.float64) for low, high in square.box)
    values = square.grid(x, s)
    top = float(values.max())
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * top)
    values[:, [0, -1]] = np.minimum(values[:, [0, -1]], -1e-9 * top)
    lines = contourpy.contour_generator(x, s, values).lines(0.0)
    outlines = [np.asarray(line, dtype=np.float64) for line in lines]
    area = abs(sum(_enclosed(line) for line in outlines))
    a, b = np.ptp(np.concatenate(outlines), axis=0) / 2
    row, column = np.unravel_index(np.argmax(values), values.shape)
    place = float(x[column]), float(s[row])
    return PatchShape(outlines, float(area), float(a), float(b), float(np.sqrt(top)), place)


def _enclosed(line: Array) -> float:
    """Signed area in a closed curve: a hole counts the other way round."""
    x, s = line.T
    return float(0.5 * np.sum(x[:-1] * s[1:] - x[1:] * s[:-1]))
