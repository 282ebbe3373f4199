"""From the axes of an instrument to those of profiles: unit, up and down, sides, origin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.meshing import layout, scans, wear
from railhead.meshing.dialects import Table
from railhead.meshing.smoothing import PointError

Array = NDArray[np.float64]
UNITS = {"mm": 1.0, "m": 1000.0, "inch": 25.4, "cm": 10.0, "um": 1e-3, "ft": 304.8}
WIDTHS = 7.5, 300.0  # mm of any profile, ...
USUAL = {"rail": (25.0, 100.0), "wheel": (60.0, 150.0)}  # ... and of one whose unit nobody says
GUESSED = ("mm", "inch", "m")  # units that are told apart by these
FALLS = 4.0  # mm that a head of 60 mm and more falls at its sides, at least
FLANGE, PROTRUDES = 10.0, 1.5  # mm above the tread, and times what lies below it, at least
FACES = 3.0  # mm from the outermost points: what lies there may be a face of the rim
EVENLY = 500  # places across at which heights are compared
TIP, NEAR_TIP = -55.0, 8.0  # mm, y of the flange's tip, give or take
BACK = -70.0  # mm, y of the flange back
UPRIGHT = 2.5  # mm up in the first one across: S1002 rises by 6.3 from its back, 1.6 from 2 mm on
SIDES = (17.0, 30.0)  # mm below the top: the faces whose lean is that of the head
TAPER, CLEAR = 0.125, 0.1  # a head gets wider by 1:10 where they are not worn; between their slopes
LEANS = 0.01  # slope: less says nothing of the side
AT_END = 1.0  # mm from the first point: what is highest there may go on
NEAR_TOP, NEAR_ZERO = 2.0, 5.0  # mm: the origin lies where profiles have theirs


@dataclass(frozen=True)
class Choices:
    """What a person says of a file; 'auto' is found out. unit: 'mm', 'm', 'inch'; mirror (left and
    right), flip (up and down): 'on', 'off'; origin: 'file' keeps the file's own."""

    unit: str = "auto"
    mirror: str = "auto"
    flip: str = "auto"
    origin: str = "auto"


def turned(table: Table, body: str, choices: Choices) -> tuple[Array, list[str]]:
    """Points (n, 2) in the axes of profiles, mm, and what was done to them, in words.

    Raises PointError, of a point in the axes of the table, as `in_mm`, `scans.in_order`,
    `scans.check_digits`, `scans.check_wild`, `layout.check_head` and `_origin`.
    """
    points, unit = in_mm(table, body, choices.unit)
    try:
        scans.check_digits(points)
        scans.check_wild(scans.in_order(points))
    except PointError as error:
        raise _listed(error, points, table) from None
    if body == "rail":
        layout.check_head(points, table.points)
    said = [unit]
    upside, why = _upside_down(points, body)
    if (choices.flip == "on") if choices.flip != "auto" else upside:
        points = points * [1, -1]
        said.append("turned upside down" + _why(choices.flip, why))
    swapped, why = _mirrored(part(points, body), body)
    if (choices.mirror == "on") if choices.mirror != "auto" else swapped:
        points = points * [-1, 1]
        said.append("mirrored" + _why(choices.mirror, why))
    elif choices.mirror == "auto" and not why:
        side = "gauge side" if body == "rail" else "flange"
        said.append(f"sides as in the file: it shows no {side}")
    if choices.origin == "auto":
        try:
            move = _origin(part(points, body), body)
        except PointError as error:
            raise _listed(error, points, table) from None
        if move.any():
            points = points + move
            place = "crown centre" if body == "rail" else "tape circle"
            warning = ""
            if body == "wheel" and move[0] and flange(points) is None:
                warning, place = "WARNING: ", "middle of its width, as it shows no flange"
            said.append(f"{warning}moved by {move[0]:.2f}, {move[1]:.2f} mm to the {place}")
    return points, said


def part(points: Array, body: str) -> Array:
    """Of points (n, 2) in the axes of profiles, mm, those of the profile (m, 2)."""
    return scans.head(points) if body == "rail" else points


def in_mm(table: Table, body: str, choice: str) -> tuple[Array, str]:
    """Points (n, 2) of a 'rail' or 'wheel' in mm, and of which unit they were and why; choice: as
    `Choices.unit`.

    Raises PointError as `layout.check_across`, and of the outermost point in the axes of the table
    where no unit, or not the one that is given, fits the width.
    """
    layout.check_across(table.points)
    unit = choice if choice != "auto" else table.unit or _unit(table.points, body)
    points = UNITS[unit] * table.points
    width, (least, most) = float(np.ptp(points[:, 0])), WIDTHS
    if not least < width <= most:
        raise PointError(f"is {width:.4g} mm wide in {unit}; give its profile_unit, in which it is "
                         f"{least:g} to {most:g} mm wide", _outermost(table.points))  # fmt: skip
    if choice == "auto":
        usual = USUAL[body][0] <= width <= USUAL[body][1]
        warning = "" if usual else f"; WARNING: {width:.3g} mm is no usual width of a {body}"
        why = "as the file says" if table.unit else "by its width"
        return points, f"in {unit} ({why}){warning}"
    overruled = table.unit not in ("", unit)
    return points, f"in {unit}" + (f" as given (the file says {table.unit})" if overruled else "")


def _listed(error: PointError, points: Array, table: Table) -> PointError:
    """In the axes of the table an error in those of points (n, 2)."""
    nearest = np.argmin(np.linalg.norm(points - error.place, axis=1))
    return PointError(str(error), table.points[nearest])


def _why(choice: str, found: str) -> str:
    return "" if choice != "auto" or not found else f" ({found})"


