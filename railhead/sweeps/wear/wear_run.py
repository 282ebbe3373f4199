"""The route of a scene and its wear, step by step, with a record of each step in a folder.

A route has positions that wear the same profiles, each with its share.

The route is solved twice. The coarse run chooses the steps. The main run halves them, has twice as
many cells each way, and three times as many knots of the worn depth. It is the answer; the
difference between both is its error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter

from railhead.contact import solid
from railhead.geometry.profiles import Places, flange_thickness
from railhead.half_spaces import worn_contact
from railhead.half_spaces.worn_contact import (
    BODIES,
    Fields,
    Fineness,
    Position,
    Seen,
)
from railhead.planning import simulation_plan as planning
from railhead.run.progress import Progress
from railhead.scene.files import wear_pairs
from railhead.scene.quantities import GROUPS
from railhead.scene.scene import Scene, SceneError, checked
from railhead.scene.sections import refuse_first
from railhead.sweeps import store, worker_pool
from railhead.sweeps.grid import read_rows
from railhead.theory import wear
from railhead.theory.array_types import Array
from railhead.theory.wear import Stage, WearLaw

Grid = tuple[int, float]
"""Cells each way, and knots over the smallest half width of a patch."""
RUNS: dict[str, Grid] = {"coarse": (48, 7.5), "main": (96, 15.0)}
QUICK = (24, 4.0)  # before the first step
CHANGE = 0.55  # of the rate in a step, over the root of the accuracy: errors fall as its square
DEEP = 20.0  # mm, a depth that no wheel or rail has to give
NOTHING = 1e-5  # mm, a depth that no one measures
LIGHT, HEAVY = 1e-9, 1e9  # shares that a table may give
APART = 10_000  # numbers of records from one run to the next
LARGEST, SUMMED = ("pressure", "index"), ("energy", "damage", "rate")
SHARE, AMOUNT = "share", {"rail": "axles", "wheel": "distance"}
FILE_KEYS = (
    *(f"profile_{key}" for key in ("unit", "mirror", "flip", "origin", "shift")),
    "smoothing",
)
SHAPE = {
    "rail": ("profile", "crown_radius", "inclination", "width", *FILE_KEYS),
    "wheel": ("profile", "transverse_radius", "rolling_radius", "tape_circle", *FILE_KEYS),
}
"""Keys of the shape of a body, which must be the same in all positions where it is worn."""
PHYSICS = ("finite_bodies", "rail_section", "plasticity", "plasticity_wheel", "heat")
"""Effects that are named where plans call for them."""
TIRES = ("fatigue",)
"""Quantities of a route whose stresses of fatigue are found, too."""
NO_SOLID = "wear needs the profiles of a rail and of a wheel, not half-spaces or a section"


@dataclass(frozen=True, kw_only=True)
class Route:
    """Positions that wear the profiles of a scene.

    scene: the scene, with its table [wear].
    positions: with their parts of the passages.
    shares: of all passages, one a position; their sum is 1.
    left_out: why effects are called for that wear leaves out, of the first such position, by name.
    yields: elastic von Mises stress over the yield stress, by index of the positions whose steel
        yields, unless effects.plasticity is off.
    """

    scene: Scene
    positions: tuple[Position, ...]
    shares: tuple[float, ...]
    left_out: dict[str, str]
    yields: dict[int, float] = field(default_factory=dict)

    @property
    def tires(self) -> bool:
        """Whether the stresses of fatigue are asked for, by quantities = "fatigue"."""
        return self.scene.quantities == TIRES

    @property
    def worn(self) -> list[str]:
        """Names of the bodies that are worn, 'rail' and 'wheel'."""
        return [body for body in BODIES if self.scene.wear.on in (body, "both")]


def read(scene: Scene) -> Route:
    """The route of a scene. Raises SceneError for a table [wear], a file of positions or a position
    that cannot be used.
    """
    given = checked(scene).wear
    worn = [body for body in BODIES if given.on in (body, "both")]
    for body, key in AMOUNT.items():
        if (body in worn) != (getattr(given, key) is not None):
            needed = f"is not given; wear.on = {given.on} needs it"
            text = needed if body in worn else f"is not allowed beside wear.on = {given.on}"
            raise SceneError(f"wear.{key}", text)
    if given.flange_limit is not None:
        wheel = worn_contact.places(scene)["wheel"].points
        if "wheel" not in worn or flange_thickness(wheel, solid.tape_circle(scene)) is None:
            raise SceneError("wear.flange_limit", "needs a wheel that has a flange and is worn")
    laws = {"energy": WearLaw.of_energy(given.rate), "usfd": WearLaw(wear.USFD)}
    law = laws.get(given.law) or WearLaw(wear_pairs(given.law))
    rows = _rows(scene)
    weights = [_weight(row.pop(SHARE, 1.0), number) for number, row in enumerate(rows, 1)]
    shares = tuple(weight / math.fsum(weights) for weight in weights)
    positions: list[Position] = []
    left_out: dict[str, str] = {}
    yields: dict[int, float] = {}
    for number, (row, share) in enumerate(zip(rows, shares, strict=True), 1):
        try:
            position = scene.replace(**{"effects.finite_bodies": "off", **row})
            _refuse(position, scene, worn)
            plan = planning.make(position)
            refuse_first((not plan.contact.curved_solid, "rail.extent", NO_SOLID))
        except SceneError as error:
            where = f" (position {number})" if given.positions else ""
            raise SceneError(error.key, f"{error.text}{where}") from None
        for name in PHYSICS:
            effect = plan.effects[name]
            if effect.called_for and not effect.on:
                cost = f"; it may change a quantity by {effect.error:.1%}" if effect.error else ""
                left_out.setdefault(name, f"{effect.why}{cost}")
        if plan.effects["plasticity"].called_for and position.effects.plasticity != "off":
            yields[number - 1] = plan.context.over_yield
        axles, distance = share * (given.axles or 0.0), share * (given.distance or 0.0)
        positions.append(
            Position(scene=position, hertz=plan.hertz, law=law, axles=axles, distance=distance)
        )
    every = tuple(positions)
    return Route(scene=scene, positions=every, shares=shares, left_out=left_out, yields=yields)


def _rows(scene: Scene) -> list[dict[str, object]]:
    """Rows of values by dotted key of the route of a scene; one without values where it has none.
    Raises SceneError for a file that is no such table.
    """
    if scene.wear.positions is None:
        return [{}]
    try:
        rows = read_rows(Path(scene.wear.positions))
    except SceneError as error:
        raise SceneError("wear.positions", error.text) from None
    if own := [key for key in rows[0] if key.startswith("wear.")]:
        text = f"{own[0]} is of the whole route; give it in the scene, not in a position"
        raise SceneError("wear.positions", text)
    return rows


def _weight(value: object, number: int) -> float:
    """The share of a position. Raises SceneError for no number, and one out of range."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not LIGHT <= value <= HEAVY:
        text = f"share {value!r} of position {number} is not allowed; give {LIGHT:g} to {HEAVY:g}"
        raise SceneError("wear.positions", text)
    return float(value)


