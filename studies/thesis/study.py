"""Every claim of the 2012 thesis, computed again: exact theory, geometry and finite elements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from railhead.cli import study
from railhead.contact import solid as geometry
from railhead.geometry import profiles, wheelset
from railhead.geometry.placement import Pair
from railhead.planning.references import closed_forms
from railhead.scene import catalogue
from railhead.theory.bem import boundary_element
from studies import tables
from studies.thesis import formulas
from studies.thesis.claims import Check, Facts, Judged, read_claims
from studies.thesis.rules import RULES, stress

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

STUDY = "every claim of the 2012 thesis recomputed, with a verdict, and its figures drawn again"
CASE = "uic54_thesis"
TREADS, INCLINATIONS = ("cylinder", "cone40", "cone20"), {"0": 0.0, "1:40": 1 / 40, "1:20": 1 / 20}


@dataclass(frozen=True)
class Row:
    """One check of one claim, for the CSV."""

    claim: int
    where: str
    verdict: str
    reference: str
    check: str
    thesis: float | str
    exact: float | str
    ours: float | str | None
    unit: str
    grade: str


def main(out: Path, *, quick: bool) -> None:
    """Write thesis.csv, thesis_runs.csv, three pictures and the page; quick: closed forms only."""
    from studies.thesis import page as thesis_page
    from studies.thesis import plots as thesis_plots
    from studies.thesis import runs as thesis_runs

    scene = catalogue.find(CASE)
    given = facts(scene)
    runs, fe, sampled = ([], {}, None) if quick else thesis_runs.measure(scene, given.ellipse)
    given = replace(given, fe=fe)
    judged = judge(given)
    case = thesis_plots.Case(given.ellipse, given.poisson, stress.P0, stress.A)
    thesis_plots.patch(case, sampled, out / "thesis_patch.png")
    thesis_plots.lines(case, sampled, out / "thesis_lines.png")
    loads = [asdict(run) for run in runs if run.elements == thesis_runs.DEFAULT]
    thesis_plots.loads(case, loads, out / "thesis_loads.png")
    tables.write_csv(out / "thesis.csv", [row for item in judged for row in _rows(item)])
    if runs:
        tables.write_csv(out / "thesis_runs.csv", runs, thesis_runs.UNITS)
    text = thesis_page.page(given, judged, [asdict(run) for run in runs])
    (out / study.PAGE).write_text(text, encoding="utf-8")


def judge(given: Facts) -> list[Judged]:
    """All claims in order."""
    return [Judged(claim, RULES[claim.id](given)) for claim in read_claims()]


def facts(scene: Scene) -> Facts:
    """Exact Hertz, the thesis's route, and what the profiles say; no finite elements yet."""
    contact = geometry.locate(scene)
    ellipse = closed_forms.ellipse(scene, contact)
    curvatures = (ellipse.curvature_x, 0.0), (0.0, ellipse.curvature_y)
    route = formulas.thesis_contact(*curvatures, ellipse.contact_modulus, ellipse.load)
    numerical = boundary_element.solve(
        contact.half_space_gap(contact.touch),
        ellipse.contact_modulus,
        load=ellipse.load,
        half_size=(2 * ellipse.a, 2 * ellipse.b),
    )
    poisson = scene.rail.poisson_ratio
    return Facts(ellipse, poisson, route, profile_facts(), {}, numerical.max_pressure)


def profile_facts() -> dict[str, float]:
    """Where treads touch the rail (y in its own section, mm), the crown, the S1002 tread."""
    found = {}
    for tread in TREADS:
        wheel = profiles.cone(profiles.CONES[tread], geometry.TREAD_HALF_WIDTH, tread)
        for name, slope in INCLINATIONS.items():
            pair = Pair(profiles.rail_head("54E1", slope), wheel, 420.0)
            touch = wheelset.place(pair, wheelset.Track()).right.touches[0]
            angle = math.atan(slope)
            found[f"y {tread} {name}"] = touch.y * math.cos(angle) + touch.z * math.sin(angle)
    head, s1002 = profiles.rail_head("54E1"), profiles.s1002()
    hollow = np.flatnonzero(s1002.curvature(np.arange(0.0, 30.0, 0.01)) < 0)[-1] / 100
    return found | {
        "crown_radius": 1 / float(head.curvature(0.0)),
        "crown_half_width": head.joints[len(head.joints) // 2],
        "head_half_width": head.domain[1],
        "s1002_radius": 1 / float(s1002.curvature(0.0)),
        "s1002_convex_from": float(hollow),
    }


def _rows(item: Judged) -> Sequence[Row]:
    claim, verdict = item.claim, str(item.finding.verdict)

    checks: Sequence[Check | None] = item.finding.checks or (None,)
    return [
        Row(claim.id, claim.where, verdict, claim.expected, "none", "", "", None, "", "")
        if check is None
        else Row(
            claim.id,
            claim.where,
            verdict,
            claim.expected,
            check.what,
            check.thesis,
            check.exact,
            check.ours,
            check.unit,
            check.grade.name.lower(),
        )
        for check in checks
    ]
