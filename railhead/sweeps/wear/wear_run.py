"""Wear over a route, step by step, with a record of each step in a folder.

The route is solved three times: with its own steps, with these on a grid that is half as fine, and
there with steps half as long. The differences are the errors. The last contacts are those on the
profiles as they are written, which a reader of these finds again.
"""

from __future__ import annotations

import io
import math
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from railhead.run.half_spaces import worn_contact
from railhead.run.half_spaces.worn_contact import BODIES, Fields, Fineness, Known, Seen
from railhead.run.progress import Progress
from railhead.scene.scene import SceneError
from railhead.sweeps import store, worker_pool
from railhead.sweeps.wear.wear_route import AMOUNT, Route
from railhead.theory import wear
from railhead.theory.array_types import Array
from railhead.theory.wear import Stage

FINE, COARSE = Fineness(places=4001, cells=96), Fineness(places=2001, cells=48)
RUNS = {"main": FINE, "coarse": COARSE, "halved": COARSE}
SETTLES = 0.03  # of the smallest approach: a depth by which halving a step may change the profile
QUICK = Fineness(places=1001, cells=24)
DEEP = 20.0  # mm, a depth that no wheel or rail has to give
DEPTH = 0.1  # mm that a step takes, about, over the root of the accuracy
COST = 35.0  # processor time of a step in all runs, over that of the first contacts on QUICK
APART = 10_000  # numbers of records from one run to the next
LARGEST, SUMMED = ("pressure", "index"), ("energy", "damage")


@dataclass(frozen=True, kw_only=True)
class Contacts:
    """The contacts of all positions at a stage; fields are those of `Seen`.

    values: of each position.
    known: of each position.
    others: of each position (positions, 2, n): 'rate' of all others over its own 'force', mm2/N.
    deepest: largest depth that all positions wear in all passages at this rate, mm.
    fields: by name (2, n), of all positions: 'pressure' and 'index' the largest, 'energy' and
        'damage' the sum.
    """

    values: list[dict[str, float]]
    known: list[Known]
    others: Array
    deepest: float
    fields: Fields


@dataclass(kw_only=True)
class Run:
    """One solution of a route.

    fineness: its grids.
    stages: worn depths (2, n) of rail and wheel, from the new profiles on.
    seen: the contacts at each of the stages; of a run that goes on, at all but the last.
    reason: why it ended early; empty where it did not.
    """

    fineness: Fineness
    stages: list[Stage]
    seen: list[Contacts] = field(default_factory=list)
    reason: str = ""

    def depths(self, number: int = -1) -> Fields:
        """Worn depth (n,) of 'rail' and 'wheel' at a stage, mm."""
        return dict(zip(BODIES, self.stages[number].depth, strict=True))


def expected(route: Route) -> str:
    """Words that say about how many steps and minutes a route takes, from contacts on the new
    profiles. Raises SceneError for wear that is deeper than profiles are at their rates.
    """
    start, given = time.process_time(), route.scene.wear
    run = Run(fineness=QUICK, stages=[])
    first = _Marching(route, Path(), None, Progress(quiet=True), "", 0, run)
    try:
        deepest = first.contacts(np.zeros((len(BODIES), QUICK.places)), (), None)[0].deepest
    except ValueError:
        return "first contacts"  # they fail again, with their reason
    if deepest > DEEP:
        key = AMOUNT[route.worn[0]]
        text = f"{getattr(given, key):g} would wear {deepest:.3g} mm at the rates of the new "
        raise SceneError(f"wear.{key}", f"{text}profiles; give at most {DEEP / deepest:.2g} of it")
    steps = math.ceil(deepest / (DEPTH * math.sqrt(given.accuracy))) + 1
    if given.step != "auto":
        steps = given.step
    side_by_side = min(worker_pool.workers(1), len(route.positions))
    seconds = COST * steps * (time.process_time() - start) / side_by_side
    return f"about {steps} steps, {seconds / 60:.1g} min"


