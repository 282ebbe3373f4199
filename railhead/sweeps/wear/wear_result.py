"""The answer of a wear run: worn profiles, areas, pressures and damage, with errors and checks."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from railhead.contact import solid
from railhead.geometry import profiles
from railhead.geometry.placement import PlacementError
from railhead.geometry.wheelset import rolling_radii
from railhead.half_spaces import worn_contact
from railhead.half_spaces.worn_contact import BODIES, Fields
from railhead.results import checks
from railhead.results.checks import Check
from railhead.scene.catalogue import portable
from railhead.scene.scene import SceneError
from railhead.sweeps.wear.wear_run import RUNS, Route, Run
from railhead.theory.array_types import Array

ROW_STEP = 0.1  # mm between the rows of tables
AMPLITUDE, REACH = 3.0, 8.0  # mm: of the equivalent conicity, and of the shifts it is read from
VOLUME = 0.02  # relative: of the worn area, by the passages between two steps
LEAST = 0.003  # relative error that is always expected
OWN = {"flange_thickness_mm": 0.0, "pressure_max_MPa": 0.005}  # that of some numbers
FACTOR = 2.0  # of the change from the coarse run to the main one, an error
USEFUL = 0.25  # largest relative error of a pressure that says something
ALONE, THIN = 0.8, 2.0  # part of the wear of a place; depth of a groove, over the approach
EDGE = 2.0  # cells between a patch and the end of a profile, at least
STEEP = 0.2  # least y between two places of the worn profile, over that of the new one
KM, MILLION = 1e6, 1e6  # mm; wheels
DAMAGE_LAW = "T-gamma of a patch: 0 to 15 N, 1e-5 at 65 N, 0 from 175 N on (Burstow, from memory)"

GIVEN = ("done", "axles", "distance_km")
"""What rows of the history are given at."""
NUMBERS: dict[str, dict[str, tuple[int, str]]] = {
    "worn_mm2": {body: (-1, f"worn_{body}_mm2") for body in BODIES},
    "depth_max_mm": {body: (-1, f"depth_{body}_mm") for body in BODIES},
    "pressure_max_MPa": {"first": (0, "pressure_max_MPa"), "last": (-1, "pressure_max_MPa")},
}
"""Row and column of the numbers of wear.json, by their names there."""
Row = dict[str, Any]


@dataclass(frozen=True)
class WearResult:
    """Wear over a route, with what is read from its two runs.

    route: the route.
    runs: by name, `wear_run.solve`.
    beside: one position on the worn profiles by finite elements and by half-spaces, as in
        wear.json; None where it is not solved.
    grooves: "yield" of wear.json; None where no steel yields.
    fatigue: "fatigue" of wear.json; None where it is not asked for.
    """

    route: Route
    runs: Mapping[str, Run]
    beside: dict[str, Any] | None = None
    grooves: dict[str, Any] | None = None
    fatigue: list[Row] | None = None

    @property
    def passed(self) -> bool:
        """Whether all checks hold."""
        return bool(self.summary["checks"]["passed"])

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of wear.json."""
        scene, run, last = self.route.scene, self.runs["main"], self.rows[-1]
        return {
            "case": scene.name,
            "scene": portable(scene),
            "steps": len(self.rows) - 1,
            "done": last["done"],
            "reason": self._reason,
            **{
                name: {key: self.rows[at][column] for key, (at, column) in group.items()}
                for name, group in NUMBERS.items()
            },
            "pressure_mean": worn_contact.MEAN,
            "worn_mm2_by_part": {
                body: places.parts(body, run.depths[body]) for body, places in run.places.items()
            },
            "worn_mm2_per": self._per(),
            "limits_reached": self._limits(),
            "rows": self.rows,
            "positions": self._positions(),
            "left_out": self.route.left_out | self._thin,
            "beside": self.beside,
            "yield": self.grooves,
            "fatigue": self.fatigue,
            "damage_law": DAMAGE_LAW,
            "accuracy": {
                "asked": scene.wear.accuracy,
                "bound": self._bounds,
                "reached": self._largest <= scene.wear.accuracy,
            },
            "checks": {"converged": not self._reason, **checks.summary([*self._checks()], {})},
        }

    def rows_of(self, run: Run) -> list[Row]:
        """What changes from stage to stage of a run, a row each: see docs/howto-wear.md."""
        given, rows = self.route.scene.wear, list[Row]()
        for stage, seen in itertools.zip_longest(run.stages, run.seen):
            row: Row = {
                "done": stage.done,
                "axles": given.axles and stage.done * given.axles,
                "distance_km": given.distance and stage.done * given.distance / KM,
                **self._together(seen.values if seen else [], ""),
            }
            for body, depth in zip(BODIES, stage.depth, strict=True):
                row[f"depth_{body}_mm"] = float(depth.max())
                row[f"worn_{body}_mm2"] = run.places[body].area(depth)
            rows.append(row | _geometry(run, stage.depth))
        return rows

    def _together(self, contacts: Sequence[Row], end: str) -> Row:
        """Largest pressure, and mean area and T-gamma by share of the passages, of the contacts of
        all positions; None where one has none. end: of the names of these numbers; " estimate" has
        how far the largest of pressures within their estimates may be from the largest.
        """
        row: Row = {}
        for name in ("pressure_max_MPa", "area_mm2", "t_gamma_N"):
            values: list[Any] = [each.get(f"{name}{end}") for each in contacts]
            if None in values or not values:
                row[f"{name}{end}"] = None
            elif name == "pressure_max_MPa":
                own = np.array([each[name] for each in contacts])
                ends = [float(np.max(own + sign * np.array(values))) for sign in (-1, 1)]
                row[f"{name}{end}"] = float(np.abs(ends - own.max()).max()) if end else max(values)
            else:
                row[f"{name}{end}"] = math.fsum(np.multiply(self.route.shares, values))
        return row

    @cached_property
    def _every(self) -> dict[str, list[Row]]:
        """`rows_of` the runs by name."""
        return {name: self.rows_of(run) for name, run in self.runs.items()}

    @cached_property
    def rows(self) -> list[Row]:
        """`rows_of` the main run at the stages of the coarse one, each number with its estimate in
        the same unit; those of contacts are of the estimates of all positions, as the numbers are.
        """
        return [
            _estimated(row, other) | self._together(self._contacts(n), " estimate")
            for n, (row, other) in enumerate(
                zip(self._every["main"][::2], self._every["coarse"], strict=True)
            )
        ]

    def _contacts(self, number: int) -> list[Row]:
        """Values of the contacts of all positions at a row, with their estimates; empty where they
        are not known. Both runs may agree by chance in the pressure of one position: its relative
        error is at least the root mean square of those of all positions. That of the edge of a
        groove is added.
        """
        main, coarse = self.runs["main"].seen[2 * number :], self.runs["coarse"].seen[number:]
        known = [each[0].values for each in (main, coarse) if each]
        found = [_estimated(*each) for each in zip(*known, strict=True)] if main else []
        if len(known) == len(self.runs):
            name = "pressure_max_MPa"
            own, other = (np.array([each[name] for each in values]) for values in known)
            off = _error(own, other, OWN[name])
            off = np.maximum(off, own * math.sqrt(np.mean((off / own) ** 2)))
            for each, error in zip(found, off.tolist(), strict=True):
                each[f"{name} estimate"] = math.hypot(error, each["pressure_edge_MPa"])
        return found

    @property
    def _thin(self) -> dict[str, str]:
        """Entry of "left_out" where one of several positions wears a groove of its own."""
        run, positions = self.runs["main"], self.route.positions
        depth = max(float(run.depths[body].max()) for body in self.route.worn)
        over = depth / min(position.hertz.approach for position in positions)
        thin = len(positions) > 1 and over > THIN and run.seen and run.seen[-1].alone > ALONE
        text = f"one wears a groove of its own, {over:.2g} approaches deep; sample the real route"
        return {"positions": text} if thin else {}

    @property
    def _reason(self) -> str:
        """Which runs ended early, where, and why; empty where none did."""
        return "; ".join(
            f"{name} run, after {run.stages[-1].done:.1%}: {run.reason}"
            for name, run in self.runs.items()
            if run.reason
        )

    @cached_property
    def _bounds(self) -> dict[str, Row]:
        """Relative errors of `NUMBERS`; None where a number is 0 or its error is not known."""

        def bound(at: int, column: str) -> float | None:
            """Relative error of a number in a row and a column."""
            value, off = self.rows[at][column], self.rows[at][f"{column} estimate"]
            return None if off is None or not value else off / value

        return {
            name: {key: bound(*place) for key, place in group.items()}
            for name, group in NUMBERS.items()
        }

    @cached_property
    def _largest(self) -> float:
        """Largest relative error of area and depth of the bodies that are worn; infinite where one
        is not known.
        """
        names, worn = ("worn_mm2", "depth_max_mm"), self.route.worn
        known = [self._bounds[name][body] for name in names for body in worn]
        return max(math.inf if each is None else each for each in known)

    def _per(self) -> Row:
        """Worn area of the rail by a million wheels, and of the wheel in 1000 km, mm2."""
        given, last = self.route.scene.wear, self.rows[-1]
        return {
            f"{body}_{name}": last[f"worn_{body}_mm2"] * unit / (last["done"] * amount)
            if amount and last["done"]
            else None
            for body, name, unit, amount in (
                ("rail", "1e6_axles", MILLION, given.axles),
                ("wheel", "1000_km", 1000 * KM, given.distance),
            )
        }

    def _limits(self) -> dict[str, Row]:
        """Limits of wear that the scene gives, by name: the limit, and the wheels, km and share of
        the wear after which it is first passed, linear between stages, each with its estimate; None
        where it is not.
        """
        given, found = self.route.scene.wear, dict[str, Row]()
        amounts = {
            "axles": given.axles,
            "distance_km": given.distance and given.distance / KM,
            "done": 1.0,
        }
        for name, columns, rising in (
            ("depth_limit", ("depth_rail_mm", "depth_wheel_mm"), 1),
            ("flange_limit", ("flange_thickness_mm",), -1),
            ("conicity_limit", ("conicity",), 1),
        ):
            if (limit := getattr(given, name)) is not None:
                coarse, at = (_crossing(self._every[run], columns, limit, rising) for run in RUNS)
                off = None if at is None or coarse is None else _error(at, coarse)
                found[name] = {"limit": limit} | {
                    f"{key}{end}": None if share is None or amount is None else share * amount
                    for end, share in (("", at), (" estimate", off))
                    for key, amount in amounts.items()
                }
        return found

    def _positions(self) -> list[Row]:
        """Share of each position, and the values of its contact at both ends of the main run, with
        their estimates.
        """
        first, last = self._contacts(0), self._contacts(len(self.rows) - 1)
        return [
            {
                "share": share,
                **{key: each[n] for key, each in (("first", first), ("last", last)) if each},
            }
            for n, share in enumerate(self.route.shares)
        ]

    def _checks(self) -> Iterator[Check]:
        """Checks of the run."""
        run, given = self.runs["main"], self.route.scene.wear
        yield Check(
            name="converged",
            value=math.inf if self._reason else 0.0,
            limit=0.0,
            source=self._reason or "every step was solved",
            advice="the files hold what was worn up to there; give more positions, or less wear",
        )
        yield Check(
            name="accuracy",
            value=self._largest,
            limit=given.accuracy,
            source="wear.accuracy; largest error of area and depth by steps and grids",
            advice="ask for less; where wear.step is given, give more steps or leave it out",
        )
        if grooves := self.grooves:
            yield Check(
                name="yield",
                value=float(len(grooves["unknown"]) + len(grooves.get("checks", ()))),
                limit=0.0,
                source="positions whose passes over yielding steel are not known, or failed checks",
                advice="wear.json has the reasons; effects.plasticity=off leaves yield out",
            )
        if self.fatigue is not None:
            yield Check(
                name="fatigue",
                value=float(sum("reason" in each for each in self.fatigue)),
                limit=0.0,
                source="positions, on new or worn profiles, whose stresses of fatigue are missing",
                advice="wear.json has the reasons; leave these positions out",
            )
        known = self._bounds["pressure_max_MPa"].values()
        yield Check(
            name="pressure_estimate",
            value=max(math.inf if each is None else each for each in known),
            limit=USEFUL,
            source="relative error of the largest pressure of any position; more tells nothing",
            advice="the depths stand; for the pressure give more steps or leave out that position",
        )
        for body in self.route.worn:
            area = self.rows[-1][f"worn_{body}_mm2"] or math.nan
            rates = [sum(each[f"{body}_mm2"] for each in seen.values) for seen in run.seen]
            done = [stage.done for stage in run.stages][: len(rates)]
            yield Check(
                name=f"{body}_volume",
                value=abs(float(trapezoid(rates, done)) / area - 1),
                limit=max(VOLUME, given.accuracy),
                source="worn area: rate times T-gamma and passages, over the steps",
                advice="give more steps",
            )
        yield Check(
            name="patch_on_profile",
            value=min(
                (v["edge_cells"] for each in run.seen for v in each.values), default=math.nan
            ),
            limit=EDGE,
            source="cells between a patch and the end of a profile",
            advice="give profiles that reach further, or leave that position out",
            at_least=True,
        )
        ratios = [
            np.diff(places.worn(run.depths[body])[:, 0]) / np.diff(places.points[:, 0])
            for body, places in run.places.items()
        ]
        yield Check(
            name="profile_folds",
            value=min(float(each.min()) for each in ratios),
            limit=STEEP,
            source="y between two places of a worn profile, over that of the new one; 0 is a fold",
            advice="give less wear; a corner that is worn to the other side is not followed",
            at_least=True,
        )

    def lines(self) -> Iterator[Row]:
        """Rows of wear.csv and damage.csv, every 0.1 mm (ROW_STEP) or more over both profiles: worn
        depth, largest pressure and surface fatigue index of any position and time, the sum of
        T-gamma per width, and damage, with their errors; of a run in which nothing was pressed
        none.
        """
        main = self.runs["main"]
        every = [_fields(self.runs[name]) for name in ("main", "coarse") if main.seen]
        for number, (body, places) in enumerate(main.places.items() if every else ()):
            steel, columns = self.route.scene.bodies[body], {"y [mm]": places.points[:, 0]}
            for name in every[0]:
                values = [each[name][number] for each in every]
                columns |= {name: values[0], f"{name} estimate": _error(*values)}
            k = steel.first_yield / math.sqrt(3) if steel.yields else math.nan
            columns["p0/k"] = columns["p_max [MPa]"] / k
            step = max(1, math.ceil(ROW_STEP / places.step))
            for cells in zip(*(each[::step].tolist() for each in columns.values()), strict=True):
                known = (None if math.isnan(cell) else cell for cell in cells)
                yield {"body": body, **dict(zip(columns, known, strict=True))}

    def words(self) -> list[str]:
        """Lines that say what was worn, within which errors, and which checks failed."""
        return words(self.summary)


