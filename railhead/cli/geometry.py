"""The commands that look at geometry alone.

`railhead locate`: where both wheels of a wheelset touch their rails, and over lateral shifts.
`railhead profile`: how a measured profile was read and smoothed, and what is worn off it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.table import Table

from railhead.contact import solid
from railhead.contact.conicity import equivalent_conicity
from railhead.geometry import wheelset
from railhead.geometry.measured import BODY_BY_EXTENSION, measured_profile, standards
from railhead.geometry.measured.measured_profile import Measured, smoothness
from railhead.geometry.measured.standards import LaidStandard
from railhead.geometry.placement import ContactPoint
from railhead.geometry.wheelset import Placed, Side
from railhead.postprocess.findings import BASE_UNITS, Subject, Units
from railhead.results import result_folder
from railhead.results.report import terminal
from railhead.scene.arrays import is_array
from railhead.scene.catalogue import as_path, portable
from railhead.scene.scene import Scene, SceneError, assigned, checked

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from railhead.postprocess.pictures.diagrams import Drawing

CLEARANCE = 0.05  # mm, largest gap of a contact, of the size of elastic approaches
SHIFTS = np.linspace(-10.0, 10.0, 81)  # mm, of pictures and positions.csv
ROW_STEP = 0.25  # mm between the rows of profile.csv
NOTHING = 1e-9  # mm, 1/mm or degrees: rounding, printed as 0

CONTACT_ROWS = (
    ("rail: y from the crown centre", "mm", "rail_y_mm"),
    ("rail: y from the highest point", "mm", "top_y_mm"),
    ("rail: z", "mm", "rail_z_mm"),
    ("wheel: y from the tape circle", "mm", "wheel_y_mm"),
    ("wheel: x ahead of the axle", "mm", "ahead_mm"),
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


@dataclass(frozen=True)
class Location(terminal.Drawn):
    """A wheelset placed on its track.

    scene: the scene, of which profiles, inclination, gauge and [wheelset] count.
    placed: roll and contacts of both wheels, up to a gap of 0.05 mm (CLEARANCE) over the smallest;
        each side has its own axes (`wheelset.Side`).
    """

    scene: Scene
    placed: Placed

    def summary(self) -> dict[str, Any]:
        """The content of summary.json: lengths in mm, angles in rad, curvatures in 1/mm. "right"
        and "left" are lists of contacts, smallest gap first, in the axes of their side.
        """
        placed, pair = self.placed, solid.solved_side(self.scene, self.placed).pair
        return {
            "case": self.scene.name,
            "scene": portable(self.scene),
            "roll_rad": placed.roll,
            "height_mm": placed.right.height,
            "right_rail_rise_mm": placed.left.height - placed.right.height,
            "rolling_radius_difference_mm": placed.rolling_radius_difference,
            "right": _contacts(placed.right),
            "left": _contacts(placed.left),
            "measured": {
                key: smoothness(profile)
                for key, profile in (("rail", pair.rail), ("wheel", pair.wheel))
                if key in solid.measured_bodies(self.scene)
            },
        }

    @cached_property
    def swept(self) -> list[Placed]:
        """The wheelset at those rising shifts from -10 to 10 mm (SHIFTS) at which it can stand."""
        found = solid.on_track(self.scene).place_all(SHIFTS, CLEARANCE)
        return [each for each in found if isinstance(each, Placed)]

    def positions(self) -> list[dict[str, Any]]:
        """Rows of positions.csv: cells by column header, a row for each lateral shift of `swept`.
        "equivalent conicity" is that of a wheelset which swings by the size of this shift to both
        sides. It is None at shift 0, where the wheelset is not turned back, and where it would
        swing beyond the shifts of `swept`.
        """
        shifts = np.array([placed.shift for placed in self.swept])
        right = np.array([placed.right.touches[0].radius for placed in self.swept])
        left = np.array([placed.left.touches[0].radius for placed in self.swept])
        rows = []
        for placed in self.swept:
            conicity = equivalent_conicity(abs(placed.shift), shifts, right, left)
            row = {
                "shift [mm]": placed.shift,
                "roll [mrad]": 1e3 * placed.roll,
                "rolling radius difference [mm]": placed.rolling_radius_difference,
                "equivalent conicity": None if math.isnan(conicity) else conicity,
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

    def save(
        self,
        folder: str | Path,
        *,
        pictures: bool = True,
        units: Units | None = None,
        force: bool = False,
    ) -> None:
        """Write the files of `railhead locate` into a folder.

        pictures: whether PNG files are written: both wheels on their rails, and contacts and
            rolling radius difference over lateral shifts.
        units: of pictures; None: mm.
        force: whether another result is replaced.
        Raises SceneError for a folder with other files and, without `force`, with another result;
        OSError where it cannot be written.
        """
        folder = as_path(folder, "folder")
        result_folder.check_free(folder, "locate", self.scene, force=force)
        drawings = self.drawings(units or BASE_UNITS) if pictures else {}
        _write(folder, "locate", self, "positions.csv", self.positions(), drawings)

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Functions that draw the pictures, by name of their PNG file. units: of their numbers."""
        from railhead.postprocess.pictures import profile_plots

        scene, swept = self.scene, self.swept
        wheel, rail = Path(scene.wheel.profile).name, Path(scene.rail.profile).name
        words = f"{scene.name}: wheelset with wheels {wheel} on rails {rail}"
        yaw = f", yaw {1e3 * scene.wheelset.yaw:g} mrad"
        shifted = f", shifted by {units.text(scene.wheelset.shift, 'mm')} to the right"
        here, over = (Subject(words + more + yaw, units=units) for more in (shifted, ""))
        return {
            "profiles.png": partial(profile_plots.profiles, self.placed, here),
            "positions.png": partial(profile_plots.positions, swept, over),
            "rolling_radius.png": partial(profile_plots.rolling_radius, swept, over),
        }

    def show(self, console: Console, units: Units = BASE_UNITS) -> None:
        """Print a table with a column for each contact, below it the values of the wheelset. units:
        of the numbers.
        """
        summary, scene = self.summary(), self.scene
        table = Table(title=f"contacts of {scene.name}", title_justify="left")
        table.add_column("quantity")
        table.add_column("unit")
        columns = [
            (f"{side} {number}", contact)
            for side in ("left", "right")
            for number, contact in enumerate(summary[side], 1)
        ]
        for name, _ in columns:
            table.add_column(name, justify="right")
        for label, unit, key in CONTACT_ROWS:
            factor = math.degrees(1) if unit == "deg" else 1.0
            values = (factor * contact[key] for _, contact in columns)
            exact = (each if abs(each) > NOTHING else 0.0 for each in values)
            table.add_row(
                label, units.unit(unit), *(f"{units.value(each, unit):.6g}" for each in exact)
            )
        console.print(table)
        console.print(
            f"shift {units.text(scene.wheelset.shift, 'mm')}, "
            f"yaw {1e3 * scene.wheelset.yaw:g} mrad: "
            f"roll {1e3 * summary['roll_rad']:.4g} mrad, rolling radius difference "
            f"{units.text(summary['rolling_radius_difference_mm'], 'mm')}; contacts: "
            f"{len(summary['left'])} left, {len(summary['right'])} right "
            f"(gap below {units.text(CLEARANCE, 'mm')}); y to the field side",
            highlight=False,
        )
        for key, smooth in summary["measured"].items():
            console.print(
                f"{key} profile, smoothed: radius {_radii(smooth['curvatures'], units)}; "
                f"{smooth['waves']} changes between convex and concave",
                highlight=False,
            )


