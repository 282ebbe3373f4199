"""Scenes solved side by side, a record of each in a folder, a table and pictures."""

import json
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpi4py import MPI

from railhead.contact import head_loads
from railhead.meshing.mesh import MeshError
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import BASE_UNITS, Units
from railhead.results import pipeline, result_folder
from railhead.results.result import Result
from railhead.run import process
from railhead.run.progress import Progress, Tell, show_progress
from railhead.scene.catalogue import as_path, copy_files, places, portable
from railhead.scene.scene import Scene, SceneError, checked, warn_of_units
from railhead.scene.sections import ArgumentError, refuse_first
from railhead.sweeps import runner, store, sweep_table, worker_pool
from railhead.sweeps.grid import ParameterGrid, parse_values
from railhead.sweeps.sampling import SEED
from railhead.sweeps.sweep_table import Sweep

TABLE, SAMPLE = "sweep.csv", "sample.json"
WORST = [f"worst_{number}.toml" for number in range(1, 6)]  # scenes of the largest pressures
DRAWN = sweep_table.REPORT, sweep_table.MAP, sweep_table.PICTURE
LATER = (TABLE, SAMPLE, *WORST, *DRAWN)
"""Names of what is written into the folder of a sweep."""
POLL = 0.5  # s between two looks at the finished jobs
ROWS = "rows of a file"  # stands for the values of a key that has no law
LOST_RECORD = "its record is gone: something else has written into the folder"


@dataclass(frozen=True, kw_only=True)
class ParallelSweep:
    """What is solved, and what is kept of it.

    grid: the scenes.
    folder: folder of records, table and pictures.
    units: of pictures and report.
    """

    grid: ParameterGrid
    folder: Path
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
        """Everything that determines the records: "railhead" (version), "scene" and "over" (values
        by key). Files are named by their places in the folder, which hold the first digits of their
        SHA-256. Raises OSError where a file cannot be read.
        """
        rows = [self.values(number) for number in range(len(self.grid.scenes))]
        over = {key: [row[key] for row in rows] for key in self.grid.keys}
        if not self.grid.listed:
            over = {key: list(dict.fromkeys(values)) for key, values in over.items()}
        if (laws := self.grid.laws) is not None:  # records tell whether rows are those of before
            over = {key: [laws.get(key, ROWS)] for key in over}
        return {
            "railhead": result_folder.VERSION,
            "scene": portable(self.grid.base),
            "over": over,
            **({"sample": {"seed": SEED, "sobol": self.grid.sobol}} if laws is not None else {}),
        }


def run(
    sweep: ParallelSweep,
    *,
    pictures: bool,
    quiet: bool,
    other: store.Other = "refuse",
    tell: Tell | None = None,
) -> Sweep | None:
    """Solve the scenes of a sweep that have no record yet, side by side, and write table and
    pictures; under MPI called on all ranks. `Sweep.failures` has what could not be drawn.

    other: what happens to another result in the folder (`store.begin`).
    pictures: whether PNG files and report.html are written.
    quiet: whether no progress is shown. tell: as of `Progress`.
    Returns None on all MPI ranks but the first, which solve scenes. Raises SceneError before
    anything is solved, OSError where nothing can be written.
    """
    meshed = any(scene.effects.finite_bodies != "off" for scene in sweep.grid.scenes)
    with ExitStack() as stack:
        progress = stack.enter_context(show_progress(quiet=quiet, tell=tell))

        def solve(submit: worker_pool.Submit) -> Sweep:
            """Plan all scenes, get the folder ready for their records, and solve them."""
            refused: dict[int, SceneError] | None = None if sweep.grid.laws is None else {}
            plans = runner.plan_all(sweep.grid, progress, submit, refused)
            stack.enter_context(result_folder.claimed(sweep.folder))
            store.begin(sweep.folder, sweep.request, other, LATER)
            copy_files(map(Path, sweep.files), sweep.folder)
            _check_records(sweep)
            for number, error in (refused or {}).items():
                over = sweep.values(number), sweep.grid.names[number]
                store.write(sweep.folder, number, sweep_table.record(*over, error))
            _solve_all(sweep, plans, submit, progress)
            return Sweep(sweep.folder)

        jobs = worker_pool.JOBS_PER_PROCESS if meshed else 0
        found = worker_pool.on_first(MPI.COMM_WORLD, solve, jobs)
        if found is not None:
            _write(sweep, found, pictures=pictures)
        return found


def _check_records(sweep: ParallelSweep) -> None:
    """Remove the records of scenes that have no result: they are tried again. Raises SceneError for
    the first other one that cannot be read or does not belong to its scene.
    """
    for number, (record, _) in sweep_table.records(sweep.folder).items():
        path = store.record_path(sweep.folder, number)
        if sweep.grid.laws is not None and number >= len(sweep.grid.scenes):
            raise ArgumentError("sample", f"{str(sweep.folder)!r} has more samples; give as many")
        if record["fault"]:
            path.unlink()
        elif number >= len(sweep.grid.scenes) or record["over"] != json.loads(
            result_folder.to_json(sweep.values(number))
        ):
            if sweep.grid.laws is None:
                raise store.broken(path)
            text = f"{str(sweep.folder)!r} has another sample {number}; {store.ADVICE}"
            raise ArgumentError("folder", text)


