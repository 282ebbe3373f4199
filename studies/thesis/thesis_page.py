"""The page of the study thesis: verdicts, and their numbers by chapter; figures 6.1 to 6.7 of the
thesis drawn again from its formulas, exact Hertz and finite elements."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array, AxisPressure, DepthAxis, Findings, Surface
from railhead.postprocess.patch.surface import facing_facets, triangulated
from railhead.postprocess.pictures.diagrams import FE, GREY, HERTZ, new_figure
from railhead.postprocess.stress.gauss_points import nodal_stress
from railhead.solver.system.fields import Fields
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.subsurface import max_shear, principal, stress
from studies.tables import render
from studies.thesis.claims import CLOSE, CLOSE_CURVE, EXACT, Claim, Finding, Verdict
from studies.thesis.facts import (
    INCLINATIONS,
    LOAD,
    P0,
    TREADS,
    WHEEL,
    YIELD,
    A,
    Facts,
    thesis_axis_stress,
)

CHAPTERS = {
    "1": "1 Introduction",
    "2": "2 Literature",
    "3": "3 Surfaces",
    "4": "4 Contact point",
    "5": "5 Simulation",
    "6": "6 Results",
    "7": "7 Conclusions",
    "all": "All chapters",
}
DEFAULT, HEXAHEDRA = "quadratic tetrahedra, Nitsche", "linear hexahedra, penalty"
Judged = tuple[Claim, Finding]
CIRCLE_SHAKEDOWN = 4.7  # p0/k, circular patch
STRIP_SHAKEDOWN = 4.0  # p0/k, line contact


def page(facts: Facts, judged: Sequence[Judged], runs: Sequence[Mapping[str, Any]]) -> str:
    """The whole page; runs: rows of `thesis.runs`, empty without finite elements."""
    ours = Counter(finding.verdict for _, finding in judged)
    reference = Counter(claim.expected_verdict for claim, _ in judged)
    total = ("all", len(judged), len(judged))
    return render(
        "thesis",
        facts=facts,
        verdicts=[*((v, ours[v], reference[v]) for v in Verdict), total],
        harmless=sum(finding.harmless for _, finding in judged),
        differing=[pair for pair in judged if pair[1].verdict != pair[0].expected_verdict],
        exact=EXACT,
        close=CLOSE,
        close_curve=CLOSE_CURVE,
        kinds=list(Verdict),
        chapters=[
            _chapter(title, [pair for pair in judged if pair[0].chapter == chapter])
            for chapter, title in CHAPTERS.items()
        ],
        touches=[
            (tread, *(f"{facts.profiles[f'y {tread} {i}'] + 0.0:.2f}" for i in INCLINATIONS))
            for tread in TREADS
        ],
        wheel=facts.real,
        wheel_mises=_mises(facts.real, facts),
        extrema=facts.extrema,
        surface_shear=(facts.stress(0.0).max() + facts.ellipse.p0) / 2,
        printed_p0=P0,
        printed_shear=facts.printed_shear[1],
        **_elements(facts, runs),
        **_strength(facts, runs),
    )


def _mises(contact: Ellipse, facts: Facts) -> float:
    """Largest von Mises stress on the axis of a contact, MPa."""
    return contact.axis_extrema(facts.poisson).von_mises_max


def _chapter(title: str, judged: Sequence[Judged]) -> list[str]:
    """Cells of a chapter: its title, number of its claims, and of those with each verdict."""
    found = Counter(finding.verdict for _, finding in judged)
    return [title, str(len(judged)), *(str(found[verdict]) for verdict in Verdict)]


def _at(runs: Sequence[Mapping[str, Any]], load: float) -> Mapping[str, Any] | None:
    """The run with the default elements under a load in N."""
    own = (r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - load) < 1)
    return next(own, None)


def _elements(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Values of the page's template: linear hexahedra with a penalty beside the default, at 25 kN;
    `coarse` alone, as None, without finite elements."""
    own, best = [r for r in runs if r["elements"] == HEXAHEDRA], _at(runs, LOAD)
    if best is None:
        return {"coarse": None}
    names = ("a", "b", "p0", "tau_max", "tau_depth", "tau_surface")
    lines = [
        (
            row["elements"],
            f"b/{row['per_semi_axis']:.0f}",
            row["unknowns"],
            f"{row['seconds'] / best['seconds']:.2f}",
            *(f"{row[f'error_{name}']:+.1%}" for name in names),
            f"{row['surface_ratio']:.3f}",
        )
        for row in (*own, best)
    ]
    s_x, s_y, _ = facts.stress(0.0)
    return {"coarse": own[0], "elements": lines, "ratio": s_x / s_y}


