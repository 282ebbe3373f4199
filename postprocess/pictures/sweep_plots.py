"""The picture of a sweep: quantities over the varied columns.

Rows are those of the sweep's table; `columns` names the one or two columns that are varied, whose
values may be words.
"""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from railhead.postprocess.findings import Array, Drawing, Subject, Target, Units, keyed
from railhead.postprocess.pictures.diagrams import FE, HERTZ, new_figure

Rows = Sequence[Mapping[str, Any]]
PLACE = "patch y [mm]"
PANELS = {
    "p_max [MPa]": "largest pressure, MPa",
    "area [mm2]": "patch area, mm2",
    PLACE: "patch centre, y, mm",
    "tau_max [MPa]": "largest shear stress, MPa",
}
FRICTION = {"force along [N]": "force along the rail, N", "force across [N]": "force across, N"}
WEAR = {"T-gamma [N]": "T-gamma, N"}
AHEAD = "contact ahead [mm]"
SHAPE = {
    AHEAD: "contact ahead of the smooth one, mm",
    "load share": "load share of the most loaded patch",
    "found approach [mm]": "approach, mm",
}
HEADS = {
    "share rail": "share of the rail",
    "p_max rail [MPa]": "largest pressure, rail, MPa",
    "p_max wing [MPa]": "largest pressure, wing, MPa",
}


def drawings(columns: Sequence[str], rows: Rows, subject: Subject) -> dict[str, Drawing]:
    """The picture of a sweep by name of its PNG file; arguments as of `curves`, with any number of
    columns. Rows are numbered where they are not all combinations of the values of their columns,
    or no column has numbers. Empty without rows or columns, and where rows are all combinations of
    three or more columns.
    """
    if not rows or not columns:
        return {}
    whole = math.prod(len(_values(name, rows)) for name in columns) == len(rows)
    if not whole or not any(_numbers(name, rows) for name in columns):
        columns = ["combination"]
        rows = [{**row, "combination": number} for number, row in enumerate(rows, 1)]
    return {"sweep.png": partial(curves, columns, rows, subject)} if len(columns) < 3 else {}


def samples(
    columns: Sequence[str],
    rows: Rows,
    name: str,
    quantiles: Mapping[str, Any],
    subject: Subject,
    target: Target = None,
) -> Figure:
    """How often a quantity has which value, with its quantiles, and its values over each sampled
    column of at most five; columns of words have a place for each word.

    columns: headers of the sampled columns. rows: of sweep.csv. name: header of the quantity, whose
        label is in PANELS. quantiles: by share, with "value".
    """
    shown = columns[:5]
    height = math.ceil((len(shown) + 1) / 2)
    with new_figure(target, 11, 3.8 * height, subject) as figure:
        first, *others = figure.subplots(height, 2, squeeze=False).ravel()
        found = [row for row in rows if row.get(name) is not None]
        values = _cells(found, name)
        first.hist(values, bins="auto", color=FE)
        for share, own in quantiles.items():
            first.axvline(own["value"], color=HERTZ, lw=1)
            place = {"transform": first.get_xaxis_transform(), "ha": "right", "va": "top"}
            first.text(own["value"], 0.98, f"{float(share):.0%}", rotation=90, **place)
        first.set(xlabel=PANELS[name], ylabel="samples")
        for axes, column in zip(others, shown, strict=False):
            axes.plot([row[column] for row in found], values, ".", color=FE, ms=4)
            axes.set(xlabel=column, ylabel=PANELS[name])
        for axes in others[len(shown) :]:
            axes.set_axis_off()
    return figure


def fatigue_map(
    places: Sequence[float],
    every: Sequence[Mapping[str, Any]],
    subject: Subject,
    target: Target = None,
) -> Figure:
    """Where on the rail head which stress of Dang Van and of Findley was found, over y (mm) and the
    depth (mm); the largest lie on top.

    places: y of the patch of each row, mm. every: "profile" of "fatigue" of each result.
    """
    with new_figure(target, 11, 4.4, subject) as figure:
        for axes, name in zip(figure.subplots(1, 2), ("Dang Van", "Findley"), strict=True):
            key = f"{name.lower().replace(' ', '_')}_MPa"
            stress = np.concatenate([each[key] for each in every])
            depth = np.concatenate([each["depth_mm"] for each in every])
            y, order = (
                np.repeat(np.round(places, 3), [len(each[key]) for each in every]),
                stress.argsort(),
            )
            shown = axes.scatter(y[order], depth[order], c=stress[order], s=9, cmap="inferno_r")
            figure.colorbar(shown, label=f"{name}, MPa")
            axes.set(xlabel="y of the patch, mm (gauge side < 0)", ylabel="depth, mm")
            axes.invert_yaxis()
    return figure


