"""Do hard cases stay stable? The whole battery, each case in its own process."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from railhead import studies

STUDY = "hard cases: loads, starts, shapes, stiffness, meshes, places, factors, random scenes"


@dataclass(frozen=True)
class Record:
    """One case; None where it ended without a result."""

    group: str
    case: str
    limit: float
    holds: bool
    fault: str
    known: str
    deviation: float | None
    force_balance: float | None
    newton_iterations: int | None
    linear_iterations: int | None
    noise: float | None
    seconds: float


def main(out: Path, *, quick: bool) -> None:
    """Write hard_cases.csv, hard_cases.png and page.md; quick: the cases of the tests."""
    from cases.hard import page
    from cases.hard.battery import CASES, QUICK
    from cases.hard.worker import Outcome, outcomes
    from postprocess import failure_map

    def record(outcome: Outcome) -> Record:
        case, found = outcome.case, outcome.measured
        return Record(
            case.group,
            case.name,
            case.limit,
            case.ruled and not outcome.fault,
            outcome.fault,
            case.known,
            found.deviation if found else None,
            found.balance if found else None,
            found.newton if found else None,
            found.krylov if found else None,
            found.noise if found else None,
            outcome.seconds,
        )

    done: list[Outcome] = []
    for outcome in outcomes(QUICK if quick else CASES.values()):
        print(f"{outcome.case.key}: {outcome.fault or 'holds'}", file=sys.stderr)
        done.append(outcome)
    studies.write_csv(out / "hard_cases.csv", [record(outcome) for outcome in done])
    failure_map.draw(page.maps(done), out / "hard_cases.png")
    (out / studies.PAGE).write_text(page.page(done), encoding="utf-8")


if __name__ == "__main__":
    from railhead.cli import main as command

    command(["study", "hard_cases", *sys.argv[1:]])
