"""The answer of a wear run: worn profiles, areas, pressures and damage, with errors and checks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from railhead.contact import conicity, solid
from railhead.geometry import worn_profile
from railhead.geometry.placement import PlacementError
from railhead.geometry.worn_profile import Places
from railhead.results import checks
from railhead.results.checks import Check
from railhead.run.half_spaces import worn_contact
from railhead.run.half_spaces.worn_contact import BODIES
from railhead.scene.catalogue import portable
from railhead.scene.scene import SceneError
from railhead.sweeps.wear.wear_route import Route
from railhead.sweeps.wear.wear_run import SETTLES, Run, by_body
from railhead.theory.array_types import Array

ROW_STEP = 0.1  # mm between the rows of tables
AMPLITUDE, REACH = 3.0, 8.0  # mm: of the equivalent conicity, and of the shifts it is read from
VOLUME = 0.02  # relative: of the worn area, by the passages between two steps
USEFUL = 0.25  # largest relative error of a pressure that says something
EDGE = 2.0  # cells between a patch and the end of a profile, at least
STEEP = 0.2  # least y between two places of the worn profile, over that of the new one
KM, MILLION = 1e6, 1e6  # mm; wheels
DAMAGE_LAW = "T-gamma of a patch: 0 to 15 N, 1e-5 at 65 N, 0 from 175 N on (Burstow, from memory)"

Numbers = dict[str, dict[str, Any]]
"""By name in wear.json: numbers by body, or 'first' and 'last'; None where there is none."""


@dataclass(frozen=True)
class WearResult:
    """Wear over a route, with what is read from its three runs.

    route: the route.
    runs: by name, `wear_run.RUNS`.
    beside: one position on the worn profiles by finite elements and by half-spaces, as in
        wear.json; None where it is not solved.
    """

    route: Route
    runs: Mapping[str, Run]
    beside: dict[str, Any] | None = None

    @property
    def passed(self) -> bool:
        """Whether all checks hold."""
        return bool(self.summary["checks"]["passed"])

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of wear.json."""
        scene, run, bound = self.route.scene, self.runs["main"], self._bounds
        return {
            "case": scene.name,
            "scene": portable(scene),
            "steps": len(run.stages) - 1,
            "done": run.stages[-1].done,
            "reason": run.reason,
            **self._found[0],
            "worn_mm2_by_part": {
                body: places.parts(body, run.depths()[body])
                for body, places in self.places(run).items()
            },
            "worn_mm2_per": self._per(),
            "limits_reached": self._limits(),
            "rows": self.rows,
            "positions": self._positions(),
            "left_out": self.route.left_out,
            "beside": self.beside,
            "damage_law": DAMAGE_LAW,
            "accuracy": {
                "asked": scene.wear.accuracy,
                "bound": bound,
                "reached": self._largest(bound) <= scene.wear.accuracy,
            },
            "checks": {"converged": not run.reason, **checks.summary([*self._checks()], {})},
        }

    def places(self, run: Run) -> dict[str, Places]:
        """Places along the new profiles of 'rail' and 'wheel', as many as a run has."""
        return worn_contact.places(self.route.scene, run.fineness.places)

    def _numbers(self, run: Run) -> Numbers:
        """Worn areas, largest depths, and largest pressures of all positions at both ends."""
        depths, places = run.depths(), self.places(run)
        pressures: list[Any] = [
            max(each["pressure_max_MPa"] for each in seen.values) for seen in run.seen
        ] or [None]
        return {
            "worn_mm2": {body: places[body].area(depths[body]) for body in BODIES},
            "depth_max_mm": {body: float(depths[body].max()) for body in BODIES},
            "pressure_max_MPa": {"first": pressures[0], "last": pressures[-1]},
        }

    @cached_property
    def _found(self) -> list[Numbers]:
        """`_numbers` of the three runs, that of the main run first."""
        return [self._numbers(run) for run in self.runs.values()]

    @cached_property
    def _complete(self) -> bool:
        """Whether all runs came to the same end."""
        ends = {each.stages[-1].done for each in self.runs.values()}
        return len(ends) == 1 and not any(run.reason for run in self.runs.values())

    def error(self, main: Any, coarse: Any, halved: Any) -> Any:
        """Error of a number or an array (n,) of the main run, from those of the three runs: the
        change by the grid, and twice that by steps half as long, as of first order; NaN where it is
        not known.
        """
        steps = 2 * abs(coarse - halved)
        if np.size(coarse) != np.size(main):
            shares = [np.linspace(0.0, 1.0, len(each)) for each in (main, coarse)]
            coarse, steps = (np.interp(shares[0], shares[1], each) for each in (coarse, steps))
        return abs(main - coarse) + (steps if self._complete else math.nan)

    @cached_property
    def _bounds(self) -> Numbers:
        """Relative errors of `_numbers`; None where a number is 0 or its error is not known."""
        main, *others = self._found
        found: Numbers = {}
        for name, group in main.items():
            found[name] = {}
            for key, value in group.items():
                values = (value, *(other[name][key] for other in others))
                off = self.error(*values) if all(values) else math.nan
                found[name][key] = float(off / value) if math.isfinite(off) else None
        return found

    def _largest(self, bound: Numbers) -> float:
        """Largest relative error of area and depth of the bodies that are worn; infinite where one
        is not known.
        """
        names, worn = ("worn_mm2", "depth_max_mm"), self.route.worn
        known = [bound[name][body] for name in names for body in worn]
        return max(math.inf if each is None else each for each in known)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """What changes from stage to stage of the main run, a row each: see docs/howto-wear.md."""
        run, given, rows = self.runs["main"], self.route.scene.wear, []
        for number, (stage, seen) in enumerate(zip(run.stages, run.seen, strict=False)):
            depths = run.depths(number)
            mean = {
                name: math.fsum(
                    share * each[name]
                    for share, each in zip(self.route.shares, seen.values, strict=True)
                )
                for name in ("area_mm2", "t_gamma_N")
            }
            rows.append(
                {
                    "done": stage.done,
                    "axles": stage.done * given.axles if given.axles else None,
                    "distance_km": stage.done * given.distance / KM if given.distance else None,
                    "pressure_max_MPa": max(each["pressure_max_MPa"] for each in seen.values),
                    **mean,
                    **{f"depth_{body}_mm": float(depths[body].max()) for body in BODIES},
                    **self._geometry(number),
                }
            )
        return rows

    def _geometry(self, number: int) -> dict[str, float | None]:
        """Equivalent conicity at 3 mm (AMPLITUDE), of level axles, and flange thickness in mm at a
        stage; None where the profiles have none.
        """
        run, scene = self.runs["main"], self.route.scene
        places, depths = self.places(run), run.depths(number)
        found: float | None = None
        try:
            wheelset = solid.on_track(scene, worn_contact.pairs(scene, places, depths))
            radii = conicity.rolling_radii(replace(wheelset, roll=0.0), REACH)
            found = radii.conicities.get(AMPLITUDE)
        except (PlacementError, SceneError, ValueError):
            pass
        points = places["wheel"].worn(depths["wheel"])
        thickness = worn_profile.flange_thickness(points, solid.tape_circle(scene))
        return {"conicity": found, "flange_thickness_mm": thickness}

    def _per(self) -> dict[str, float | None]:
        """Worn area of the rail by a million wheels, and of the wheel in 1000 km, mm2."""
        given, worn = self.route.scene.wear, self._found[0]["worn_mm2"]
        done = self.runs["main"].stages[-1].done
        return {
            f"{body}_{name}": worn[body] * unit / (done * amount) if amount and done else None
            for body, name, unit, amount in (
                ("rail", "1e6_axles", MILLION, given.axles),
                ("wheel", "1000_km", 1000 * KM, given.distance),
            )
        }

    def _limits(self) -> dict[str, dict[str, float | None]]:
        """Limits of wear that the scene gives, by name: the limit, and the wheels, km and share of
        the wear after which it is first passed, linear between stages; None where it is not.
        """
        given, rows, found = self.route.scene.wear, self.rows, {}
        depth = [max(row["depth_rail_mm"], row["depth_wheel_mm"]) for row in rows]
        for name, values, rising in (
            ("depth_limit", depth, 1),
            ("flange_limit", [row["flange_thickness_mm"] for row in rows], -1),
            ("conicity_limit", [row["conicity"] for row in rows], 1),
        ):
            if (limit := getattr(given, name)) is not None:
                at = _crossing([row["done"] for row in rows], values, limit, rising)
                amounts = {
                    "axles": given.axles,
                    "distance_km": given.distance and given.distance / KM,
                }
                found[name] = {
                    "limit": limit,
                    **{
                        key: None if at is None or amount is None else at * amount
                        for key, amount in amounts.items()
                    },
                    "done": at,
                }
        return found

    def _positions(self) -> list[dict[str, Any]]:
        """Share of each position, and the values of its contact at both ends of the main run."""
        seen = self.runs["main"].seen
        ends = {"first": seen[:1], "last": seen[-1:]}
        return [
            {"share": share, **{key: each.values[n] for key, at in ends.items() for each in at}}
            for n, share in enumerate(self.route.shares)
        ]

    def _checks(self) -> Iterator[Check]:
        """Checks of the run."""
        run, given = self.runs["main"], self.route.scene.wear
        yield Check(
            name="converged",
            value=math.inf if run.reason else 0.0,
            limit=0.0,
            source=run.reason or "every step was solved",
            advice="the files hold what was worn up to there; give less wear or other positions",
        )
        yield Check(
            name="accuracy",
            value=self._largest(self._bounds),
            limit=given.accuracy,
            source="wear.accuracy; largest error of area and depth by steps and grids",
            advice="ask for less; where wear.step is given, give more steps or leave it out",
        )
        approach = min(position.hertz.approach for position in self.route.positions)
        yield Check(
            name="steps",
            value=max(stage.change for stage in run.stages) / approach,
            limit=2 * SETTLES,
            source="change of the worn depth by half a step, over the smallest approach",
            advice="leave wear.step to the program, or give more steps",
        )
        known = [each or 0.0 for each in self._bounds["pressure_max_MPa"].values()]
        yield Check(
            name="pressure_estimate",
            value=max(known),
            limit=USEFUL,
            source="relative error of the largest pressure of any position; more tells nothing",
            advice="the depths stand; for the pressure give more steps or leave out that position",
        )
        for body in self.route.worn:
            area = self._found[0]["worn_mm2"][body] or math.nan
            rates = [sum(each[f"{body}_mm2"] for each in seen.values) for seen in run.seen]
            done = [stage.done for stage in run.stages][: len(rates)]
            yield Check(
                name=f"{body}_volume",
                value=abs(float(np.trapz(rates, done)) / area - 1) if len(done) > 1 else math.nan,
                limit=max(VOLUME, given.accuracy),
                source="worn area: rate times T-gamma and passages, by trapezoids over the steps",
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
            float(
                (
                    np.diff(places.worn(run.depths()[body])[:, 0]) / np.diff(places.points[:, 0])
                ).min()
            )
            for body, places in self.places(run).items()
        ]
        yield Check(
            name="profile_folds",
            value=min(ratios),
            limit=STEEP,
            source="y between two places of a worn profile, over that of the new one; 0 is a fold",
            advice="give less wear; a corner that is worn to the other side is not followed",
            at_least=True,
        )

    def depth_rows(self) -> list[dict[str, Any]]:
        """Rows of wear.csv: worn depth over y of the bodies that are worn, with its error."""
        return list(self._lines(lambda run: {"depth [mm]": run.stages[-1].depth}))

    def damage_rows(self) -> list[dict[str, Any]]:
        """Rows of damage.csv: over y, largest pressure and surface fatigue index of any position
        and time, the sum of T-gamma per width, and damage, of both bodies.
        """

        def fields(run: Run) -> dict[str, Array]:
            """Fields of all stages together, by column."""
            done = [stage.done for stage in run.stages][: len(run.seen)]
            every = {
                name: np.array([each.fields[name] for each in run.seen])
                for name in run.seen[0].fields
            }
            summed = {name: np.trapz(every[name], done, axis=0) for name in ("energy", "damage")}
            return {
                "p_max [MPa]": every["pressure"].max(axis=0),
                "surface fatigue index": np.fmax.reduce(every["index"], axis=0),
                "sum of T-gamma [N/mm]": summed["energy"],
                "damage": summed["damage"],
            }

        rows = []
        for row in self._lines(fields) if all(run.seen for run in self.runs.values()) else ():
            steel = self.route.scene.bodies[row["body"]]
            k = steel.first_yield / math.sqrt(3) if steel.yields else None
            rows.append({**row, "p0/k": row["p_max [MPa]"] / k if k else None})
        return rows

    def _lines(self, fields: Callable[[Run], Mapping[str, Array]]) -> Iterator[dict[str, Any]]:
        """Rows of body, y and fields with their errors, every 0.1 mm (ROW_STEP) or more, of fields
        (n,) by column, rail and wheel in a row.
        """
        main = self.runs["main"]
        every = [
            {name: by_body(field) for name, field in fields(run).items()}
            for run in self.runs.values()
        ]
        for body, places in self.places(main).items():
            stride = max(1, math.ceil(ROW_STEP / places.step))
            columns = {
                name: (each[body], self.error(*(of[name][body] for of in every)))
                for name, each in every[0].items()
            }
            for n in range(0, len(places.points), stride):
                row: dict[str, Any] = {"body": body, "y [mm]": float(places.points[n, 0])}
                for name, (value, error) in columns.items():
                    row |= {name: _number(value[n]), f"{name} estimate": _number(error[n])}
                yield row


def _number(value: float) -> float | None:
    """A number, None for NaN."""
    return None if math.isnan(value) else float(value)


def _crossing(
    shares: Sequence[float], values: Sequence[float | None], limit: float, rising: int
) -> float | None:
    """Share at which values first pass a limit, linear between shares; rising: 1, falling: -1. None
    where they do not; values that are None do not count.
    """
    before: tuple[float, float] | None = None
    for share, value in zip(shares, values, strict=True):
        if value is None:
            continue
        over = rising * (value - limit)
        if over >= 0:
            if before is None:
                return share
            return before[0] + (share - before[0]) * before[1] / (before[1] - over)
        before = share, over
    return None
