"""Does any scene break the program, or get a wrong number signed?"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from railhead import study
from railhead.studies import tables
from railhead.studies.hard.fuzz_scenes import MOST, Fuzzed, fuzz
from railhead.studies.pool import attempts

STUDY = "500 fuzzed scenes: no traceback, no abort, no wrong number with status 0"
SCENES, SEED, SECONDS = 500, 2024, 180.0
OUTCOMES = {0: "status 0", 1: "status 1", 2: "status 2", None: "none"}


def main(out: Path, *, quick: bool) -> None:
    """Write fuzz.csv and page.md; quick: 40 scenes."""
    jobs = [(SEED + index, index % 2 == 1) for index in range(40 if quick else SCENES)]
    found, seconds = [], []
    for (seed, broken), attempt in zip(
        jobs, attempts(fuzz, jobs, [SECONDS] * len(jobs)), strict=True
    ):
        kind = "broken" if broken else "valid"
        lost = Fuzzed(seed, kind, "run", None, attempt.fault, "", "", None, None, attempt.fault)
        found.append(attempt.found or lost)
        seconds.append(attempt.seconds)
        ended = found[-1].fault or f"status {found[-1].status}"
        print(f"{len(found)} of {len(jobs)}: {found[-1].kind}, seed {seed}: {ended}",
              file=sys.stderr)  # fmt: skip
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
        shares = [each.deviation / each.allowed for each in solved
                  if each.deviation is not None and each.allowed]  # fmt: skip
        rows.append([
            kind, len(own), *(status[key] for key in OUTCOMES),
            sum(each.command == "plan" for each in own), len(solved),
            f"{max(shares):.2f}" if shares else "-", sum(bool(each.fault) for each in own),
        ])  # fmt: skip
    head = ("scenes", "", *OUTCOMES.values(), "only planned", "signed and held against the truth",
            "deviation over allowed, max", "faults")  # fmt: skip
    failed = Counter(name for each in found if each.status == 1 for name in each.said.split()[:1])
    faults = [each for each in found if each.fault]
    parts = [
        "# Fuzzed scenes",
        f"{len(found)} scenes of seed {SEED}, every other one valid (any profiles, materials, "
        f"laws, cells, positions and sizes, below {MOST} predicted unknowns), the others with "
        "unknown keys, odd values, extremes of size, damaged bytes or profiles that are none; what "
        "would be dearer is planned only. Each goes through the command line, which must end with "
        "status 0, with 1 and a named check, or with 2 and one line; where exact Hertz or "
        "boundary elements are the truth, status 0 must not go with a pressure, area or stress "
        "off by more than 1.5 times its estimate (5 % where it has none) and what the truth does "
        "not know. Made by `railhead study fuzz`.",
        tables.table(head, rows),
        f"{sum(seconds) / 60:.0f} minutes of one process, {max(seconds):.0f} s at most.",
        "## What must not happen",
        "\n".join(f"- {each.kind}, seed {each.seed}: {each.fault}" for each in faults)
        or "Nothing.",
        "## First check that failed",
        tables.table(("check", "scenes"), failed.most_common()),
    ]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    from railhead.cli import main as command

    command(["study", "fuzz", *sys.argv[1:]])