def solve(
    route: Route,
    folder: Path,
    submit: worker_pool.Submit | None,
    progress: Progress,
    runs: Mapping[str, Fineness] | None = None,
) -> dict[str, Run]:
    """The runs of a route by name, as far as they go. Stages with a record in the folder are not
    solved again.

    submit: starts a job of another process; None: all is done here.
    runs: grids by name; None: RUNS. After "coarse" steps are half as long. Beside it comes "again":
        the contacts on the worn profiles of the main run, on coarse cells.
    """
    given, found, ends = route.scene.wear, dict[str, Run](), None
    if given.step != "auto":
        ends = [n / given.step for n in range(1, given.step + 1)]
    for number, (name, fineness) in enumerate((runs or RUNS).items()):
        new = np.zeros((len(BODIES), fineness.places))
        run = Run(fineness=fineness, stages=[Stage(0.0, new, 0.0, wear.FIRST)])
        marching = _Marching(route, folder, submit, progress, name, APART * number, run)
        found[name] = marching.run(ends)
        ends = [stage.done for stage in found[name].stages[1:]]
        if name == "coarse":
            if not found["main"].reason:
                with suppress(ValueError):
                    found["again"] = marching.again(found["main"])
            ends = [
                end for n, end in enumerate(ends) for end in ((end + sum(ends[n - 1 : n])) / 2, end)
            ]
    return found


