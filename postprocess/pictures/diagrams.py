"""Figure and units of every picture, and diagrams of the findings against exact Hertz.

Functions that draw a picture end with an argument `target`: the path of a PNG file that is written,
or None. They return what was drawn on: a figure, or the part of one between title and notes; the
attribute `figure` of both is the whole. `hertz` is the exact Hertz contact, point or line, or None:
then only the computed result is drawn. Its middle is at the origin of the contact frame.
"""

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import AutoLocator, FixedLocator, MaxNLocator

from railhead.postprocess.findings import (
    Array,
    AxisPressure,
    DepthAxis,
    Findings,
    Subject,
    Target,
    Units,
    brief,
)
from railhead.theory.elastic.line import Hertz
from railhead.theory.elastic.subsurface import max_shear, principal

UNTITLED = Subject()
FE, HERTZ, GREY = "#1f4e79", "#c8502d", "#7a7a7a"
DPI = 160  # of every PNG file
BANDS = 10
STYLE = {
    "font.size": 11,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.8,
    "lines.markersize": 4.5,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "figure.autolayout": False,  # a person's own setting, which the layout of `new_figure` forbids
    "figure.constrained_layout.use": False,
}


@contextmanager
def new_figure(
    target: Target, width: float, height: float, of: Findings | Subject = UNTITLED
) -> Iterator[Figure]:
    """Context manager: a matplotlib figure of width by height inches, to which title and notes are
    added. The Agg backend draws it; at the end its axes get the units of the subject, and it is
    saved if `target` is the path of a PNG file.

    of: findings, whose title is written above the figure and whose notes below; or their subject,
        without notes. In titles and notes `$` is a plain character.
    """
    import matplotlib
    from matplotlib.figure import Figure

    subject, notes = (of, ()) if isinstance(of, Subject) else (of.subject, of.notes)
    over = textwrap.wrap(subject.title, int(10.5 * width), break_on_hyphens=False)
    below = [line for note in notes for line in textwrap.wrap(note, int(13 * width))]
    rows = 0.2 * len(over) + 0.06, height, 0.16 * len(below) + 0.06
    with matplotlib.rc_context(STYLE):
        if not (over or below):
            sheet = figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
        else:
            sheet = Figure(figsize=(width, sum(rows)), dpi=DPI, layout="constrained")
            top, figure, bottom = sheet.subfigures(3, 1, height_ratios=rows, hspace=0)
            top.text(0.012, 0.5, "\n".join(over), va="center", parse_math=False)
            look: dict[str, Any] = {"fontsize": 9, "color": HERTZ, "ha": "center", "va": "center"}
            bottom.text(0.5, 0.5, "\n".join(below), parse_math=False, **look)
        yield figure
        in_units(figure.axes, subject.units)
        if target is not None:
            # savefig would draw the whole figure once more, unseen, for its layout.
            sheet.get_layout_engine().execute(sheet)
            sheet.set_layout_engine(None)
            sheet.savefig(target, format="png")


class ReaderTicks(AutoLocator):
    """Ticks at round numbers of a unit of which there are `factor` in that of the axis."""

    def __init__(self, factor: float) -> None:
        """factor: number of the reader's units in one unit of the axis."""
        super().__init__()
        self.factor = factor

    def tick_values(self, vmin: float, vmax: float) -> Array:
        """Places of the ticks between two places of the axis."""
        values = super().tick_values(self.factor * vmin, self.factor * vmax)
        return np.asarray(values) / self.factor


def in_units(panels: Sequence[Axes], units: Units) -> None:
    """Give those axes that have mm, um or MPa in their labels the units of a reader: labels and
    numbers of the ticks. What is drawn stays in mm, um and MPa.
    """
    every = [each for axes in panels for each in (axes, *axes.child_axes)]
    for axis in (axis for axes in every for axis in (axes.xaxis, axes.yaxis)):
        label = axis.get_label_text()
        factor = units.value(1.0, label)
        if factor != 1.0:
            axis.set_label_text(units.unit(label))
            if not isinstance(axis.get_major_locator(), FixedLocator):
                axis.set_major_locator(ReaderTicks(factor))
            axis.set_major_formatter(lambda value, _, by=factor: minus(brief(by * value, 6)))


def levels(units: Units, label: str, values: Array, count: int = BANDS) -> Array:
    """Limits (k,) of colour bands that hold zero and values (n,), in the unit of the label, MPa or
    none: round numbers of the reader's unit, zero among them. count: about how many bands.
    """
    factor = units.value(1.0, label)
    low, high = factor * min(values.min(), 0.0), factor * max(values.max(), 0.0)
    ends = MaxNLocator(count).tick_values(low, high if low < high else 1.0)
    return np.asarray(ends / factor, dtype=np.float64)