def _refuse(position: Scene, base: Scene, worn: Sequence[str]) -> None:
    """Raise SceneError for a position that does not roll with friction under a load, or with
    another shape of a body that is worn than in the base scene.
    """
    rolling = position.rolling
    refuse_first(
        (position.load is None, "load", "is not given; wear needs it"),
        (not rolling.prescribed, "rolling", "is not given; wear needs creepages, spin or a force"),
        (position.effects.friction == "off", "effects.friction", "off is not allowed in wear"),
        (rolling.passes is not None, "rolling.passes", "is not allowed in wear; leave it out"),
        (
            {*position.quantities} != {*GROUPS} and position.quantities != TIRES,
            "quantities",
            f"{','.join(position.quantities)} is not allowed in wear; give fatigue or leave it out",
        ),
        *(
            (part.surface is not None, f"{body}.surface", "is not allowed in wear; leave it out")
            for body, part in position.bodies.items()
        ),
        *(
            (
                position.value(f"{body}.{key}") != base.value(f"{body}.{key}"),
                f"{body}.{key}",
                f"must be the same in all positions, as the {body} is worn",
            )
            for body in worn
            for key in SHAPE[body]
        ),
    )


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """Numbers of the contacts of all positions at a stage, as of `Seen`.

    values: of each position.
    rises: of each position.
    deepest: largest depth that all positions wear in all passages at this rate, mm.
    alone: the part of it that one position wears.
    """

    values: list[dict[str, float]]
    rises: list[float]
    deepest: float
    alone: float


@dataclass(frozen=True, kw_only=True)
class Contacts(Numbers):
    """The contacts of all positions at a stage; fields are those of `Seen`.

    others: of each position (positions, 2, n): 'rate' of all others over its own 'force', mm2/N.
    fields: by name (2, n), of all positions: 'pressure' and 'index' the largest, 'energy', 'damage'
        and 'rate' the sum.
    """

    others: Array
    fields: Fields