def _unit(points: Array, body: str) -> str:
    """By the width; a crown in cm is no whole head in inches, which falls at its sides."""
    width, (least, most) = float(np.ptp(points[:, 0])), USUAL[body]
    y, z = points[np.argsort(points[:, 0], kind="stable")].T
    bulge = float(np.abs(z - np.interp(y, y[[0, -1]], z[[0, -1]])).max())
    for unit in GUESSED:
        wide, fitting = least <= width * UNITS[unit] <= most, bulge * UNITS[unit] >= FALLS
        if wide and (unit == "mm" or body == "wheel" or fitting):
            return unit
    text = (
        f"is {width:g} wide and {bulge:.2g} high, no {body} of {least:g} to {most:g} mm in "
        f"{', '.join(GUESSED)}; give its profile_unit, or name it in a header"
    )
    raise PointError(text, _outermost(points))


def _outermost(points: Array) -> Array:
    return np.asarray(points[np.argmax(np.abs(points[:, 0] - np.median(points[:, 0])))])


def flange(points: Array) -> tuple[float, float] | None:
    """y of the flange's tip and the side of the tread that it is on, +1 or -1; None without one."""
    y, z = points[np.argsort(points[:, 0], kind="stable")].T
    inner = np.interp(np.linspace(y[0] + FACES, y[-1] - FACES, EVENLY), y, z)
    tread = float(np.median(inner))  # by width, as points may be dense at the flange
    away, above, below = z - tread, inner.max() - tread, tread - inner.min()
    if max(above, below) < max(FLANGE, PROTRUDES * min(above, below)):
        return None
    tip = int(np.argmax(away) if above > below else np.argmin(away))
    return float(y[tip]), 1.0 if above > below else -1.0


def _upside_down(points: Array, body: str) -> tuple[bool, str]:
    """A rail is open below, or narrow above; a wheel's flange makes it larger."""
    if body == "wheel":
        found = flange(points)
        return (found[1] < 0, "by its flange") if found else (False, "")
    way = scans.in_order(points)
    even = scans.evenly(way, wear.STEP)
    if not scans.closes(way):  # a head may have its underside
        return bool(way[[0, -1], 1].mean() > even[:, 1].mean()), "by its ends"
    y, z = even.T
    return bool(np.polyfit(y - y.mean(), z, 2)[0] > 0), "by its crown"


def _mirrored(points: Array, body: str) -> tuple[bool, str]:
    """Whether the gauge side lies at y > 0, and by what; '' where nothing tells."""
    if body == "wheel":
        tip = flange(points)
        if tip is None:
            return False, ""
        return bool(tip[0] > (points[:, 0].min() + points[:, 0].max()) / 2), "by its flange"
    right, why = _by_faces(points)
    if why:
        return right, why
    return wear.gauge_side(scans.evenly(scans.in_order(points), wear.STEP))


def _by_faces(points: Array) -> tuple[bool, str]:
    """As `_mirrored` of a rail, by the faces below its head."""
    found = np.array(list(_widths(points))).reshape(-1, 3)
    depth, left, right = found[(found[:, 0] >= SIDES[0]) & (found[:, 0] <= SIDES[1])].T
    if len(depth) < 10:
        return False, ""
    steps = np.diff(depth)  # medians, as wear may reach down to the faces
    out, away = (float(np.median(np.diff(y) / steps)) for y in (left, right))
    if away - out > TAPER:
        clear = abs(away + out) > CLEAR
        return (away + out > 0, "by its worn face") if clear else (False, "")
    lean = -(out + away) / 2
    return (lean > 0, wear.leaning(lean)) if abs(lean) > LEANS else (False, "")


def _widths(points: Array) -> Iterator[tuple[float, float, float]]:
    """Depth below the top and y of the left and right face there, mm, as far as both reach."""
    top = int(np.argmax(points[:, 1]))
    y, down = points[:, 0], points[top, 1] - points[:, 1]
    left, right = y < y[top], y > y[top]
    if not (left.any() and right.any()):
        return
    for depth in np.arange(0.5, min(down[left].max(), down[right].max(), SIDES[1]), 0.5):
        yield float(depth), _face(y, down, left, depth), _face(y, down, right, depth)


def _face(y: Array, down: Array, side: NDArray[np.bool_], depth: float) -> float:
    order = np.argsort(down[side])
    return float(np.interp(depth, down[side][order], y[side][order]))


def _origin(points: Array, body: str) -> Array:
    """What brings the crown centre or the tape circle to the origin, where the file has another.
    Raises PointError of the first point of a wheel that begins in its flange."""
    y, z = points.T

    def height(at: float) -> float:
        return float(z[np.argmin(np.abs(y - at))])

    move = np.zeros(2)
    inside = y.min() < 0 < y.max()
    if body == "rail":
        if not inside or height(0.0) < z.max() - NEAR_TOP:
            widths = list(_widths(points))
            move[0] = -sum(widths[-1][1:]) / 2 if widths else -y[np.argmax(z)]
    elif tip := flange(points):
        upright = np.ptp(z[y < y.min() + 1.0]) > UPRIGHT  # as the flange back and the round at it
        behind = upright and y.min() < tip[0] - NEAR_TIP
        if abs(tip[0] - TIP) > NEAR_TIP:
            if not behind and tip[0] < y.min() + AT_END:
                text = "begins in its flange, so that nothing tells where the tape circle is; give "
                text += "points from the flange back on, or its profile_origin"
                raise PointError(text, points[np.argmin(y)])
            move[0] = BACK - y.min() if behind else TIP - tip[0]
    elif not inside:
        move[0] = -(y.min() + y.max()) / 2
    level = height(-move[0])
    if abs(level) > NEAR_ZERO:
        move[1] = -level
    return move
