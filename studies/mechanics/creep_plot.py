"""Forces over creepages and spin, and the hardest places over the coefficient."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure
from studies.mechanics.creep_curves import Point
from studies.mechanics.friction_changes import Slid

LOOKS = {"railhead": (FE, "o"), "boundary elements": (HERTZ, "-"), "FASTSIM": (GREY, "--"),
         "linear theory": (GREY, ":")}  # fmt: skip
PANELS = (
    ("along", "force_along", "creepage along"),
    ("across", "force_across", "creepage across"),
    ("spin", "force_across", "spin, 1/mm"),
)
STRESSES = {"railhead": (FE, "o"), "below": (HERTZ, "-"), "surface": (GREY, "-")}


def curves(points: Sequence[Point], path: Path) -> None:
    """A row a case; the motions that have one part only."""
    cases = list(dict.fromkeys(point.case for point in points))
    with new_figure(path, 11, 3.6 * len(cases)) as figure:
        rows = figure.subplots(len(cases), 3, squeeze=False, sharey="row")
        for case, row in zip(cases, rows, strict=True):
            for axes, (motion, force, label) in zip(row, PANELS, strict=True):
                rest = [name for name, _, _ in PANELS if name != motion]
                for by, (colour, look) in LOOKS.items():
                    own = [
                        p for p in points
                        if p.case == case and p.by == by and not any(getattr(p, r) for r in rest)
                    ]  # fmt: skip
                    x, y = ([getattr(p, name) for p in own] for name in (motion, force))
                    axes.plot(x, y, look, color=colour, label=by)
                axes.set(xscale="log", ylim=(0, 1.1), xlabel=label)
                axes.set_title(case)
            row[0].set_ylabel("force over mu N")
        rows[0, 0].legend()


def sliding(slid: Sequence[Slid], path: Path) -> None:
    """The largest von Mises stress, and its depth, with the exact largest below and at the
    surface."""
    cases = list(dict.fromkeys(each.case for each in slid))
    labels = {"railhead": "finite elements", "below": "exact, below the surface",
              "surface": "exact, at the surface"}  # fmt: skip
    with new_figure(path, 4.6 * len(cases), 3.8) as figure:
        panels = figure.subplots(1, len(cases), squeeze=False, sharey=True)[0]
        for case, axes in zip(cases, panels, strict=True):
            for by, (colour, look) in STRESSES.items():
                own = [each for each in slid if each.case == case and each.by == by]
                x, y = [each.coefficient for each in own], [each.von_mises for each in own]
                axes.plot(x, y, look, color=colour, label=labels[by])
            axes.set(xlabel="coefficient of friction")
            axes.set_title(case)
        panels[0].set_ylabel("largest von Mises stress over p0")
        panels[0].legend()
