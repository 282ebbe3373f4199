"""The page of the study thesis: verdicts, pictures, and all claims by chapter."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies.tables import render
from studies.thesis.claims import CLOSE, CLOSE_CURVE, EXACT, Check, Claim, Finding, Verdict
from studies.thesis.facts import INCLINATIONS, LOAD, P0, TREADS, WHEEL, YIELD, Facts
from studies.thesis.runs import DEFAULT, HEXAHEDRA

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
        chapters={
            title: _chapter([pair for pair in judged if pair[0].chapter == chapter])
            for chapter, title in CHAPTERS.items()
        },
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
    return subsurface.axis_extrema(contact, facts.poisson).von_mises_max


def _chapter(judged: Sequence[Judged]) -> tuple[list[list[str]], list[tuple[int, str, str]]]:
    """Lines of the table; number, why not computable and note of the claims that have a remark."""
    rows = []
    for claim, finding in judged:
        verdict = f"**{finding.verdict}**" + (", harmless" if finding.harmless else "")
        head = [str(claim.id), claim.where, claim.claim, verdict]
        for cells in [_cells(check) for check in finding.checks] or [[""] * 4]:
            rows.append([cell.replace("|", "\\|") for cell in (*head, *cells)])
            head = [""] * 4
    remarked = [(claim.id, each.not_computable, each.note) for claim, each in judged]
    return rows, [remark for remark in remarked if any(remark[1:])]


def _cells(check: Check) -> list[str]:
    unit = f", {check.unit}" if check.unit else ""
    ours = "" if check.ours is None else _value(check.ours)
    if isinstance(check.ours, float) and isinstance(check.exact, float) and check.exact:
        ours += f" ({check.ours / check.exact - 1:+.2%})"
    return [check.what + unit, _value(check.thesis), _value(check.exact), ours]


def _value(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def _at(runs: Sequence[Mapping[str, Any]], load: float) -> Mapping[str, Any] | None:
    """The run with the default elements under a load in N."""
    own = (r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - load) < 1)
    return next(own, None)


def _elements(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Linear hexahedra with a penalty beside the default, at 25 kN."""
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
    """25 kN and a real wheel against yield and shakedown."""
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