def words(summary: Mapping[str, Any]) -> list[str]:
    """`WearResult.words` of the content of wear.json."""
    bound = summary["accuracy"]["bound"]

    def within(name: str, key: str, unit: str) -> str:
        """A number with its unit and its error."""
        value, error = summary[name][key], bound[name][key]
        off = "its error is not known" if error is None else f"+- {100 * error:.2g} %"
        return "not known" if value is None else f"{value:.4g} {unit} {off}"

    lines = [
        f"steps: {summary['steps']}, positions: {len(summary['positions'])}, "
        f"after {amount(summary['rows'][-1]) or 'nothing'}"
    ]
    if summary["reason"]:
        lines.append(f"stopped: {summary['reason']}")
    worn = summary["scene"]["wear"]["on"]
    for body in BODIES if worn == "both" else [worn]:
        depth, area = within("depth_max_mm", body, "mm"), within("worn_mm2", body, "mm2")
        lines.append(f"{body}: at most {depth} deep along the normal, {area} of the section")
    first, last = (within("pressure_max_MPa", key, "MPa") for key in ("first", "last"))
    width = f"averaged over {summary['pressure_mean']:g} of a patch's half width"
    lines.append(f"largest pressure, {width}: {first}, then {last}")
    for name, limit in summary["limits_reached"].items():
        after = [
            f"{limit[key]:.4g} +- {limit[f'{key} estimate'] or math.nan:.2g} {key}"
            for key in ("axles", "distance_km")
            if limit[key]
        ]
        lines.append(f"{name} {limit['limit']:g}: {' and '.join(after) or 'not reached'}")
    if beside := summary["beside"]:
        text = beside.get("reason") or "; ".join(
            f"{name.replace('_', ' ')} {beside[name]['pressure_max_MPa']:.5g} MPa on "
            f"{beside[name]['area_mm2']:.4g} mm2"
            for name in ("finite_elements", "half_spaces")
        )
        lines.append(f"position {beside['position']}, worn: {text}")
    if grooves := summary.get("yield"):
        lines.append(
            f"steel would yield at {len(grooves['positions'])} of {len(summary['positions'])} "
            "positions; the worn depths have no yield"
        )
        if "groove_mm" in grooves:
            one, two = grooves["groove_mm"]
            lines.append(
                f"position {grooves['position']}, new and without friction: one pass leaves a "
                f"groove of {one:.3g} mm, two leave {two:.3g} mm"
            )
        lines += [f"position {n}: groove not known ({r})" for n, r in grooves["unknown"].items()]
    failed = summary["checks"]["failed"]
    return [
        *lines,
        *(
            f"left out: {name.replace('_', ' ')} ({why})"
            for name, why in summary["left_out"].items()
        ),
        f"checks: {'FAILED ' + ', '.join(failed) if failed else 'all passed'}",
    ]


