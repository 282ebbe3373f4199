"""From the axes of a file to those of the project: what keys and format say, else the shape.

A rail is seen from above: it is highest in its middle. Its gauge side is the one that reaches down
to the depth of the gauge, else the worn one. A wheel has its flange beyond the tread, and the tape
circle lies at a given distance from the flange back.
"""

from dataclasses import dataclass, replace

import numpy as np

from railhead.geometry.measured import ordering, standards
from railhead.geometry.measured.formats import MM_OF_UNIT, Table
from railhead.theory.array_types import Array

WIDTHS = 1.0, 1000.0  # mm of any profile; and where no unit is stated ...
LIKELY = 15.0, 160.0  # ... in mm and m, and in inches:
LIKELY_IN_INCHES = {"rail": (25.0, 100.0), "wheel": (60.0, 150.0)}
STEP = 0.25  # mm between the places at which shapes are looked at
HIGH = 1.3  # times its width: a head that is higher has its columns exchanged
NARROW, LEAST_FALL = 25.0, 1.0  # mm: a narrower rail may be a groove; and a flat one may be either
SECTION, END = 100.0, 20.0  # mm: a rail deeper than that has a foot; its ends are so high
GAUGE_DEPTH = 14.0  # mm below its top: the side of a head that is drawn so far is the gauge side
SYMMETRIC = 0.05  # mm by which both sides may differ where their sides do not matter
FLANGE_HEIGHT, FLANGE_WIDTH = 10.0, 10.0  # mm, at least: over the tread, and at half its height
FLANGE_WIDEST = 30.0  # mm from the flange back to the tip, at most
NEAR_TOP, PLATEAU = 2.0, 0.02  # mm: an origin on the crown is kept; the crown is so flat
BESIDE = 1.0  # mm from the middle of the top: an origin so far from it is worth a word
TAPE_CIRCLE, TAPE_RANGE = 70.0, 20.0  # mm from the flange back, and how far from there z = 0 counts
TAPE_CIRCLES = 30.0, 120.0  # mm from the flange back: tape circles that are allowed
NEAR_ZERO = 0.05  # mm: the usual tape circle is that of z = 0
UPRIGHT, VERTICAL = 0.18, 0.02  # slopes dy/dz of a flange back, at most
LEAST_FACE = 1.0  # mm: height of a flange back, at least


@dataclass(frozen=True, kw_only=True)
class Orientation:
    """What the user says of a file; 'auto' and None leave it to the file and its shape.
    unit: unit of the file, 'mm', 'm' or 'inch'.
    mirror: whether left and right are exchanged, 'on' or 'off'.
    flip: whether up and down are exchanged, 'on' or 'off'.
    origin: 'file': the file's origin is the crown centre or the tape circle; 'flange_back': its y
        begins at the flange back.
    tape_circle: distance of a wheel's tape circle from its flange back, mm.
    shift: (y, z) added at last, mm.
    """

    unit: str = "auto"
    mirror: str = "auto"
    flip: str = "auto"
    origin: str = "auto"
    tape_circle: float | None = None
    shift: tuple[float, float] = (0.0, 0.0)


FROM_SHAPE = Orientation()
SIDES = {1.0: "as in the file", -1.0: "mirrored", 0.0: "open"}
"""Words of the sign by which a file's y is multiplied; 0 where nothing tells the field side."""


