"""Pictures of profiles without a solution: a wheelset on its track (profiles in contact, places of
the contacts, rolling radii), a measured profile over the nearest standard one, and worn profiles.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from railhead.geometry.measured.measured_profile import Measured, inner
from railhead.geometry.measured.standards import LaidStandard
from railhead.geometry.profiles import FLANGE_HEIGHT, Places
from railhead.geometry.wheelset import Placed
from railhead.postprocess.findings import Array, Subject
from railhead.postprocess.pictures.diagrams import Target, minus, new_figure

RAIL_COLOUR, WHEEL_COLOUR = "#555555", "#1f4e79"
MARK, FURTHER = "#c8502d", "#7b4fa3"
SAMPLES = 1500
RAW, SMOOTH, STANDARD, LOST = "#9a9a9a", "#1f4e79", "#c8502d", "#9a5f00"


def profiles(placed: Placed, subject: Subject, target: Target = None) -> Figure:
    """Two panels: the left and the right wheel on their rails, seen along the track, with all
    contact points.

    The left panel is mirrored, so that it stands as the left side does; its labels of y grow
    towards the field side as those of the right panel do.

    placed: the wheelset's position.
    subject: title and units.
    target: PNG file or None (`new_figure`).
    """
    with new_figure(target, 12, 4.2, subject) as figure:
        axes = figure.subplots(1, 2, sharey=True)
        axes[0].invert_xaxis()
        for ax, side, name in zip(
            axes, (placed.left, placed.right), ("left", "right"), strict=True
        ):
            pair = side.pair
            y = np.linspace(*pair.rail.domain, SAMPLES)
            ax.plot(y, pair.rail.height(y), color=RAIL_COLOUR, label="rail")
            tread = np.linspace(*pair.wheel.domain, SAMPLES)
            outline = pair.outline(side.pose, tread).points
            ax.plot(*outline[:, 1:].T, color=WHEEL_COLOUR, label="wheel")
            for number, touch in enumerate(side.touches):
                colour = FURTHER if number else MARK
                ax.plot(touch.y, touch.z, "o", color=colour)
                ax.annotate(
                    minus(
                        f"{'further' if number else 'first'} contact: "
                        f"y = {subject.units.text(touch.y, 'mm')}, "
                        f"{np.degrees(touch.angle):.2f}°"
                    ),
                    (touch.y, touch.z),
                    (0.5, 0.2 - 0.1 * number),
                    textcoords="axes fraction",
                    ha="center",
                    color=colour,
                    arrowprops={"arrowstyle": "-", "color": colour},
                )
            left, right = ("field", "gauge") if name == "left" else ("gauge", "field")
            look = {"transform": ax.transAxes, "color": RAIL_COLOUR}
            ax.text(0.01, 0.65, f"{left} side", **look)
            ax.text(0.99, 0.65, f"{right} side", ha="right", **look)
            ax.set(title=f"{name} rail", aspect="equal", ylim=(-36, 34))
            ax.set_xlabel("y from the crown centre to the field side, mm")
        axes[0].set_ylabel("z, mm")
        axes[0].legend(loc="upper left")
    return figure


def rolling_radius(
    swept: Sequence[Placed],
    curve: tuple[Array, Array],
    subject: Subject,
    target: Target = None,
) -> Figure:
    """Two panels over the lateral shift: the rolling radius difference, right less left, and the
    places y of the contacts on both rails, all in mm.

    swept: the wheelset at rising shifts.
    curve: shifts (n,) and rolling radius differences (n,), mm, NaN where a contact jumps.
    subject: title and units.
    target: PNG file or None (`new_figure`).
    """
    shifts = np.array([placed.shift for placed in swept])
    with new_figure(target, 9, 7, subject) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.plot(*curve, color=MARK)
        upper.set_ylabel("rolling radius difference,\nright less left, mm")
        further: list[tuple[float, float]] = []
        for name, colour in (("right", WHEEL_COLOUR), ("left", RAIL_COLOUR)):
            touches = [getattr(placed, name).touches for placed in swept]
            first = [each[0].y for each in touches]
            lower.plot(shifts, first, ".", color=colour, ms=4, label=f"{name} rail, first contact")
            for shift, each in zip(shifts, touches, strict=True):
                further += [(shift, touch.y) for touch in each[1:]]
        label = "further contact, with a small gap" if further else None
        lower.plot(*np.reshape(further, (-1, 2)).T, ".", color=FURTHER, label=label)
        lower.set_ylabel("contact on the rail, y, mm\n(gauge side < 0 < field side)")
        lower.set_xlabel("lateral shift to the right, mm")
        lower.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure


def conicity(
    found: Mapping[str, Mapping[float, float | None]], subject: Subject, target: Target = None
) -> Figure:
    """Equivalent conicity over the amplitude, mm.

    found: by label equivalent conicity by amplitude, mm; None where there is none.
    subject: title and units.
    target: PNG file or None (`new_figure`).
    """
    with new_figure(target, 7, 4, subject) as figure:
        ax = figure.subplots()
        for (label, values), colour in zip(found.items(), (MARK, SMOOTH), strict=False):
            known = np.array(list(values.values()), dtype=float)  # None: NaN
            ax.plot(list(values), known, color=colour, label=label)
        if len(found) > 1:
            ax.legend(loc="best")
        ax.set(xlabel="amplitude of the lateral shift, mm", ylim=(0.0, None))
        ax.set_ylabel("equivalent conicity (EN 15302)")
    return figure


def draw_profile(
    found: Measured, worn: LaidStandard | None, subject: Subject, target: Target = None
) -> Figure:
    """Panels over y: the profile with its reference places, the difference of measured and smoothed
    heights, the curvature, and, where a standard fits, the material lost to wear.

    found: measured and smoothed profile.
    worn: the standard profile laid on the measured one; None where none fits.
    subject: units.
    target: PNG file or None (`new_figure`).
    """
    smoothed, profile = found.smoothed, found.profile
    y = np.linspace(*inner(profile), 3000)
    with new_figure(target, 9, 11, subject) as figure:
        ratios = [1.6, 1, 1.4, 1] if worn else [1.6, 1, 1.4]
        panels = figure.subplots(len(ratios), 1, sharex=True, gridspec_kw={"height_ratios": ratios})
        top, left, bend = panels[:3]
        if worn:
            top.plot(*worn.outline.T, color=STANDARD, lw=1.2, label=f"{worn.name}, laid on")
        top.plot(*found.points.T, ".", color=RAW, ms=3, label="measured")
        top.plot(y, profile.height(y), color=SMOOTH, label="smoothed")
        for mark, (name, place) in zip("^sDo", found.places.items(), strict=False):
            top.plot(*place, mark, color=STANDARD, ms=7, mfc="none", label=name)
        title = f"{found.path.name}: {found.body}, {len(found.points)} points"
        top.set_title(title, parse_math=False)
        top.set_ylabel("z, mm")
        raw: dict[str, Any] = {"color": RAW, "ls": "none", "marker": "."}
        noise = 1e3 * smoothed.noise
        left.plot(found.points[:, 0], 1e3 * smoothed.residual, ms=3, **raw)
        left.axhspan(-noise, noise, color=SMOOTH, alpha=0.15, label="noise")
        left.set_ylabel("measured less\nsmoothed, um")
        rough, curvature = smoothed.rough_curvature(), profile.curvature(y)
        bend.plot(found.points[1:-1, 0], rough, ms=2, label="of each three points", **raw)
        bend.plot(y, curvature, color=SMOOTH, label="smoothed")
        span = max(float(np.abs(curvature).max()), 0.02)
        bend.set_ylim(min(1.3 * float(curvature.min()), -0.2 * span), 1.3 * span)
        bend.set_ylabel("curvature, 1/mm\n(convex is positive)")
        if worn:
            lost, loss = panels[3], subject.units.text(worn.largest_loss, "mm", 3)
            lost.plot(worn.y, worn.loss, color=LOST)
            at = worn.y[worn.worst], worn.largest_loss
            lost.plot(*at, "o", color=STANDARD, label=f"largest: {loss}")
            lost.set_ylabel(f"less than {worn.name},\nalong the normal, mm")
        for axes in panels:
            axes.legend(loc="best")
        panels[-1].set_xlabel("y across the track, mm (gauge side and flange on the left)")
    return figure


def passage(
    rows: Sequence[Mapping[str, Any]], names: Sequence[str], subject: Subject, target: Target = None
) -> Figure:
    """Two panels over the position of the axle: the height of the wheel, alone on each head and on
    both, and the places y of the contacts, all in mm.

    rows: of a passage (`railhead locate`): position, heights and places of the heads.
    names: of the heads.
    subject: title and units.
    target: PNG file or None (`new_figure`).
    """
    at = np.array([row["position_mm"] for row in rows])
    with new_figure(target, 9, 7, subject) as figure:
        upper, lower = figure.subplots(2, 1, sharex=True)
        height = np.array([row["wheel_height_mm"] for row in rows])
        upper.plot(at, height, color=MARK, lw=2.5, label="on the rail as it is")
        for name, colour in zip(names, (WHEEL_COLOUR, RAIL_COLOUR), strict=False):
            heads = [row["heads"].get(name, {}) for row in rows]
            alone, y = (
                np.array([head.get(key, np.nan) for head in heads])
                for key in ("height_alone_mm", "y_mm")
            )
            upper.plot(at, alone, "--", color=colour, label=f"on the {name} alone")
            touching = np.array([row["touching"] in (name, "both") for row in rows])
            lower.plot(at, y, ":", color=colour)
            touched = np.where(touching, y, np.nan)
            lower.plot(at, touched, ".", color=colour, ms=4, label=f"touches the {name}")
        spread = float(np.ptp(height)) or 1.0
        upper.set_ylim(height.min() - spread / 2, height.max() + spread / 4)
        upper.set_ylabel("height of the wheel, mm")
        upper.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        lower.set_ylabel("lowest place over the head, y, mm")
        lower.set_xlabel("position of the axle along the sections, mm")
        lower.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure


def worn(
    bodies: Mapping[str, tuple[Places, Array, Array]],
    subject: Subject,
    target: Target = None,
    *,
    depth_limit: float | None,
    flange: tuple[float | None, float | None],
) -> Figure:
    """Of each body the profile, new and worn, with the border of its flange or gauge corner, and
    below it the worn depth along the normal over y, with its error as a band and its limit. Of a
    wheel also where the thickness of its flange is measured, and that limit.

    bodies: by name the places along the new profile, the worn depth (n,) there, and y, depth and
        its error (3, m), mm.
    subject: title.
    target: PNG file or None (`new_figure`).
    depth_limit: mm; None: there is none. flange: its thickness and the limit, mm; None as there.
    """
    with new_figure(target, 5.5 * len(bodies), 6.4, subject) as figure:
        panels = figure.subplots(2, len(bodies), squeeze=False, sharex="col")
        for (above, ax), (body, (places, depth, lines)) in zip(
            panels.T, bodies.items(), strict=True
        ):
            colour = WHEEL_COLOUR if body == "wheel" else RAIL_COLOUR
            above.plot(*places.points.T, color=RAW, lw=1, label="new")
            above.plot(*places.worn(depth).T, color=colour, label="worn")
            border = places.points[places.steep, 0].max(initial=-np.inf)
            for each in (above, ax) if np.isfinite(border) else ():
                name = "gauge corner" if body == "rail" else "flange"
                each.axvline(border, color=LOST, ls=":", label=f"left: {name} (over 15 deg)")
            above.set(title=body, ylabel="z, mm", aspect="equal", adjustable="datalim")
            if body == "wheel":
                above.invert_yaxis()
                thickness, least = flange
                if thickness is not None:
                    text = f"flange {thickness:.2f} mm thick here"
                    text += "" if least is None else f", limit {least:g}"
                    level = np.interp(0.0, *places.points.T) + FLANGE_HEIGHT
                    above.axhline(level, color=MARK, ls="--", lw=1, label=text)
            y, off, error = lines
            ax.plot(y, off, color=colour)
            ax.fill_between(y, off - error, off + error, color=colour, alpha=0.3, lw=0)
            if depth_limit is not None:
                ax.axhline(depth_limit, color=MARK, ls="--", label=f"limit {depth_limit:g} mm")
                ax.legend(loc="best")
            ax.set(xlabel="y to the field side, mm", ylabel="worn along the normal, mm")
            ax.invert_yaxis()
            above.legend(loc="best")
    return figure