def pressure(findings: Findings, hertz: Hertz | None, target: Target = None) -> Figure:
    """Contact pressure (MPa) along x and along s (mm), on the lines `Findings.along` and `across`
    through the most loaded patch.

    hertz: exact Hertz contact, drawn beside the result, or None. Of a meridian section there is
        one panel, over the radius.
    """
    count = 1 if findings.subject.revolved else 2  # along and across are the same
    with new_figure(target, 4 + 3 * count, 5.1, findings) as figure:
        panels = figure.subplots(1, count, sharey=True, squeeze=False)[0]
        for axis, axes in enumerate(panels):
            _pressure_line(axes, findings, hertz, axis)
        panels[0].set(ylabel="contact pressure, MPa", ylim=(0, None))
        handles = panels[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=count)
    return figure


def _pressure_line(axes: Axes, findings: Findings, hertz: Hertz | None, axis: int) -> None:
    """Draw on `axes` the computed pressure along x (axis 0) or s (axis 1) through the most loaded
    patch, and that of exact Hertz (`hertz`) unless that is None.
    """
    line: AxisPressure = (findings.along, findings.across)[axis]
    count, units = len(findings.patch.each), findings.subject.units
    shown = findings.patch.each[0] if count else findings.patch
    name = f"{findings.subject.method}, largest pressure {units.text(shown.max_pressure, 'MPa')}"
    look: dict[str, Any] = {"color": FE, "lw": 0.8, "ms": 3.5, "markevery": line.pressure > 0}
    axes.plot(line.coordinate, line.pressure, "o-", label=name, **look)
    axes.set_xlabel(findings.subject.label(axis))
    if not findings.subject.revolved:
        half = (findings.patch.b, findings.patch.a)[axis]
        title = f"cut at {'sx'[axis]} = {rounded(units, line.at, half)} {units.unit('mm')}"
        axes.set_title(title + f", most loaded of {count} patches" * (count > 1), fontsize=11)
    if hertz is not None:
        half = (hertz.a, hertz.b)[axis]
        label = f"exact Hertz, largest pressure {units.text(hertz.p0, 'MPa')}"
        axes.plot(*exact_line(hertz, axis), color=HERTZ, label=label, zorder=3)
        axes.axvline(-half, color=HERTZ, lw=0.8, ls=":")
        axes.axvline(half, color=HERTZ, lw=0.8, ls=":")


def exact_line(contact: Hertz, axis: int) -> tuple[Array, Array]:
    """Coordinates (181,) in mm and pressures (181,) in MPa of an exact Hertz contact on its axis
    along x (axis 0) or s (axis 1); they are dense at the steep edges.
    """
    t = (contact.a, contact.b)[axis] * np.cos(np.linspace(0, np.pi, 181))
    return t, contact.pressure(*((t, 0) if axis == 0 else (0, t)))


