"""The commands that look at geometry alone.

`railhead locate`: where both wheels of a wheelset touch their rails, and over lateral shifts.
`railhead profile`: how a measured profile was read and smoothed, and what is worn off it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from railhead.cli.examined.examined import Examined
from railhead.cli.examined.passage import Passage, passage
from railhead.contact import solid
from railhead.geometry.measured import BODY_BY_EXTENSION, standards
from railhead.geometry.measured.measured_profile import Measured
from railhead.geometry.placement import PlacementError
from railhead.geometry.wheelset import (
    Placed,
    RollingRadii,
    Side,
    WheelsetOnTrack,
    rolling_radii,
    top,
)
from railhead.postprocess.findings import BASE_UNITS, Drawing, Subject, Units
from railhead.results.report import terminal
from railhead.scene.catalogue import as_path, portable
from railhead.scene.keys import assigned
from railhead.scene.scene import Scene, SceneError, checked
from railhead.sweeps.grid import ParameterGrid
from railhead.theory.array_types import Array

CENTRED = 1e-3  # mm off the middle of the track that are none
CLEARANCE = 0.05  # mm, largest gap of a contact, of the size of elastic approaches
SHIFTS = np.linspace(-10.0, 10.0, 81)  # mm, of pictures and positions.csv
ROW_STEP = 0.25  # mm between the rows of profile.csv

CONTACT_ROWS = (
    ("rail: y from the crown centre", "mm", "rail_y_mm"),
    ("rail: y from the highest point", "mm", "top_y_mm"),
    ("rail: z", "mm", "rail_z_mm"),
    ("wheel: y from the tape circle", "mm", "wheel_y_mm"),
    ("wheel: x ahead of the axle (behind < 0)", "mm", "ahead_mm"),
    ("gap", "mm", "gap_mm"),
    ("contact angle", "deg", "angle_rad"),
    ("rolling radius", "mm", "radius_mm"),
    ("rail: curvature across", "1/mm", "rail_curvature"),
    ("wheel: curvature along its circle", "1/mm", "wheel_curvature_along"),
    ("wheel: curvature across", "1/mm", "wheel_curvature_across"),
    ("relative curvature along", "1/mm", "relative_curvature_along"),
    ("relative curvature across", "1/mm", "relative_curvature_across"),
    ("their axes turned by", "deg", "orientation_rad"),
)
"""Label, shown unit and key of the rows of the table of contacts."""
COLUMNS = {
    "shift_mm": ("shift [mm]", "shift", 6),
    "rail_y_left_mm": ("left rail y [mm]", "y left", 5),
    "rail_y_right_mm": ("right rail y [mm]", "y right", 5),
    "radius_left_mm": ("left rolling radius [mm]", "r left", 6),
    "radius_right_mm": ("right rolling radius [mm]", "r right", 6),
    "difference_mm": ("rolling radius difference [mm]", "r - l", 5),
    "angle_left_deg": ("left contact angle [deg]", "angle l", 5),
    "angle_right_deg": ("right contact angle [deg]", "angle r", 5),
    "roll_mrad": ("roll [mrad]", "roll", 5),
}
"""Column of positions.csv, head and digits of the printed table, by key of "rows"."""


@dataclass(frozen=True, eq=False)
class Location(Examined):
    """A wheelset placed on its track, at one shift and over several.

    scene: the scene, of which profiles, inclination, gauge and [wheelset] count.
    placed: roll and contacts of both wheels, up to a gap of 0.05 mm (CLEARANCE) over the smallest;
        each side has its own axes (`wheelset.Side`).
    shifts: rising lateral shifts (mm) of the rows; None: from -10 to 10 mm (SHIFTS), not printed.
    """

    command = "locate"
    scene: Scene
    placed: Placed
    shifts: Array | None = None

    def summary(self) -> dict[str, Any]:
        """The content of summary.json: lengths in mm, angles in rad, or in the unit at the end of
        the key, curvatures in 1/mm. "right" and "left" are lists of contacts, smallest gap first,
        in the axes of their side. "rows" has an entry for each shift at which the wheelset can
        stand, "left_out" one for each other shift; they are printed where "tabulated".
        """
        placed = self.placed
        return {
            "case": self.scene.name,
            "scene": portable(self.scene),
            "roll_rad": placed.roll,
            "height_mm": placed.right.height,
            "right_rail_rise_mm": placed.left.height - placed.right.height,
            "rolling_radius_difference_mm": placed.rolling_radius_difference,
            "right": _contacts(placed.right),
            "left": _contacts(placed.left),
            "rows": [
                {key: row[column] for key, (column, _, _) in COLUMNS.items()}
                for row in self.positions()
            ],
            "left_out": [
                {"shift_mm": float(shift), "why": str(each)}
                for shift, each in zip(self._shifts, self._found, strict=True)
                if isinstance(each, PlacementError)
            ],
            "tabulated": self.shifts is not None,
            "jumps_mm": self.radii.jumps,
            "conicity": [
                {"amplitude_mm": amplitude, "value": value, "middle_mm": middle}
                for amplitude, (value, middle) in self.level.motions.items()
            ],
            "nonlinearity_per_mm": self.level.nonlinearity,
        }

    @property
    def _shifts(self) -> Array:
        """Lateral shifts of the wheelset in the rows of the table, mm, ascending."""
        return SHIFTS if self.shifts is None else self.shifts

    @cached_property
    def _found(self) -> list[Placed | PlacementError]:
        """The wheelset at the shifts of the rows, or why it cannot stand there."""
        start = np.interp(self._shifts, self.radii.shifts, self.radii.rolls)
        return self._wheelset.place_all(self._shifts, CLEARANCE, start)

    @cached_property
    def _wheelset(self) -> WheelsetOnTrack:
        """The wheelset over its track."""
        return solid.on_track(self.scene)

    @property
    def swept(self) -> list[Placed]:
        """The wheelset at those shifts of the rows at which it can stand."""
        return [each for each in self._found if isinstance(each, Placed)]

    @cached_property
    def radii(self) -> RollingRadii:
        """Rolling radii of both wheels over the shift, at least from -10 to 10 mm."""
        return self._radii_of(self._wheelset, np.abs([*SHIFTS, *self._shifts]).max())

    @cached_property
    def level(self) -> RollingRadii:
        """Rolling radii of both wheels over the shift on an axle that stays level, as EN 15302
        tabulates them; where the scene gives a roll, those of `radii`.
        """
        if self.scene.wheelset.roll is not None:
            return self.radii
        level = replace(self._wheelset, roll=0.0)
        return self._radii_of(level, np.abs(self.radii.shifts).max())

    def _radii_of(self, wheelset: WheelsetOnTrack, reach: float) -> RollingRadii:
        """Rolling radii of a wheelset. Raises SceneError where it can stand nowhere. reach: mm."""
        try:
            return rolling_radii(wheelset, reach)
        except PlacementError as error:
            raise SceneError("wheelset.shift", f"{error}, at whole shifts from 0 on") from None

    def positions(self) -> list[dict[str, Any]]:
        """Rows of positions.csv: cells by column header, a row for each wheelset of `swept`."""
        rows = []
        for placed in self.swept:
            row = {
                "shift [mm]": placed.shift,
                "roll [mrad]": 1e3 * placed.roll,
                "rolling radius difference [mm]": placed.rolling_radius_difference,
            }
            for name, side in (("right", placed.right), ("left", placed.left)):
                touch = side.touches[0]
                row |= {
                    f"{name} rail y [mm]": touch.y,
                    f"{name} wheel y [mm]": touch.wheel_y,
                    f"{name} contact angle [deg]": math.degrees(touch.angle),
                    f"{name} rolling radius [mm]": touch.radius,
                    f"{name} contacts": len(side.touches),
                }
            rows.append(row)
        return rows

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of positions.csv and conicity.csv by name of the file."""
        conicity = [
            {"amplitude [mm]": amplitude, "equivalent conicity": value, "middle [mm]": middle}
            for amplitude, (value, middle) in self.level.motions.items()
        ]
        return {"positions.csv": self.positions(), "conicity.csv": conicity}

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Functions that draw the pictures, by name of their PNG file; `profiles.png` only where
        no shifts were asked for. units: of their numbers.
        """
        from railhead.postprocess.pictures import profile_plots

        scene, swept, radii = self.scene, self.swept, self.radii
        wheel, rail = Path(scene.wheel.profile).name, Path(scene.rail.profile).name
        sides = scene.wheelset.side, "left" if scene.wheelset.side == "right" else "right"
        words = f"{scene.name}: {sides[0]} wheel {wheel} on rail {rail}"
        for body in ("wheel", "rail"):
            if other := getattr(scene.wheelset, f"other_{body}"):
                words += f", {sides[1]} {body} {Path(other).name}"
        yaw = f", yaw {1e3 * scene.wheelset.yaw:g} mrad"
        shifted = f", shifted by {units.text(scene.wheelset.shift, 'mm')} to the right"
        here, over = (Subject(words + more + yaw, units=units) for more in (shifted, ""))
        one = {"profiles.png": partial(profile_plots.profiles, self.placed, here)}
        return (one if self.shifts is None else {}) | {
            "rolling_radius.png": partial(
                profile_plots.rolling_radius, swept, radii.differences, over
            ),
            "conicity.png": partial(profile_plots.conicity, {"": self.level.conicities}, over),
        }

    @staticmethod
    def shown(summary: Mapping[str, Any], console: Console, units: Units) -> None:
        """Print the contacts at the scene's shift, or a row for each shift that was asked for, and
        the equivalent conicity. units: of the numbers.
        """
        if summary["tabulated"]:
            columns = {name: (head, digits) for name, head, digits in COLUMNS.values()}
            rows = [
                {name: row[key] for key, (name, _, _) in COLUMNS.items()} for row in summary["rows"]
            ]
            title = f"contacts of {summary['case']}"
            console.print(terminal.column_table(title, rows, columns, units))
            for each in summary["left_out"]:
                shift = units.text(each["shift_mm"], "mm")
                terminal.labelled(console, f"left out   {shift}: {each['why']}")
        else:
            _show_contacts(console, units, summary)
        jumps = ", ".join(f"{units.value(each, 'mm'):.4g}" for each in summary["jumps_mm"])
        text = f"at shifts of {jumps} {units.unit('mm')}" if jumps else "none"
        terminal.labelled(console, f"jumps      {text}")
        whole = [
            (units.value(each["amplitude_mm"], "mm"), each["value"], each["middle_mm"])
            for each in summary["conicity"]
            if each["amplitude_mm"] % 1 == 0 and each["value"] is not None
        ]
        values = ", ".join(f"{value:.4g} at {amplitude:g}" for amplitude, value, _ in whole)
        text = f"conicity   {values or 'none'} {units.unit('mm')} (equivalent, EN 15302"
        if (slope := summary["nonlinearity_per_mm"]) is not None:
            slope = round(units.value(slope, "1/mm"), 4) + 0.0
            text += f"; nonlinearity parameter {slope:g} {units.unit('1/mm')}"
        terminal.labelled(console, f"{text})")
        if any(abs(middle) > CENTRED for *_, middle in whole):
            text = ", ".join(f"{units.value(y, 'mm'):.3g} at {a:g}" for a, _, y in whole)
            unit = units.unit("mm")
            terminal.labelled(console, f"middle     of the motion: shifts of {text} {unit}")


def _show_contacts(console: Console, units: Units, summary: Mapping[str, Any]) -> None:
    """Print a table with a column for each contact, below it the values of the wheelset."""
    contacts = {
        f"{side} {number}": contact
        for side in ("left", "right")
        for number, contact in enumerate(summary[side], 1)
    }
    rows = []
    for label, unit, key in CONTACT_ROWS:
        factor = math.degrees(1) if unit == "deg" else 1.0
        values = (terminal.exact(factor * contact[key]) for contact in contacts.values())
        cells = (f"{units.value(each, unit):.6g}" for each in values)
        rows.append([label, units.unit(unit), *cells])
    header = "quantity", "unit", *contacts
    console.print(terminal.number_table(f"contacts of {summary['case']}", header, rows, 2))
    placed = summary["scene"]["wheelset"]
    console.print(
        f"shift {units.text(placed['shift'], 'mm')}, "
        f"yaw {1e3 * placed['yaw']:g} mrad: "
        f"roll {1e3 * summary['roll_rad']:.4g} mrad, rolling radius difference "
        f"{units.text(summary['rolling_radius_difference_mm'], 'mm')}; contacts: "
        f"{len(summary['left'])} left, {len(summary['right'])} right "
        f"(gap below {units.text(CLEARANCE, 'mm')}); y to the field side",
        highlight=False,
    )


def locate(scene: Scene, over: Mapping[str, Sequence[object]] | None = None) -> Location | Passage:
    """Place the wheelset of a scene so that both wheels touch their rails; nothing is solved. On a
    rail of sections the wheel is placed alone, at `rail.position`.
    over: {"wheelset.shift": values}, lateral shifts of the rows; None: from -10 to 10 mm. Of a rail
        of sections {"rail.position": values}; None: the scene's own.
    Raises SceneError for half-spaces, for another key or a wrong value in `over`, and where the
    wheelset cannot stand at the scene's own shift.
    """
    if checked(scene).rail.varies:
        return passage(scene, over)
    if scene.rail.extent == "half-space":
        raise SceneError(
            "rail.extent", "half-space has no profiles to locate; give head or section"
        )
    shifts = None
    if over is not None:
        for key in over.keys() - {"wheelset.shift"}:
            text = "is not allowed in over of locate; give wheelset.shift alone"
            raise SceneError(key, f"{text} (railhead diff A B compares two folders of locate)")
        scenes = ParameterGrid.combine(scene, over).scenes
        shifts = np.array(sorted(each.wheelset.shift for each in scenes))
    return Location(scene, solid.place(scene, CLEARANCE), shifts)


def _contacts(side: Side) -> list[dict[str, float | bool]]:
    """Contacts of a side, as values of summary.json: mm, rad and 1/mm, in the axes of its side."""
    crest, _ = top(side.pair.rail)
    return [
        {
            "rail_y_mm": touch.y,
            "top_y_mm": touch.y - crest,
            "rail_z_mm": touch.z,
            "wheel_y_mm": touch.wheel_y,
            "ahead_mm": touch.radius * math.sin(touch.axle_angle),
            "gap_mm": touch.gap,
            "angle_rad": touch.angle,
            "radius_mm": touch.radius,
            "rail_curvature": touch.rail_curvature,
            "wheel_curvature_along": touch.wheel_curvatures[0],
            "wheel_curvature_across": touch.wheel_curvatures[1],
            "relative_curvature_along": touch.curvature_x,
            "relative_curvature_across": touch.curvature_y,
            "orientation_rad": touch.orientation,
            "at_edge": touch.at_edge,
        }
        for touch in side.touches
    ]


@dataclass(frozen=True)
class ExaminedProfile(Examined):
    """A measured profile and its wear.

    scene: a scene with the profile; its other keys have no meaning.
    measured: the smoothed profile, and how its file was read.
    worn: the nearest standard profile laid on the measured one, and the material lost against that;
        None where none fits.
    """

    command = "profile"
    scene: Scene
    measured: Measured
    worn: standards.LaidStandard | None

    def summary(self) -> dict[str, Any]:
        """Content of summary.json: lengths in mm, areas in mm2, in the axes of profiles."""
        found, worn = self.measured, self.worn
        wear = worn and {
            "largest_mm": worn.largest_loss,
            "largest_y_mm": float(worn.y[worn.worst]),
            "area_mm2": worn.lost_area,
        }
        return {
            "body": found.body,
            **found.summary(),
            "profile": {"origin": found.origin, "sides": found.oriented.sides},
            "domain_mm": list(found.profile.domain),
            "standard": worn and worn.name,
            "asked": solid.asked(self.scene, found.body),
            "wear": wear,
        }

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of profile.csv by name of the file."""
        profile = self.measured.profile
        start, end = profile.domain
        y = np.linspace(start, end, math.ceil((end - start) / ROW_STEP) + 1)
        columns = {
            "y_mm": y,
            "z_mm": profile.height(y),
            "slope": profile.slope(y),
            "curvature_per_mm": profile.curvature(y),
        }
        rows = [
            {name: f"{values[index]:.9g}" for name, values in columns.items()}
            for index in range(len(y))
        ]
        return {"profile.csv": rows}

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Function that draws the picture, by name of its PNG file. units: of its numbers."""
        from railhead.postprocess.pictures import profile_plots

        subject = Subject(units=units)
        draw = partial(profile_plots.draw_profile, self.measured, self.worn, subject)
        return {"profile.png": draw}

    @staticmethod
    def shown(summary: Mapping[str, Any], console: Console, units: Units) -> None:
        """Print reading and smoothing of the file, and wear. units: of the numbers."""
        lines = [*terminal.profile_lines({summary["body"]: summary}, units)]
        if worn := summary["wear"]:
            lines.append(
                f"wear       against {summary['standard']}: "
                f"at most {units.text(worn['largest_mm'], 'mm', 3)} along the normal "
                f"at y = {units.text(worn['largest_y_mm'], 'mm', 3)}, "
                f"{units.text(worn['area_mm2'], 'mm2', 3)} of the section"
            )
        lines += [f"a run asks {text}" for text in summary["asked"]]
        for line in lines:
            terminal.labelled(console, line)


def profile(
    path: object, body: str | None = None, assignments: Sequence[str] = ()
) -> ExaminedProfile:
    """Read and smooth a measured profile and compare it with a standard profile.

    path: of its file.
    body: "rail" or "wheel"; None takes the body of the first assignment, else that of the file's
        extension, else a rail.
    assignments: keys of that body as in a scene, e.g. "rail.profile_unit=inch".
    Raises SceneError for a profile that cannot be read.
    """
    names = (key.partition(".")[0] for key in assigned(assignments))
    kind = body or next((name for name in names if name in ("rail", "wheel")), None)
    kind = kind or BODY_BY_EXTENSION.get(as_path(path, "path").suffix.lower(), "rail")
    scene = Scene.from_mapping({"load": 1.0, kind: {"profile": path}}).replace(assignments)
    found = solid.from_file(scene, kind)
    worn = standards.nearest(found.resampled(standards.STEP), kind)
    return ExaminedProfile(scene, found, worn if worn.fits else None)