@dataclass(frozen=True, kw_only=True)
class Oriented:
    """Points in the axes of profiles, and how they came there.
    points: (n, 2) of (y, z), mm, in their order along the curve; y to the field side, z up for a
        rail and outwards for a wheel.
    signs: (2,) 1 or -1 by which the file's y and z were multiplied.
    move: (2,) displacement in mm that was added after that.
    sides: 'as in the file', 'mirrored', or 'open' where nothing tells the field side.
    unlike: difference in height, mm, of the profile and its mirror image about y = 0 where the
        sides are open, else 0.
    open_by: distance in mm of a rail's origin from the middle of its top where nothing says that
        it is the crown centre, else 0.
    tape_circle: distance of a wheel's tape circle from its flange back, mm; 0 for a rail.
    done: remarks on what was done, and why.
    """

    points: Array
    signs: Array
    move: Array
    sides: str
    unlike: float
    open_by: float
    tape_circle: float
    done: tuple[str, ...]

    def of_file(self, points: Array) -> Array:
        """Coordinates (n, 2) in the axes of profiles of points (n, 2) in those of the file, mm."""
        return np.asarray(points * self.signs + self.move)

    def in_file(self, point: Array) -> list[float]:
        """Coordinates in the axes of the file, mm, of a point (2,) in those of profiles."""
        return [round(float(each), 9) + 0.0 for each in (point - self.move) * self.signs]


def oriented(points: Array, body: str, table: Table, given: Orientation) -> Oriented:
    """Points (n, 2) of a 'rail' or 'wheel', mm, in their order along the curve, brought to the axes
    of profiles and in their order there.
    table: what the file says of its axes; given: what the user says.
    Raises PointError, with a place in the axes of `points`, where up and down of a rail, or the
    tape circle of a wheel, stay open.
    """
    width, height = np.ptp(points, axis=0)
    if HIGH * width < height and (body == "wheel" or height < SECTION):
        raise ordering.PointError("is higher than it is wide; give y before z", points[0])
    turn = _rail_signs if body == "rail" else _wheel_signs
    side, up, done = turn(points, table, given)
    signs = np.array([side or 1.0, up])
    turned = points * signs
    if up < 0:
        done.append("turned upside down")
    tape = open_by = 0.0
    if body == "rail":
        move, open_by, how = _to_crown(turned, table, given)
    else:
        move, tape, how = _to_tape_circle(points, turned, table, given)
    done += [how] * bool(how)
    if any(given.shift):
        done.append(f"moved by {given.shift[0]:g}, {given.shift[1]:g} mm as given")
        move = move + given.shift
    turned = ordering.in_order(turned + move)
    return Oriented(
        points=turned,
        signs=signs,
        move=move,
        sides=SIDES[side],
        unlike=0.0 if side else _unlike(turned),
        open_by=open_by,
        tape_circle=tape,
        done=tuple(done),
    )


def _even(way: Array) -> Array:
    """Points (m, 2) on the straight lines through points (n, 2), mm, in their order: the highest
    one of each 0.25 mm (STEP) of y, from left to right.
    """
    way = ordering.resampled(way, STEP / 4)
    cells = np.floor(way[:, 0] / STEP)
    order = np.lexsort((way[:, 1], cells))
    return way[order[np.diff(cells[order], append=np.inf) > 0]]


def _sign(key: str, said: int | None) -> float:
    """Sign of an axis: by the user's key ('on' is -1), else as the format says (1, -1 or None),
    else 0.
    """
    return {"on": -1.0, "off": 1.0}.get(key, float(said or 0))


def _rail_signs(way: Array, table: Table, given: Orientation) -> tuple[float, float, list[str]]:
    """Signs of y (0 where nothing tells the field side) and z that turn the points (n, 2) of a
    rail, mm, into the axes of profiles, and why. Raises PointError where the shape does not tell
    which way is up.
    """
    up = _sign(given.flip, table.outward)
    if not up:
        if np.ptp(way[:, 1]) < SECTION and not table.body and flanged_way(way) is not None:
            text = "has the flange of a wheel; give it as a wheel's, or its profile_flip"
            raise ordering.PointError(text, way[0])
        bulge, narrow = _bulge(way), np.ptp(way[:, 0]) < NARROW
        up = 1.0 if bulge > -LEAST_FALL else -1.0
        _refuse_hollow(way, bulge < -SYMMETRIC and (up > 0 or narrow))
    side = _sign(given.mirror, table.field)
    if side:
        return side, up, []
    side, why = _field_side(ordering.head(ordering.in_order(way * [1.0, up])))
    return side, up, [f"{'' if side < 0 else 'sides '}{SIDES[side or 1.0]} ({why})"]


