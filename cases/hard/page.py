"""The page of the hard cases: a table by group, known limits, noise, maps."""

from __future__ import annotations

from collections.abc import Sequence

from cases.hard.maps import FACTOR_MAP, FACTORS, LAWS, MATERIAL_MAP, POISSON, STIFFNESS
from cases.hard.worker import Outcome
from postprocess.failure_map import Cell, Map
from railhead.studies import percent, table


def _deviation(outcome: Outcome) -> str:
    found = outcome.measured
    return "-" if found is None else f"{found.deviation:.1e}"


def _cell(outcome: Outcome | None) -> Cell:
    found = outcome.measured if outcome else None
    if found is None:
        return Cell(None, False, "no end" if outcome and "back" in outcome.fault else "x")
    if not found.converged:
        return Cell(found.deviation, False, f"x\n{found.newton} steps")
    noise = "" if found.noise is None else f"\nnoise {found.noise:.0%}"
    return Cell(found.deviation, True, f"{found.deviation:.1%}{noise}")


def maps(outcomes: Sequence[Outcome]) -> list[Map]:
    """The two failure maps of a whole run."""
    found = {outcome.case.key: outcome for outcome in outcomes}

    def cells(group: str, rows: Sequence[str], columns: Sequence[str]) -> list[list[Cell]]:
        return [
            [_cell(found.get(f"{group}: {row}, {column}")) for column in columns] for row in rows
        ]

    factors = [f"{factor:g}" for factor in FACTORS]
    ratios, laws = [f"{ratio:g}" for ratio in STIFFNESS], list(LAWS)
    poisson = [f"{value:g}" for value in POISSON]
    return [
        Map("Contact laws on the thesis ellipse, four elements per semi-axis", laws, factors,
            "solver.gamma_factor", cells(FACTOR_MAP, laws, factors)),
        Map("Rail of any stiffness under a steel wheel, quadratic tetrahedra", poisson, ratios,
            "E of the rail over E of the wheel (rows: Poisson's ratio of the rail)",
            cells(MATERIAL_MAP, poisson, ratios)),
    ]  # fmt: skip


def _row(outcome: Outcome) -> list[str]:
    case, found = outcome.case, outcome.measured
    return [
        case.name,
        case.reason + (f" ({found.remark})" if found and found.remark else ""),
        case.reference,
        f"{case.limit:g}",
        _deviation(outcome),
        str(found.newton) if found else "-",
        str(found.krylov) if found else "-",
        percent(found.noise) if found and found.noise is not None else "-",
        f"{outcome.seconds:.1f}",
        ("known limit: " + outcome.fault) if outcome.fault and case.known
        else outcome.fault or "holds",
    ]  # fmt: skip


HEAD = (
    "case", "what is hard", "reference", "limit", "deviation", "Newton", "Krylov", "noise",
    "seconds", "result",
)  # fmt: skip


def page(outcomes: Sequence[Outcome]) -> str:
    """The whole page."""
    ruled = [outcome for outcome in outcomes if outcome.case.ruled]
    failed = [outcome for outcome in ruled if outcome.fault]
    known = [outcome for outcome in failed if outcome.case.known]
    parts = [
        "# Hard cases",
        f"{len(ruled)} cases with a rule: {len(ruled) - len(failed)} hold, {len(known)} are known "
        f"limits, {len(failed) - len(known)} fail. A case holds if it converges, its forces "
        "balance to 1e-6, it deviates from its reference by no more than the limit, and it takes "
        "at most 10 Newton steps (15 from adverse starts). Noise: L2 distance of the raw pressure "
        "from its recovered field. Every case runs in a process of its own with a time limit. "
        "Made by `railhead study hard-cases`.",
        "![Failure maps](hard_cases.png)",
        "Colour: worst error against exact Hertz. Grey with a cross: not converged, or not back in "
        "time. The rule (1 % for factors 0.1 to 100) is for the default law.",
    ]
    if failed:
        parts.append("## What does not hold")
        parts += [
            f"- **{outcome.case.key}**: {outcome.fault}"
            + (f"; {outcome.case.known}" if outcome.case.known else "")
            for outcome in failed
        ]
    for group in dict.fromkeys(outcome.case.group for outcome in ruled):
        own = [outcome for outcome in ruled if outcome.case.group == group]
        parts += [f"## {group}", table(HEAD, map(_row, own))]
    return "\n\n".join(parts).replace("\n\n- **", "\n- **") + "\n"
