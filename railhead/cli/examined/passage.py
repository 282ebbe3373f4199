"""`railhead locate` of a rail that is given by sections: the path of the wheel over its heads."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

from rich.console import Console

from railhead.cli.examined.examined import Examined
from railhead.contact import crossing
from railhead.postprocess.findings import BASE_UNITS, Drawing, Subject, Units
from railhead.results.report import terminal
from railhead.scene.catalogue import portable
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps.grid import ParameterGrid

CLEARANCE = 0.05  # mm, largest gap of a head that touches, of the size of elastic approaches
PLACES = (("x", "x_mm", "mm", 7), ("y", "y_mm", "mm", 6), ("angle", "angle_deg", "deg", 5))
"""Word, key, unit and digits of a head's contact in the tables; then the height alone."""


@dataclass(frozen=True, eq=False)
class Passage(Examined):
    """A wheel that touches a rail of sections at several positions, without load.

    scene: the scene.
    crossings: the wheel at each position, in ascending order.
    """

    command = "locate"
    scene: Scene
    crossings: tuple[crossing.Crossing, ...]

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """An entry for each position: position and height of the wheel, mm; by head the place of
        its lowest contact point along the sections and across, its angle to the horizontal, and
        the height of a wheel that touches nothing else; and what touches.
        """
        return [_row(each) for each in self.crossings]

    @property
    def overs(self) -> list[float]:
        """Positions between the rows, mm, at which the wheel changes from one head to the other."""
        found = []
        for here, after in zip(self.rows, self.rows[1:], strict=False):
            ends = [_ahead(each) for each in (here, after)]
            if None not in ends and ends[0] * ends[1] < 0:  # type: ignore[operator]
                share = ends[0] / (ends[0] - ends[1])  # type: ignore[operator]
                step = after["position_mm"] - here["position_mm"]
                found.append(here["position_mm"] + share * step)
        return found

    def summary(self) -> dict[str, Any]:
        """Content of summary.json: "rows", and "over_mm", positions at which the wheel goes over
        from one head to the other.
        """
        scene = self.scene
        return {
            "case": scene.name,
            "scene": portable(scene),
            "rows": self.rows,
            "over_mm": self.overs,
        }

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of positions.csv by name of the file; cells of a head that is not there are
        empty.
        """
        return {"positions.csv": _cells(self.rows)}

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Function that draws the path, by name of its PNG file. units: of its numbers."""
        from railhead.postprocess.pictures import profile_plots

        subject = Subject(f"{self.scene.name}: path of the wheel", units=units)
        draw = partial(profile_plots.passage, self.rows, _names(self.rows), subject)
        return {"passage.png": draw}

    @staticmethod
    def shown(summary: Mapping[str, Any], console: Console, units: Units) -> None:
        """Print a row for each position, and where the wheel goes over. units: of the numbers."""
        columns = {"position [mm]": ("position", 6), "height [mm]": ("height", 5)}
        for name in _names(summary["rows"]):
            columns |= {f"{name} {w} [{unit}]": (f"{name} {w}", k) for w, _, unit, k in PLACES}
        title = f"path of {summary['case']}, x along the sections"
        columns["touching"] = "touches", 0
        console.print(terminal.column_table(title, _cells(summary["rows"]), columns, units))
        overs = ", ".join(f"{units.value(each, 'mm'):.5g}" for each in summary["over_mm"])
        if overs:
            text = f"goes over  from one head to the other at {overs} {units.unit('mm')}"
            terminal.labelled(console, f"{text} (rigid)")


def _names(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the heads that are under the wheel in any of "rows"."""
    return [name for name in crossing.NAMES if any(name in row["heads"] for row in rows)]


def _cells(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of positions.csv of "rows"."""
    found = []
    for row in rows:
        cells = {"position [mm]": row["position_mm"], "height [mm]": row["wheel_height_mm"]}
        for name in _names(rows):
            head = row["heads"].get(name, {})
            for word, key, unit, _ in PLACES:
                cells[f"{name} {word} [{unit}]"] = head.get(key, "")
            cells[f"{name} height alone [mm]"] = head.get("height_alone_mm", "")
        found.append(cells | {"touching": row["touching"]})
    return found


def _row(found: crossing.Crossing) -> dict[str, Any]:
    """Entry of "rows" of a position."""
    at = found.scene.rail.position
    touching = found.touching(CLEARANCE)
    return {
        "position_mm": at,
        "wheel_height_mm": found.height(found.lift),
        "heads": {
            name: {
                "x_mm": at + head.touches[0].x,
                "y_mm": head.touches[0].y,
                "angle_deg": math.degrees(math.acos(head.touches[0].upright)),
                "height_alone_mm": found.alone(name),
            }
            for name, head in found.heads.items()
        },
        "touching": touching[0] if len(touching) == 1 else "both",
    }


def _ahead(row: Mapping[str, Any]) -> float | None:
    """Height of the wheel alone on the rail over that alone on the wing, mm; None without both."""
    heights = [head["height_alone_mm"] for head in row["heads"].values()]
    return heights[0] - heights[1] if len(heights) > 1 else None


def passage(scene: Scene, over: Mapping[str, Sequence[object]] | None = None) -> Passage:
    """The wheel of a scene on its rail of sections.
    over: {"rail.position": values} of the rows, mm; None: the scene's own.
    Raises SceneError for another key or a wrong value in `over`, and as `crossing.touch`.
    """
    for key in (over or {}).keys() - {"rail.position"}:
        text = "is not allowed in over of locate beside rail.sections"
        raise SceneError(key, f"{text}; give rail.position alone")
    scenes = ParameterGrid.combine(scene, over).scenes if over else [scene]
    scenes = sorted(scenes, key=lambda each: each.rail.position)
    return Passage(scene, tuple(crossing.touch(each) for each in scenes))
