"""A measured profile by itself: how it was read and smoothed, and what is worn off it."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from railhead import report, results, screen
from railhead.geometry import solid
from railhead.meshing import instruments, orientation, wear
from railhead.meshing.measured import Measured, smoothness
from railhead.meshing.suffixes import BODIES
from railhead.meshing.wear import Wear
from railhead.scene.scene import Scene, SceneError

WHEEL = 100.0  # mm: a table of points that wide or wider is of a wheel
STEP = 0.25  # mm between the rows of profile.csv


@dataclass(frozen=True)
class Examined:
    """A measured profile and its wear."""

    found: Measured
    worn: Wear

    def summary(self) -> dict[str, Any]:
        """As in summary.json: lengths mm, curvatures 1/mm."""
        found, worn = self.found, self.worn
        low, middle, high = smoothness(found.profile).curvatures
        return {
            "body": found.body,
            **found.summary(),
            "domain_mm": list(found.profile.domain),
            "curvatures_per_mm": {"5%": low, "50%": middle, "95%": high},
            "standard": worn.standard,
            "wear": {
                "largest_mm": worn.largest, "largest_y_mm": worn.at, "area_mm2": worn.area,
            },
        }  # fmt: skip


def examine(path: Path, body: str | None, assignments: Sequence[str]) -> Examined:
    """The profile of a file; body: 'rail' or 'wheel', if None that of the suffix or of the first
    assignment, else found out; assignments: keys of that body, as in a scene
    (`rail.profile_unit=inch`). Raises SceneError."""
    named = (assignment.partition(".")[0] for assignment in assignments)
    given = next((name for name in named if name in BODIES.values()), None)
    said = body or BODIES.get(path.suffix.lower()) or given
    guessed = "" if said else _kind(path)
    kind = said or guessed or "rail"
    try:
        scene = Scene.from_mapping({"load": 1.0, kind: {"profile": str(path)}}).replace(assignments)
        found = solid.from_file(scene, kind)
    except SceneError as error:
        told = f" (taken for a {kind}'s by its shape: --body says whose it is)" if guessed else ""
        raise SceneError(error.key, error.text + told) from None
    return Examined(found, wear.nearest(found.evenly(wear.STEP), kind))


def _kind(path: Path) -> str:
    """'wheel' for a table of points as wide as wheels are or with a flange, else 'rail'; '' where
    it cannot be read: what is wrong is said later."""
    checked = Scene.from_mapping({"load": 1.0, "rail": {"profile": str(path)}}).rail.profile
    try:
        points, _ = orientation.in_mm(instruments.read(Path(checked)), "wheel", "auto")
    except (ValueError, OSError):
        return ""
    width, most = float(np.ptp(points[:, 0])), orientation.USUAL["wheel"][1]
    wide = width <= most and (width >= WHEEL or orientation.flange(points) is not None)
    return "wheel" if wide else "rail"


def write(examined: Examined, folder: Path) -> None:
    """summary.json, profile.csv (the smoothed profile) and profile.png."""
    from railhead.postprocess import profile_plot

    profile = examined.found.profile
    start, end = profile.domain
    y = np.linspace(start, end, math.ceil((end - start) / STEP) + 1)
    with results.replacing(folder) as work:
        profile_plot.draw(examined.found, examined.worn, work / "profile.png")
        with (work / "profile.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["y_mm", "z_mm", "slope", "curvature_per_mm"])
            values = zip(y, profile.height(y), profile.slope(y), profile.curvature(y), strict=True)
            writer.writerows([f"{value:.9g}" for value in row] for row in values)
        (work / results.SUMMARY).write_text(as_json(examined), encoding="utf-8")


def as_json(examined: Examined) -> str:
    """The summary as JSON."""
    return results.to_json(examined.summary())


def show(examined: Examined, console: Console) -> None:
    """How it was read and smoothed, its curvature and its wear."""
    found, summary, worn = examined.found, examined.summary(), examined.worn
    radii = (
        "inf" if value == 0 else f"{1 / value:.4g}"
        for value in summary["curvatures_per_mm"].values()
    )
    lines = [
        *report.profile_lines({found.body: summary}),
        f"radius     {', '.join(radii)} mm at 5, 50, 95 % of the curvature",
        f"wear       against {worn.standard}: at most {worn.largest:.3g} mm at y = {worn.at:.1f} "
        f"mm, {worn.area:.3g} mm2 of the section",
    ]
    for line in lines:
        screen.labelled(console, line)
