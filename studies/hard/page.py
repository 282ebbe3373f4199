"""The page of the hard cases: what fails, a table by group, maps."""

from __future__ import annotations

from collections.abc import Sequence

from railhead.studies.hard.case import Outcome
from railhead.studies.hard.failure_map import Cell, Map
from railhead.studies.hard.maps import FACTOR_MAP, FACTORS, LAWS, MATERIAL_MAP, POISSON, STIFFNESS
from railhead.studies.tables import percent, table


def _cell(outcome: Outcome | None) -> Cell:
    if outcome is None or outcome.measured is None:
        return Cell(None, False, "no end" if outcome and "back" in outcome.fault else "x")
    worst = outcome.measured.worst
    error = worst[1].value if worst else None
    if outcome.measured.failed:
        return Cell(error, False, outcome.measured.failed[0].replace("_", "\n", 1))
    if error is None:
        return Cell(None, False, "x")
    return Cell(error, True, f"{error:.1%}" + ("\nWRONG" if outcome.fault else ""))


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
    worst = found.worst if found else None
    return [
        case.name,
        case.reason + (f" ({found.remark})" if found and found.remark else ""),
        case.reference,
        worst[0] if worst else "-",
        f"{worst[1].value:.1e}" if worst else "-",
        f"{worst[1].allowed:.1e}" if worst else "-",
        str(found.newton) if found else "-",
        str(found.krylov) if found else "-",
        percent(found.noise) if found and found.noise is not None else "-",
        f"{outcome.seconds:.1f}",
        outcome.result,
    ]


HEAD = (
    "case", "what is hard", "reference", "quantity", "deviation", "allowed", "Newton", "Krylov",
    "noise", "seconds", "result",
)  # fmt: skip


def page(outcomes: Sequence[Outcome]) -> str:
    """The whole page."""
    failing = [outcome for outcome in outcomes if outcome.fault]
    refused = sum(outcome.refused for outcome in outcomes)
    parts = [
        "# Hard cases",
        f"{len(outcomes)} cases: {len(outcomes) - len(failing) - refused} are right, {refused} are "
        f"refused by a check as they may be, {len(failing)} fail. A case is right if it ends with "
        "status 0, if each judged quantity (largest pressure, area, largest shear stress; between "
        "half-spaces the approach) deviates from its reference by at most 1.5 times its own "
        "estimate, or by the limit of the case where it has none (1 %, 2 % against a finer mesh), "
        "and by what the reference does not know; and if it takes at most 10 Newton steps (15 "
        "from adverse starts and on flanges, 30 with other laws and any materials). Some cases "
        "declare the check that fails: it must. Others may be refused by any check, but not signed "
        "wrong: noisy profiles, and contact laws far from the defaults, where 5 % are allowed. The "
        "quantity of a row is the one nearest to what is allowed. Noise: L2 distance of the raw "
        "pressure from its recovered field. Every case runs in a process of its own with a time "
        "limit. Made by `railhead study hard-cases`.",
        "![Failure maps](hard_cases.png)",
        "Colour: error of the quantity of the row against exact Hertz. Grey: refused, with the "
        "first check that failed.",
    ]
    if failing:
        parts.append("## What fails")
        parts += [f"- **{outcome.case.key}**: {outcome.fault}" for outcome in failing]
    for group in dict.fromkeys(outcome.case.group for outcome in outcomes):
        own = [outcome for outcome in outcomes if outcome.case.group == group]
        parts += [f"## {group}", table(HEAD, map(_row, own))]
    return "\n\n".join(parts).replace("\n\n- **", "\n- **") + "\n"
