"""Every claim of the 2012 thesis, computed again: exact theory, geometry and finite elements."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from railhead.postprocess.findings import Findings
from railhead.results.pipeline import Result, run
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse
from studies import tables
from studies.thesis import geometry, hertz, stress, thesis_page
from studies.thesis.claims import Claim, Finding, Rule, read_claims
from studies.thesis.facts import WHEEL, Facts, facts

CASE = "uic54_thesis"
RULES: dict[int, Rule] = geometry.RULES | hertz.RULES | stress.RULES
"""By the number of the claim."""
LOADS = (1e3, 5e3, 12.5e3, 25e3, 50e3, WHEEL, 150e3)
SOLID185 = ("mesh.cell=hexahedron", "mesh.order=1", "solver.method=penalty")
ELEMENTS = (2, 3, 4, 6)  # hexahedra per smaller semi-axis
UNITS = {
    "load": "N",
    "a": "mm",
    "b": "mm",
    "p0": "MPa",
    "tau_max": "MPa",
    "tau_depth": "mm",
    "mises_max": "MPa",
}
Row = dict[str, Any]
"""One run with the columns of thesis_runs.csv. error_*: relative to exact Hertz;
error_tau_surface: of the shear at the centre of the patch; surface_ratio: s_x over s_y there;
shape_error: see `Findings`."""


def main(out: Path, *, quick: bool) -> None:
    """Write thesis.csv, thesis_runs.csv, two pictures and the page; quick: closed forms only."""
    scene = catalogue.find(CASE)
    given = facts(scene)
    rows, fe, sampled = ([], {}, None) if quick else measure(scene, given.ellipse)
    given = replace(given, fe=fe)
    judged = judge(given)
    thesis_page.patch(given, sampled, out / "thesis_patch.png")
    thesis_page.lines(given, sampled, out / "thesis_lines.png")
    checks = [row for pair in judged for row in _rows(*pair)]
    text = thesis_page.page(given, judged, rows)
    tables.publish(out, text, UNITS, thesis=checks, thesis_runs=rows)


def judge(given: Facts) -> list[tuple[Claim, Finding]]:
    """All claims in order, each with what its rule finds."""
    return [(claim, RULES[claim.id](given)) for claim in read_claims()]


def _rows(claim: Claim, finding: Finding) -> list[dict[str, Any]]:
    """The checks of a claim, for the CSV; one row without numbers where it has none."""
    head = {
        "claim": claim.id,
        "where": claim.where,
        "statement": claim.claim,
        "verdict": finding.verdict,
        "reference": claim.expected,
        "remark": " ".join(filter(None, (finding.not_computable, finding.note))),
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


def measure(
    scene: Scene, exact: Ellipse
) -> tuple[list[Row], dict[str, float], thesis_page.Sampled]:
    """Solve the case under all loads, and with linear hexahedra; also what the rules and the
    pictures need of the case itself."""
    runs: list[Row] = []
    fe: dict[str, float] = {}
    with Progress(quiet=False) as progress:
        for load in LOADS:
            progress.stage(f"{scene.name}: {load:.0f} N")
            result = run(scene.replace([f"load={load!r}"]))
            runs.append(_row(thesis_page.DEFAULT, result))
            if load == scene.load:
                assert result.fields is not None and result.findings is not None
                sampled = thesis_page.sample(result.fields, result.findings)
                fe |= fe_facts(result.findings, runs[-1], exact)
            if load == WHEEL:
                fe |= {"p0_axle": runs[-1]["p0"], "mises_axle": runs[-1]["mises_max"]}
        for n in ELEMENTS:
            progress.stage(f"{scene.name}: linear hexahedra, penalty, b/{n}")
            size = f"mesh.patch_size={exact.b / n!r}"
            runs.append(_row(thesis_page.HEXAHEDRA, run(scene.replace([*SOLID185, size]))))
    return runs, fe, sampled


def fe_facts(found: Findings, base: Row, exact: Ellipse) -> dict[str, float]:
    """Finite-element values by the names under which the rules look for them."""
    axis, along, top = found.axis, found.along, found.axis.stress[:1]
    values = {key: base[key] for key in ("a", "b", "p0", "tau_max", "tau_depth", "mises_max")} | {
        "p0_error": abs(base["error_p0"]),
        "p_mean": found.patch.mean_pressure,
        "tau_surface": float(subsurface.max_shear(top)[0]),
        "mises_depth": axis.peak(subsurface.von_mises(axis.stress))[0],
    }
    for i, name in enumerate(("s_x", "s_y", "s_z")):
        values[name] = float(top[0, i])
        for share in (0.5, 1.0):
            value = np.interp(share * exact.a, axis.depth, axis.stress[:, i])
            values[f"{name} at {share:g} a"] = float(value)
    for share in (0.5, 1.0):
        at = share * base["a"]  # of the patch itself: pressure falls as a square root at its edge
        values[f"p at {share:g} a"] = float(np.interp(at, along.coordinate, along.pressure))
    return values


def _row(elements: str, result: Result) -> Row:
    """Row of one run; elements: their name in the table."""
    summary, solved = result.summary, result.mesh_solution
    found, error, hertz = summary["result"], summary["difference"], summary["hertz"]
    surface = np.array(found["stress"]["surface_centre_MPa"])
    shear = np.ptp(surface) / np.ptp(hertz["stress"]["surface_centre_MPa"])

    def values(of: dict[str, Any]) -> Row:
        axis = of["stress"]["axis"]
        return {
            "a": of["patch"]["a_mm"],
            "b": of["patch"]["b_mm"],
            "p0": of["pressure"]["max_MPa"],
            "tau_max": axis["tau_max_MPa"],
            "tau_depth": axis["tau_max_depth_mm"],
        }

    return {
        "elements": elements,
        "per_semi_axis": result.ellipse.b / solved.plan.grading.size,
        "load": found["load_N"],
        "unknowns": solved.unknowns,
        "seconds": sum(solved.seconds.values()),
        **values(found),
        "mises_max": found["stress"]["axis"]["von_mises_max_MPa"],
        **{f"error_{key}": value for key, value in values(error).items()},
        "error_tau_surface": float(shear) - 1,
        "surface_ratio": float(surface[0] / surface[1]),
        "shape_error": summary["checks"]["shape_error"],
    }
