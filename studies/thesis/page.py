"""The page of the study thesis: verdicts, pictures, and all claims by chapter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from studies.tables import render
from studies.thesis import values
from studies.thesis.claims import CLOSE, CLOSE_CURVE, EXACT, Check, Facts, Judged, Verdict

CHAPTERS = {
    "1": "1 Introduction", "2": "2 Literature", "3": "3 Surfaces", "4": "4 Contact point",
    "5": "5 Simulation", "6": "6 Results", "7": "7 Conclusions", "all": "All chapters",
}  # fmt: skip


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
        touches=values.touches(facts),
        **values.findings(facts),
        **values.elements(facts, runs),
        **values.strength(facts, runs),
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