def _strength(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Values of the page's template: 25 kN and a real wheel against yield and shakedown."""
    c, lines = facts.ellipse, []
    for contact in (facts.under(LOAD), facts.real):
        fe = _at(runs, contact.load)
        ours = ("-", "-") if fe is None else (f"{fe['p0']:.0f}", f"{fe['mises_max']:.0f}")
        mises = f"{_mises(contact, facts):.0f}"
        load = f"{contact.load / 1e3:.1f}"
        lines.append((load, f"{contact.p0:.0f}", ours[0], mises, ours[1]))
    share = facts.extrema.von_mises_max / c.p0
    strip, circle = (
        (factor, *(factor * sigma / math.sqrt(3) for sigma in YIELD))
        for factor in (STRIP_SHAKEDOWN, CIRCLE_SHAKEDOWN)
    )
    return {
        "loads": lines,
        "share": share,
        "yields": YIELD,
        "onset": tuple(c.load * (sigma / (share * c.p0)) ** 3 / 1e3 for sigma in YIELD),
        "overload": WHEEL / LOAD,
        "strip": strip,
        "circle": circle,
    }


LABELS = (r"$\sigma_1$", r"$\sigma_2$", r"$\sigma_3$", r"$\tau_{max}$")
PLACES = ((0.08, -12, 6), (0.2, 12, -12), (0.3, 10, -14), (0.3, 10, 12))
"""Of the labels: share of the curve, and offset in points."""
MARKS: dict[str, Any] = {"color": FE, "lw": 0, "marker": "o", "ms": 4, "zorder": 3}
ROUTES = (
    ("finite elements", MARKS),
    ("exact Hertz", {"color": HERTZ}),
    ("thesis", {"color": GREY, "ls": "--"}),
)


@dataclass(frozen=True)
class Sampled:
    """Finite-element stresses that the pictures show.

    patch: the three principal stresses on the patch, a surface for each.
    radius: x (k,) of nodes on the surface, from the centre of the patch, mm.
    along: nodal stresses (k, 6) at these distances, MPa.
    axis: stresses on the axis below the patch.
    pressure: pressure along x.
    """

    patch: tuple[Surface, Surface, Surface]
    radius: Array
    along: Array
    axis: DepthAxis
    pressure: AxisPressure


def sample(fields: Fields, found: Findings) -> Sampled:
    """Read out of a solution cut at y = 0 what the pictures need."""
    nodes, triangles = triangulated(fields, facing_facets(fields))
    stresses, points = nodal_stress(fields)[nodes], fields.points[nodes]
    values, local = principal(stresses), found.frame.local(points)[:, :2]
    still, moved = np.zeros(len(nodes)), fields.displacement[nodes]
    maps = [
        symmetry.surface(
            Surface(
                points=points,
                local=local,
                triangles=triangles,
                pressure=values[:, i],
                gap=still,
                displacement=moved,
            ),
            fields.mirrors,
        )
        for i in range(3)
    ]
    line = np.flatnonzero((np.abs(local[:, 1]) < 1e-6) & (local[:, 0] <= 1.5 * found.patch.a))
    line = line[np.argsort(local[line, 0])]
    return Sampled(
        (maps[0], maps[1], maps[2]), local[line, 0], stresses[line], found.axis, found.along
    )


def patch(facts: Facts, fe: Sampled | None, path: Path) -> None:
    """Draw figures 6.1 to 6.3: principal stresses on the patch; colours: finite elements, or exact
    where there are none; lines: exact. The thesis has one value for each, at the centre."""
    c = facts.ellipse
    x, y = np.meshgrid(np.linspace(-1.3, 1.3, 131) * c.a, np.linspace(-1.3, 1.3, 131) * c.b)
    points = np.column_stack((x.ravel(), y.ravel(), np.zeros(x.size)))
    exact = principal(stress(c, facts.poisson, points)).reshape(*x.shape, 3)
    printed = thesis_axis_stress(P0, A, facts.poisson, 0.0)[0]
    with new_figure(path, 13.5, 3.8) as figure:
        for i, axes in enumerate(figure.subplots(1, 3, sharey=True)):
            levels = np.arange(-800, 101, 100) if i < 2 else np.arange(-800, 1, 100)
            if fe is None:
                bands = axes.contourf(x, y, exact[..., i], levels, cmap="YlOrRd_r", extend="both")
            else:
                s = fe.patch[i]
                bands = axes.tricontourf(
                    *s.local.T, s.triangles, s.pressure, levels, cmap="YlOrRd_r", extend="both"
                )
            axes.contour(
                x, y, exact[..., i], levels, colors="black", linewidths=0.7, linestyles="solid"
            )
            axes.plot(*c.outline.T, "--", color="black", lw=1.4)
            axes.set(
                xlabel="x, along the rail, mm", aspect="equal", xlim=(-5.6, 5.6), ylim=(-4.5, 4.5)
            )
            axes.set_title(
                f"6.{i + 1}: {LABELS[i]}\ncentre: exact ${exact[65, 65, i]:.0f}$, "
                f"thesis ${printed[i]:.0f}$ MPa",
                fontsize=11,
            )
            figure.colorbar(bands, ax=axes, label="MPa", shrink=0.8)
        figure.axes[0].set_ylabel("y, across the rail, mm")


def lines(facts: Facts, fe: Sampled | None, path: Path) -> None:
    """Draw figures 6.4 to 6.7: stresses along the major radius on the surface, and over depth; fe:
    None without finite elements."""
    c = facts.ellipse
    t = 1.5 * c.a * np.sin(np.linspace(-1, 1, 241) * np.pi / 2)
    surface = stress(c, facts.poisson, np.outer(t, (1.0, 0.0, 0.0)))
    mistaken = _diagonal(thesis_axis_stress(P0, A, facts.poisson, t))
    depth = np.linspace(0, 3 * c.b, 241, dtype=np.float64)
    with new_figure(path, 13.5, 5.6) as figure:
        left, middle, right = figure.subplots(1, 3)
        for values, look in ((surface[:, 2], 1), (mistaken[:, 2], 2)):
            left.plot(t, values, **ROUTES[look][1])
        if fe is not None:
            left.plot(fe.pressure.coordinate, -fe.pressure.pressure, **MARKS)
        half = t >= 0
        _four(middle, t[half], surface[half], 1)
        _four(middle, t[half], mistaken[half], 2)
        _four(right, depth, _diagonal(c.axis_stress(facts.poisson, depth)), 1, True)
        _four(right, depth, _diagonal(thesis_axis_stress(P0, A, facts.poisson, depth)), 2)
        if fe is not None:
            _four(middle, fe.radius, fe.along, 0)
            _four(right, fe.axis.depth[::5], fe.axis.stress[::5], 0)
        for axes, title, label in (
            (left, r"6.4: $\sigma_3$ along the major radius", "x, mm"),
            (middle, "6.5, 6.6: on the surface along the major radius", "x, mm"),
            (right, "6.7: below the centre", "depth, mm"),
        ):
            axes.set(title=title, xlabel=label, ylabel="stress, MPa")
        for axes in (left, middle):
            axes.axvline(c.a, color="black", lw=0.8, ls=":")
        shown = ROUTES if fe else ROUTES[1:]
        handles = [Line2D([], [], **look) for _, look in shown]
        figure.legend(handles, [name for name, _ in shown], loc="outside upper center", ncols=3)


def _four(axes: Axes, at: Array, stresses: Array, route: int, named: bool = False) -> None:
    """Draw principal stresses and largest shear of stresses (k, 6), MPa, over `at` (k,), mm; route:
    index in ROUTES; named: whether names stand beside the curves."""
    curves = np.column_stack((principal(stresses), max_shear(stresses)))
    axes.plot(at, curves, **ROUTES[route][1])
    for i, (share, x, y) in enumerate(PLACES if named else ()):
        row = int(share * len(at))
        axes.annotate(
            LABELS[i],
            (at[row], curves[row, i]),
            xytext=(x, y),
            fontsize=13,
            textcoords="offset points",
            ha="center",
            va="center",
        )


def _diagonal(normal: Array) -> Array:
    """(n, 3) normal stresses -> (n, 6) without shear."""
    return np.hstack((normal, np.zeros_like(normal)))