def _bulge(way: Array) -> float:
    """Height, mm, that is positive where points (n, 2), mm, in their order, bulge upwards: their
    median height over the mean of both ends. Of a whole section that closes, by how much its lower
    end is wider than the upper one, as a foot is.
    """
    y, z = way.T
    if np.ptp(z) > SECTION and ordering.closes(way):
        return float(np.ptp(y[z < z.min() + END]) - np.ptp(y[z > z.max() - END]))
    return float(np.median(ordering.resampled(way, STEP)[:, 1]) - z[[0, -1]].mean())


def _refuse_hollow(points: Array, hollow: bool) -> None:
    """Raises PointError, at the lowest of points (n, 2), where they are hollow as the file stands,
    so that it may count z downwards.
    """
    if hollow:
        text = "is hollow, or its z counts downwards; give its profile_flip: off if it is hollow"
        raise ordering.PointError(text, points[np.argmin(points[:, 1])])


def _field_side(head: Array) -> tuple[float, str]:
    """Sign of the y that points to the field side of a head (n, 2), mm, upright, and why; 0 where
    nothing tells. The gauge side is the only one that is drawn: down to the depth of the gauge,
    the other one to less than half of it. Else it is the one that the nearest standard tells.
    """
    top = int(np.argmax(head[:, 1]))
    falls = [float(head[top, 1] - side.min()) for side in (head[: top + 1, 1], head[top:, 1])]
    if max(falls) > GAUGE_DEPTH and min(falls) < GAUGE_DEPTH / 2:
        side = 1.0 if falls[0] > falls[1] else -1.0
        return side, "only the gauge side reaches 14 mm below the top"
    return standards.field_side(ordering.resampled(head, standards.STEP))


def _unlike(points: Array) -> float:
    """Difference in height, mm, that 95 % of points (n, 2) and their mirror image about y = 0 are
    within, where both have some and are no steeper than 45 deg; 0 where there are none.
    """
    y, z = _even(points).T
    mirrored = np.interp(-y, y, z, left=np.nan, right=np.nan)
    flat = np.abs(np.gradient(z, y)) < 1
    off = np.abs(mirrored - z)[flat & np.isfinite(mirrored)]
    return float(np.quantile(off, 0.95)) if len(off) else 0.0


def _to_crown(turned: Array, table: Table, given: Orientation) -> tuple[Array, float, str]:
    """Displacement (2,) in mm that brings the crown centre of a rail's upright points (n, 2) to
    (0, 0), how far in mm it may be wrong across, and a remark.
    The crown centre is the origin where user or format define it, or where it lies within 2 mm
    (NEAR_TOP) of the top; else the middle of what is within 0.02 mm (PLATEAU) of the top. An origin
    that nothing defines may be wrong where it is more than 1 mm (BESIDE) beside that middle.
    """
    y, z = turned.T
    middle = float(z[np.argmin(np.abs(y))])
    hollow = _bulge(turned) < 0 and abs(middle) < NEAR_TOP
    on_crown = y.min() <= 0 <= y.max() and (middle > z.max() - NEAR_TOP or hollow)
    across, height = _even(turned).T
    crown = across[height > height.max() - PLATEAU]
    top = np.array([(crown[0] + crown[-1]) / 2, z.max()])
    defined = given.origin == "file" or table.placed
    if not (defined or on_crown):
        return -top, 0.0, f"moved by {-top[0]:.2f}, {-top[1]:.2f} mm to the crown centre"
    if hollow or np.abs(top).max() < BESIDE:
        return np.zeros(2), 0.0, ""
    sure = defined or any(given.shift) or abs(top[0]) <= BESIDE
    text = f"its crown centre is the file's origin, its top is at y = {top[0]:.1f}, "
    return np.zeros(2), 0.0 if sure else float(abs(top[0])), f"{text}z = {top[1]:.1f}"


