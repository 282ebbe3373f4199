"""Outline, area, half lengths and peak of a patch whose p^2 is known everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import contourpy
import numpy as np

from railhead.postprocess.findings import Array
from railhead.postprocess.patch.reconstruct import SquaredPressure

GRID_LINES = 400  # in each direction: zeros of a parabola are exact to 4e-6 of its width


@dataclass(frozen=True, kw_only=True)
class PatchShape:
    """Extents and peak of one patch, measured on a smooth p^2.

    outlines: closed curves (k, 2) of (x, s), mm; a hole is a curve of its own. Empty for a section.
    area: enclosed by the outlines, without the holes, mm2.
    a, b: half lengths along x and along s, mm.
    max_pressure: largest pressure, MPa.
    top: (x, s) of the largest pressure, mm; zeros for a section.
    """

    outlines: list[Array]
    area: float
    a: float
    b: float
    max_pressure: float
    top: tuple[float, float] = (0.0, 0.0)


def outline_shape(square: SquaredPressure) -> PatchShape:
    """Extents and peak of a patch from the zero contour of p^2, traced on a grid of GRID_LINES by
    GRID_LINES points over the box.

    The border of the box counts as outside of the patch, since the contact surface may end there.
    """
    x, s = (np.linspace(low, high, GRID_LINES, dtype=np.float64) for low, high in square.box)
    values = square.grid(x, s)
    top = float(values.max())
    values[[0, -1]] = np.minimum(values[[0, -1]], -1e-9 * top)
    values[:, [0, -1]] = np.minimum(values[:, [0, -1]], -1e-9 * top)
    lines = contourpy.contour_generator(x, s, values).lines(0.0)
    outlines = [np.asarray(line, dtype=np.float64) for line in lines]
    area = abs(sum(_enclosed(line) for line in outlines))
    a, b = np.ptp(np.concatenate(outlines), axis=0) / 2
    row, column = np.unravel_index(np.argmax(values), values.shape)
    return PatchShape(
        outlines=outlines,
        area=float(area),
        a=float(a),
        b=float(b),
        max_pressure=float(np.sqrt(top)),
        top=(float(x[column]), float(s[row])),
    )


def _enclosed(line: Array) -> float:
    """Signed area, mm2, enclosed by a closed curve (k, 2), mm: positive for a curve that turns from
    x to s. The curves of holes turn the other way than outer curves and have the other sign.
    """
    x, s = line.T
    return float(0.5 * np.sum(x[:-1] * s[1:] - x[1:] * s[:-1]))
