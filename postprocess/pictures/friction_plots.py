"""Pictures of friction: zones of stick and slip with tractions, and the shakedown map."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

from railhead.postprocess.findings import Array, Findings, Subject, brief
from railhead.postprocess.pictures.diagrams import (
    FE,
    GREY,
    HERTZ,
    Target,
    new_figure,
    over_patches,
    rounded,
)
from railhead.theory import damage
from railhead.theory.friction.solution import FrictionSolution

STICK, SLIP, ACROSS = "#d3e4f3", "#e08a4f", "#3f7d54"  # light and dark: told apart in grey, too
SAFE, ONCE, NEVER = "#e3f0e6", "#fdf3d9", "#fae3e0"  # elastic, shakes down, ratchets
ARROWS = 17  # along the longer side of the patch
LONG = 1.1  # cells of their grid: the longest arrow
CELLS = 400  # of the map, along each side
WIDE, HIGH = 0.6, 6.0  # traction coefficient and p0/k, at least
POINTS = 61


def draw_tractions(
    found: FrictionSolution,
    findings: Findings,
    target: Target = None,
) -> Figure:
    """Tractions of the wheel on the rail.

    One panel shows the zones of stick and slip in the tangent plane, with tractions as arrows; of a
    section it is left out. With heat one shows the temperature rise of the rail's surface. The last
    shows tractions along and across over x, between the limits +/- mu p. They are interpolated on
    the line at the s of the centre of the most loaded patch. Of a section it shows those along its
    line, over the coordinate along it. Only points with pressure are used.

    found: solution at the points of the whole model.
    """
    frame, patch, subject = findings.frame, findings.patch, findings.subject
    touches = found.pressure > 0
    local = frame.local(found.points[touches])[:, :2]
    traction = found.traction[touches] @ frame.axes.T[:, :2]
    bound, sticks = found.bound[touches], found.sticks[touches]
    extent = np.ptp(local, axis=0)
    flat = extent.min() < 1e-9
    line = int(flat and extent[1] > extent[0])  # 0: along x, 1: along s
    hot = None if flat or found.rise_rail is None else found.rise_rail[touches]
    count = (1 if flat else 2) + (hot is not None)
    with new_figure(target, 2 + 5 * count, 5.4, findings) as figure:
        *maps, axes = figure.subplots(1, count, squeeze=False)[0]
        if hot is not None:
            _rise(maps.pop(0), local, hot, findings)
        values: Array = np.column_stack([traction, bound, sticks])
        if flat:
            order = np.argsort(local[:, line])
            x, values = local[order, line], values[order]
        else:
            _map(maps[0], local, traction, sticks, findings)
            middle, s = patch.centre
            x = np.linspace(middle - patch.a, middle + patch.a, CELLS)
            values = LinearNDInterpolator(local, values)(x, s)
            place = rounded(subject.units, s, 0.1 * patch.b)
            axes.set_title(f"cut at s = {place} {subject.units.unit('mm')}", fontsize=11)
        slides = values[:, 3] < 0.5
        for where, colour, name in ((~slides, STICK, "sticks"), (slides, SLIP, "slips")):
            band = {"transform": axes.get_xaxis_transform(), "color": colour, "alpha": 0.5}
            known = where & np.isfinite(values[:, 3])
            axes.fill_between(x, 0, 1, where=known, lw=0, label=name if flat else None, **band)
        name = r"friction times pressure, $\pm\mu p$"
        axes.plot(x, values[:, 2], color=HERTZ, lw=1.2, label=name)
        axes.plot(x, -values[:, 2], color=HERTZ, lw=1.2)
        ways = ("along", FE), ("across", ACROSS)
        for axis in [line] if flat else (0, 1):
            way, colour = ways[axis]
            axes.plot(x, values[:, axis], color=colour, label=f"traction {way} the rail")
        axes.set(xlabel=subject.label(line), ylabel="traction of the wheel on the rail, MPa")
        handles = axes.get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper right", ncols=1 + count)
    return figure


def _rise(axes: Axes, local: Array, rise: Array, findings: Findings) -> None:
    """Draw the rise (n,) of the rail's surface temperature, K, at x and s (n, 2), mm."""
    drawn = axes.tripcolor(*local.T, rise, shading="gouraud", cmap="inferno")
    over_patches(axes, drawn, findings)
    axes.figure.colorbar(drawn, ax=axes, label="temperature rise, rail, K")