def _wheel_signs(way: Array, table: Table, given: Orientation) -> tuple[float, float, list[str]]:
    """Signs as of `_rail_signs` for the points (n, 2) of a wheel, and why: by its flange, which
    stands out at the left; without one as the format says. Raises PointError where the shape does
    not tell which way is outwards.
    """
    flanged = flanged_way(way, given)
    if flanged is not None:
        side, up = flanged
        return side, up, [f"{SIDES[side]} (by its flange)"] * (side < 0)
    if given.flip == "auto" and not table.outward:
        _refuse_hollow(way, _bulge(way) < -SYMMETRIC)
    up = _sign(given.flip, table.outward) or 1.0
    return _sign(given.mirror, table.field), up, ["without a flange"]


def flanged_way(way: Array, given: Orientation = FROM_SHAPE) -> tuple[float, float] | None:
    """Signs of y and z with which points (n, 2), mm, in their order, have a flange as of `flange`;
    None where none do. Of several those that change least. given: what the user says of mirror and
    flip.
    """
    mirror, flip = _sign(given.mirror, None), _sign(given.flip, None)
    ways = ((mirror or side, flip or up) for up in (1.0, -1.0) for side in (1.0, -1.0))
    return next((signs for signs in ways if flange(_even(way * signs))), None)


def flange(even: Array) -> tuple[float, float] | None:
    """y of the tip of a flange at the left of a profile, and y of its right flank at half its
    height, mm; None where there is none.
    even: (m, 2) outer side of the profile from left to right, mm, as of `_even`, z outwards.
    A flange is the highest part, in the left half. It stands 10 mm (FLANGE_HEIGHT) out of the
    median height, is 10 mm (FLANGE_WIDTH) wide at half of that, and its right flank is steeper than
    45 deg from three quarters to a quarter of it.
    """
    y, z = even.T
    tip, tread = int(np.argmax(z)), float(np.median(z))
    height = z[tip] - tread

    def down(share: float) -> int:
        """Index of the first place to the right of the tip that is lower than a share of the height
        over the tread; the last one where none is.
        """
        low = np.flatnonzero(z[tip:] < tread + share * height)
        return tip + int(low[0]) if len(low) else len(y) - 1

    behind = np.flatnonzero(z[:tip] < tread + height / 2)
    wide = y[down(0.5)] - y[max(behind, default=-1) + 1]
    flank = y[down(0.25)] - y[down(0.75)]
    stands = height > FLANGE_HEIGHT and wide > FLANGE_WIDTH and y[tip] < y.mean()
    return (float(y[tip]), float(y[down(0.5)])) if stands and flank < height / 2 else None


def _to_tape_circle(
    points: Array, turned: Array, table: Table, given: Orientation
) -> tuple[Array, float, str]:
    """Displacement (2,) in mm that brings the tape circle of a wheel to (0, 0), its distance from
    the flange back in mm, and a remark. Heights of a format that defines its origin stay.
    points, turned: (n, 2) in the axes of the file, and with y to the field side and z outwards.
    Without a flange the origin stays. An origin on the tread, 30 to 120 mm (TAPE_CIRCLES) from the
    flange back, is the tape circle; one behind the flange's tip is the flange back, else that is
    the upright face of the flange. The tape circle's distance is the user's or the header's, else
    where z = 0, else 70 mm (TAPE_CIRCLE).
    Raises PointError, in the axes of the file, where nothing tells, and for a header's distance
    that is not allowed.
    """
    even = _even(turned)
    found, tape = flange(even), given.tape_circle or table.tape_circle
    low, high = TAPE_CIRCLES
    if tape and not low <= tape <= high:
        text = f"has its tape circle {tape:g} mm from the flange back by its header, {low:g} to "
        raise ordering.PointError(f"{text}{high:g} are allowed; give its tape_circle", points[0])
    if given.origin == "file" or (given.origin == "auto" and not found):
        return np.zeros(2), tape or TAPE_CIRCLE, ""
    back = 0.0
    if found and given.origin == "auto":
        tip, root = found
        upright = _flange_face(turned, tip, VERTICAL)
        shown, unsaid = -(upright or -TAPE_CIRCLE), not (upright and given.tape_circle)
        if root < 0 < even[-1, 0] and low <= shown <= high and unsaid:
            level = float(np.interp(0.0, *even.T))
            text = f"its tread is at z = {level:.2f} mm on the tape circle, its origin"
            return np.zeros(2), tape or shown, text * (abs(level) > NEAR_ZERO)
        defined, face = 0 < tip < FLANGE_WIDEST, _flange_face(turned, tip, UPRIGHT)
        if face is None and not defined:
            text = "begins in its flange, so that nothing tells where the tape circle is; give "
            text += "points from the flange back on, or its profile_origin"
            raise ordering.PointError(text, points[np.argmin(turned[:, 0])])
        back = 0.0 if face is None or (defined and table.placed) else face
    zero = None if tape else _distance_of_zero(even, back)
    distance = tape or zero or TAPE_CIRCLE
    level = 0.0 if table.placed else float(np.interp(back + distance, *even.T))
    move = -np.array([back + distance, level])
    text = f"moved by {move[0]:.2f}, {move[1]:.2f} mm to the tape circle, {distance:.2f} mm"
    text += f" from the flange back{' by its z = 0' * bool(zero)}"
    return move, distance, text


