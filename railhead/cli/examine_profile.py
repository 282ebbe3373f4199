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

from railhead.contact import solid
from railhead.geometry.measured import standards
from railhead.geometry.measured.extensions import BODY_BY_EXTENSION
from railhead.geometry.measured.profile import Measured, smoothness
from railhead.geometry.measured.standards import LaidStandard
from railhead.results import result_folder
from railhead.results.report import tables, terminal
from railhead.scene.scene import Scene, SceneError

STEP = 0.25  # mm between the rows of profile.csv


@dataclass(frozen=True)
class Examined:
    """A measured profile and its wear."""

    found: Measured
    worn: LaidStandard

    def summary(self) -> dict[str, Any]:
        """As in summary.json: lengths mm, curvatures 1/mm."""
        found, worn = self.found, self.worn
        low, middle, high = smoothness(found.profile).curvatures
        return {
            "body": found.body,
            **found.summary(),
            "domain_mm": list(found.profile.domain),
            "curvatures_per_mm": {"5%": low, "50%": middle, "95%": high},
            "standard": worn.name,
            "wear": {
                "largest_mm": worn.largest_loss,
                "largest_y_mm": float(worn.y[worn.worst]),
                "area_mm2": worn.lost_area,
            },
        }


def examine(path: Path, body: str | None, assignments: Sequence[str]) -> Examined:
    """The profile of a file. Raises SceneError.

    body: 'rail' or 'wheel'; None takes that of the extension or of the first assignment, else the
    first of both whose standard profiles it fits. assignments: keys of that body, as in a scene
    (`rail.profile_unit=inch`).
    """
    names = (assignment.partition(".")[0] for assignment in assignments)
    of_key = next((name for name in names if name in ("rail", "wheel")), None)
    kind = body or BODY_BY_EXTENSION.get(path.suffix.lower()) or of_key
    if kind:
        return _examine(path, kind, assignments)
    try:
        return _examine(path, "rail", assignments)
    except SceneError as rail:
        try:
            return _examine(path, "wheel", assignments)
        except SceneError:
            text = f"{rail.text} (as a rail; no wheel either: --body says whose it is)"
            raise SceneError(rail.key, text) from None


def _examine(path: Path, body: str, assignments: Sequence[str]) -> Examined:
    scene = Scene.from_mapping({"load": 1.0, body: {"profile": str(path)}}).replace(assignments)
    found = solid.from_file(scene, body)
    return Examined(found, standards.nearest(found.resampled(standards.STEP), body))


def write(examined: Examined, folder: Path) -> None:
    """summary.json, profile.csv (the smoothed profile) and profile.png."""
    from railhead.postprocess.plots import profile_plot

    profile = examined.found.profile
    start, end = profile.domain
    y = np.linspace(start, end, math.ceil((end - start) / STEP) + 1)
    with result_folder.replacing(folder) as work:
        profile_plot.draw(examined.found, examined.worn, work / "profile.png")
        with (work / "profile.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["y_mm", "z_mm", "slope", "curvature_per_mm"])
            values = zip(y, profile.height(y), profile.slope(y), profile.curvature(y), strict=True)
            writer.writerows([f"{value:.9g}" for value in row] for row in values)
        (work / result_folder.SUMMARY).write_text(as_json(examined), encoding="utf-8")


def as_json(examined: Examined) -> str:
    """The summary as JSON."""
    return result_folder.to_json(examined.summary())


def show(examined: Examined, console: Console) -> None:
    """How it was read and smoothed, its curvature and its wear."""
    found, summary, worn = examined.found, examined.summary(), examined.worn
    radii = (
        "inf" if value == 0 else f"{1 / value:.4g}"
        for value in summary["curvatures_per_mm"].values()
    )
    lines = [
        *tables.profile_lines({found.body: summary}),
        f"radius     {', '.join(radii)} mm at 5, 50, 95 % of the curvature",
        f"wear       against {worn.name}: at most {worn.largest_loss:.3g} mm at y = "
        f"{worn.y[worn.worst]:.1f} mm, {worn.lost_area:.3g} mm2 of the section",
    ]
    for line in lines:
        terminal.labelled(console, line)
