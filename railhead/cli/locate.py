"""Where both wheels of a wheelset touch their rails, for one position and over lateral shifts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from railhead.contact import solid as geometry
from railhead.geometry import placement
from railhead.geometry.measured import profile as measured
from railhead.geometry.placement import ContactPoint, Pair, Placed, PlacementError, Track
from railhead.results import result_folder
from railhead.scene.catalogue import portable
from railhead.scene.scene import Scene, SceneError

CLEARANCE = 0.05  # mm, largest gap of a contact, of the size of elastic approaches
SHIFTS = np.linspace(-10.0, 10.0, 81)  # mm


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
class Location:
    """A wheelset placed on its track.

    scene: profiles, gauge, shift and yaw.
    pair: profiles of rail and wheel.
    placed: height, roll and contacts of both wheels.
    """

    scene: Scene
    pair: Pair
    placed: Placed

    def summary(self) -> dict[str, Any]:
        """The content of summary.json: lengths in mm, angles in rad, curvatures in 1/mm."""
        placed, (crest, _) = self.placed, placement.top(self.pair.rail)
        return {
            "case": self.scene.name,
            "scene": portable(self.scene),
            "roll_rad": placed.roll,
            "height_mm": placed.height,
            "rolling_radius_difference_mm": placed.rolling_radius_difference,
            "right": [_contact(touch, crest) for touch in placed.right.touches],
            "left": [_contact(touch, crest) for touch in placed.left.touches],
            "measured": {
                key: measured.smoothness(profile)
                for key, profile in (("rail", self.pair.rail), ("wheel", self.pair.wheel))
                if key in geometry.measured_bodies(self.scene)
            },
        }

    def placed_at(self, shifts: Sequence[float]) -> list[tuple[float, Placed]]:
        """Pairs (shift, position) of the same wheelset at other lateral shifts (mm). Shifts at
        which a wheel misses its rail are left out.
        """
        scene, positions = self.scene, []
        track = Track(scene.wheelset.back_to_back, scene.rail.gauge)
        for shift in shifts:
            try:
                placed = placement.place(self.pair, track, shift, scene.wheelset.yaw, CLEARANCE)
            except PlacementError:
                continue
            positions.append((float(shift), placed))
        return positions

    def write(self, folder: Path) -> None:
        """Write summary.json and pictures into a folder: both wheels on their rails, and contacts
        and rolling radius difference over lateral shifts.
        """
        from railhead.postprocess.pictures.plots import profile_plots

        scene = self.scene
        wheel, rail = Path(scene.wheel.profile).name, Path(scene.rail.profile).name
        profiles = f"wheels {wheel} on rails {rail}"
        pair = f"{scene.name}: wheelset with {profiles}"
        at = f"shifted by {scene.wheelset.shift:g} mm to the right"
        yaw = f", yaw {1e3 * scene.wheelset.yaw:g} mrad"
        title, swept = f"{pair}, {at}{yaw}", self.placed_at(list(SHIFTS))
        with result_folder.result(folder, "locate", scene, self.summary()) as (work, attempt):
            with attempt("profiles.png"):
                profile_plots.profiles(self.pair, self.placed, work / "profiles.png", title)
            with attempt("positions.png"):
                profile_plots.positions(self.pair, swept, work / "positions.png", pair + yaw)
            with attempt("rolling_radius.png"):
                profile_plots.rolling_radius(swept, work / "rolling_radius.png", pair + yaw)

    def show(self, console: Console) -> None:
        """Print a table with a column for each contact, below it the values of the wheelset."""
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
            table.add_row(label, unit, *(f"{round(each, 12) + 0.0:.6g}" for each in values))
        console.print(table)
        console.print(
            f"shift {scene.wheelset.shift:g} mm, yaw {1e3 * scene.wheelset.yaw:g} mrad: roll "
            f"{1e3 * summary['roll_rad']:.4g} mrad, rolling radius difference "
            f"{summary['rolling_radius_difference_mm']:.4g} mm; contacts: "
            f"{len(summary['left'])} left, {len(summary['right'])} right "
            f"(gap below {CLEARANCE:g} mm); y to the field side",
            highlight=False,
        )
        for key, smooth in summary["measured"].items():
            low, middle, high = (f"{1 / k:.4g}" if k else "inf" for k in smooth["curvatures"])
            console.print(
                f"{key} profile, smoothed: radius {low}, {middle}, {high} mm at 5, 50, 95 % of the "
                f"curvature; {smooth['waves']} changes between convex and concave",
                highlight=False,
            )


def locate(scene: Scene) -> Location:
    """Place the wheelset of a scene so that both wheels touch their rails. Raises SceneError for
    half-spaces and where a wheel misses its rail.
    """
    if scene.rail.extent == "half-space":
        raise SceneError(
            "rail.extent", "half-space has no profiles to locate; give head or section"
        )
    return Location(scene, *geometry.place(scene, CLEARANCE))


def _contact(touch: ContactPoint, crest: float) -> dict[str, float | bool]:
    """Values of one contact by key of summary.json: mm, rad and 1/mm. crest: y of the rail's
    highest point, mm.
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