def panels(rows: Rows) -> dict[str, str]:
    """Labels of the panels of `curves` by column: with friction its forces and, where it rolls,
    T-gamma; of surfaces that vary along the rail where they touch, and the approach; of a crossing
    share and pressures of its heads.
    """
    varies = any(row.get(AHEAD) is not None for row in rows)
    known = PANELS | (SHAPE if varies else {}) | HEADS | FRICTION | WEAR
    return {
        name: label
        for name, label in known.items()
        if name in PANELS or any(row.get(name) is not None for row in rows)
    }


def curves(columns: Sequence[str], rows: Rows, subject: Subject, target: Target = None) -> Figure:
    """A panel of each of `panels` over the varied column of numbers with the most values; bars are
    error estimates. What mesh or grid do not resolve is crossed; where the steel would yield, the
    elastic answer is hollow.

    columns: headers of the one or two columns that are varied, of which one has numbers. rows: of
        sweep.csv, cells by column header. subject: title and units. There is a line for each value
        of the other column. Rows whose checks did not pass are ringed; quantities that a row lacks
        are not drawn.
    """
    over, *others = sorted(
        columns, key=lambda name: (not _numbers(name, rows), -len(_values(name, rows)))
    )
    lines = _values(others[0], rows) if others else [None]
    units, shown = subject.units, panels(rows)
    panel_rows = math.ceil(len(shown) / 2)
    with new_figure(target, 11, 3.8 * panel_rows, subject) as figure:
        import matplotlib

        shades = matplotlib.colormaps["viridis"](np.linspace(0, 0.85, len(lines)))
        colours = [FE] if len(lines) == 1 else list(shades)
        grid = figure.subplots(panel_rows, 2, sharex=True, squeeze=False)
        for axes in grid.ravel()[len(shown) :]:
            axes.set_axis_off()
        for axes, (name, label) in zip(grid.ravel(), shown.items(), strict=False):
            for value, colour in zip(lines, colours, strict=True):
                own = [row for row in rows if not others or row[others[0]] == value]
                x, short = _cells(own, over), name.partition(" [")[0]
                order = np.argsort(x)
                found = _cells(own, name)
                of = _cells(own, "mu N [N]") if name in FRICTION else found
                error = np.abs(of * _cells(own, f"{short} estimate"))
                name_of = _word(own[0], others[0], units) if others else ""
                look: dict[str, Any] = {"color": colour, "label": name_of, "capsize": 3}
                axes.errorbar(x[order], found[order], error[order], fmt="o-", **look)
                yields = np.array([bool(row.get("steel")) for row in own])
                axes.plot(x[yields], found[yields], "o", mfc="white", mec=colour, zorder=3)
                bad = np.array([row["checks"] != "passed" for row in own])
                axes.plot(x[bad], found[bad], "o", ms=10, mfc="none", mec=HERTZ, zorder=3)
                names = [str(row.get("below resolution") or "").split("; ") for row in own]
                hidden = np.array([short in each for each in names])
                axes.plot(x[hidden], found[hidden], "x", ms=9, color=HERTZ, zorder=3)
            axes.set_ylabel(label)
            if name not in (PLACE, AHEAD, *FRICTION):
                axes.set_ylim(0, 1.05 * axes.get_ylim()[1])  # room for a ring
            axes.set_xlabel(over)
            axes.tick_params(labelbottom=True)
        estimates = [f"{name.partition(' [')[0]} estimate" for name in shown]
        known = any(row.get(name) is not None for row in rows for name in estimates)
        notes = ["bars: estimated errors"] * known
        if any(row.get("steel") for row in rows):
            notes += ["hollow: elastic answer, the steel would yield"]
        if any(row.get("below resolution") for row in rows):
            notes += ["crossed: below resolution"]
        if any(row["checks"] != "passed" for row in rows):
            notes += ["ringed: a check failed", "not drawn: no result"]
        figure.suptitle("; ".join(notes), fontsize=10)
        if others:
            handles, labels = grid[0, 0].get_legend_handles_labels()
            figure.legend(
                handles, labels, title=units.unit(others[0]), loc="outside right upper", fontsize=9
            )
    return figure


def _cells(rows: Rows, column: str) -> Array:
    """Numbers (n,) of a column, NaN where a row has none."""
    return np.array([row.get(column) for row in rows], dtype=float)


def _values(column: str, rows: Rows) -> list[Any]:
    """Different values of a column, in the order of their first rows."""
    return list(dict.fromkeys(row[column] for row in rows))


def _numbers(column: str, rows: Rows) -> bool:
    """Whether all values of a column in the rows are finite numbers, truth values excluded."""
    return all(
        isinstance(row[column], float | int)
        and not isinstance(row[column], bool)
        and math.isfinite(row[column])
        for row in rows
    )


def _word(row: Mapping[str, Any], column: str, units: Units) -> str:
    """Text of a cell for matplotlib: decimal numbers in their shortest form and the reader's unit,
    no formula.
    """
    value = keyed(column, row[column])
    if isinstance(value, float):
        return f"{units.value(value, column):.6g}"
    return str(value).replace("$", r"\$")
