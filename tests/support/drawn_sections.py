"""Section files of artificial crossings, drawn from formulae.

The formulae and the truths beside them come from the reference of the project's crossings (own
boundary elements and closed forms that share no code with the program), its cases 1 to 7.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Array = np.ndarray
STEP = 0.25  # mm between points


def top(q: Array, radius: float) -> Array:
    """Depth (n,) below the top of a circle, mm, at distances q (n,) from its middle."""
    return radius - np.sqrt(radius**2 - q**2)


def head(
    y: Array, radius: float, half_width: float, height: float, middle: float, flank: float = 4.0
) -> Array:
    """Heights (n,) of an arc with flanks of a slope, mm."""
    q = np.abs(y - middle)
    return height - top(np.minimum(q, half_width), radius) - flank * np.maximum(q - half_width, 0)


def ramp(x: float, start: float, end: float, slope: float, height: float) -> float:
    """Height, mm, of a ramp up to `start` (its height there), level from `end` on."""
    if x <= start:
        return height + slope * (x - start)
    x = min(x, end) - start
    return height + slope * x - slope * x**2 / 2 / (end - start)


def nose(x: float) -> Array:
    """Points (n, 2) of the nose of cases 5 and 6 at a place, mm, about its own middle."""
    width = 8 + 22 * x / 400
    y = np.arange(-np.ceil((width + 6) / STEP), np.ceil((width + 6) / STEP) + 1) * STEP
    return np.column_stack([y, head(y, 80, width, ramp(x, 250, 350, 0.04, -2), 0.0)])


def moved(points: Array, y: float) -> Array:
    """Points (n, 2) moved across, mm."""
    return points + [y, 0.0]


def wing(x: float) -> Array:
    """Points (n, 2) of the wing of case 6 at a place, mm."""
    y = 25 + x / 10 + np.arange(-26, 26 + STEP / 2, STEP)
    return np.column_stack([y, head(y, 300, 20, -0.4 - 0.01 * x, 25 + x / 10)])


def blade(x: float) -> Array:
    """Points (n, 2) of the blade of case 7 at a place, mm."""
    y = -22.45 + np.arange(-14, 14 + 0.1, 0.2)
    return np.column_stack([y, head(y, 13, 10, -4 + x / 100, -22.45)])


def both(x: float) -> Array:
    """Points (n, 2) of nose and wing of case 6 in one line over a floor, mm."""
    y = np.arange(-60, 95 + STEP / 2, STEP)
    heights = [np.full_like(y, -30.0), head(y, 300, 20, -0.4 - 0.01 * x, 25 + x / 10)]
    if x >= 0:
        heights.append(head(y, 80, 8 + 22 * x / 400, ramp(x, 250, 350, 0.04, -2), -20.0))
    return np.column_stack([y, np.max(heights, axis=0)])


def arcs(x: float) -> Array:
    """Points (n, 2) of an arc of radius 300 mm on a hump of radius 5000 mm (case 2)."""
    y = np.arange(-25, 25 + STEP / 2, STEP)
    return np.column_stack([y, -top(y, 300.0) - top(np.array([x]), 5000.0)])


def write(
    folder: Path, places: Any, points: Callable[[float], Array], digits: int = 8, slcs: bool = False
) -> str:
    """Path of a table of sections at places (n,), mm, drawn by a function, with so many digits.
    slcs: as a file of CONTACT, z downwards.
    """
    folder.mkdir(parents=True, exist_ok=True)
    names = []
    for x in places:
        drawn = points(float(x)) * [1, -1 if slcs else 1]
        names.append(f"{x:g}.txt")
        np.savetxt(folder / names[-1], drawn, fmt=f"%.{digits}f")
    lines = [f"{x:g},{name}" for x, name in zip(places, names, strict=True)]
    if slcs:
        lines = [f"{x:g} '{name}'" for x, name in zip(places, names, strict=True)]
        head_lines = ["% drawn", "0.0 1.0", f"{len(names)}", "0 0 0", "1"]
        (folder / "rail.slcs").write_text("\n".join([*head_lines, *lines]))
        return str(folder / "rail.slcs")
    (folder / "rail.csv").write_text("\n".join(["# drawn", "x_mm,file", *lines]))
    return str(folder / "rail.csv")


def root_wheel(path: Path) -> str:
    """Path of the wheel of case 7: cone 1:40 for y >= -18, then a concave root of radius 25 mm
    tangent to it, from 70 degrees on a straight flange.
    """
    begin, end = np.arctan(1 / 40), np.radians(70)
    angles = np.linspace(begin, end, 400)
    middle = np.array([-18 + 25 * np.sin(begin), 18 / 40 + 25 * np.cos(begin)])
    root = middle - 25 * np.column_stack([np.sin(angles), np.cos(angles)])
    flange = root[-1] + np.outer(np.linspace(0, 10, 60)[1:], [-np.cos(end), np.sin(end)])
    tread = np.linspace(-18, 60, 313)[1:]
    points = np.vstack([flange[::-1], root[::-1], np.column_stack([tread, -tread / 40])])
    np.savetxt(path, points, "%.9f", ",", header="y_mm,z_mm", comments="")
    return str(path)


def stock(x: float) -> Array:
    """Points (n, 2) of the stock rail of case 7, the same at every place, mm."""
    y = 18 + np.arange(-30, 30 + STEP / 2, STEP)
    return np.column_stack([y, head(y, 300, 24, 0.0, 18.0)])
