"""A sweep as a command: combinations side by side, a record of each, a table and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

from railhead import __version__, loads, pool, records, refine, results, spreadsheet, sweep_table
from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.progress import Bar, Progress
from railhead.scene.scene import Scene, SceneError

POLL = 0.5  # s between looks at what is done
TABLE = "sweep.csv"
PASSED = sweep_table.PASSED


@dataclass(frozen=True)
class Campaign:
    """scenes: of all combinations; keys: dotted, those that change."""

    base: Scene
    scenes: Sequence[Scene]
    keys: Sequence[str]
    folder: Path

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
        """All that decides the numbers."""
        over = {key: [each.value(key) for each in self.scenes] for key in self.keys}
        return {
            "railhead": __version__,
            "scene": self.base.model_dump(exclude_none=True),
            "over": {key: list(dict.fromkeys(values)) for key, values in over.items()},
        }


def run(campaign: Campaign, *, resume: bool, pictures: bool, quiet: bool) -> list[str] | None:
    """Solve what is not done yet and write table and pictures. Returns the status of each
    combination, on the first rank; None on the others, which work for it. Raises SceneError before
    anything is solved, OSError where nothing can be written."""
    comm = MPI.COMM_WORLD
    groups: list[list[int]] = []
    problem: Exception | None = None
    if comm.rank == 0:
        try:
            groups = loads.groups(_plans(campaign, quiet))
            records.begin(campaign.folder, campaign.asked, resume=resume)
        except (SceneError, OSError) as error:
            problem = error
    if (problem := comm.bcast(problem)) is not None:
        raise problem
    with pool.submitting(comm.size) as submit:
        if submit is None:
            return None
        finished = len(records.done(campaign.folder))
        with Bar(len(campaign.scenes), done=finished, quiet=quiet) as bar:
            faults = _solve_all(campaign, groups, submit, bar)
            # What was to be solved after the one that crashed, each by itself.
            lost = [[number] for group in groups if len(group) > 1 for number in group]
            again = [each for each in lost if each[0] in faults]
            faults |= _solve_all(campaign, again, submit, bar)
    return _write(campaign, faults, pictures=pictures)


def _solve_all(
    campaign: Campaign, groups: Sequence[Sequence[int]], submit: pool.Submit, bar: Bar
) -> dict[int, str]:
    """Solve what has no record of groups that share a mesh; why some of them still have none."""
    folder, scenes = campaign.folder, campaign.scenes
    finished, jobs = records.done(folder), {}
    for group in groups:
        wanted = [place for place, number in enumerate(group) if number not in finished]
        if wanted:
            chosen = [scenes[number] for number in group]
            jobs[submit(_solve, folder, group, chosen, wanted)] = [group[each] for each in wanted]
    faults: dict[int, str] = {}
    pending = set(jobs)
    while pending:
        ended, pending = wait(pending, POLL, FIRST_COMPLETED)
        for job in ended:
            faults |= dict.fromkeys(jobs[job], pool.outcome(job).fault)
        bar.reach(len(records.done(folder)))
    return {number: faults[number] for number in faults.keys() - records.done(folder)}


def _solve(
    folder: Path, group: Sequence[int], scenes: Sequence[Scene], wanted: Sequence[int]
) -> None:
    """In a process of its own: solve and keep a record of each."""
    for place, found in loads.run(scenes, wanted, Progress(quiet=True), MPI.COMM_SELF):
        records.write(folder, group[place], sweep_table.record(found))


def _write(campaign: Campaign, faults: Mapping[int, str], *, pictures: bool) -> list[str]:
    """Table and pictures, beside the records; faults: of what may have none."""
    from railhead.postprocess import sweep_plots

    done = records.done(campaign.folder)
    kept = [
        records.read(campaign.folder, number) if number in done else {"fault": faults[number]}
        for number in range(len(campaign.scenes))
    ]
    values = [campaign.values(number) for number in range(len(kept))]
    rows = [sweep_table.row(*each) for each in zip(values, kept, strict=True)]
    with results.replacing(campaign.folder) as work:
        records.keep(campaign.folder, work)
        (work / TABLE).write_bytes(spreadsheet.encoded(rows))
        if pictures and 1 <= len(campaign.keys) <= 2:
            columns = [sweep_table.column(key) for key in campaign.keys]
            title = f"sweep of {campaign.scenes[0].name} over {' and '.join(campaign.keys)}"
            sweep_plots.curves(columns, rows, work / "sweep.png", title)
            outlines: list[Any] = [each.get("outlines", []) for each in kept]
            sweep_plots.patches(columns, rows, outlines, work / "patches.png", title)
    return [row[sweep_table.CHECKS] for row in rows]


def _plans(campaign: Campaign, quiet: bool) -> list[Plan]:
    """Of all scenes: what makes no contact problem is refused before anything is solved."""
    made = []
    with refine.telling(quiet=quiet) as progress:
        for number, scene in enumerate(campaign.scenes):
            if number % 10 == 0:
                progress.stage(f"planning {number + 1} of {len(campaign.scenes)}")
            try:
                made.append(planning.make(scene))
            except SceneError as error:
                raise SceneError(error.key, f"{error.text} ({campaign.name(number)})") from None
    return made
