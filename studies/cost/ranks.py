"""What processes of MPI bring: the same meshes with one and with two, and what that lets expect of
more."""

import itertools
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from railhead.cli import launch
from railhead.results import pipeline
from railhead.run.progress import Progress
from railhead.scene import catalogue
from studies import processes, tables

SIZES = (0.4, 0.28, 0.22, 0.142, 0.112)  # mm in the patch of hertz_ellipse
PARTS = ("start", "mesh", "assemble", "solve", "postprocess")
FORECAST = (2, 8, 64)
COUNTS = ("newton_iterations", "linear_iterations")


def measure(patch_size: float) -> dict[str, Any] | None:
    """Solve one mesh with all processes of MPI; patch_size: mm. Returns counts and seconds on the
    first process, None on the others."""
    scene = catalogue.find("hertz_ellipse").replace([f"mesh.patch_size={patch_size}"])
    result = pipeline.run(scene, Progress(quiet=True))
    end, cost = time.time(), result.summary["cost"]
    found = {"end": end, **{key: cost[key] for key in ("dofs", *COUNTS)}, **cost["seconds"]}
    return found if MPI.COMM_WORLD.rank == 0 else None


def recorded(patch_size: float, ranks: int) -> tables.Row:
    """One mesh with some processes. seconds by the clock, whole: from the start of the interpreter
    to the findings, start: what is none of the other parts."""
    begin = time.time()
    found = processes.measured("studies.cost.ranks", patch_size, ranks)
    whole, parts = found["end"] - begin, {name: found[name] for name in PARTS[1:]}
    return {
        "unknowns": found["dofs"],
        "ranks": ranks,
        **{key: found[key] for key in COUNTS},
        "whole": whole,
        "start": whole - sum(parts.values()),
        **parts,
    }


def forecast(one: tables.Row, two: tables.Row, ranks: int) -> dict[str, float]:
    """Seconds of each part with so many processes, each on a core of its own with its share of the
    memory's bandwidth: T = s + p / ranks through what one and two take (Amdahl), none faster than
    p = T(1)."""
    found = {}
    for part in PARTS:
        shared = min(max(2 * (one[part] - two[part]), 0.0), one[part])
        found[part] = one[part] - shared + shared / ranks
    return found


def main(out: Path, *, quick: bool) -> None:
    """Write ranks.csv and page.md; quick: the smallest mesh."""
    runs = itertools.product(SIZES[: 1 if quick else None], (1, 2))
    records = [
        recorded(*each) for each in tables.told(runs, "{0[0]:g} mm, {0[1]} processes".format)
    ]
    tables.publish(out, page(records), ranks=records)


def page(records: Sequence[tables.Row]) -> str:
    """What was measured, and the forecast from the largest mesh."""
    one, two = records[-2:]
    parts = [f"{{{part}:.1f}}" for part in PARTS]
    measured = [
        {
            **r,
            "each": 1e6 * r["whole"] * r["ranks"] / r["unknowns"],
            "gain": f"{records[i - 1]['whole'] / r['whole']:.2f}" if r["ranks"] > 1 else "",
        }
        for i, r in enumerate(records)
    ]
    forecasts = []
    for ranks in FORECAST:
        expected = forecast(one, two, ranks)
        whole = sum(expected.values())
        forecasts.append({**expected, "ranks": ranks, "whole": whole, "gain": one["whole"] / whole})
    return tables.render(
        "ranks",
        measured=tables.cells(
            measured,
            *("{unknowns}", "{ranks}", "{newton_iterations}", "{linear_iterations}"),
            *(*parts, "{whole:.1f}", "{each:.0f}", "{gain}"),
        ),
        forecasts=tables.cells(
            forecasts,
            *("{ranks}", *parts, "{whole:.1f}", "{gain:.1f}"),
        ),
        largest=one,
        parts=list(PARTS),
        worth=launch.UNKNOWNS_PER_PROCESS,
    )


if __name__ == "__main__":
    processes.answer(measure)
