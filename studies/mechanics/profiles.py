"""What a noisy measurement of a worn profile does to the answer: seeds of noise against the truth.

Standard profiles less a smooth wear are sampled as a gauge would, with noise, read and smoothed as
any file is, and solved as half-spaces; the truth is the worn profile itself.
"""

import hashlib
import itertools
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railhead.contact import closed_forms, solid
from railhead.geometry.placement import ProfilePair
from railhead.geometry.profiles import Array, Piece, Profile
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.planning import error_envelopes
from railhead.scene.scene import Scene, SceneError
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from studies import tables
from studies.processes import attempts

NOISES: tuple[float, ...] = (0.0, 2.0, 10.0, 20.0)  # um
SPACINGS: tuple[float, ...] = (0.1, 0.25, 0.5)  # mm
SEEDS = 10
LIMITS = {2.0: 0.03, 10.0: 0.08}  # of p_max in 90 % of the seeds, by noise ...
AREA_LIMIT = 0.05  # ... and of the area
EDGE = 0.3  # mm at either end that the gauge does not reach
COUNTED = 0.02  # of the load: smaller patches are no contact of their own
UNITS = {"spacing": "mm", "noise": "um", "true_pressure": "MPa"}


@dataclass(frozen=True)
class Worn:
    """A piece of a profile from which depth exp(-((y - centre) / width)^2 / 2) is worn off.

    start, end: y at which the piece starts and ends, mm.
    base: the piece before wear.
    wear: depth, centre and width, mm.
    """

    start: float
    end: float
    base: Piece
    wear: tuple[float, float, float]

    def derivative(self, y: Array, order: int) -> Array:
        """z (order 0), dz/dy (1) or d2z/dy2 (2)."""
        depth, centre, width = self.wear
        u = (y - centre) / width
        factor = (1.0, -u / width, (u**2 - 1) / width**2)[order]
        return self.base.derivative(y, order) - depth * factor * np.exp(-(u**2) / 2)


@dataclass(frozen=True)
class WornCase:
    """A pair of wheel and rail of which one profile is worn.

    name: name of the pair in tables.
    worn: the worn body, 'rail' or 'wheel'.
    wear: depth, centre and width of what is worn off, mm, as `Worn.wear`.
    keys: assignments to keys of the scene.
    """

    name: str
    worn: str
    wear: tuple[float, float, float]
    keys: tuple[str, ...]

    @property
    def scene(self) -> Scene:
        """The scene of the pair before wear."""
        base = {"name": "worn", "load": 1e5, "wheel": {"rolling_radius": 460}}
        return Scene.from_mapping(base).replace(self.keys)

    def true_pair(self) -> ProfilePair:
        """The two profiles after wear and without noise, the truth of the case."""
        pair = solid.pair(self.scene)
        new: Profile = getattr(pair, self.worn)
        pieces = tuple(Worn(each.start, each.end, each, self.wear) for each in new.pieces)
        bodies = {"rail": pair.rail, "wheel": pair.wheel, self.worn: Profile(new.name, pieces)}
        return ProfilePair(bodies["rail"], bodies["wheel"], pair.rolling_radius)

    def measured(self, folder: Path, spacing: float, noise: float, seed: int) -> Scene:
        """The scene whose worn profile is that of the file <seed>.csv, written here with points as
        of a gauge.

        spacing: between points along the profile, mm. noise: standard deviation of z, um.
        """
        profile: Profile = getattr(self.true_pair(), self.worn)
        y = np.linspace(profile.domain[0] + EDGE, profile.domain[1] - EDGE, 40001)
        length = np.hypot(np.diff(y), np.diff(profile.height(y))).cumsum()
        y = np.interp(np.arange(0, length[-1], spacing), length, y[1:])
        text = f"{self.name} {spacing} {noise} {seed}".encode()
        random = np.random.default_rng(list(hashlib.sha256(text).digest()))
        z = profile.height(y) + random.normal(0.0, 1e-3 * noise, y.shape)
        file = folder / f"{seed}.csv"
        np.savetxt(file, np.column_stack([y, z]), "%.5f", ",", header="y, z in mm")
        keys = [f"{self.worn}.profile={file}", "rail.inclination=0"]
        return self.scene.replace(keys if self.worn == "rail" else keys[:1])


