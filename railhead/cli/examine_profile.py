"""A measured profile by itself: how it was read and smoothed, and what is worn off it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from railhead.contact import solid
from railhead.geometry.measured import BODY_BY_EXTENSION, standards
from railhead.geometry.measured.profile import Measured, smoothness
from railhead.geometry.measured.standards import LaidStandard
from railhead.results import result_folder
from railhead.results.report import terminal
from railhead.scene.scene import Scene, SceneError

ROW_STEP = 0.25  # mm between the rows of profile.csv


@dataclass(frozen=True)
class ExaminedProfile:
    """A measured profile and its wear.

    scene: a scene with the profile.
    measured: the smoothed profile, and how its file was read.
    worn: the standard profile aligned with the measured one, and the material lost against that.
    """

    scene: Scene
    measured: Measured
    worn: LaidStandard

    def summary(self) -> dict[str, Any]:
        """Content of summary.json: lengths in mm, areas in mm2, curvatures in 1/mm."""
        found, worn = self.measured, self.worn
        low, middle, high = smoothness(found.profile)["curvatures"]
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

    def write(self, folder: Path) -> None:
        """Write summary.json, profile.csv (the smoothed profile) and profile.png into a folder."""
        from railhead.postprocess.pictures.plots import profile_plots

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
        with result_folder.result(folder, "profile", self.scene, self.summary()) as (work, attempt):
            (work / "profile.csv").write_bytes(result_folder.encoded(rows))
            with attempt("profile.png"):
                profile_plots.draw_profile(self.measured, self.worn, work / "profile.png")

    def show(self, console: Console) -> None:
        """Print reading and smoothing of the file, radii of curvature and wear."""
        summary, worn = self.summary(), self.worn
        curvatures = summary["curvatures_per_mm"].values()
        radii = (f"{1 / value:.4g}" if value else "inf" for value in curvatures)
        lines = [
            *terminal.profile_lines({self.measured.body: summary}),
            f"radius     {', '.join(radii)} mm at 5, 50, 95 % of the curvature",
            f"wear       against {worn.name}: at most {worn.largest_loss:.3g} mm at y = "
            f"{worn.y[worn.worst]:.1f} mm, {worn.lost_area:.3g} mm2 of the section",
        ]
        for line in lines:
            terminal.labelled(console, line)


def examine(path: Path, body: str | None, assignments: Sequence[str]) -> ExaminedProfile:
    """Read and smooth the profile of a file and compare it with a standard profile.

    body: "rail" or "wheel"; None takes the body of the extension or of the first assignment, else
        the first of both whose standard profiles fit.
    assignments: keys of that body as in a scene, e.g. "rail.profile_unit=inch".
    Raises SceneError for a profile that cannot be read.
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


def _examine(path: Path, body: str, assignments: Sequence[str]) -> ExaminedProfile:
    """The examined profile of a file as that of `body`, "rail" or "wheel". Raises SceneError."""
    scene = Scene.from_mapping({"load": 1.0, body: {"profile": str(path)}}).replace(assignments)
    found = solid.from_file(scene, body)
    return ExaminedProfile(scene, found, standards.nearest(found.resampled(standards.STEP), body))