def _flange_face(turned: Array, tip: float, slope: float) -> float | None:
    """y in mm of the face behind the flange's tip, of points (n, 2) turned as those of `flange`;
    None where the file shows less than 1 mm (LEAST_FACE) of it.
    tip: y of the flange's tip, mm. slope: dy/dz of the face, at most.
    """
    y, z = turned.T
    upright = (np.abs(np.diff(y)) < slope * np.abs(np.diff(z))) & (y[1:] < tip)
    height = float(np.abs(np.diff(z))[upright].sum())
    return float(y[:-1][upright].min()) if height > LEAST_FACE else None


def _distance_of_zero(even: Array, back: float) -> float | None:
    """Distance in mm from the flange back at y = back (mm) to the only place within 20 mm
    (TAPE_RANGE) of the usual tape circle at which the tread's height changes its sign. None where
    there is no such place, and where the tread is not higher at the usual one: wear lowers it.
    even: (m, 2) outer side of the profile, mm, z outwards.
    """
    y, z = even[np.abs(even[:, 0] - back - TAPE_CIRCLE) < TAPE_RANGE].T
    at = np.flatnonzero(z[1:] * z[:-1] < 0)
    if len(at) != 1 or np.interp(back + TAPE_CIRCLE, y, z) < NEAR_ZERO:
        return None
    k = at[0]
    return float(y[k] - z[k] * (y[k + 1] - y[k]) / (z[k + 1] - z[k])) - back


def in_mm(table: Table, body: str, given: str) -> tuple[Table, str]:
    """The table of a 'rail' or 'wheel' with its points and its resolution in mm, and a remark on
    the unit of the file and its source.
    given: the unit, or 'auto' for the file's unit, else the one in which its width is usual.
    Raises PointError, at the outermost point in the axes of the table, where no unit, or not the
    given or stated one, fits the width.
    """
    stated = table.unit if given == "auto" else given
    likely = {"mm": LIKELY, "inch": LIKELY_IN_INCHES[body], "m": LIKELY}
    widths = {stated: WIDTHS} if stated else likely
    y = table.points[:, 0]
    width = float(np.ptp(y))
    fits = (unit for unit, (low, high) in widths.items() if low <= width * MM_OF_UNIT[unit] <= high)
    unit = next(fits, None)
    if unit is None:
        text = f"is {width:.4g} wide, which is no usual width of a {body} in {', '.join(widths)}; "
        text += "give its profile_unit, or name it in a header, y before z"
        raise ordering.PointError(text, table.points[np.argmax(np.abs(y - np.median(y)))])
    source = "as given" if given != "auto" else "as the file says" if stated else "by its width"
    mm = MM_OF_UNIT[unit]
    scaled = replace(table, points=mm * table.points, resolution=mm * table.resolution)
    return scaled, f"in {unit} ({source})"