STAGE, NUMBERS = TypeAdapter(dict[str, float]), TypeAdapter(Numbers)  # of a record


@dataclass(kw_only=True)
class Run:
    """One solution of a route.

    route: the route.
    fineness: its grids.
    submit: starts a job of another process; None: all is done here.
    stages: worn depths (2, n) of rail and wheel, from the new profiles on.
    seen: the contacts at each of the stages; of a run that goes on or has stopped, at all but the
        last.
    reason: why it ended early; empty where it did not.
    """

    route: Route
    fineness: Fineness
    submit: worker_pool.Submit | None
    stages: list[Stage]
    seen: list[Contacts] = field(default_factory=list)
    reason: str = ""

    @classmethod
    def begun(cls, route: Route, grid: Grid, submit: worker_pool.Submit | None = None) -> Run:
        """A run on new profiles."""
        cells, knots = grid
        half = min(position.hertz.b for position in route.positions)
        new = np.zeros((len(BODIES), worn_contact.PLACES))
        stages = [Stage(0.0, new, 0.0, wear.FIRST)]
        fineness = Fineness(cells=cells, knots=half / knots)
        return cls(route=route, fineness=fineness, submit=submit, stages=stages)

    @cached_property
    def places(self) -> dict[str, Places]:
        """Places along the new profiles of 'rail' and 'wheel'."""
        return worn_contact.places(self.route.scene)

    @property
    def depths(self) -> Fields:
        """Worn depth (n,) of 'rail' and 'wheel' at the end, mm."""
        return dict(zip(BODIES, self.stages[-1].depth, strict=True))

    def advance(self, depth: Array, share: float) -> tuple[Array, float]:
        """As of `wear.Advance`; the contacts at the start of a step are kept. A change of half the
        area that a step wears is 1.
        """
        contacts, worn = self.contacts(depth, share)
        self.seen[len(self.stages) - 1 :] = [contacts]
        pairs, width = zip(self.places.values(), worn, strict=True), self.fineness.width
        after = np.array([wear.averaged(each, along.step, width) for along, each in pairs])
        change = np.abs(after - share * contacts.fields["rate"]).sum() / after.sum()
        return depth + worn, float(change)

    def contacts(self, depth: Array, share: float) -> tuple[Contacts, Array]:
        """Contacts of all positions at a depth, solved side by side, and the depth that all wear in
        a share of the passages from there. Raises ValueError as of `worn_contact.WornContact`.
        """
        positions = self.route.positions
        count, known = len(positions), self.seen[-1] if self.seen else None
        others = np.zeros((count, *depth.shape)) if known is None else known.others
        rises = [0.0] * count if known is None else known.rises
        before = [(0.0, 0.0)] * count
        if len(self.stages) > 1:
            (start, end), seen = self.stages[-2:], self.seen[len(self.stages) - 2]
            before = [(each["t_gamma_N"], end.done - start.done) for each in seen.values]
        jobs = [
            (position, self.fineness, depth, each, share, *more)
            for position, each, *more in zip(positions, rises, others, before, strict=True)
        ]
        answers = list(worker_pool.together(self.submit, worn_contact.solve, jobs))
        return _joined([each for each, _ in answers]), np.sum([w for _, w in answers], axis=0)

    def write(self, folder: Path, number: int) -> None:
        """Write the record of the last stage, with the contacts of the stage before. number: of the
        record. OSError: it cannot be written.
        """
        stage, contacts = self.stages[-1], self.seen[-1]
        record = {
            "stage": {"done": stage.done, "change": stage.change, "share": stage.share},
            "seen": {name: getattr(contacts, name) for name in Numbers.__annotations__},
        }
        arrays = {"depth": stage.depth, "others": contacts.others, **contacts.fields}
        store.write(folder, number, record, arrays)

    def read(self, folder: Path, first: int) -> None:
        """Take the records of the run, whose numbers are those of its stages after `first`. Raises
        SceneError for one that is broken.
        """
        done = store.done(folder)
        while (number := first + len(self.stages)) in done:
            record, arrays = store.read(folder, number), store.read_arrays(folder, number)
            try:
                stage = Stage(depth=arrays.pop("depth"), **STAGE.validate_python(record["stage"]))
                others, given = arrays.pop("others"), NUMBERS.validate_python(record["seen"])
                _ = [*zip(self.route.positions, given.values, given.rises, others, strict=True)]
                _ = [each[name] for each in given.values for name in worn_contact.VALUES]
                seen = Contacts(others=others, fields=arrays, **vars(given))
            except (LookupError, TypeError, ValueError):
                raise store.broken(store.record_path(folder, number)) from None
            self.stages.append(stage)
            self.seen.append(seen)