class _Marching:
    """One run of a route, whose records have numbers from `first` on."""

    def __init__(
        self,
        route: Route,
        folder: Path,
        submit: worker_pool.Submit | None,
        progress: Progress,
        name: str,
        first: int,
        run: Run,
    ) -> None:
        """As of `solve`; name: of the run, which has its first stage."""
        self._route, self._folder, self._submit = route, folder, submit
        self._progress, self._name, self._first, self._run = progress, name, first, run

    def run(self, ends: Sequence[float] | None) -> Run:
        """The run with steps to given shares of all passages; None: with steps that are chosen."""
        run = self._run
        self._read()
        last = run.stages[-1]
        try:
            if not run.seen:  # what the others wear in the first step
                run.seen.append(self.contacts(last.depth, (), None)[0])
                share = min(wear.FIRST, wear.DEEPEST / max(run.seen[0].deepest, 1e-9))
                last = replace(last, share=share)
            if ends is None:
                approach = min(position.hertz.approach for position in self._route.positions)
                accuracy, most = self._route.scene.wear.accuracy, SETTLES * approach
                steps = wear.march_freely(self._advance, last, accuracy, most)
            else:
                left = [end for end in ends if end > last.done]
                steps = wear.march(self._advance, last, left)
            for stage in steps:
                run.stages.append(stage)
                self._write()
            run.seen.append(self._as_written())
        except ValueError as error:
            run.reason = " ".join(str(error).split())
        return run

    def again(self, main: Run) -> Run:
        """The contacts on the worn profiles of another run, on the cells of this one. Raises
        ValueError as of `worn_contact.WornContact`.
        """
        fineness = replace(main.fineness, cells=self._run.fineness.cells)
        self._run = Run(fineness=fineness, stages=main.stages[-1:], seen=main.seen[-1:])
        return replace(self._run, seen=[self._as_written()])

    def _as_written(self) -> Contacts:
        """The contacts on the last profiles as they are written, with no lines of an earlier grid
        in between.
        """
        last = self._run.seen[-1]
        bare = replace(last, known=[replace(each, lines={}) for each in last.known])
        return self.contacts(self._run.stages[-1].depth, (), bare)[0]

    def _advance(self, depth: Array, shares: Sequence[float]) -> list[Array]:
        """As of `wear.Advance`; the contacts at the start of a step are kept."""
        contacts, worn = self.contacts(depth, shares, self._run.seen[-1])
        if len(shares) > 1:
            at = len(self._run.stages) - 1
            self._run.seen[at:] = [contacts]
            share = self._run.stages[-1].done
            pressure = max(each["pressure_max_MPa"] for each in contacts.values)
            text = f"{self._name} run: {share:.1%} worn, largest pressure {pressure:.5g} MPa"
            self._progress.stage(text)
        return [depth + each for each in worn]

    def contacts(
        self, depth: Array, shares: Sequence[float], known: Contacts | None
    ) -> tuple[Contacts, list[Array]]:
        """Contacts of all positions at a depth, and the depth that all wear in each of some shares
        of the passages from there. known: the contacts before; None at first.
        """
        positions, fineness = self._route.positions, self._run.fineness
        others = np.zeros((len(positions), *depth.shape)) if known is None else known.others
        begin = [Known()] * len(positions) if known is None else known.known
        jobs = [
            (position, fineness, depth, each, shares, other)
            for position, each, other in zip(positions, begin, others, strict=True)
        ]
        answers = _answers(jobs, self._submit)
        seen = [each for each, _ in answers]
        total = [np.sum([worn[n] for _, worn in answers], axis=0) for n in range(len(shares))]
        return _joined(seen), total

    def _write(self) -> None:
        """Write the record of the last stage, with the contacts of the stage before."""
        stage, contacts = self._run.stages[-1], self._run.seen[-1]
        number, file = self._first + len(self._run.stages) - 1, io.BytesIO()
        arrays = {"depth": stage.depth, "others": contacts.others, **contacts.fields}
        np.savez_compressed(file, **arrays)
        store.write_whole(self._folder, self._path(number), file.getvalue())
        entry = {key: value for key, value in asdict(stage).items() if key != "depth"}
        entry |= {
            "values": contacts.values,
            "deepest": contacts.deepest,
            "known": [asdict(each) for each in contacts.known],
        }
        store.write(self._folder, number, entry)

    def _path(self, number: int) -> Path:
        """File of the arrays of a record."""
        return self._folder / store.RECORDS / f"{number:05d}.npz"

    def _read(self) -> None:
        """Read the records of the run. Raises SceneError for one that is broken."""
        done = store.done(self._folder)
        while (number := self._first + len(self._run.stages)) in done:
            entry, path = store.read(self._folder, number), self._path(number)
            try:
                with np.load(path) as file:
                    arrays = dict(file)
                stage = Stage(entry["done"], arrays.pop("depth"), entry["change"], entry["share"])
                contacts = Contacts(
                    values=entry["values"],
                    known=[Known(**each) for each in entry["known"]],
                    others=arrays.pop("others"),
                    deepest=entry["deepest"],
                    fields=arrays,
                )
            except (OSError, LookupError, ValueError):
                raise store.broken(path) from None
            self._run.stages.append(stage)
            self._run.seen.append(contacts)


def _answers(
    jobs: Sequence[tuple[Any, ...]], submit: worker_pool.Submit | None
) -> list[tuple[Seen, list[Array]]]:
    """What `worn_contact.solve` returns for each of its arguments in turn, side by side. Raises
    ValueError with the reason of one that fails.
    """
    if submit is None:
        return [worn_contact.solve(*job) for job in jobs]
    futures = [submit(worn_contact.solve, *job) for job in jobs]
    found = []
    for attempt in [worker_pool.outcome(future) for future in futures]:
        if attempt.value is None:
            raise ValueError(attempt.fault)
        found.append(attempt.value)
    return found


def _joined(seen: Sequence[Seen]) -> Contacts:
    """The contacts of all positions from those of each."""

    def rows(name: str) -> Array:
        """A field of all positions (positions, 2, n)."""
        return np.array([each.fields[name] for each in seen])

    rates = rows("rate")
    total = rates.sum(axis=0)
    return Contacts(
        values=[each.values for each in seen],
        known=[each.known for each in seen],
        others=(total - rates).clip(0.0) / rows("force"),
        deepest=float(total.max()),
        fields={
            **{name: np.fmax.reduce(rows(name), axis=0) for name in LARGEST},
            **{name: rows(name).sum(axis=0) for name in SUMMED},
        },
    )
