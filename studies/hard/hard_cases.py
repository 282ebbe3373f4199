"""Do hard cases stay right? The whole battery, each case in a process that may die alone."""

import sys
from pathlib import Path
from typing import Any

from railhead.sweeps.worker_pool import attempts
from studies import tables
from studies.hard import page
from studies.hard.battery import CASES, QUICK, solve
from studies.hard.case import Outcome


def row(outcome: Outcome) -> dict[str, Any]:
    """The columns of a case; None where it ended without a result. quantity: the one nearest to
    what is allowed."""
    case, found = outcome.case, outcome.measured
    name, worst = found.worst or ("", None) if found else ("", None)
    return {
        "group": case.group,
        "case": case.name,
        "holds": not outcome.fault,
        "fault": outcome.fault,
        "known": case.known,
        "refusable": case.refusable,
        "failed": " ".join(found.failed) if found else "",
        "quantity": name,
        "deviation": worst.value if worst else None,
        "allowed": worst.allowed if worst else None,
        "newton_iterations": found.newton if found else None,
        "linear_iterations": found.krylov if found else None,
        "noise": found.noise if found else None,
        "seconds": outcome.seconds,
    }


def main(out: Path, *, quick: bool) -> None:
    """Write hard_cases.csv, hard_cases.png and page.md; quick: the cases of the tests."""
    cases = QUICK if quick else list(CASES.values())
    done: list[Outcome] = []
    jobs, limits = [(case.key,) for case in cases], [case.seconds for case in cases]
    for case, attempt in zip(cases, attempts(solve, jobs, limits), strict=True):
        found = attempt.value
        fault = attempt.fault if found is None else case.fault(found)
        done.append(Outcome(case, found, fault, attempt.seconds))
        print(f"{case.key}: {done[-1].result}", file=sys.stderr)
    page.draw(done, out / "hard_cases.png")
    tables.publish(out, page.page(done), hard_cases=[row(outcome) for outcome in done])
