"""Pictures of wear over a route: worn depth over y, and what changes on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from railhead.postprocess.findings import Subject
from railhead.postprocess.pictures.diagrams import Target, new_figure

COLOURS = {"rail": "#555555", "wheel": "#1f4e79"}
PANELS = {
    "largest pressure, MPa": ("pressure_max_MPa",),
    "largest depth, mm": ("depth_rail_mm", "depth_wheel_mm"),
    "equivalent conicity at 3 mm": ("conicity",),
}
"""Keys of the rows that each panel of the history draws, by its label."""


def depth(
    rows: Sequence[Mapping[str, Any]], worn: Sequence[str], subject: Subject, target: Target = None
) -> Figure:
    """Worn depth over y of each body that is worn, with its error as a band.

    rows: of wear.csv. worn: 'rail', 'wheel' or both. subject: title. target: as of `new_figure`.
    """
    with new_figure(target, 5.5 * len(worn), 3.6, subject) as figure:
        panels = figure.subplots(1, len(worn), squeeze=False)[0]
        for ax, body in zip(panels, worn, strict=True):
            own = [row for row in rows if row["body"] == body]
            y, worn_off, error = (
                np.array([row[name] for row in own], dtype=float)
                for name in ("y [mm]", "depth [mm]", "depth [mm] estimate")
            )
            ax.plot(y, worn_off, color=COLOURS[body])
            ax.fill_between(
                y, worn_off - error, worn_off + error, color=COLOURS[body], alpha=0.3, lw=0
            )
            ax.set_title(body)
            ax.set_xlabel("y to the field side, mm")
            ax.set_ylabel("worn depth, mm")
            ax.invert_yaxis()
    return figure


def history(rows: Sequence[Mapping[str, Any]], subject: Subject, target: Target = None) -> Figure:
    """Largest pressure, largest depths and conicity over the share of the wear.

    rows: of history.csv. subject: title. target: as of `new_figure`.
    """
    with new_figure(target, 5.0 * len(PANELS), 3.6, subject) as figure:
        done = [100 * row["done"] for row in rows]
        for ax, (label, keys) in zip(figure.subplots(1, len(PANELS)), PANELS.items(), strict=True):
            for key in keys:
                name = key.removeprefix("depth_").removesuffix("_mm")
                values = np.array([row[key] for row in rows], dtype=float)
                ax.plot(done, values, "o-", label=name, color=COLOURS.get(name, "#c8502d"))
            if len(keys) > 1:
                ax.legend()
            ax.set_xlabel("share of the wear, %")
            ax.set_ylabel(label)
    return figure