def amount(row: Row) -> str:
    """Words for what a row of the history has passed: wheels over the rail, km of the wheel."""
    units = {"axles": "wheels", "distance_km": "km"}
    return " and ".join(f"{row[key]:g} {unit}" for key, unit in units.items() if row[key])


def _geometry(run: Run, depths: Array) -> Row:
    """Equivalent conicity at 3 mm (AMPLITUDE), of level axles, and flange thickness in mm after a
    depth; None where the profiles have none.
    """
    scene, found = run.route.scene, None
    with suppress(PlacementError, SceneError, ValueError):
        wheelset = solid.on_track(scene, worn_contact.pairs(scene, run.places, depths))
        radii = rolling_radii(replace(wheelset, roll=0.0), REACH)
        found = radii.conicities.get(AMPLITUDE)
    points = run.places["wheel"].worn(depths[1])
    thickness = profiles.flange_thickness(points, solid.tape_circle(scene))
    return {"conicity": found, "flange_thickness_mm": thickness}


def _fields(run: Run) -> Fields:
    """Columns (2, n) of wear.csv and damage.csv, of rail and wheel, from all stages of a run."""
    done = [stage.done for stage in run.stages][: len(run.seen)]
    every = {
        name: np.array([each.fields[name] for each in run.seen]) for name in run.seen[0].fields
    }
    return {
        "depth [mm]": run.stages[-1].depth,
        "p_max [MPa]": every["pressure"].max(axis=0),
        "surface fatigue index": np.fmax.reduce(every["index"], axis=0),
        "sum of T-gamma [N/mm]": trapezoid(every["energy"], done, axis=0),
        "damage": trapezoid(every["damage"], done, axis=0),
    }