def refuse_amount(route: Route) -> None:
    """Raise SceneError for wear that is deeper than profiles are at the rates of the new ones, and
    for none.
    """
    given, run = route.scene.wear, Run.begun(route, QUICK)
    try:
        deepest = run.contacts(run.stages[0].depth, 0.0)[0].deepest
    except ValueError:
        return  # they fail again, with their reason
    if deepest > DEEP:
        key = AMOUNT[route.worn[0]]
        text = f"{getattr(given, key):g} would wear {deepest:.3g} mm at the rates of the new "
        raise SceneError(f"wear.{key}", f"{text}profiles; give at most {DEEP / deepest:.2g} of it")
    if deepest < NOTHING:
        text = f"wears {deepest:.1g} mm, as hardly anything slips; give creepages or spin"
        raise SceneError("rolling", text)


def solve(
    route: Route,
    folder: Path,
    submit: worker_pool.Submit | None,
    progress: Progress,
    runs: Mapping[str, Grid] | None = None,
) -> dict[str, Run]:
    """The runs of a route by name, as far as the contacts of both are known. Stages with a record
    in the folder are not solved again. submit: as of `Run`. runs: grids by name; None: RUNS.
    """
    step, found = route.scene.wear.step, dict[str, Run]()
    ends = None if step == "auto" else [n / step for n in range(1, step + 1)]
    for number, (name, grid) in enumerate((runs or RUNS).items()):
        run = found[name] = Run.begun(route, grid, submit)
        run.read(folder, APART * number)
        try:
            for stage in _stages(run, ends):
                run.stages.append(stage)
                run.write(folder, APART * number + len(run.stages) - 1)
                of = "" if ends is None else f" of {len(ends)}"
                half = "half " * number
                progress.stage(
                    f"run {number + 1} of 2 ({name}): {half}step {len(run.stages) - 1}{of}, "
                    f"{stage.done:.1%} worn"
                )
            end = run.stages[-1]
            seen, owed = run.contacts(end.depth, 0.0)
            run.seen.append(seen)
            run.stages[-1] = replace(end, depth=end.depth + owed)
        except ValueError as error:
            run.reason = " ".join(str(error).split())
        done = [stage.done for stage in run.stages]
        ends = [end for pair in pairwise(done) for end in (sum(pair) / 2, pair[1])]
    coarse, main = found.values()
    steps = max(min(len(coarse.seen), (len(main.seen) + 1) // 2) - 1, 0)
    for run, last in ((coarse, steps), (main, 2 * steps)):
        del run.stages[last + 1 :], run.seen[last + 1 :]
    return found


def _stages(run: Run, ends: Sequence[float] | None) -> Iterator[Stage]:
    """The stages of a run after its last one, with steps to given shares of all passages; None:
    with steps that are chosen. Raises ValueError as of `Run.contacts`.
    """
    last, given = run.stages[-1], run.route.scene.wear
    if not run.seen:  # what the others wear in the first step
        run.seen.append(run.contacts(last.depth, 0.0)[0])
        share = min(wear.FIRST, wear.DEEPEST / max(run.seen[0].deepest, 1e-9))
        last = replace(last, share=share)
    if ends is not None:
        return wear.march(run.advance, last, [end for end in ends if end > last.done])
    return wear.march_freely(run.advance, last, CHANGE * math.sqrt(given.accuracy))


def _joined(seen: Sequence[Seen]) -> Contacts:
    """The contacts of all positions from those of each."""

    def rows(name: str) -> Array:
        """A field of all positions (positions, 2, n)."""
        return np.array([each.fields[name] for each in seen])

    rates = rows("rate")
    total = rates.sum(axis=0)
    place = int(total.argmax())
    deepest, every = float(total.flat[place]), rates.reshape(len(rates), -1)[:, place]
    return Contacts(
        values=[each.values for each in seen],
        rises=[each.rises for each in seen],
        others=(total - rates).clip(0.0) / rows("force"),
        deepest=deepest,
        alone=float(every.max()) / deepest if deepest > 0 else 0.0,
        fields={
            **{name: np.fmax.reduce(rows(name), axis=0) for name in LARGEST},
            **{name: rows(name).sum(axis=0) for name in SUMMED},
        },
    )
