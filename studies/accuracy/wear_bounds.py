"""Estimates of wear over random routes, beside runs with four times the steps on finer grids."""

import csv
import math
import tempfile
from pathlib import Path

import numpy as np

import railhead as rh
from railhead.half_spaces.worn_contact import BODIES
from railhead.run.progress import Progress
from railhead.sweeps.wear import wear_run
from railhead.sweeps.wear.wear_result import WearResult
from studies.processes import values
from studies.tables import Row, beside_errors, groups, publish, render

SEED, ROUTES, STEPS, FINER = 20261127, 20, 2, 4
RUNS: dict[str, wear_run.Grid] = {"coarse": (32, 7.5), "main": (64, 15.0)}
TRUTH: dict[str, wear_run.Grid] = {"coarse": (64, 15.0), "main": (96, 30.0)}
NUMBERS = (
    "pressure_max_MPa",
    "area_mm2",
    "t_gamma_N",
    *(
        f"{name}_{body}_mm{power}"
        for name, power in (("depth", ""), ("worn", "2"))
        for body in BODIES
    ),
    "conicity",
    "flange_thickness_mm",
)
RATE = 6.75e-7  # mm3/(N mm)


def main(out: Path, *, quick: bool) -> None:
    """Write wear_bounds.csv and page.md; quick: two routes."""
    count = 2 if quick else ROUTES
    records = values(measure, [(index,) for index in range(count)])
    publish(out, page(records), wear_bounds=records)


def scene(index: int, folder: Path) -> rh.Scene:
    """A random route of two to four positions, whose table is written into a folder: S1002 on a
    rail of a track, or arcs; shifts, yaws, loads, creepages; laws energy and usfd; on rail, wheel
    or both.
    """
    rng = np.random.default_rng([SEED, index])
    track, count = rng.random() < 0.5, int(rng.integers(2, 5))
    on = str(rng.choice(["rail", "wheel", "both"]))
    law = str(rng.choice(["energy", "usfd"]))
    radius, mu = float(rng.uniform(300, 500)), float(rng.uniform(0.2, 0.5))
    if track:
        rail = rh.Rail(profile=str(rng.choice(["54E1", "60E1"])), inclination=1 / 40, gauge=1435)
        wheel = rh.Wheel(profile="S1002", rolling_radius=radius)
        shifts, yaws = rng.uniform(-4, 4, count), rng.uniform(-3e-3, 3e-3, count)
    else:
        rail = rh.Rail(profile="arc", crown_radius=float(rng.uniform(150, 350)))
        across = float(rng.choice([-1, 1]) * rng.uniform(600, 2000))
        wheel = rh.Wheel(profile="arc", transverse_radius=across, rolling_radius=radius)
        shifts, yaws = rng.uniform(-2, 2, count), np.zeros(count)
    follows = track and rng.random() < 0.5
    loads = rng.uniform(40e3, 110e3, count)
    creepages = np.exp(rng.uniform(math.log(1e-3), math.log(1e-2), count))
    along = creepages * np.cos(angles := rng.uniform(0, 2 * math.pi, count))
    shares = rng.uniform(0.1, 1.0, count)
    rows = [
        {"share": share, "load": load, "wheelset.shift": shift, "wheelset.yaw": yaw}
        | ({} if follows else {"rolling.creepage_along": x, "rolling.creepage_across": y})
        for share, load, shift, yaw, x, y in zip(
            shares, loads, shifts, yaws, along, creepages * np.sin(angles), strict=True
        )
    ]
    file = folder / "positions.csv"
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    mean = 2e-3 if follows else float(creepages.mean())
    passes = float(rng.uniform(0.05, 0.4)) / (RATE * mu * float(loads.mean()) * mean)
    passes /= 2 if on == "both" else 1
    return rh.Scene(
        name=f"route_{index}",
        load=float(loads.mean()),
        rail=rail,
        wheel=wheel,
        friction=rh.Friction(coefficient=mu),
        rolling=rh.Rolling(from_wheelset=True) if follows else rh.Rolling(creepage_along=0.0),
        wear=rh.Wear(
            law=law,
            on=on,
            axles=None if on == "wheel" else passes,
            distance=None if on == "rail" else passes * 2 * math.pi * radius,
            positions=str(file),
            step=STEPS,
            accuracy=0.2,
        ),
        effects=rh.Effects(finite_bodies="off", plasticity="off"),
    )


def measure(index: int) -> list[Row]:
    """Estimates and relative errors of a route, a row a number."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        given = scene(index, folder)
        own = _solved(given, folder / "own", RUNS)
        truth = _solved(given.replace(**{"wear.step": FINER * STEPS}), folder / "truth", TRUTH)
    exact = truth.rows[::FINER]
    return [
        {
            "route": index,
            "law": given.wear.law,
            "on": given.wear.on,
            "stage": stage,
            "number": number,
            "value": known[number],
            "estimate": known[f"{number} estimate"] / known[number],
            "error": abs(other[number] / known[number] - 1),
        }
        for stage, (known, other) in enumerate(zip(own.rows, exact, strict=True))
        for number in NUMBERS
        if known[number]
    ]


def _solved(given: rh.Scene, folder: Path, runs: dict[str, wear_run.Grid]) -> WearResult:
    """The answer of a route on some grids, with records in a new folder."""
    folder.mkdir()
    route = wear_run.read(given)
    return WearResult(route, wear_run.solve(route, folder, None, Progress(quiet=True), runs))


def page(records: list[Row]) -> str:
    """Text of the page: a row a number, at all stages; the answers of a route are those at its
    ends.
    """
    ends = {"pressure_max_MPa": (0, STEPS)} | {
        f"{name}_{body}_{unit}": (STEPS,)
        for name, unit in (("depth", "mm"), ("worn", "mm2"))
        for body in BODIES
    }
    answers = [each for each in records if each["stage"] in ends.get(each["number"], ())]
    whole = [all(map(_holds, own)) for own in groups(answers, "route").values()]
    rows = [
        (f"`{number}`", *beside_errors(own, [*map(_holds, own)]))
        for number, own in [*groups(records, "number").items(), ("all", records)]
    ]
    return render(
        "wear_bounds",
        rows=rows,
        holds=sum(whole),
        routes=len(whole),
        seed=SEED,
        cells=[runs[name][0] for runs, name in ((RUNS, "coarse"), (RUNS, "main"), (TRUTH, "main"))],
        steps=(STEPS, FINER * STEPS),
    )


def _holds(record: Row) -> bool:
    """Whether the error is within its estimate."""
    return bool(record["error"] <= record["estimate"])
