"""Does any scene break the program, or get a wrong number signed?"""

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhead.sweeps.worker_pool import attempts
from studies import tables
from studies.hard.fuzz.fuzz_scenes import MOST, Fuzzed, ended, fuzz

SCENES, SEED, SECONDS = 500, 2024, 180.0
OUTCOMES = (0, 1, 2, None)  # status


def main(out: Path, *, quick: bool) -> None:
    """Write fuzz.csv and page.md; quick: 40 scenes."""
    jobs = [(SEED + index, index % 2 == 1) for index in range(40 if quick else SCENES)]
    found, seconds = [], []
    done = attempts(fuzz, jobs, [SECONDS] * len(jobs))
    for (seed, broken), attempt in zip(jobs, done, strict=True):
        kind, fault = "broken" if broken else "valid", attempt.fault
        row = attempt.value or ended(seed, kind, said=fault, fault=fault)
        end = row["fault"] or f"status {row['status']}"
        found.append(row)
        seconds.append(attempt.seconds)
        print(f"{len(found)} of {len(jobs)}: {row['kind']}, seed {seed}: {end}", file=sys.stderr)
    tables.publish(out, page(found, seconds), fuzz=found)


def page(found: Sequence[Fuzzed], seconds: Sequence[float]) -> str:
    """Counts by kind and outcome, what must not happen, why results were refused."""
    failed = Counter(
        name for each in found if each["status"] == 1 for name in each["said"].split()[:1]
    )
    return tables.render(
        "fuzz",
        found=found,
        seed=SEED,
        most=MOST,
        rows=[
            _row(kind, own) for kind, own in (tables.groups(found, "kind") | {"all": found}).items()
        ],
        seconds=seconds,
        failed=failed.most_common(),
    )


def _row(kind: str, own: Sequence[Fuzzed]) -> list[Any]:
    status = Counter(each["status"] for each in own)
    solved = [each for each in own if each["status"] == 0 and each["deviation"] is not None]
    shares = [each["deviation"] / each["allowed"] for each in solved if each["allowed"]]
    return [
        kind,
        len(own),
        *(status[key] for key in OUTCOMES),
        sum(each["command"] == "plan" for each in own),
        len(solved),
        f"{max(shares):.2f}" if shares else "-",
        sum(bool(each["fault"]) for each in own),
    ]
