"""Every claim of the 2012 thesis, computed again: exact theory, geometry and finite elements."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from railhead.scene import catalogue
from studies import tables
from studies.thesis import page, plots, runs
from studies.thesis.claims import Claim, Finding, read_claims
from studies.thesis.facts import Facts, facts
from studies.thesis.rules import RULES

CASE = "uic54_thesis"


def main(out: Path, *, quick: bool) -> None:
    """Write thesis.csv, thesis_runs.csv, three pictures and the page; quick: closed forms only."""
    scene = catalogue.find(CASE)
    given = facts(scene)
    rows, fe, sampled = ([], {}, None) if quick else runs.measure(scene, given.ellipse)
    given = replace(given, fe=fe)
    judged = judge(given)
    plots.patch(given, sampled, out / "thesis_patch.png")
    plots.lines(given, sampled, out / "thesis_lines.png")
    plots.loads(given, [r for r in rows if r["elements"] == runs.DEFAULT], out / "thesis_loads.png")
    checks = [row for pair in judged for row in _rows(*pair)]
    text = page.page(given, judged, rows)
    tables.publish(out, text, runs.UNITS, thesis=checks, thesis_runs=rows)


def judge(given: Facts) -> list[tuple[Claim, Finding]]:
    """All claims in order, each with what its rule finds."""
    return [(claim, RULES[claim.id](given)) for claim in read_claims()]


def _rows(claim: Claim, finding: Finding) -> list[dict[str, Any]]:
    """The checks of a claim, for the CSV; one row without numbers where it has none."""
    head = {
        "claim": claim.id,
        "where": claim.where,
        "verdict": finding.verdict,
        "reference": claim.expected,
    }
    none = dict.fromkeys(("check", "thesis", "exact", "ours", "unit", "grade"), "")
    checks: list[dict[str, Any]] = [
        {
            "check": check.what,
            "thesis": check.thesis,
            "exact": check.exact,
            "ours": check.ours,
            "unit": check.unit,
            "grade": check.grade.name.lower(),
        }
        for check in finding.checks
    ]
    return [head | check for check in checks or [none | {"check": "none"}]]