def locate(scene: Scene) -> Location:
    """Place the wheelset of a scene so that both wheels touch their rails; nothing is solved.
    Raises SceneError for half-spaces and where a wheel misses its rail.
    """
    if checked(scene).rail.extent == "half-space":
        raise SceneError(
            "rail.extent", "half-space has no profiles to locate; give head or section"
        )
    return Location(scene, solid.place(scene, CLEARANCE))


def _contacts(side: Side) -> list[dict[str, float | bool]]:
    """Contacts of a side, as values of summary.json (`_contact`)."""
    crest, _ = wheelset.top(side.pair.rail)
    return [_contact(touch, crest) for touch in side.touches]


def _contact(touch: ContactPoint, crest: float) -> dict[str, float | bool]:
    """Values of one contact by key of summary.json: mm, rad and 1/mm, in the axes of its side.
    crest: y of the rail's highest point, mm.
    """
    return {
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


@dataclass(frozen=True)
class ExaminedProfile(terminal.Drawn):
    """A measured profile and its wear.

    scene: a scene with the profile; its other keys have no meaning.
    measured: the smoothed profile, and how its file was read.
    worn: the nearest standard profile laid on the measured one, and the material lost against that;
        None where none fits.
    """

    scene: Scene
    measured: Measured
    worn: LaidStandard | None

    def summary(self) -> dict[str, Any]:
        """Content of summary.json: lengths in mm, areas in mm2, curvatures in 1/mm, in the axes of
        profiles.
        """
        found, worn = self.measured, self.worn
        low, middle, high = smoothness(found.profile)["curvatures"]
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
            "curvatures_per_mm": {"5%": low, "50%": middle, "95%": high},
            "standard": worn and worn.name,
            "wear": wear,
        }

    def save(
        self,
        folder: str | Path,
        *,
        pictures: bool = True,
        units: Units | None = None,
        force: bool = False,
    ) -> None:
        """Write the files of `railhead profile` into a folder.

        pictures: whether profile.png is written.
        units: of the picture; None: mm.
        force: whether another result is replaced.
        Raises SceneError for a folder with other files and, without `force`, with another result;
        OSError where it cannot be written.
        """
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
        folder = as_path(folder, "folder")
        result_folder.check_free(folder, "profile", self.scene, force=force)
        drawings = self.drawings(units or BASE_UNITS) if pictures else {}
        _write(folder, "profile", self, "profile.csv", rows, drawings)

    def plot(self, picture: str = "profile", ax: Any = None) -> Figure:
        """Draw "profile", which has four panels, as `Result.plot`."""
        return super().plot(picture, ax)

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Function that draws the picture, by name of its PNG file. units: of its numbers."""
        from railhead.postprocess.pictures import profile_plots

        subject = Subject(units=units)
        draw = partial(profile_plots.draw_profile, self.measured, self.worn, subject)
        return {"profile.png": draw}

    def show(self, console: Console, units: Units = BASE_UNITS) -> None:
        """Print reading and smoothing of the file, radii of curvature and wear. units: of the
        numbers.
        """
        summary, worn = self.summary(), self.worn
        lines = [
            *terminal.profile_lines({self.measured.body: summary}, units),
            f"radius     {_radii(summary['curvatures_per_mm'].values(), units)}",
        ]
        if worn:
            lines.append(
                f"wear       against {worn.name}: at most {units.text(worn.largest_loss, 'mm', 3)} "
                f"at y = {units.text(worn.y[worn.worst], 'mm', 3)}, "
                f"{units.text(worn.lost_area, 'mm2', 3)} of the section"
            )
        for line in lines:
            terminal.labelled(console, line)


def profile(
    path: object, body: str | None = None, assignments: Sequence[str] = ()
) -> ExaminedProfile:
    """Read and smooth a measured profile and compare it with a standard profile.

    path: of its file, or an array (n, 2) of y and z, mm.
    body: "rail" or "wheel"; None takes the body of the first assignment, else that of the file: as
        it says, else a wheel where it has a flange.
    assignments: keys of that body as in a scene, e.g. "rail.profile_unit=inch".
    Raises SceneError for a profile that cannot be read.
    """
    names = (key.partition(".")[0] for key in assigned(assignments))
    kind = body or next((name for name in names if name in ("rail", "wheel")), None)
    suffix = "" if is_array(path) else as_path(path, "path").suffix.lower()
    kind = kind or BODY_BY_EXTENSION.get(suffix)
    scene = Scene.from_mapping({"load": 1.0, kind or "rail": {"profile": path}})
    if not kind:
        try:
            kind = measured_profile.body_of(Path(scene.rail.profile))
        except (ValueError, OSError) as error:
            raise SceneError("rail.profile", str(error)) from None
        scene = Scene.from_mapping({"load": 1.0, kind: {"profile": path}})
    scene = scene.replace(assignments)
    found = solid.from_file(scene, kind)
    worn = standards.nearest(found.resampled(standards.STEP), kind)
    return ExaminedProfile(scene, found, worn if worn.fits else None)


def _write(
    folder: Path,
    command: str,
    computed: Location | ExaminedProfile,
    table: str,
    rows: list[dict[str, Any]],
    drawings: Mapping[str, Drawing],
) -> None:
    """Write summary, table and pictures of what a command computed into a folder, which they
    replace. table: name of the file of the rows. OSError: as of `result_folder.result`.
    """
    with result_folder.result(folder, command, computed.scene, computed.summary()) as (work, keep):
        (work / table).write_bytes(result_folder.encoded(result_folder.signed(rows)))
        result_folder.draw(drawings, work, keep)


def _radii(curvatures: Iterable[float], units: Units) -> str:
    """Radii (negative where concave) as text for the curvatures (1/mm) below which 5, 50 and 95 %
    of a profile lie.
    """
    radii = (f"{units.value(1 / value, 'mm'):.4g}" if value else "inf" for value in curvatures)
    return f"{', '.join(radii)} {units.unit('mm')} at 5, 50, 95 % of the curvature"