def _solve_all(
    sweep: ParallelSweep, plans: Mapping[int, Plan], submit: worker_pool.Submit, progress: Progress
) -> None:
    """Let other processes solve the scenes that have no record, one a job, and wait. A scene that
    still has no record then, as its process crashed, gets one with the reason.

    plans: of all scenes that make a contact problem, by number. submit: starts a job. OSError: a
        reason cannot be written.
    """
    folder, names, done = sweep.folder, sweep.grid.names, store.done(sweep.folder)
    over = {number: (sweep.values(number), names[number]) for number in plans.keys() - done}
    progress.jobs(len(done), len(sweep.grid.scenes))
    jobs: dict[worker_pool.Job, int] = {
        submit(_solve, folder, number, over[number], plans[number]): number
        for number in sorted(over)
    }
    while jobs:
        for job in wait(jobs, POLL, FIRST_COMPLETED).done:
            number, fault = jobs.pop(job), worker_pool.outcome(job).fault or LOST_RECORD
            if number not in store.done(folder):
                lost = sweep_table.record(*over[number], RuntimeError(fault))
                store.write(folder, number, lost)
        progress.jobs(len(store.done(folder)), len(sweep.grid.scenes))


def _solve(
    folder: Path,
    number: int,
    over: tuple[Mapping[str, object], Mapping[str, str]],
    plan: Plan,
) -> None:
    """Solve a scene in this process, and write its record.
    over: values of the changing keys, and names of files.
    """
    result: Result | Exception
    try:
        result = pipeline.solve(plan, Progress(quiet=True), MPI.COMM_SELF)
    except (MeshError, SceneError) as error:
        result = error
    store.write(folder, number, sweep_table.record(*over, result))
    process.release_memory()


def _write(sweep: ParallelSweep, found: Sweep, *, pictures: bool) -> None:
    """Write the table beside the records. With `pictures` write report.html, and PNG files where at
    most two keys are set or the scenes are rows of a table. Older pictures and reports are deleted
    in any case.

    found: rows of all scenes; its failures are added to.
    """
    folder = sweep.folder

    def attempt(name: str) -> AbstractContextManager[None]:
        """Context in which a file is written; it keeps an error as a line."""
        return result_folder.attempt(found.failures, folder / name, folder)

    store.write_whole(folder, folder / TABLE, result_folder.encoded(found.rows()))
    over = found.as_dict().get(store.TRANSFER)
    whole = result_folder.to_json(sweep.request | ({store.TRANSFER: over} if over else {}))
    store.write_whole(folder, folder / store.REQUEST, whole.encode())
    if sweep.grid.laws is not None:
        store.write_whole(folder, folder / SAMPLE, result_folder.to_json(found.sample).encode())
        for name, number in zip(WORST, found.worst(), strict=False):
            text = result_folder.scene_toml("run", sweep.grid.scenes[number])
            store.write_whole(folder, folder / name, text.encode())
    for name in DRAWN:
        (folder / name).unlink(missing_ok=True)
    if pictures:
        result_folder.draw(found.drawings(sweep.units), folder, attempt)
    if pictures:
        with attempt(sweep_table.REPORT):
            found.write_report(folder, sweep.grid.scenes, sweep.units)


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[object]] | None = None,
    /,
    *,
    sample: int | None = None,
    sobol: bool = False,
    out: str | Path | None = None,
    quiet: bool = False,
    progress: Tell | None = None,
    **values: Sequence[object],
) -> Sweep:
    """Solve a scene for every combination of values, or samples of it, a process a core, as
    `railhead sweep`.

    over: lists of values by key, for keys with a dot: ``{"wheelset.shift": [0, 2]}``.
    sample: number of samples; values are laws then, ``load="lognormal(10kN, 0.2)"``, and `sample`
        of the answer has what they say together. sobol: whether that has shares of variance.
    out: folder for the files of `railhead sweep`, which a repeated call goes on with; None: no
        files.
    quiet: whether no progress is shown on standard error.
    progress: as of `railhead.solve`, e.g. (8.1, "3 of 50 done, 0:02:10 left").
    values: lists of values by key: ``load=["25 kN", "50 kN"]``.
    Results have numbers, no arrays. Under MPI, call this on all ranks. Raises SceneError for a
    wrong scene or folder, before any scene is solved, OSError where files cannot be written, after
    the others are. A combination that cannot be meshed or does not fit into the memory has the
    reason in its row.
    """
    if sample is None:
        lists = head_loads.refined(checked(scene), _lists(over, values))
        grid = ParameterGrid.combine(scene, lists)
    else:
        laws = parse_values([f"{key}={text}" for key, text in {**(over or {}), **values}.items()])
        grid = ParameterGrid.sampled(checked(scene), laws, [], sample, sobol=sobol)
    warn_of_units(*grid.scenes)
    comm = MPI.COMM_WORLD
    with tempfile.TemporaryDirectory() as temporary:
        folder = as_path(comm.bcast(temporary) if out is None else out, "out")
        result_folder.check_folder(folder)
        task = ParallelSweep(grid=grid, folder=folder)
        own = run(task, pictures=out is not None, quiet=quiet, tell=progress)
    found: Sweep = comm.bcast(own)
    if own is not None and own.failures:
        raise OSError("\n".join(own.failures))
    return found


def _lists(
    over: Mapping[str, Sequence[object]] | None, values: Mapping[str, Sequence[object]]
) -> dict[str, Sequence[object]]:
    """Lists of values by key from a mapping and from keyword arguments. Raises SceneError for
    anything that is no mapping of keys to lists, and for a key in both.
    """
    given = {} if over is None else over
    if not isinstance(given, Mapping):
        raise SceneError("over", f"{over!r} is not a mapping of keys to lists of values; give one")
    lists = {**given, **values}
    refuse_first(
        *((key in values, key, "is given twice; give one list of values") for key in given),
        *((not isinstance(key, str), "over", f"{key!r} is no key; give a word") for key in lists),
        *(
            (
                isinstance(chosen, str) or not isinstance(chosen, Iterable),
                key,
                f"{chosen!r} is not a list of values; give one",
            )
            for key, chosen in lists.items()
        ),
    )
    return {key: list(chosen) for key, chosen in lists.items()}
