"""The page of the study thesis: verdicts, pictures, and all claims by chapter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.studies.tables import table
from railhead.studies.thesis import text as thesis_text
from railhead.studies.thesis.claims import CLOSE, CLOSE_CURVE, EXACT, Check, Facts, Judged, Verdict

CHAPTERS = {
    "1": "1 Introduction", "2": "2 Literature", "3": "3 Surfaces", "4": "4 Contact point",
    "5": "5 Simulation", "6": "6 Results", "7": "7 Conclusions", "all": "All chapters",
}  # fmt: skip
PICTURES = (
    (
        "thesis_patch",
        "Figures 6.1 to 6.3",
        "Colours: finite elements (without them, exact); lines: exact Hertz; dashed: the patch. "
        "The thesis's formulas know no place on the patch, only its centre.",
    ),
    (
        "thesis_lines",
        "Figures 6.4 to 6.7",
        "Left and middle: eqs 5.2 and 5.3 with the radius in the place of the depth, as the labels "
        "of the thesis have it; dotted: the edge of the patch. Middle: nodal stresses, as a "
        "finite-element program shows them.",
    ),
    (
        "thesis_loads",
        "Figures 6.8 to 6.10",
        "Dotted verticals: 25 kN and half a 22.5 t axle. The thesis's line lies on the exact one. "
        "In 6.10 the pressure rises or falls with the radius, depending on what changes it, which "
        "the thesis does not say.",
    ),
)


def page(facts: Facts, judged: Sequence[Judged], runs: Sequence[Mapping[str, Any]]) -> str:
    """The whole page; runs: fields of `thesis_runs.Run`, empty without finite elements."""
    parts = [
        "# The claims of the thesis",
        thesis_text.INTRODUCTION,
        _counts(judged),
        _differing(judged),
        "## Five findings",
        thesis_text.findings(facts),
        "## Figures 6.1 to 6.10",
        *(f"![{title}]({name}.png)\n\n{title}. {text}" for name, title, text in PICTURES),
        "## Chapters 3 and 4, corrected",
        thesis_text.equations(facts),
        "## What the thesis's finite elements could not see",
        thesis_text.elements(facts, runs),
        "## Load, yield and shakedown",
        thesis_text.strength(facts, runs),
        "## All claims",
        f"Rule: a number is correct within {EXACT:.1%} or half a unit of its last printed digit, "
        f"approximate within {CLOSE:.0%} (a curve within {CLOSE_CURVE:.0%} of the pressure), else "
        "wrong; a claim whose checks disagree is partly correct, one that only contradicts the "
        "thesis's own numbers inconsistent. Ours: finite elements, with the difference from the "
        "exact value, or another computation.",
        *(_chapter(judged, chapter) for chapter in CHAPTERS),
    ]
    return "\n\n".join(parts) + "\n"


def _counts(judged: Sequence[Judged]) -> str:
    ours = Counter(item.finding.verdict for item in judged)
    reference = Counter(item.claim.expected_verdict for item in judged)
    harmless = sum(item.finding.harmless for item in judged)
    lines: list[tuple[object, ...]] = [(v, ours[v], reference[v]) for v in Verdict]
    return (
        table(("verdict", "computed", "reference"), [*lines, ("all", len(judged), len(judged))])
        + f"\n\nOf the wrong ones, {harmless} change no result by more than {EXACT:.1%}."
    )


def _differing(judged: Sequence[Judged]) -> str:
    lines = [
        f"- {item.claim.id}: computed {item.finding.verdict}, reference {item.claim.expected}. "
        + item.finding.note
        for item in judged
        if not item.agrees
    ]
    if not lines:
        return "No verdict differs from the reference's."
    return "Verdicts that differ from the reference's:\n\n" + "\n".join(lines)


def _chapter(judged: Sequence[Judged], chapter: str) -> str:
    own = [item for item in judged if item.claim.chapter == chapter]
    rows, notes = [], []
    for item in own:
        claim, finding = item.claim, item.finding
        verdict = f"**{finding.verdict}**" + (", harmless" if finding.harmless else "")
        head = [str(claim.id), claim.where, claim.claim, verdict]
        checks: Sequence[Check | None] = finding.checks or (None,)
        for check in checks:
            rows.append([*head, *_cells(check)])
            head = [""] * 4
        reason = finding.not_computable and f"Not computable: {finding.not_computable}."
        remark = " ".join(filter(None, (reason, finding.note)))
        if remark:
            notes.append(f"- {claim.id}: {remark}")
    header = ("no.", "where", "claim", "verdict", "check", "thesis", "exact", "ours")
    safe = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    text = [f"### {CHAPTERS[chapter]}", table(header, safe)]
    return "\n\n".join([*text, "\n".join(notes)] if notes else text)


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
