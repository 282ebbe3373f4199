"""The picture of the axes and signs of friction."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from railhead.geometry import profiles
from railhead.geometry.placement import Pair
from railhead.geometry.wheelset import Track, place
from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure

Point = tuple[float, float]
SHIFT = 4.0  # mm, for a contact angle that can be seen
STEEL = "#d9dde2"
ORIGIN = (0.0, 0.0)


def draw(path: Path) -> None:
    """The wheel from the front and the patch from above."""
    with new_figure(path, 12, 4.1) as figure:
        front, above = figure.subplots(1, 2, width_ratios=(1, 1.05))
        _front(front)
        _above(above)
        for axes in (front, above):
            axes.set_aspect("equal")
            axes.set_axis_off()


def _front(axes: Axes) -> None:
    pair = Pair(profiles.rail_head("60E1", 1 / 40), profiles.s1002(), 460.0)
    side = place(pair, Track(gauge=1435.0), shift=SHIFT).right
    touch, y = side.touches[0], np.linspace(*pair.rail.domain, 801)
    outline = pair.outline(side.pose, np.linspace(*pair.wheel.domain, 801)).points[:, 1:].T
    for steel, end, colour in (((y, pair.rail.height(y)), -30, STEEL), (outline, 40, "#eceff2")):
        axes.fill_between(*steel, end, color=colour, lw=0)
        axes.plot(*steel, color=GREY)
    at, c, s = (touch.y, touch.z), np.cos(touch.angle), np.sin(touch.angle)
    _arrow(axes, at, (at[0] + 26 * c, at[1] + 26 * s), FE, "y, s: field side")
    _arrow(axes, at, (at[0] - 26 * s, at[1] + 26 * c), FE, "normal, out of the rail")
    _out_of_the_page(axes, at)
    _note(axes, "x: to where the wheel rolls,\nout of the page", at, (at[0] + 12, at[1] - 20))
    _arrow(axes, (-62.0, 32.0), (-48.0, 32.0), HERTZ, "wheelset.shift")
    axes.text(-40, -37, "gauge side", color=GREY, ha="right")
    axes.text(42, -37, "field side", color=GREY)
    axes.set(xlim=(-75, 75), ylim=(-42, 42), title="From the front")


def _above(axes: Axes) -> None:
    turn, arc = np.linspace(0, 2 * np.pi, 181), np.radians(np.linspace(200, 340, 60))
    axes.fill(6 * np.cos(turn), 4.6 * np.sin(turn), color=STEEL, lw=0)
    x, y = 2.6 * np.cos(arc), 2.6 * np.sin(arc)
    axes.plot(x[:-2], y[:-2], color=HERTZ)
    for start, end, colour, name in (
        (ORIGIN, (9.0, 0.0), FE, "x"),
        (ORIGIN, (0.0, 6.2), FE, "y, s"),
        ((0.8, 0.9), (3.6, 0.9), HERTZ, ""),
        ((0.8, 1.5), (0.8, 3.8), HERTZ, ""),
        ((x[-6], y[-6]), (x[-1], y[-1]), HERTZ, ""),
    ):
        _arrow(axes, start, end, colour, name)
    _out_of_the_page(axes, ORIGIN)
    for text, at, where, colour in (
        ("normal, out of the page", ORIGIN, (-6.0, 6.2), FE),
        ("creepage along, force along", (3.2, 0.9), (10.4, 2.8), HERTZ),
        ("creepage across, force across", (0.8, 3.4), (8.0, 5.4), HERTZ),
        ("spin, moment", (2.0, -1.7), (7.5, -3.6), HERTZ),
    ):
        _note(axes, text, at, where, colour)
    axes.text(6.2, -0.9, "leading edge", color=GREY)
    axes.text(-6.2, 0, "trailing edge", color=GREY, ha="right")
    axes.set(xlim=(-11, 14), ylim=(-6, 8), title="The patch from above")


def _out_of_the_page(axes: Axes, at: Point) -> None:
    """The point of an arrow towards the reader."""
    axes.plot(*at, "o", color=FE, ms=11, mfc="white", mew=2)
    axes.plot(*at, "o", color=FE, ms=4)


def _note(axes: Axes, text: str, at: Point, where: Point, colour: str = FE) -> None:
    line = {"arrowstyle": "-", "color": colour, "lw": 0.8}
    axes.annotate(text, at, where, color=colour, ha="center", arrowprops=line)


def _arrow(axes: Axes, start: Point, end: Point, colour: str, name: str = "") -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2})
    x, y = (1.06 * stop - 0.06 * begin for begin, stop in zip(start, end, strict=True))
    axes.text(x, y, name, color=colour, va="center" if end[1] == start[1] else "bottom")
