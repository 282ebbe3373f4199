"""The page of the hard cases: what fails, a table by group, maps."""

from __future__ import annotations

from collections.abc import Sequence

from studies.hard.case import Outcome
from studies.hard.failure_map import Cell, Map
from studies.hard.maps import FACTOR_MAP, FACTORS, LAWS, MATERIAL_MAP, POISSON, STIFFNESS
from studies.tables import percent, render


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
            "solver.gamma_factor", "", cells(FACTOR_MAP, laws, factors)),
        Map("Rail of any stiffness under a steel wheel, quadratic tetrahedra", poisson, ratios,
            "E of the rail over E of the wheel", "Poisson's ratio of the rail",
            cells(MATERIAL_MAP, poisson, ratios)),
    ]  # fmt: skip


def _row(outcome: Outcome) -> list[str]:
    case, found = outcome.case, outcome.measured
    worst = found.worst if found else None
    none = ("-",) * 3
    nearest = (worst[0], f"{worst[1].value:.1e}", f"{worst[1].allowed:.1e}") if worst else none
    steps = (str(found.newton), str(found.krylov), percent(found.noise)) if found else none
    reason = case.reason + (f" ({found.remark})" if found and found.remark else "")
    seconds = f"{outcome.seconds:.1f}"
    return [case.name, reason, case.reference, *nearest, *steps, seconds, outcome.result]


def page(outcomes: Sequence[Outcome]) -> str:
    """The whole page."""
    groups: dict[str, list[list[str]]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.case.group, []).append(_row(outcome))
    failing = [outcome for outcome in outcomes if outcome.fault]
    refused = sum(outcome.refused for outcome in outcomes)
    return render(
        "hard_cases", count=len(outcomes), failing=failing, refused=refused, groups=groups
    )
