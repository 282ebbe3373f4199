"""One position of a wheelset on worn profiles: pressure, tractions, and what they wear off.

A position has a share of all passages. Its profiles have the depth that all positions wore before.
In a step its own wear follows from the pressure at the end of the step (`theory.wear`); all lines
together lose as much as T-gamma wears. What the others wear in the step is taken to grow with the
position's own pressure on each line: alike positions then wear as one, and any step is stable. The
largest pressure is an average across over 0.1 (MEAN) of the half width of its patch: at the edge of
a groove what is narrower depends on the grid.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from railhead.contact import solid
from railhead.geometry import profiles
from railhead.geometry.placement import ProfilePair
from railhead.geometry.profiles import Places
from railhead.half_spaces import shearing, torque_free
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.scene.scene import Scene
from railhead.theory import wear
from railhead.theory.array_types import Array
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.bem.influence import Lines
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.damage import surface_fatigue_index
from railhead.theory.elastic.line import Hertz
from railhead.theory.wear import Splines, WearLaw

BODIES = ("rail", "wheel")
BROAD, FAINT = 3.0, 0.05
MEAN = 0.1  # of the half width of a patch: over it its largest pressure is averaged
MOST = 0.5  # of what a step wears, from the step before
FOLLOWS = 2.0  # largest factor on the wear of all lines, by which slip follows the pressure
PLACES = 4001  # along each profile
LEAST = 4  # places from knot to knot
VALUES = (
    *("pressure_max_MPa", "pressure_edge_MPa", "area_mm2", "t_gamma_N"),
    *("rail_mm2", "wheel_mm2", "edge_cells"),
)
FIELDS = ("pressure", "index", "energy", "damage", "rate", "force")
Fields = dict[str, Array]
"""Values (2, n) at the places along the profiles of rail and wheel, by name."""


@dataclass(frozen=True, kw_only=True)
class Position:
    """A position of the wheelset, and how much of the wear it brings.

    scene: the scene, whose profiles are new.
    hertz: exact Hertz of the new profiles, of which contact modulus and approach are used.
    law: of wear.
    axles: wheels that pass the rail in this position; 0: the rail is not worn.
    distance: that the wheel rolls in this position, mm; 0: the wheel is not worn.
    """

    scene: Scene
    hertz: Hertz
    law: WearLaw
    axles: float
    distance: float


@dataclass(frozen=True, kw_only=True)
class Fineness:
    """Resolution of a solution.

    cells: of the pressure of a patch each way; the tractions have half as many.
    knots: mm between the knots of the splines of the worn depth.
    """

    cells: int
    knots: float

    @property
    def width(self) -> float:
        """Width of averages, mm: their weights fall linearly to zero there, to each side."""
        return BROAD * self.knots

    def splines(self, along: Places) -> Splines:
        """Splines of the worn depth at places along a profile."""
        intervals = len(along.points) - 1
        wanted = round(along.step * intervals / self.knots)
        return _splines(intervals + 1, min(max(wanted, 1), intervals // LEAST))


_splines = lru_cache(maxsize=8)(Splines)


@dataclass(frozen=True, kw_only=True)
class Seen:
    """The contact of a position on profiles as they are.

    values: quantities by their names in wear.json, VALUES; 'pressure_edge_MPa' is half of what an
        average over twice the width takes off the largest pressure, 'rail_mm2' and 'wheel_mm2' are
        areas that all passages take at the present rate, 'edge_cells' the least distance of a patch
        from an end of a profile, in cells.
    fields: by name, (2, n) at the places along rail and wheel: 'pressure', largest of the line,
        MPa; 'index', largest surface fatigue index of the line, NaN without pressure or yield
        stress; by all passages at the present rate 'energy', the sum of T-gamma per width, N/mm,
        and 'damage'; 'rate', the depth by all passages, mm; and 'force' per width, N/mm, at least
        5 % (FAINT) of its largest value. 'pressure', 'rate' and 'force' are averages over 3 (BROAD)
        spacings of knots to each side.
    rises: vertical force that the tractions carry, N; the next solution begins with it.
    """

    values: dict[str, float]
    fields: Fields
    rises: float


def places(scene: Scene) -> dict[str, Places]:
    """4001 places (PLACES) along each of the new profiles of 'rail' and 'wheel' of a scene."""
    new = solid.pair(scene)
    return {body: profiles.places_along(getattr(new, body), PLACES) for body in BODIES}


def pairs(scene: Scene, along: Mapping[str, Places], depths: Array) -> solid.Pairs:
    """Both sides of a wheelset with worn profiles. The other side is worn alike, but a profile of
    its own stays new. Raises ValueError where a profile folds.
    """
    rail, wheel = (each.profile_at(d) for each, d in zip(along.values(), depths, strict=True))
    here = ProfilePair(rail, wheel, scene.wheel.rolling_radius, solid.tape_circle(scene))
    return here, solid.pairs(scene)[1] if scene.wheelset.unlike else here


class WornContact:
    """A position on worn profiles: its pressure, and what it wears off.

    seen: what is read of pressure and tractions.
    """

    def __init__(self, position: Position, fineness: Fineness, depths: Array, rises: float) -> None:
        """depths: (2, n) worn so far, mm. rises: of an earlier solution of this position.
        Raises ValueError where a profile folds, the wheelset does not stand on its track, or no
        pressure or tractions are found.
        """
        scene, along = position.scene, places(position.scene)
        self._position, self._cells = position, fineness.cells
        placed = solid.place(scene, both=pairs(scene, along, depths))
        self._contact = torque_free.balanced(solid.on_side(scene, placed, line=True))
        self._pair = HalfSpacePair(self._contact, position.hertz)
        self._surface = self._pair.developed
        self._steps = {body: along[body].step for body in BODIES}
        self._splines = {body: fineness.splines(along[body]) for body in BODIES}
        self._width = fineness.width
        worn = zip(along.items(), depths, strict=True)
        self._across = {body: each.worn(depth)[:, 0] for (body, each), depth in worn}
        self._load = float(scene.load or 0.0) + rises
        self._pressed = self._press(None)
        self._windows = sorted(self._pressed.windows, key=lambda window: window.centroid[1])
        self._middle = np.array([window.centroid for window in self._windows]).T
        self.seen = self._sheared()

    def wear(self, share: float, others: Array) -> Array:
        """Depth (2, n) that this position wears off both bodies in a share of its passages, by the
        pressure of their end. others: depth (2, n) that the other positions wear in all of theirs
        over the force per width of this one, mm2/N.
        """

        def opening(s: Array) -> Array:
            """Compliance (n, n), mm2/N, of the lines at s (n,), mm."""
            total = np.zeros((s.size, s.size))
            for body, other in zip(BODIES, others, strict=True):
                lines = self._line(body, s)
                lines = lines + np.interp(self._y(body, s), self._across[body], other)
                seen = self._hats(body, s) * np.sqrt(share * lines)
                total += self._splines[body].between(seen) * self._steps[body] / (s[1] - s[0])
            return total

        after, worn = self._press(opening).windows, []
        for body in BODIES:
            lines = [self._line(body, each.s) * _force(each) for each in after]
            steps = [float(each.s[1] - each.s[0]) for each in after]
            area = math.fsum(step * line.sum() for step, line in zip(steps, lines, strict=True))
            # Slip follows the pressure: all lines together lose what T-gamma wears.
            follows = self.seen.values[f"{body}_mm2"] / area if area else 0.0
            depth = self._splines[body].projected(self._field(body, after, lines))
            worn.append(share * min(follows, FOLLOWS) * depth)
        return np.array(worn)

    def _press(self, lines: Lines | None) -> BoundaryElementSolution:
        """The pressure on the present profiles, with a compliance of the lines or without."""
        return self._pair.solve(
            self._load,
            self._cells,
            lines=lines,
            start=None if lines is None else self._pressed,
        )

    def _y(self, body: str, s: Array) -> Array:
        """y (n,) on the profile of a body, mm, of the lines at s (n,), mm; a line on the wheel is
        one of its circles.
        """
        if body == "rail":
            return np.interp(s, self._surface.s, self._surface.y)
        assert self._contact.pose is not None
        s = s.clip(*self._surface.s[[0, -1]])
        points = self._surface.points(np.interp(s, self._middle[1], self._middle[0]), s)
        return self._contact.pose.inward(points)[:, 1]

    def _passes(self, body: str, s: Array) -> Array:
        """Number (n,) of passages, or of the wheel's turns, that wear the lines at s (n,), mm."""
        if body == "rail":
            return np.full(s.shape, self._position.axles)
        assert self._contact.pair is not None
        pair = self._contact.pair
        radius = pair.rolling_radius + pair.wheel.height(self._y(body, s))
        return np.nan_to_num(self._position.distance / (2 * math.pi * radius))

    def _line(self, body: str, s: Array) -> Array:
        """Depth by all passages over the force per width, (n,), mm2/N, of the lines at s (n,)."""
        return self._passes(body, s) * self._rate(s)

    def _hats(self, body: str, s: Array) -> Array:
        """Weights (n, m) of straight lines through values at s (m,), evenly spaced, mm, at the
        places along the profile of a body; zero beyond.
        """
        own = np.interp(self._across[body], self._y(body, s), s, left=np.inf, right=np.inf)
        return np.maximum(1 - np.abs(own[:, None] - s) / (s[1] - s[0]), 0.0)

    def _field(self, body: str, windows: Sequence[PatchSolution], values: Sequence[Array]) -> Array:
        """Sum (n,) of values of the lines of windows at the places along the profile of a body."""
        pairs = zip(windows, values, strict=True)
        return np.sum([self._hats(body, window.s) @ value for window, value in pairs], axis=0)

    def _sheared(self) -> Seen:
        """Tractions under the pressure, and what is read from both."""
        pair = self._pair
        patches = shearing.patches(pair, self._pressed, self._cells // 2)
        found = shearing.shear(pair, patches, shearing.motion(self._contact))
        windows, curves = [patch.pressed for patch in patches], []
        lines: list[dict[str, Array]] = []
        for window, each in zip(windows, found.found, strict=True):
            energy = (each.traction * each.slip).sum(axis=0)
            if pair.materials.like and energy.any():  # what the grid adds to the slip has no part
                energy *= each.t_gamma / (each.cell * float(energy.sum()))
            total = each.cell * float(energy.sum())
            rate = self._position.law.rate(total / window.area)
            step = float(each.x[1] - each.x[0])
            force = step * each.pressure.sum(axis=0)
            lost = np.maximum(step * energy.sum(axis=0), 0.0)  # of rounding at the edge
            curves.append((each.y[force > 0], rate * lost[force > 0] / force[force > 0]))
            lines.append(
                {
                    "energy": lost,
                    "worn": rate * lost,
                    "pressure": each.pressure.max(axis=0),
                    "traction": np.linalg.norm(each.traction, axis=0).max(axis=0),
                    "damage": wear.damage(total) * (each.pressure > 0).any(axis=0),
                }
            )
        at, rates = (np.concatenate(each) for each in zip(*curves, strict=True))
        order = np.argsort(at)
        self._rate = partial(np.interp, xp=at[order], fp=rates[order])
        bodies = [self._fields(body, windows, lines) for body in BODIES]
        return Seen(
            values=self._values(windows, lines),
            fields={name: np.array([each[name] for each in bodies]) for name in FIELDS},
            rises=found.upwards,
        )

    def _values(
        self, windows: Sequence[PatchSolution], lines: Sequence[Mapping[str, Array]]
    ) -> dict[str, float]:
        """Quantities of the contact, as of `Seen.values`, from the pressed patches and, of each,
        what its lines carry by name.
        """
        steps = [float(window.s[1] - window.s[0]) for window in windows]
        worn = {
            f"{body}_mm2": sum(
                step * float(self._passes(body, window.s) @ each["worn"])
                for step, window, each in zip(steps, windows, lines, strict=True)
            )
            for body in BODIES
        }
        energy = [(step, each["energy"]) for step, each in zip(steps, lines, strict=True)]
        largest = self._largest(MEAN)
        return {
            "pressure_max_MPa": largest,
            "pressure_edge_MPa": (largest - self._largest(2 * MEAN)) / 2,
            "area_mm2": self._pressed.area,
            "t_gamma_N": sum(step * float(line.sum()) for step, line in energy),
            **worn,
            "edge_cells": self._edge_cells(),
        }

    def _largest(self, part: float) -> float:
        """Largest pressure, MPa, averaged across over a part of the half width of its patch."""
        return max(
            float(wear.averaged(each.pressure.max(axis=0), step, part * each.half_extents[1]).max())
            for each in self._windows
            for step in np.diff(each.s[:2]).tolist()
        )

    def _edge_cells(self) -> float:
        """Distance of the pressed lines of all patches from the nearest end of a profile, in cells
        across; negative beyond it.
        """
        least = np.inf
        for window in self._pressed.windows:
            used = window.s[window.pressure.any(axis=0)]
            if not used.size:
                continue
            for body in BODIES:
                y, (low, high) = self._y(body, used[[0, -1]]), self._across[body][[0, -1]]
                room = min(y.min() - low, high - y.max())
                least = min(least, float(room / (window.s[1] - window.s[0])))
        return least

    def _fields(
        self, body: str, windows: Sequence[PatchSolution], lines: Sequence[Mapping[str, Array]]
    ) -> Fields:
        """Fields (n,) along the profile of a body, as of `Seen.fields`, and `lines`; arguments as
        of `_values`.
        """
        steel = self._position.scene.bodies[body]
        passes = [self._passes(body, window.s) for window in windows]
        found = {name: [each[name] for each in lines] for name in ("pressure", "traction")}
        for name in ("worn", "energy", "damage"):
            found[name] = [number * each[name] for number, each in zip(passes, lines, strict=True)]
        fields = {name: self._field(body, windows, values) for name, values in found.items()}
        fields["rate"] = fields.pop("worn")
        fields["force"] = self._field(body, self._windows, [_force(w) for w in self._windows])
        for name in ("pressure", "traction", "rate", "force"):
            fields[name] = wear.averaged(fields[name], self._steps[body], self._width)
        fields["force"] = fields["force"].clip(FAINT * fields["force"].max())
        touches = fields["pressure"] > 0
        fields["index"] = np.full(touches.shape, np.nan)
        if steel.yields:
            peak, k = float(fields["pressure"].max()), steel.first_yield / math.sqrt(3)
            fields["index"][touches] = [
                surface_fatigue_index(each, peak, k)
                for each in fields["traction"][touches].tolist()
            ]
        return fields


def solve(
    position: Position,
    fineness: Fineness,
    depths: Array,
    rises: float,
    share: float,
    others: Array,
    before: tuple[float, float] = (0.0, 0.0),
) -> tuple[Seen, Array]:
    """A position on profiles that are worn by some depths, and the depth (2, n) that it wears in a
    share of its passages, from there. Arguments and errors as of `WornContact`.

    before: T-gamma of the position at the start of the step before, N, and the share of that step,
        in which half of the change of T-gamma was not worn: it is worn in this step. In a share of
        0, after the last step, it is all that is worn, and negative where T-gamma fell.
    """
    contact = WornContact(position, fineness, depths, rises)
    (last, step), now = before, contact.seen.values["t_gamma_N"] or math.inf
    owed, most = (1 - last / now) * step / 2, MOST * (share or step)
    total = share + min(max(owed, -most), most)
    if not total:
        return contact.seen, np.zeros_like(depths)
    return contact.seen, math.copysign(1.0, total) * contact.wear(abs(total), others)


def _force(window: PatchSolution) -> Array:
    """Force per width of the lines of a window (ns,), N/mm."""
    return np.asarray(float(window.x[1] - window.x[0]) * window.pressure.sum(axis=0))
