"""A sweep as a command: combinations side by side, a record of each, a table and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import ExitStack
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead import __version__
from railhead.planning import plan as planning
from railhead.planning.cost import price
from railhead.planning.plan import Plan
from railhead.results import result_folder, table_file
from railhead.results.subject import shared_y
from railhead.run import process, refinement
from railhead.run.progress import Progress
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import shared_mesh, store, sweep_table, worker_pool

POLL = 0.5  # s between looks at what is done
TABLE = "sweep.csv"
GONE = "its record is gone: something else has written into the folder"
PASSED = sweep_table.PASSED


@dataclass(frozen=True)
class Campaign:
    """scenes: of all combinations; keys: dotted, those that change; vtu: whether each leaves files
    for ParaView."""

    base: Scene
    scenes: Sequence[Scene]
    keys: Sequence[str]
    folder: Path
    vtu: bool = False

    def values(self, number: int) -> dict[str, object]:
        """What changes, in base units."""
        return {key: self.scenes[number].value(key) for key in self.keys}

    def name(self, number: int) -> str:
        """One combination in words."""
        said = ", ".join(
            f"{sweep_table.column(key)} = {value}" for key, value in self.values(number).items()
        )
        return said or "the scene"

    @property
    def asked(self) -> dict[str, Any]:
        """All that decides what is kept of a combination. OSError: a file cannot be read."""
        over = {key: [each.value(key) for each in self.scenes] for key in self.keys}
        files = {path for scene in self.scenes for path in scene.files}
        return {
            "railhead": __version__,
            "scene": self.base.model_dump(exclude_none=True),
            "over": {key: list(dict.fromkeys(values)) for key, values in over.items()},
            "files": {str(path): sha256(path.read_bytes()).hexdigest() for path in sorted(files)},
            **({"vtu": True} if self.vtu else {}),
        }

    @property
    def times(self) -> list[float]:
        """Of the combinations in ParaView: the values of the one key that changes, in base units,
        where these are numbers; else the combinations' own numbers."""
        values = [scene.value(key) for scene in self.scenes for key in self.keys]
        numbers = [float(each) for each in values if isinstance(each, int | float)]
        if len(self.keys) == 1 and len(numbers) == len(values) and np.isfinite(numbers).all():
            return numbers
        return [float(number) for number in range(len(self.scenes))]


def run(campaign: Campaign, *, resume: bool, pictures: bool, quiet: bool) -> list[str] | None:
    """Solve what is not done yet and write table and pictures. Returns the status of each
    combination, on the first rank; None on the others, which work for it. Raises SceneError before
    anything is solved, OSError where nothing can be written."""
    comm = MPI.COMM_WORLD
    groups: list[list[int]] = []
    y = ""
    problem: Exception | None = None
    with ExitStack() as claim:
        if comm.rank == 0:
            try:
                plans = _plans(campaign, quiet)
                groups, y = shared_mesh.groups(plans), shared_y(plans)
                store.begin(campaign.folder, campaign.asked, resume=resume)
                claim.enter_context(store.claimed(campaign.folder))
                store.check(campaign.folder, campaign.values, sweep_table.check)
                if campaign.vtu:
                    store.forget_without_grids(campaign.folder)
            except (SceneError, OSError) as error:
                problem = error
        if (problem := comm.bcast(problem)) is not None:
            raise problem
        with worker_pool.submitting(comm.size) as submit:
            if submit is None:
                return None
            workers = worker_pool.workers(comm.size)
            with Progress(quiet=quiet) as progress:
                progress.jobs(len(store.done(campaign.folder)), len(campaign.scenes))
                faults = _solve_all(campaign, groups, workers, submit, progress)
                # What was to be solved after the one that crashed, each by itself.
                lost = [[number] for group in groups if len(group) > 1 for number in group]
                again = [each for each in lost if each[0] in faults]
                faults |= _solve_all(campaign, again, workers, submit, progress)
        return _write(campaign, faults, y, pictures=pictures)


