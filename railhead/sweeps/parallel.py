"""Scenes solved side by side, a record of each in a folder, a table and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import AbstractContextManager, ExitStack, suppress
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.planning.simulation_plan import NoMemoryError, Plan
from railhead.postprocess.findings import BASE_UNITS, Subject, Units
from railhead.results import files, result_folder
from railhead.results.result import Result
from railhead.results.subject import shared_y
from railhead.run import process
from railhead.run.progress import Progress, Tell, show_progress
from railhead.scene.catalogue import copy_files, places, portable
from railhead.scene.scene import SceneError
from railhead.sweeps import runner, store, sweep_table, worker_pool
from railhead.sweeps.grid import ParameterGrid, column

Row = dict[str, Any]
POLL = 0.5  # s between two looks at the finished jobs
LOST_RECORD = "its record is gone: something else has written into the folder"


@dataclass(frozen=True, kw_only=True)
class ParallelSweep:
    """What is solved, and what is kept of it.

    grid: the scenes.
    folder: folder of records, table and pictures.
    vtu: whether files for ParaView are written for each scene; not for half-spaces.
    fields: whether the arrays of `Result.contact_points` are written, of all scenes into one file.
    keep_results: whether `Outcome.results` holds the results, with their fields, of the scenes that
        are solved now; those that had a record are not solved again. Else it is empty.
    units: of pictures and report.
    """

    grid: ParameterGrid
    folder: Path
    vtu: bool = False
    fields: bool = False
    keep_results: bool = False
    units: Units = BASE_UNITS

    @cached_property
    def files(self) -> dict[str, str]:
        """Places in the folder of the files that the scenes name (`catalogue.places`), by path;
        nothing is copied here.
        """
        return places({path for scene in self.grid.scenes for path in scene.files})

    def values(self, number: int) -> dict[str, object]:
        """Values of the changing keys in scene `number`, from 0, by dotted key, in base units; of
        files their places in the folder. Raises OSError where a file cannot be read.
        """
        values = self.grid.values(number).items()
        return {key: self.files.get(str(value), value) for key, value in values}

    @property
    def request(self) -> dict[str, Any]:
        """Everything that determines the records: "railhead" (version), "scene", "over" (values by
        key), "vtu" and "fields". Files are named by their places in the folder, which hold the
        first digits of their SHA-256. Raises OSError where a file cannot be read.
        """
        rows = [self.values(number) for number in range(len(self.grid.scenes))]
        over = {key: [row[key] for row in rows] for key in self.grid.keys}
        if not self.grid.listed:
            over = {key: list(dict.fromkeys(values)) for key, values in over.items()}
        return {
            "railhead": result_folder.VERSION,
            "scene": portable(self.grid.base),
            "over": over,
            **({"vtu": True} if self.vtu else {}),
            **({"fields": True} if self.fields else {}),
        }

    @property
    def times(self) -> list[float]:
        """Times of the scenes in ParaView: the values of the one key that changes, in base units,
        where these are finite numbers; else the numbers of the scenes from 0."""
        count = len(self.grid.scenes)
        values = [value for n in range(count) for value in self.grid.values(n).values()]
        numbers = [float(each) for each in values if isinstance(each, int | float)]
        if len(self.grid.keys) == 1 and len(numbers) == count and np.isfinite(numbers).all():
            return numbers
        return [float(number) for number in range(count)]


@dataclass(frozen=True)
class Outcome:
    """What became of a sweep.

    rows: of sweep.csv, in the order of the scenes, cells by column header.
    failures: a line for each picture that could not be drawn or file that could not be stamped.
    results: by number of the scene those that were solved now; empty without
        `ParallelSweep.keep_results`.
    """

    rows: list[Row]
    failures: list[str]
    results: dict[int, Result]

    @property
    def status(self) -> dict[int, str]:
        """By number of the scene from 0, "passed" or why not."""
        return {number: row[sweep_table.CHECKS] for number, row in enumerate(self.rows)}


def run(
    sweep: ParallelSweep,
    *,
    pictures: bool,
    quiet: bool,
    other: store.Other = "refuse",
    tell: Tell | None = None,
) -> Outcome | None:
    """Solve the scenes of a sweep that have no record yet, side by side, and write table and
    pictures; under MPI called on all ranks.

    other: what happens to another result in the folder (`store.begin`).
    pictures: whether PNG files and report.html are written.
    quiet: whether no progress is shown. tell: as of `Progress`.
    Returns None on all MPI ranks but the first, which solve scenes. Raises SceneError before
    anything is solved, OSError where nothing can be written.
    """
    comm = MPI.COMM_WORLD
    groups: list[list[int]] = []
    plans: list[Plan] = []
    rows: dict[int, Row] = {}
    results: dict[int, Result] = {}
    y_label = ""
    problem: Exception | None = None
    with ExitStack() as claim:
        if comm.rank == 0:
            try:
                with show_progress(quiet=quiet, tell=tell) as progress:
                    plans = runner.plan_all(sweep.grid, progress)
                groups, y_label = runner.group_by_mesh(plans), shared_y(plans)
                claim.enter_context(result_folder.claimed(sweep.folder))
                store.begin(sweep.folder, sweep.request, other)
                copy_files(map(Path, sweep.files), sweep.folder)
                store.check(sweep.folder, sweep.values)
            except (SceneError, OSError) as error:
                problem = error
        if (problem := comm.bcast(problem)) is not None:
            raise problem
        jobs = 0 if all(plan.by_half_spaces for plan in plans) else worker_pool.JOBS_PER_PROCESS
        with worker_pool.submitting(comm.size, jobs) as submit:
            if submit is None:
                return None
            workers = worker_pool.workers(comm.size)
            with Progress(quiet=quiet, tell=tell) as progress:
                solve = partial(_solve_all, sweep, plans, rows, results, workers, submit, progress)
                faults = solve(groups)
                # A crash takes the rest of its group with it: these again, each alone.
                again = [[n] for group in groups if len(group) > 1 for n in group if n in faults]
                faults |= solve(again)
        return _write(sweep, rows, results, faults, y_label, pictures=pictures)


def _solve_all(
    sweep: ParallelSweep,
    plans: Sequence[Plan],
    rows: dict[int, Row],
    results: dict[int, Result],
    workers: int,
    submit: worker_pool.Submit,
    progress: Progress,
    groups: Sequence[Sequence[int]],
) -> dict[int, str]:
    """Let the workers solve the scenes of all groups that have no record, and wait; returns reasons
    by number for scenes that still have none.

    plans: of all scenes. rows: of sweep.csv by number; they grow with the records.
    results: by number; they grow with the solved scenes (with `ParallelSweep.keep_results`).
    workers: number of processes.
    submit: starts a job.
    """
    finished, total = store.done(sweep.folder), len(sweep.grid.scenes)
    progress.jobs(len(finished), total)
    missing = [[number for number in group if number not in finished] for group in groups]
    busy = sum(map(bool, missing))
    numbers_of = {}
    for group, wanted in zip(groups, missing, strict=True):
        planned = {number: plans[number] for number in group}
        for part in split_among_workers(wanted, busy, workers):
            over = {number: (sweep.values(number), sweep.grid.names[number]) for number in part}
            job = submit(
                _solve, sweep.folder, over, planned, sweep.vtu, sweep.fields, sweep.keep_results
            )
            numbers_of[job] = part
    faults: dict[int, str] = {}
    pending = set(numbers_of)
    while pending:
        ended, pending = wait(pending, POLL, FIRST_COMPLETED)
        for job in ended:
            attempt = worker_pool.outcome(job)
            solved, problems = attempt.value or ({}, {})
            results |= solved
            faults |= dict.fromkeys(numbers_of[job], attempt.fault) | problems
        with suppress(OSError):  # of a full disk: records may still fit
            _write_table(sweep, rows)
        progress.jobs(len(rows), total)
    without_record = faults.keys() - store.done(sweep.folder)
    return {number: faults[number] or LOST_RECORD for number in without_record}


def split_among_workers(numbers: Sequence[int], groups: int, workers: int) -> list[Sequence[int]]:
    """The numbers of the scenes of one group, split into as many parts as there are processes for
    each group. groups: number of groups; workers: number of processes. Each process makes the mesh
    of the whole group again, as it would otherwise wait for that mesh.
    """
    parts = min(len(numbers), max(1, workers // max(1, groups)))
    return [numbers[first::parts] for first in range(parts)]


def _solve(
    folder: Path,
    over: Mapping[int, tuple[Mapping[str, object], Mapping[str, str]]],
    group: Mapping[int, Plan],
    vtu: bool,
    fields: bool,
    keep_results: bool,
) -> tuple[dict[int, Result], dict[int, str]]:
    """Solve scenes of a group in this process, and write for each its .vtu files (with `vtu`), its
    arrays (with `fields`) and then its record.

    over: of the scenes that are solved, values of the changing keys and names of files, by number.
    group: plans by number. Returns results by number (with `keep_results`), and reasons by number
        for scenes without a record: not enough free memory now.
    """
    results: dict[int, Result] = {}
    faults: dict[int, str] = {}
    solved = runner.solve_group(group, over, Progress(quiet=True), MPI.COMM_SELF)
    for number, result in solved:
        if isinstance(result, NoMemoryError):  # another time it may fit
            faults[number] = str(result)
            continue
        if vtu and not isinstance(result, Exception):
            grids = store.vtu_folder(folder, number)
            grids.mkdir(parents=True, exist_ok=True)
            files.write_grids(result.solved, files.nodal_stress(result.solved), grids)
            result_folder.stamp(grids)
        if fields and not isinstance(result, Exception) and result.summary["result"]:
            store.write_fields(folder, number, result.contact_points)
        if keep_results and not isinstance(result, Exception):
            results[number] = result
        store.write(folder, number, sweep_table.record(over[number][0], result, over[number][1]))
    process.release_memory()
    return results, faults


def _write(
    sweep: ParallelSweep,
    rows: dict[int, Row],
    results: dict[int, Result],
    faults: Mapping[int, str],
    y_label: str,
    *,
    pictures: bool,
) -> Outcome:
    """Write the table beside the records. With `pictures` write report.html, and PNG files where at
    most two keys are set or the scenes are rows of a table. With `sweep.vtu` write .pvd files, for
    ParaView, of the scenes that passed. Older pictures and reports are deleted in any case.

    rows: of the table, by number of the scene from 0; completed in place. results: of the outcome.
        faults: reasons by number for scenes without a record, which get a row with it. y_label:
        label of y in the pictures.
    """
    from railhead.postprocess import vtu

    grid, folder, failures = sweep.grid, sweep.folder, list[str]()

    def attempt(name: str) -> AbstractContextManager[None]:
        """Context in which a file is written; it keeps an error as a line."""
        return result_folder.attempt(failures, folder / name, folder)

    done = store.done(folder)
    for number in faults.keys() - done:
        again = sweep_table.record(
            sweep.values(number), RuntimeError(faults[number]), grid.names[number]
        )
        rows[number] = sweep_table.row(again)
        with suppress(OSError):  # of a full disk
            store.write(folder, number, again, again=True)
    _write_table(sweep, rows)
    outcome = Outcome([row for _, row in sorted(rows.items())], failures, results)
    status = outcome.status
    for name in store.SERIES if sweep.vtu else ():
        files = {
            sweep.times[number]: f"{store.vtu_folder(Path(), number)}/{name}.vtu"
            for number, text in status.items()
            if text == sweep_table.PASSED
        }
        vtu.series(files, folder / f"{name}.pvd")
    for name in (*store.PICTURES, sweep_table.REPORT):
        for suffix in (Path(name).suffix, *store.BESIDE):
            (folder / name).with_suffix(suffix).unlink(missing_ok=True)
    keys = [column(key) for key in grid.keys]
    title = f"sweep of {grid.scenes[0].name} over {' and '.join(grid.keys)}"
    if pictures:
        outlines = [
            store.read(folder, number).get("outlines", []) if number in done else []
            for number in status
        ]
        from railhead.postprocess.pictures import sweep_plots as plots

        subject = Subject(title, units=sweep.units)
        drawings = plots.drawings(keys, outcome.rows, outlines, y_label, subject)
        result_folder.draw(drawings, folder, attempt)
    if sweep.fields:
        with attempt(f"{store.FIELDS}.npz"):
            store.join_fields(folder)
    with attempt(""):
        result_folder.stamp(folder)
    if pictures:
        with attempt(sweep_table.REPORT):
            sweep_table.write_report(
                title, grid.scenes, keys, outcome.rows, folder, store.PICTURES, sweep.units
            )
    return outcome


def _write_table(sweep: ParallelSweep, rows: dict[int, Row]) -> None:
    """Add the rows of the scenes that have a record and no row yet, and write sweep.csv if there
    are any, or if every scene has a row.
    """
    new = store.done(sweep.folder) - rows.keys()
    for number in new:
        rows[number] = sweep_table.row(store.read(sweep.folder, number))
    if new or len(rows) == len(sweep.grid.scenes):
        table = result_folder.encoded(row for _, row in sorted(rows.items()))
        store.write_whole(sweep.folder, sweep.folder / store.TABLE, table)
