"""Rolling radii of a wheelset over its lateral shift, and the equivalent conicity (EN 15302)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from railhead.geometry.placement import PlacementError
from railhead.geometry.wheelset import Placed, WheelsetOnTrack
from railhead.theory.array_types import Array, Index

STEP = 0.5  # mm between the first shifts
AREA = 4e-6  # mm2, between the radii and the straight lines that replace them
SHARE = 5e-3  # of the rolling radius difference that straight lines may be off the radii
STEEP = 1e3  # mm/mm: a radius that changes more by the shift jumps
ROUNDING = 1e-12  # mm of shift
ANGLES = 2000  # points of the integral over half a wavelength


@dataclass(frozen=True, eq=False)
class RollingRadii:
    """Rolling radii of both wheels at rising lateral shifts, straight in between.
    shifts: (n,) lateral shift to the right, mm.
    rolls: (n,) roll, rad.
    right, left: (n,) rolling radius of that wheel at its first contact, mm.
    """

    shifts: Array
    rolls: Array
    right: Array
    left: Array

    @property
    def steep(self) -> Index:
        """Numbers of the intervals within which a contact jumps."""
        change = np.maximum(abs(np.diff(self.right)), abs(np.diff(self.left)))
        return np.flatnonzero(change > STEEP * np.diff(self.shifts))

    @property
    def differences(self) -> tuple[Array, Array]:
        """Lateral shifts (m,), and rolling radius of the right wheel less that of the left one
        (m,), mm; NaN in both between the two sides of a jump.
        """
        at, difference = self.steep + 1, self.right - self.left
        return np.insert(self.shifts, at, np.nan), np.insert(difference, at, np.nan)

    @property
    def jumps(self) -> list[float]:
        """Shifts at which a contact jumps, mm."""
        steep = self.steep
        first = steep[np.diff(steep, prepend=-2) > 1]
        return [float(each) for each in self.shifts[first]]

    @cached_property
    def conicities(self) -> dict[float, float | None]:
        """Equivalent conicity by amplitude, mm, from 0.5 in steps of 0.1 as far as the shifts
        reach; None where there is none.
        """
        found: dict[float, float | None] = {}
        for tenths in range(5, math.floor(5 * (self.shifts[-1] - self.shifts[0]) + 1e-6) + 1):
            value = equivalent_conicity(tenths / 10, self.shifts, self.right, self.left)
            found[tenths / 10] = None if math.isnan(value) else value
        return found

    @property
    def nonlinearity(self) -> float | None:
        """Nonlinearity parameter of EN 15302:2021, 1/mm: half of what the equivalent conicity at 4
        mm is larger than at 2 mm. None where one of both is missing.
        """
        two, four = (self.conicities.get(amplitude) for amplitude in (2.0, 4.0))
        return None if two is None or four is None else (four - two) / 2


def equivalent_conicity(amplitude: float, shifts: Array, right: Array, left: Array) -> float:
    """Equivalent conicity of a free wheelset that swings by an amplitude a (mm) to both sides of
    some middle: the conicity of cones whose motion has the same wavelength (EN 15302). NaN where
    the wheelset is driven outward, without amplitude, and where it would swing beyond the shifts; 0
    where nothing turns it back.

    The motion is y'' = -D(y)/(e r): D is the rolling radius difference, right less left, at the
    shift y, e the distance of the contacts, r the rolling radius. It turns back at m - a and m + a,
    between which the integral of D is 0: of unlike sides the middle m is not 0. Its wavelength is
    2 J sqrt(e r), where J is the integral of dy/sqrt(2 (G(m + a) - G(y))) from m - a to m + a, and
    G that of D. That of cones (D = 2 c y) is pi sqrt(2 e r/c) (Klingel), so c = pi^2/(2 J^2).

    shifts: (n,) lateral shifts, mm, which rise, or stay where a radius jumps.
    right, left: (n,) rolling radii at these shifts, mm, straight in between.
    """
    difference, steps = right - left, np.diff(shifts)
    areas = (difference[1:] + difference[:-1]) / 2 * steps
    sums = np.concatenate([[0.0], np.cumsum(areas)])
    slopes = np.diff(difference) / np.where(steps > 0, steps, np.inf)

    def integral(y: Array | float) -> Array:
        """Integral of the difference from the first shift to y, mm2."""
        at = np.clip(np.searchsorted(shifts, y, "right") - 1, 0, len(steps) - 1)
        past = y - shifts[at]
        return np.asarray(sums[at] + past * (difference[at] + past * slopes[at] / 2))

    def left_over(middle: float) -> float:
        """Integral of the difference over a swing about a middle (mm), mm2."""
        return float(integral(middle + amplitude) - integral(middle - amplitude))

    ends = shifts[0] + amplitude, shifts[-1] - amplitude
    low, high, slack = *map(left_over, ends), ROUNDING * np.abs(difference).max()
    if not (amplitude > 0 and ends[0] <= ends[1] + ROUNDING and low <= slack and high >= -slack):
        return math.nan
    middle = brentq(left_over, *ends, xtol=1e-13) if low < 0 < high else ends[low < 0]
    angles = ((np.arange(ANGLES) + 0.5) / ANGLES - 0.5) * math.pi  # y = m + a sin(angle): no pole
    energy = integral(middle + amplitude) - integral(middle + amplitude * np.sin(angles))
    if energy.min() < -slack:
        return math.nan
    with np.errstate(divide="ignore"):  # the wheelset stays where nothing turns it back
        half = math.pi * np.mean(amplitude * np.cos(angles) / np.sqrt(2 * energy.clip(0.0)))
    return float(math.pi**2 / (2 * half**2))


def rolling_radii(wheelset: WheelsetOnTrack, reach: float) -> RollingRadii:
    """Rolling radii of a wheelset over the shifts from -reach to reach (mm, rounded up to whole
    steps), or over those around shift 0 at which it can stand.

    Each interval is divided by four until straight lines are within 0.5 % (SHARE) of the difference
    of the radii, or enclose less than 4e-6 mm2 (AREA) with them; the last division makes that 16
    times better. Where a contact jumps, intervals become about 1e-6 mm wide.
    Raises PlacementError where the wheelset can stand nowhere.
    """
    alike = wheelset.right is wheelset.left and not wheelset.roll
    count = math.ceil(reach / STEP)
    shifts = STEP * np.arange(0 if alike else -count, count + 1)
    found = wheelset.place_all(shifts)
    rolls = np.array([each.roll if isinstance(each, Placed) else np.nan for each in found])
    stands = np.flatnonzero(np.isfinite(rolls))
    if not len(stands):
        raise PlacementError(str(found[0]))
    runs = np.split(stands, np.flatnonzero(np.diff(stands) > 1) + 1)
    run = min(runs, key=lambda run: np.abs(shifts[run]).min())
    rows = _rows(wheelset, shifts[run], rolls[run])
    fresh, inside = np.arange(len(rows) - 1), np.array([[0.25], [0.5], [0.75]])
    while len(fresh):
        line = rows[fresh, None] * (1 - inside) + rows[fresh + 1, None] * inside
        flat = line.reshape(-1, 4)
        true = _rows(wheelset, flat[:, 0], flat[:, 1])
        off = np.abs(true - flat)[:, 2:].reshape(len(fresh), -1).max(axis=1)
        enclosed = off * (rows[fresh + 1, 0] - rows[fresh, 0])
        difference = np.abs(line[:, 1, 2] - line[:, 1, 3])
        bent = (enclosed > AREA) & (off > SHARE * difference)
        rows = np.insert(rows, np.repeat(fresh + 1, 3), true, axis=0)
        first = (fresh + 3 * np.arange(len(fresh)))[bent]
        fresh = (first[:, None] + np.arange(4)).ravel()
    if alike:  # the other shifts are the mirror image of these
        rows = np.vstack([rows[:0:-1, [0, 1, 3, 2]] * [-1, -1, 1, 1], rows])
    return RollingRadii(*rows.T)


def _rows(wheelset: WheelsetOnTrack, shifts: Array, start: Array) -> Array:
    """Shifts (mm), rolls (rad) and rolling radii, right and left (mm), of a wheelset, (n, 4); the
    search of the rolls goes from `start` (n,).
    """
    rolls, radii = wheelset.rolling(shifts, start, rough=True)
    return np.vstack([shifts, rolls, radii]).T