def _solve_all(
    campaign: Campaign, groups: Sequence[Sequence[int]], workers: int, submit: worker_pool.Submit,
    progress: Progress,
) -> dict[int, str]:  # fmt: skip
    """Solve what has no record of groups that share a mesh; why some of them still have none."""
    folder, scenes = campaign.folder, campaign.scenes
    finished, jobs = store.done(folder), {}
    left = [
        (group, [place for place, number in enumerate(group) if number not in finished])
        for group in groups
    ]
    left = [(group, wanted) for group, wanted in left if wanted]
    for group, wanted in left:
        chosen = [scenes[number] for number in group]
        for part in shares(wanted, len(left), workers):
            job = submit(_solve, folder, campaign.keys, group, chosen, part, campaign.vtu)
            jobs[job] = [group[each] for each in part]
    faults: dict[int, str] = {}
    pending = set(jobs)
    while pending:
        ended, pending = wait(pending, POLL, FIRST_COMPLETED)
        for job in ended:
            attempt = worker_pool.outcome(job)
            faults |= dict.fromkeys(jobs[job], attempt.fault) | (attempt.value or {})
        progress.jobs(len(store.done(folder)), len(scenes))
    return {number: faults[number] or GONE for number in faults.keys() - store.done(folder)}


def shares(wanted: Sequence[int], groups: int, workers: int) -> list[Sequence[int]]:
    """What is wanted of one of several groups, shared among the processes that would have nothing
    to do. Each makes the mesh of the whole group again: it waits for that in any case."""
    parts = min(len(wanted), max(1, workers // groups))
    return [wanted[first::parts] for first in range(parts)]


def _solve(
    folder: Path, keys: Sequence[str], group: Sequence[int], scenes: Sequence[Scene],
    wanted: Sequence[int], vtu: bool,
) -> dict[int, str]:  # fmt: skip
    """In a process of its own: solve and keep a record of each, after its files; why some of them
    have none."""
    short: dict[int, str] = {}
    for place, found in shared_mesh.run(scenes, wanted, Progress(quiet=True), MPI.COMM_SELF):
        if vtu and not isinstance(found, Exception):
            target = store.grids(folder, group[place])
            target.mkdir(exist_ok=True)
            result_folder.write_grids(found, target)
        if isinstance(found, price.NoMemoryError):  # another time it may fit
            short[group[place]] = str(found)
            continue
        over = {key: scenes[place].value(key) for key in keys}
        store.write(folder, group[place], {"over": over, **sweep_table.record(found)})
    process.trim()
    return short


def _write(campaign: Campaign, faults: Mapping[int, str], y: str, *, pictures: bool) -> list[str]:
    """Table and pictures, beside the records; faults: of what may have none; y: its label."""
    from railhead.postprocess.plots import sweep

    done = store.done(campaign.folder)
    kept = [
        store.read(campaign.folder, number) if number in done else {"fault": faults[number]}
        for number in range(len(campaign.scenes))
    ]
    values = [campaign.values(number) for number in range(len(kept))]
    rows = [sweep_table.row(*each) for each in zip(values, kept, strict=True)]
    with result_folder.replacing(campaign.folder) as work:
        store.keep(campaign.folder, work)
        (work / TABLE).write_bytes(table_file.encoded(rows))
        if campaign.vtu:
            _collect(campaign, [row[sweep_table.CHECKS] for row in rows], work)
        if pictures and 1 <= len(campaign.keys) <= 2:
            columns = [sweep_table.column(key) for key in campaign.keys]
            title = f"sweep of {campaign.scenes[0].name} over {' and '.join(campaign.keys)}"
            sweep.curves(columns, rows, work / "sweep.png", y, title)
            outlines: list[Any] = [each.get("outlines", []) for each in kept]
            sweep.patches(columns, rows, outlines, work / "patches.png", y, title)
    return [row[sweep_table.CHECKS] for row in rows]


def _collect(campaign: Campaign, said: Sequence[str], work: Path) -> None:
    """The combinations that passed as time steps for ParaView."""
    from railhead.postprocess.vtu import export

    for name in store.SERIES:
        files = {
            time: f"{store.grids(Path(), number)}/{name}.vtu"
            for number, (time, each) in enumerate(zip(campaign.times, said, strict=True))
            if each == PASSED
        }
        export.series(files, work / f"{name}.pvd")


def _plans(campaign: Campaign, quiet: bool) -> list[Plan]:
    """Of all scenes: what makes no contact problem is refused before anything is solved."""
    made = []
    with refinement.telling(quiet=quiet) as progress:
        for number, scene in enumerate(campaign.scenes):
            if number % 10 == 0:
                progress.stage(f"planning {number + 1} of {len(campaign.scenes)}")
            try:
                made.append(planning.make(scene))
            except SceneError as error:
                raise SceneError(error.key, f"{error.text} ({campaign.name(number)})") from None
    return made
