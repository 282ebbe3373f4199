"""Picture of a measured profile: as measured and smoothed, over the nearest standard one."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from railhead.geometry.measured.profile import Measured, inner
from railhead.geometry.measured.standards import LaidStandard
from railhead.postprocess.findings import Array
from railhead.postprocess.plots.diagrams import new_figure

RAW, SMOOTH, STANDARD, LOST = "#9a9a9a", "#1f4e79", "#c8502d", "#9a5f00"


def draw(found: Measured, worn: LaidStandard, path: Path) -> None:
    """Write a PNG file with four panels over y: the profile, the difference of measured and
    smoothed heights, the curvature, and the material lost to wear.

    found: measured and smoothed profile. worn: the nearest standard profile, laid on the measured
        one. path: of the file.
    """
    smoothed, profile = found.smoothed, found.profile
    y = np.linspace(*inner(profile), 3000)
    with new_figure(path, 9, 11) as figure:
        top, left, bend, lost = figure.subplots(
            4, 1, sharex=True, gridspec_kw={"height_ratios": [1.6, 1, 1.4, 1]}
        )
        top.plot(*worn.outline.T, color=STANDARD, lw=1.2, label=f"{worn.name}, laid on")
        top.plot(*found.points.T, ".", color=RAW, ms=3, label="measured")
        top.plot(y, profile.height(y), color=SMOOTH, label="smoothed")
        title = f"{found.path.name}: {found.body}, {len(found.points)} points"
        top.set_title(title, parse_math=False)
        top.set_ylabel("z, mm")
        top.legend(loc="best")
        left.plot(found.points[:, 0], 1e3 * smoothed.residual, ".", color=RAW, ms=3)
        left.axhspan(
            -1e3 * smoothed.noise, 1e3 * smoothed.noise, color=SMOOTH, alpha=0.15, label="noise"
        )
        left.legend(loc="upper right")
        left.set_ylabel("measured less\nsmoothed, um")
        bend.plot(
            found.points[1:-1, 0],
            smoothed.rough_curvature(),
            ".",
            color=RAW,
            ms=2,
            label="of each three points",
        )
        curvature = profile.curvature(y)
        bend.plot(y, curvature, color=SMOOTH, label="smoothed")
        bend.plot(*_curvature(worn), color=STANDARD, lw=1.2, label=worn.name)
        span = max(float(np.abs(curvature).max()), 0.02)
        bend.set_ylim(min(1.3 * float(curvature.min()), -0.2 * span), 1.3 * span)
        bend.set_ylabel("curvature, 1/mm\n(convex is positive)")
        bend.legend(loc="best")
        lost.plot(worn.y, worn.loss, color=LOST)
        lost.plot(
            worn.y[worn.worst],
            worn.largest_loss,
            "o",
            color=STANDARD,
            label=f"largest: {worn.largest_loss:.3g} mm",
        )
        lost.legend(loc="upper right")
        lost.set_ylabel(f"less than\n{worn.name}, mm")
        lost.set_xlabel("y across the track, mm (gauge side and flange on the left)")


def _curvature(worn: LaidStandard) -> tuple[Array, Array]:
    """y (n,) in mm and curvature (n,) in 1/mm, convex positive, of those parts of a standard
    profile that face upwards.
    """
    outline = worn.outline[::10]
    first = np.gradient(outline, axis=0)
    second = np.gradient(first, axis=0)
    bend = first[:, 1] * second[:, 0] - first[:, 0] * second[:, 1]
    bend = bend / np.linalg.norm(first, axis=1) ** 3
    upwards = first[:, 0] > 0.1 * np.linalg.norm(first, axis=1)
    return outline[upwards, 0], bend[upwards]
