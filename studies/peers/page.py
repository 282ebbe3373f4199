"""What the page of the study says."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from statistics import median
from typing import Any

from studies import tables
from studies.peers import running
from studies.peers.peer import Peer
from studies.peers.reading import Run

OURS = "railhead"
TRAVEL = 0.04126  # mm of the far ends towards each other: close to 25 kN on these blocks
ERRORS = ("p_max", "p_fit", "a", "b", "area", "approach", "tau_max")


def medians(runs: Sequence[Run]) -> list[Run]:
    """One run for each code and setting, in the order of codes: the medians of what was measured
    several times. (Its errors are the same each time.)"""
    groups: dict[tuple[str, str], list[Run]] = {}
    for run in sorted(runs, key=lambda run: (run.code != OURS, run.code)):
        groups.setdefault((run.code, run.setting), []).append(run)
    return [_median(group) for group in groups.values()]


def _median(group: Sequence[Run]) -> Run:
    done = [run for run in group if not run.failure]
    if not done:
        return group[0]
    costs = {
        key: median(getattr(run, key) for run in done)
        for key in ("seconds", "cpu_seconds", "peak_bytes")
    }
    return replace(done[0], **costs)


def page(
    runs: Sequence[Run],
    present: Sequence[Peer],
    versions: Mapping[str, str],
    absent: Mapping[str, str],
) -> str:
    """The whole page."""
    seen = medians(runs)
    own = [run for run in runs if run.code == OURS and not run.failure]
    repeated = [
        [run.cpu_seconds for run in own if run.setting == setting and run.cpu_seconds]
        for setting in {run.setting for run in own}
    ]
    forces = [run.force / 1e3 for run in runs if run.code != OURS and run.force]
    waited = [run.seconds / run.cpu_seconds for run in runs if run.seconds and run.cpu_seconds]
    return tables.render(
        "peers",
        ours=version("railhead"),
        threads=running.THREADS,
        cores=os.cpu_count(),
        travel=TRAVEL,
        forces=(min(forces), max(forces)) if forces else None,
        limit=f"{running.LIMIT:g}",
        waited=median(waited) if waited else None,
        repeats=max((len(each) for each in repeated), default=0),
        spread=max((max(each) / min(each) for each in repeated), default=1.0),
        peers=[
            {
                "title": peer.TITLE, "version": versions[peer.TITLE], "method": peer.METHOD,
                "settings": " ".join(peer.SETTINGS.split()),
            }
            for peer in present
        ],
        absent=absent,
        failed=[run for run in seen if run.failure],
        rows=[_row(run) for run in seen if not run.failure],
    )  # fmt: skip


def _row(run: Run) -> tuple[Any, ...]:
    values = vars(run)
    errors = [values[f"error_{name}"] for name in ERRORS]
    return (
        run.code, run.setting, run.unknowns, f"{run.cpu_seconds:.1f}", f"{run.seconds:.1f}",
        f"{(run.peak_bytes or 0) / 1e6:.0f}",
        *("-" if error is None else f"{100 * error:+.2f}" for error in errors),
    )  # fmt: skip