CASES: tuple[WornCase, ...] = (
    WornCase("54E1 crown 1 mm, cylinder", "rail", (1.0, 0.0, 25.0), ()),
    WornCase(
        "60E1 crown 3 mm, 1:40",
        "rail",
        (3.0, 0.0, 45.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=cone40"),
    ),
    WornCase(
        "54E1 crown 2 mm, 1:20",
        "rail",
        (2.0, 0.0, 30.0),
        ("rail.inclination=1:20", "wheel.profile=cone20"),
    ),
    WornCase(
        "54E1 corner 2 mm, S1002",
        "rail",
        (2.0, -30.0, 10.0),
        ("wheel.profile=S1002", "wheelset.shift=4"),
    ),
    WornCase(
        "60E1 corner 3 mm, S1002",
        "rail",
        (3.0, -31.0, 12.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002", "wheelset.shift=4"),
    ),
    WornCase(
        "60E1 corner 1 mm, in flange contact",
        "rail",
        (1.0, -28.0, 8.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002", "wheelset.shift=6"),
    ),
    WornCase(
        "S1002 root 1 mm, in flange contact",
        "wheel",
        (1.0, -38.0, 8.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002", "wheelset.shift=5"),
    ),
    WornCase(
        "S1002 root 2 mm, 60E1",
        "wheel",
        (2.0, -36.0, 12.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002", "wheelset.shift=3"),
    ),
    WornCase(
        "S1002 tread hollow by 2 mm, 60E1",
        "wheel",
        (2.0, 0.0, 30.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002"),
    ),
    WornCase(
        "60E1 crown 1 mm, S1002 (conformal)",
        "rail",
        (1.0, -5.0, 20.0),
        ("rail.profile=60E1", "rail.inclination=1:40", "wheel.profile=S1002"),
    ),
)


Row = dict[str, Any]
"""Relative errors of the largest pressure (pressure_mean; pressure: what 90 % of the seeds stay
within) and of the area (alike). more: number of seeds with more contacts than there are, or without
an answer. open: median uncertainty that the plan gives; held: share of the seeds whose pressure is
within it."""


def solved(scene: Scene, pair: ProfilePair | None = None) -> BoundaryElementSolution:
    """Boundary-element solution of a scene as half-spaces; pair: profiles, None: the scene's."""
    contact = solid.locate(scene, None if pair is None else (pair, pair))
    return HalfSpacePair(contact, closed_forms.ellipse(scene, contact)).pressed(scene.load)


def contacts(found: BoundaryElementSolution) -> int:
    """Number of patches that carry more than 2 % (COUNTED) of the load."""
    return sum(patch.force > COUNTED * found.force for patch in found.patches)


def compared(case: WornCase, spacing: float, noise: float, seeds: int) -> Row:
    """Row of a case: its answers with noise of so many seeds (one without noise) against the truth.
    spacing: mm. noise: um.
    """
    true = solved(case.scene, case.true_pair())
    pressures, areas, opens, more = [], [], [], 0
    seeds = seeds if noise else 1
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(seeds):
            scene = case.measured(Path(folder), spacing, noise, seed)
            try:
                found = solved(scene)
                left = error_envelopes.around(scene, found)
            except (ValueError, SceneError):
                more += 1
                continue
            pressures.append(found.max_pressure / true.max_pressure - 1)
            areas.append(found.area / true.area - 1)
            opens.append(left)
            more += contacts(found) > contacts(true)
    worst = np.abs(pressures)
    return {
        "case": case.name,
        "spacing": spacing,
        "noise": noise,
        "seeds": seeds,
        "true_pressure": true.max_pressure,
        "pressure_mean": float(np.mean(pressures)),
        "pressure": float(np.quantile(worst, 0.9)),
        "area": float(np.quantile(np.abs(areas), 0.9)),
        "more": more,
        "open": float(np.median(opens)),
        "held": float(np.mean(worst <= np.array(opens))),
    }


def main(out: Path, *, quick: bool) -> None:
    """Write profiles.csv and page.md; quick: one case, two noises, two seeds."""
    cases, spacings, noises, seeds = CASES, SPACINGS, NOISES, SEEDS
    if quick:
        cases, spacings, noises, seeds = CASES[:1], SPACINGS[1:2], NOISES[1:3], 2
    jobs = list(itertools.product(cases, spacings, noises, [seeds]))
    rows = [each.value for each in attempts(compared, jobs) if each.value]
    tables.publish(out, page(rows), UNITS, profiles=rows)


def missed(row: Row) -> str:
    """Names of the limits that a row exceeds, in words; empty where it exceeds none."""
    judged, seeds = row["noise"] in LIMITS, f"{row['more']} of {row['seeds']}"
    found = {
        "p_max": judged and row["pressure"] > LIMITS[row["noise"]],
        "area": judged and row["area"] > AREA_LIMIT,
        f"{seeds} with another contact": row["more"],
    }
    return ", ".join(name for name, beyond in found.items() if beyond)


def page(rows: Sequence[Row]) -> str:
    """Text of the page: a row for each case, and how many of all rows are within the limits."""
    judged = [row for row in rows if row["noise"] in LIMITS]
    noises = sorted({row["noise"] for row in rows})
    return tables.render(
        "profiles",
        noises=[f"p_max at {noise:g} um" for noise in noises],
        rows=[_summary(case, own, noises) for case, own in tables.groups(rows, "case").items()],
        judged=len(judged),
        within=sum(not missed(row) for row in judged),
        seeds=max(row["seeds"] for row in rows),
        limits=LIMITS,
        area=AREA_LIMIT,
        held=_held(rows),
    )


def _held(rows: Sequence[Row]) -> float:
    """Share of the seeds whose pressure is within what the plan says is open."""
    return float(np.average([row["held"] for row in rows], weights=[row["seeds"] for row in rows]))


def _summary(case: str, rows: Sequence[Row], noises: Sequence[float]) -> list[str]:
    """Cells of a case: rows within the limits of those with one, the largest 90 % error of the
    pressure at each noise, that of the area in the judged rows, share of seeds held."""
    judged = [row for row in rows if row["noise"] in LIMITS]
    return [
        case,
        f"{sum(not missed(row) for row in judged)} of {len(judged)}",
        *(f"{100 * max(r['pressure'] for r in rows if r['noise'] == n):.1f} %" for n in noises),
        f"{100 * max(row['area'] for row in judged):.1f} %",
        f"{100 * _held(rows):.0f} %",
    ]
