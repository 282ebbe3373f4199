"""The page of the study thesis: verdicts, pictures, and all claims by chapter."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.theory.elastic import subsurface
from studies.tables import render
from studies.thesis.claims import CLOSE, CLOSE_CURVE, EXACT, Check, Facts, Judged, Verdict
from studies.thesis.rules.hertz import PRINTED_LOAD, under
from studies.thesis.rules.stress import P0, YIELD, exact_stress, thesis_shear
from studies.thesis.runs import DEFAULT, HEXAHEDRA, WHEEL

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
CIRCLE_SHAKEDOWN = 4.7  # p0/k, circular patch
STRIP_SHAKEDOWN = 4.0  # p0/k, line contact


def page(facts: Facts, judged: Sequence[Judged], runs: Sequence[Mapping[str, Any]]) -> str:
    """The whole page; runs: fields of `thesis_runs.Run`, empty without finite elements."""
    return render(
        "thesis",
        facts=facts,
        verdicts=_counts(judged),
        harmless=sum(item.finding.harmless for item in judged),
        differing=[(item.claim, item.finding) for item in judged if not item.agrees],
        exact=EXACT,
        close=CLOSE,
        close_curve=CLOSE_CURVE,
        chapters={
            title: _chapter([item for item in judged if item.claim.chapter == chapter])
            for chapter, title in CHAPTERS.items()
        },
        touches=_touches(facts),
        **_findings(facts),
        **_elements(facts, runs),
        **_strength(facts, runs),
    )


def _counts(judged: Sequence[Judged]) -> list[tuple[object, ...]]:
    ours = Counter(item.finding.verdict for item in judged)
    reference = Counter(item.claim.expected_verdict for item in judged)
    return [*((v, ours[v], reference[v]) for v in Verdict), ("all", len(judged), len(judged))]


def _chapter(judged: Sequence[Judged]) -> tuple[list[list[str]], list[tuple[int, str, str]]]:
    """Lines of the table; number, why not computable and note of the claims that have a remark."""
    rows, remarked = [], []
    for item in judged:
        claim, finding = item.claim, item.finding
        verdict = f"**{finding.verdict}**" + (", harmless" if finding.harmless else "")
        head = [str(claim.id), claim.where, claim.claim, verdict]
        checks: Sequence[Check | None] = finding.checks or (None,)
        for check in checks:
            rows.append([cell.replace("|", "\\|") for cell in (*head, *_cells(check))])
            head = [""] * 4
        if finding.not_computable or finding.note:
            remarked.append((claim.id, finding.not_computable, finding.note))
    return rows, remarked


def _cells(check: Check | None) -> list[str]:
    if check is None:
        return [""] * 4
    unit = f", {check.unit}" if check.unit else ""
    ours = "" if check.ours is None else _value(check.ours)
    if isinstance(check.ours, float) and isinstance(check.exact, float) and check.exact:
        ours += f" ({check.ours / check.exact - 1:+.2%})"
    return [check.what + unit, _value(check.thesis), _value(check.exact), ours]


def _value(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def _findings(facts: Facts) -> dict[str, Any]:
    """Of the five most important ones."""
    c, wheel = facts.ellipse, under(facts.ellipse, WHEEL)
    return {
        "wheel": wheel,
        "wheel_mises": subsurface.axis_extrema(wheel, facts.poisson).von_mises_max,
        "extrema": subsurface.axis_extrema(c, facts.poisson),
        "surface_shear": (exact_stress(facts, 0.0).max() + c.p0) / 2,
        "printed_p0": P0,
        "printed_shear": thesis_shear(facts)[1],
    }


def _touches(facts: Facts) -> list[tuple[str, ...]]:
    """Where the wheel touches the 54E1, by tread and inclination."""
    return [
        (tread, *(f"{facts.profiles[f'y {tread} {i}'] + 0.0:.2f}" for i in ("0", "1:40", "1:20")))
        for tread in ("cylinder", "cone40", "cone20")
    ]


def _elements(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Linear hexahedra with a penalty beside the default, at 25 kN."""
    if not runs:
        return {"coarse": None}
    own = [r for r in runs if r["elements"] == HEXAHEDRA]
    best = next(r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - PRINTED_LOAD) < 1)
    names = ("a", "b", "p0", "tau_max", "tau_depth", "tau_surface")
    lines = []
    for row in (*own, best):
        errors = [f"{row[f'error_{name}']:+.1%}" for name in names]
        cost = row["unknowns"], f"{row['seconds'] / best['seconds']:.2f}"
        size = f"b/{row['per_semi_axis']:.0f}"
        lines.append((row["elements"], size, *cost, *errors, f"{row['surface_ratio']:.3f}"))
    s_x, s_y, _ = exact_stress(facts, 0.0)
    return {"coarse": own[0], "elements": lines, "ratio": s_x / s_y}


def _strength(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """25 kN and a real wheel against yield and shakedown."""
    c = facts.ellipse
    lines = []
    for load in (PRINTED_LOAD, WHEEL):
        contact = under(c, load)
        mises = subsurface.axis_extrema(contact, facts.poisson).von_mises_max
        fe = next((r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - load) < 1), None)
        ours = ("-", "-") if fe is None else (f"{fe['p0']:.0f}", f"{fe['mises_max']:.0f}")
        lines.append((f"{load / 1e3:.1f}", f"{contact.p0:.0f}", ours[0], f"{mises:.0f}", ours[1]))
    share = subsurface.axis_extrema(c, facts.poisson).von_mises_max / c.p0
    strip, circle = (
        (factor, *(factor * sigma / math.sqrt(3) for sigma in YIELD))
        for factor in (STRIP_SHAKEDOWN, CIRCLE_SHAKEDOWN)
    )
    return {
        "loads": lines,
        "share": share,
        "yields": YIELD,
        "onset": tuple(c.load * (sigma / (share * c.p0)) ** 3 / 1e3 for sigma in YIELD),
        "overload": WHEEL / PRINTED_LOAD,
        "strip": strip,
        "circle": circle,
    }