def _map(
    axes: Axes,
    local: Array,
    traction: Array,
    sticks: NDArray[np.bool_],
    findings: Findings,
) -> None:
    """Draw the zones of stick and slip within the patches, each place as the nearest point, with
    tractions as arrows at a few points.

    local (n, 2): x and s of the contact points, mm. traction (n, 2): along x and s, MPa. sticks
        (n,): whether each point sticks. findings: with the outlines of the patches.
    """
    from matplotlib.patches import Patch

    units, (low, high), tree = findings.subject.units, findings.patch.box, cKDTree(local)
    x, s = (np.linspace(low[k], high[k], CELLS) for k in (0, 1))
    near = tree.query(np.stack(np.meshgrid(x, s), axis=-1))[1]
    zones = axes.contourf(x, s, sticks[near], levels=[-0.5, 0.5, 1.5], colors=[SLIP, STICK])
    over_patches(axes, zones, findings)
    cell = float(np.ptp(local, axis=0).max()) / ARROWS
    places = np.meshgrid(*(np.arange(low[k] + cell / 2, high[k], cell) for k in (0, 1)))
    few = np.unique(tree.query(np.stack(places, axis=-1), distance_upper_bound=cell / 2)[1])
    few = few[few < len(local)]  # where a point is that near
    largest = float(np.hypot(*traction.T).max())
    longest = {"scale": largest / (LONG * cell), "scale_units": "xy", "angles": "xy"}
    arrows = axes.quiver(*local[few].T, *traction[few].T, color=FE, width=0.004, **longest)
    shown = float(f"{units.value(largest, 'MPa'):.1g}")
    text = f"traction {brief(shown)} {units.unit('MPa')}"
    axes.quiverkey(arrows, 0.72, 1.05, shown / units.value(1.0, "MPa"), text, labelpos="E")
    names = [Patch(color=STICK, label="sticks"), Patch(color=SLIP, label="slips")]
    axes.legend(handles=names, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def draw_fatigue(fatigue: Mapping[str, Any], subject: Subject, target: Target = None) -> Figure:
    """Stresses of Dang Van and Findley (MPa) over the depth (mm), the largest of each with the
    angle of its plane, and limits where there are any.

    fatigue: "fatigue" of a result in summary.json. subject: gives the title.
    """
    profile = fatigue["profile"]
    with new_figure(target, 7.4, 5.4, subject) as figure:
        axes = figure.subplots()
        for name, colour in (("dang_van", FE), ("findley", HERTZ)):
            key, word = f"{name}_MPa", name.replace("_", " ").title()
            largest, deep = fatigue[key], fatigue["depth_mm"][name]
            label = f"{word}, {subject.units.text(largest, 'MPa')}"
            label += f" on planes {fatigue['plane_deg'][name]:.0f} degrees from the surface"
            axes.plot(profile[key], profile["depth_mm"], "o-", color=colour, label=label)
            axes.plot(largest, deep, "o", color=colour, ms=9)
            if share := fatigue.get(f"{name}_over_limit"):
                axes.axvline(largest / share, color=colour, ls=":", label=f"limit of {word}")
        axes.set(xlim=(0, None), xlabel="stress, MPa", ylabel="depth, mm")
        axes.invert_yaxis()
        figure.legend(loc="outside upper center")
    return figure


def draw_shakedown(
    friction: Mapping[str, Any], poisson: float, subject: Subject, target: Target = None
) -> Figure:
    """The shakedown map, p0/k over the traction coefficient, with the point of a result and its
    limits,
    and the loads that belong to p0/k.

    friction: "yield" of a result in summary.json. poisson: Poisson's
        ratio, for the limits of a line contact under full slip. subject: gives the title.
    """
    used, ratio = friction["traction_coefficient"], friction["p0_over_k"]
    shares, top = np.linspace(0.0, max(WIDE, 1.1 * used), POINTS), max(HIGH, 1.1 * ratio)
    limits = [damage.shakedown_limit(each, poisson) for each in shares]
    elastic = [damage.elastic_limit(each, poisson) for each in shares]
    load, power = friction["load_N"], math.log(friction["load_over_first_yield"])
    first, last = friction["first_yield_p0_over_k"], friction["shakedown_limit_p0_over_k"]
    power = round(power / math.log(ratio / first)) if ratio != first else 3
    with new_figure(target, 7.4, 5.4, subject) as figure:
        axes = figure.subplots()
        words = f"elastic below {first:.3g}", f"shakes down below {last:.3g}", "ratchets"
        ends = pairwise((0.0, first, last, top))
        heights = 0.04 * top, (first + last) / 2, 0.96 * top
        drawn = zip(ends, (SAFE, ONCE, NEVER), heights, words, strict=True)
        for (low, high), colour, height, word in drawn:
            axes.axhspan(low, high, color=colour, lw=0, zorder=0)
            axes.text(0.98 * shares[-1], height, word, ha="right", va="center")
        axes.plot(shares, limits, color=HERTZ, label="shakedown limit of a line, full slip")
        axes.plot(shares, elastic, "--", color=HERTZ, label="first yield of a line, full slip")
        sliding = shares[shares > 1 / (2 * HIGH)]
        axes.plot(sliding, 1 / sliding, ":", color=GREY, label="surface fatigue index FI = 0")
        name = "shakedown limit of a circle without friction"
        axes.plot(0, damage.CIRCLE, "^", color=HERTZ, clip_on=False, label=name)
        index = friction.get("surface_fatigue_index")
        name = f"this patch: {friction['shakedown']}"
        name += "" if index is None else f", FI = {index:.2f}"
        axes.plot(used, ratio, "o", color=FE, ms=8, clip_on=False, label=name)
        axes.set(
            xlim=(0, shares[-1]),
            ylim=(0, top),
            xlabel="traction coefficient: tangential over normal force",
            ylabel="largest elastic pressure over shear yield, p0/k",
        )
        loads = axes.secondary_yaxis(
            "right",
            functions=(
                lambda y: 1e-3 * load * (np.maximum(y, 0) / ratio) ** power,
                lambda f: ratio * (np.maximum(f, 0) / (1e-3 * load)) ** (1 / power),
            ),
        )
        loads.set_ylabel("load, kN")
        bands = f"Colours: this patch {'with its tractions' if used else 'without tractions'}"
        figure.legend(loc="outside upper center", ncols=2, title=bands)
    return figure
