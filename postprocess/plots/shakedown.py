"""Picture of the shakedown map with the point of one patch."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure
from railhead.theory.friction import shakedown

WIDE, HIGH = 0.6, 6.0  # traction coefficient and p0/k, at least
POINTS = 61


def draw(friction: Mapping[str, Any], poisson: float, path: Path, title: str = "") -> None:
    """Write a PNG file of the shakedown map, p0/k over the traction coefficient, with the point and
    the limits of one patch.

    friction: "friction" of a result in summary.json, which must hold p0_over_k. poisson: Poisson's
        ratio, for the limits of a line contact under full slip. path: of the file. title: above the
        picture.
    """
    used, ratio = friction["traction_coefficient"], friction["p0_over_k"]
    shares = np.linspace(0.0, max(WIDE, 1.1 * used), POINTS)
    with new_figure(path, 7, 4.8, title) as figure:
        axes = figure.subplots()
        limits = [shakedown.shakedown_limit(each, poisson) for each in shares]
        elastic = [shakedown.elastic_limit(each, poisson) for each in shares]
        axes.plot(shares, limits, color=HERTZ, label="shakedown limit of a line")
        axes.plot(shares, elastic, "--", color=HERTZ, label="elastic limit of a line")
        sliding = shares[shares > 1 / (2 * HIGH)]
        axes.plot(
            sliding,
            1 / sliding,
            ":",
            color=GREY,
            label="surface limit, FI = 0",
        )
        axes.plot(
            0,
            shakedown.CIRCLE,
            "^",
            color=HERTZ,
            clip_on=False,
            label="shakedown limit of a circle without friction",
        )
        axes.plot(
            used,
            friction["first_yield_p0_over_k"],
            "_",
            color=FE,
            ms=16,
            mew=2,
            label="this patch begins to yield",
        )
        axes.plot(
            used,
            friction["shakedown_limit_p0_over_k"],
            "_",
            color=HERTZ,
            ms=16,
            mew=2,
            label="its shakedown limit",
        )
        state, index = friction["shakedown"], friction["surface_fatigue_index"]
        axes.plot(
            used,
            ratio,
            "o",
            color=FE,
            ms=8,
            label=f"this patch: {state}, FI = {index:.2f}",
            clip_on=False,
        )
        axes.set(
            xlim=(0, shares[-1]),
            ylim=(0, max(HIGH, 1.1 * ratio)),
            xlabel="traction coefficient: tangential over normal force",
            ylabel="largest pressure over shear yield, p0/k",
        )
        figure.legend(loc="outside upper center", ncols=2)