def _error(main: Any, coarse: Any, least: float = LEAST) -> Any:
    """Error of a number or an array of the main run, from that of the coarse run. Errors of steps
    and of grids may cancel each other in the difference: it is at least a part of the number.
    """
    return np.hypot(FACTOR * (main - coarse), least * main)


def _estimated(row: Row, coarse: Row | None = None) -> Row:
    """A row, with `_error` of each of its numbers but those that are given; None where it is not
    known.
    """
    found = dict(row)
    for key in [key for key in row if key not in GIVEN]:
        value, other = row[key], (coarse or {}).get(key)
        known = value is not None and other is not None
        found[f"{key} estimate"] = (
            float(_error(value, other, OWN.get(key, LEAST))) if known else None
        )
    return found


def _crossing(
    rows: Sequence[Row], columns: Sequence[str], limit: float, rising: int
) -> float | None:
    """Share at which the largest number in some columns first passes a limit, linear between rows;
    rising: 1, falling: -1. None where it does not; rows without numbers do not count.
    """
    known = [
        (row["done"], rising * (max(values) - limit))
        for row in rows
        if None not in (values := [row[name] for name in columns])
    ]
    over = [n for n, (_, each) in enumerate(known) if each >= 0]
    if not over or over[0] == 0:
        return float(known[0][0]) if over else None
    (before, under), (after, above) = known[over[0] - 1 : over[0] + 1]
    return float(before + (after - before) * under / (under - above))
