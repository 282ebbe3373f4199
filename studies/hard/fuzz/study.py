"""Does any scene break the program, or get a wrong number signed?"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from railhead.cli import study
from railhead.sweeps.worker_pool import attempts
from studies import tables
from studies.hard.fuzz.fuzz_scenes import MOST, Fuzzed, fuzz

SCENES, SEED, SECONDS = 500, 2024, 180.0
OUTCOMES = (0, 1, 2, None)  # status


def main(out: Path, *, quick: bool) -> None:
    """Write fuzz.csv and page.md; quick: 40 scenes."""
    jobs = [(SEED + index, index % 2 == 1) for index in range(40 if quick else SCENES)]
    found, seconds = [], []
    for (seed, broken), attempt in zip(
        jobs, attempts(fuzz, jobs, [SECONDS] * len(jobs)), strict=True
    ):
        kind = "broken" if broken else "valid"
        lost = Fuzzed(seed, kind, "run", None, attempt.fault, "", "", None, None, attempt.fault)
        found.append(attempt.value or lost)
        seconds.append(attempt.seconds)
        ended = found[-1].fault or f"status {found[-1].status}"
        print(
            f"{len(found)} of {len(jobs)}: {found[-1].kind}, seed {seed}: {ended}", file=sys.stderr
        )
    tables.write_csv(out / "fuzz.csv", found)
    (out / study.PAGE).write_text(page(found, seconds), encoding="utf-8")


def page(found: Sequence[Fuzzed], seconds: Sequence[float]) -> str:
    """Counts by kind and outcome, what must not happen, why results were refused."""
    kinds = dict.fromkeys(each.kind for each in found)
    rows = []
    for kind in [*kinds, "all"]:
        own = [each for each in found if kind in (each.kind, "all")]
        status = Counter(each.status for each in own)
        solved = [each for each in own if each.status == 0 and each.deviation is not None]
        shares = [
            each.deviation / each.allowed
            for each in solved
            if each.deviation is not None and each.allowed
        ]
        rows.append(
            [
                kind,
                len(own),
                *(status[key] for key in OUTCOMES),
                sum(each.command == "plan" for each in own),
                len(solved),
                f"{max(shares):.2f}" if shares else "-",
                sum(bool(each.fault) for each in own),
            ]
        )
    failed = Counter(name for each in found if each.status == 1 for name in each.said.split()[:1])
    return tables.render(
        "fuzz",
        found=found,
        seed=SEED,
        most=MOST,
        rows=rows,
        seconds=seconds,
        failed=failed.most_common(),
    )
