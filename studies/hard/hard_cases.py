"""Do hard cases stay right? The whole battery, each case in a process that may die alone."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from railhead.cli import study
from studies import tables

STUDY = "hard cases: loads, starts, shapes, stiffness, meshes, places, factors, random scenes"


@dataclass(frozen=True)
class Record:
    """One case; None where it ended without a result. quantity: nearest to what is allowed."""

    group: str
    case: str
    holds: bool
    fault: str
    known: str
    refusable: bool
    failed: str
    quantity: str
    deviation: float | None
    allowed: float | None
    newton_iterations: int | None
    linear_iterations: int | None
    noise: float | None
    seconds: float


def main(out: Path, *, quick: bool) -> None:
    """Write hard_cases.csv, hard_cases.png and page.md; quick: the cases of the tests."""
    from railhead.sweeps.worker_pool import attempts
    from studies.hard import page
    from studies.hard.battery import CASES, QUICK, solve
    from studies.hard.case import Outcome

    def record(outcome: Outcome) -> Record:
        case, found = outcome.case, outcome.measured
        name, worst = found.worst or ("", None) if found else ("", None)
        return Record(
            case.group,
            case.name,
            not outcome.fault,
            outcome.fault,
            case.known,
            case.refusable,
            " ".join(found.failed) if found else "",
            name,
            worst.value if worst else None,
            worst.allowed if worst else None,
            found.newton if found else None,
            found.krylov if found else None,
            found.noise if found else None,
            outcome.seconds,
        )

    cases = QUICK if quick else list(CASES.values())
    done: list[Outcome] = []
    jobs, limits = [(case.key,) for case in cases], [case.seconds for case in cases]
    for case, attempt in zip(cases, attempts(solve, jobs, limits), strict=True):
        found = attempt.value
        fault = attempt.fault if found is None else case.fault(found)
        done.append(Outcome(case, found, fault, attempt.seconds))
        print(f"{case.key}: {done[-1].result}", file=sys.stderr)
    tables.write_csv(out / "hard_cases.csv", [record(outcome) for outcome in done])
    page.draw(page.maps(done), out / "hard_cases.png")
    (out / study.PAGE).write_text(page.page(done), encoding="utf-8")