def depth(
    findings: Findings,
    hertz: Hertz | None,
    poisson: float,
    target: Target = None,
) -> Figure:
    """Principal stresses and largest shear stress (MPa) over the depth (mm) below the centre of the
    most loaded patch, in two panels; the body shown is that of `Findings.axis`.

    hertz: exact Hertz contact, drawn beside the result below its own centre, or None. poisson:
        Poisson's ratio of the body shown, for the exact stresses.
    """
    axis = findings.axis
    fine = np.linspace(0, float(axis.depth.max()), 301, dtype=np.float64)
    with new_figure(target, 10, 6.6, findings) as figure:
        panels = tuple(figure.subplots(1, 2, sharey=True, width_ratios=(3, 2)))
        units = findings.subject.units
        patch = "most loaded patch" if findings.also else "patch"

        def label(name: str, deep: float, largest: float) -> str:
            """Entry of the legend: name, largest shear stress (MPa) and its depth (mm)."""
            depth = units.text(deep, "mm", 3)
            return f"{name}\n$\\tau$ up to {units.text(largest, 'MPa')}, {depth} deep"

        peak = axis.peak(max_shear(axis.stress))
        name = label(f"{findings.subject.method}, {axis.body}", *peak)
        _stresses(panels, axis.depth, axis.stress, "o", FE, name, peak)
        if hertz is not None:
            name = f"exact Hertz, {hertz.shape}"
            name += ", no friction" if findings.subject.has_friction else ""
            normal = hertz.axis_stress(poisson, fine)
            exact = hertz.axis_extrema(poisson)
            peak = exact.tau_max_depth, exact.tau_max
            stress = np.hstack((normal, np.zeros_like(normal)))  # no shear
            _stresses(panels, fine, stress, "-", HERTZ, label(name, *peak), peak)
        _name_curves(panels[0], axis)
        panels[0].set(
            xlabel="principal stress, MPa",
            ylabel=f"depth in the {axis.body}, below the middle of the {patch}, mm",
        )
        panels[1].set(
            xlabel="largest shear stress $\\tau$, MPa\n(+ its peak on this line)",
            ylim=(axis.depth.max(), 0),
        )
        panels[1].set_xlim(0, 1.08 * panels[1].dataLim.x1)  # a cross is not cut
        handles, labels = panels[1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def minus(text: str) -> str:
    """A number's text with the typographic minus sign, which matplotlib's axes have, in place of
    each hyphen.
    """
    return text.replace("-", "\N{MINUS SIGN}")


def rounded(units: Units, place: float, size: float) -> str:
    """Text of a coordinate (mm), in the reader's unit, with three digits; zero if its magnitude is
    at most 1e-3 of a size (mm).
    """
    return minus(brief(units.value(place if abs(place) > 1e-3 * size else 0.0, "mm"), 3))


def _stresses(
    panels: tuple[Axes, ...],
    at: Array,
    stress: Array,
    style: str,
    colour: str,
    name: str,
    peak: tuple[float, float],
) -> None:
    """Draw principal stresses (first panel) and largest shear stress (second panel) of one result
    over the depth.

    panels: the two axes. at (k,): depths, mm. stress (k, 6): MPa. style: 'o' for points, '-' for a
        line. colour: of both. name: label in the legend. peak: depth (mm) and value (MPa) of the
        largest shear stress, marked by a cross.
    """
    look: dict[str, Any] = {"color": colour, "zorder": 2}
    if style == "o":
        look |= {"markevery": 3, "zorder": 3, "clip_on": False}
    panels[0].plot(principal(stress), at, style, **look)
    panels[1].plot(max_shear(stress), at, style, label=name, **look)
    panels[1].plot(peak[1], peak[0], "+", color=colour, ms=16, mew=1.8, zorder=4)


def _name_curves(axes: Axes, axis: DepthAxis) -> None:
    """Write sigma_1, sigma_2, sigma_3 beside the curves of the principal stresses on a depth axis,
    each at another depth.
    """
    values = principal(axis.stress)
    for number, (share, shift) in enumerate(((0.3, 16), (0.2, -16), (0.35, -16))):
        row = int(share * (len(axis.depth) - 1))
        axes.annotate(
            rf"$\sigma_{number + 1}$",
            (values[row, number], axis.depth[row]),
            xytext=(shift, 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=14,
        )


def over_patches(axes: Axes, drawn: Any, findings: Findings) -> None:
    """Leave of a field that is drawn over x and s what lies inside the outlines of all patches,
    draw these, and give the axes their labels and equal scales.
    """
    from matplotlib.path import Path as Path2D

    outlines = findings.patch.outlines
    inside = Path2D.make_compound_path(*(Path2D(line, closed=True) for line in outlines))
    drawn.set_clip_path(inside, axes.transData)
    for number, line in enumerate(outlines):
        name = findings.subject.method if number == 0 else None
        axes.plot(*line.T, color=FE, lw=1.8, label=name)
    axes.set(xlabel=findings.subject.label(0), ylabel=findings.subject.label(1))
    axes.set_aspect("equal", adjustable="datalim")  # else a narrow patch leaves no room for labels


def patch(findings: Findings, hertz: Hertz | None, target: Target = None) -> Figure:
    """Pressure in bands over all patches, with axes x and s in the tangent plane, and their
    outlines; above, length and width, of several patches share of the load and largest pressure of
    each; not of a section.

    findings: with the whole contact surface, images included. hertz: exact Hertz contact, whose
        outline is drawn too, or None.
    """
    surface, patch, units = findings.surface, findings.patch, findings.subject.units
    curves = patch.outlines + ([] if hertz is None else [hertz.outline])
    low, high = np.min([c.min(0) for c in curves], 0), np.max([c.max(0) for c in curves], 0)
    margin = 0.12 * (high - low).max()
    width, height = high - low + 2 * margin
    scale = 6.5 / max(width, height)
    size = max(width * scale, 4) + 2.2, max(height * scale, 2) + 1.5
    with new_figure(target, *size, findings) as figure:
        axes = figure.subplots(subplot_kw={"axisbelow": True})
        limits = levels(units, "MPa", surface.pressure)
        bands = axes.tricontourf(
            *surface.local.T, surface.triangles, surface.pressure, limits, cmap="YlOrRd"
        )
        over_patches(axes, bands, findings)
        if hertz is not None:
            axes.plot(*hertz.outline.T, "--", color="black", lw=1.2, label="exact Hertz")
        long, wide = (units.text(2 * half, "mm") for half in (patch.a, patch.b))
        if len(patch.each) < 2:
            axes.set_title(f"2a = {long}, 2b = {wide}", fontsize=11)
        for one in patch.each if len(patch.each) > 1 else ():
            x, s, _ = findings.frame.local(np.array([one.centre]))[0]
            text = f"{one.share:.0%} of the load, {units.text(one.max_pressure, 'MPa')}"
            axes.annotate(text, (x, s + one.b), (0, 6), textcoords="offset points", ha="center")
        axes.set_xlim(low[0] - margin, high[0] + margin, auto=True)
        axes.set_ylim(low[1] - margin, high[1] + margin, auto=True)
        figure.colorbar(bands, ax=axes, label="contact pressure, MPa", ticks=limits)
        figure.legend(loc="outside upper center", ncols=2)
    return figure
