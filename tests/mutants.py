"""Mutants of the program: which share of small changes of its code some test notices.

In a checkout of its own, as files are changed and restored:

    python -m pip install cosmic-ray pytest-cov
    python -m pytest --cov=solver --cov=theory --cov=postprocess --cov=railhead --cov-report= \\
        --cov-context=test --junitxml=results/tests.xml
    python tests/mutants.py 200 --seed 1

A place in the code is drawn among those that tests reach, and one of cosmic-ray's changes there.
The tests that reach its line run, the shortest first, up to 45 s of them, until one fails. A mutant
that all of them pass survives; its change is printed. The whole suite may notice it.
"""

import argparse
import random
import shlex
import sys
from collections import Counter, defaultdict
from pathlib import Path
from xml.etree import ElementTree

from cosmic_ray.commands.init import init
from cosmic_ray.mutating import mutate_and_test
from cosmic_ray.work_db import WorkDB
from cosmic_ray.work_item import MutationSpec, TestOutcome
from coverage import CoverageData

ROOT = Path(__file__).parents[1]
PLACES = (
    "solver", "theory", "postprocess", "railhead/run/estimates.py", "railhead/results/checks.py",
)  # fmt: skip
SECONDS, LIMIT = 45.0, 90.0  # of the tests of a mutant, and after which a mutant hangs
LEFT_OUT = "Bit", "Shift", "Invert", "Mod", "FloorDiv", "Pow", "_Is", "Decorator", "Exception"
"""Changes that end in a TypeError on numbers, or that are none, as of annotations."""


def durations(report: Path) -> dict[str, float]:
    """Seconds of each test of a JUnit report, by name of its file and its own."""
    cases = ElementTree.parse(report).iter("testcase")
    return {
        f"{case.attrib['classname'].rpartition('.')[2]}::{case.attrib['name']}": float(
            case.attrib["time"]
        )
        for case in cases
    }


def reached(data: CoverageData, taken: dict[str, float]) -> dict[Path, dict[int, set[str]]]:
    """Tests that reach each line of each file of PLACES."""
    found: dict[Path, dict[int, set[str]]] = defaultdict(lambda: defaultdict(set))
    for file in data.measured_files():
        path = Path(file).resolve().relative_to(ROOT)
        if not str(path).startswith(PLACES):
            continue
        for line, contexts in data.contexts_by_lineno(file).items():
            tests = {each.rpartition("|")[0] for each in contexts if each}
            found[path][line] = {each for each in tests if name(each) in taken}
    return found


def name(test: str) -> str:
    """Name of a test's file and its own."""
    file, _, own = test.partition("::")
    return f"{Path(file).stem}::{own}"


def drawn(count: int, seed: int, files: list[Path]) -> list[MutationSpec]:
    """So many changes at different places, each place as probable as any other."""
    work = WorkDB(":memory:", WorkDB.Mode.create)
    init(files, work, {})
    places: dict[tuple[str, tuple[int, int]], list[MutationSpec]] = defaultdict(list)
    for item in work.work_items:
        (change,) = item.mutations
        if not any(each in change.operator_name for each in LEFT_OUT):
            places[str(change.module_path), change.start_pos].append(change)
    chance = random.Random(seed)
    chosen = chance.sample(sorted(places), min(count, len(places)))
    return [chance.choice(places[place]) for place in chosen]


def within(tests: set[str], taken: dict[str, float]) -> list[str]:
    """The shortest tests, up to SECONDS of them."""
    total, kept = 0.0, []
    for test in sorted(tests, key=lambda each: taken[name(each)]):
        total += taken[name(test)]
        if kept and total > SECONDS:
            break
        kept.append(test)
    return kept


def main() -> None:
    given = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    given.add_argument("count", type=int)
    given.add_argument("--seed", type=int, default=1)
    given.add_argument("--coverage", type=Path, default=ROOT / ".coverage")
    given.add_argument("--report", type=Path, default=ROOT / "results" / "tests.xml")
    asked = given.parse_args()
    taken = durations(asked.report)
    data = CoverageData(str(asked.coverage))
    data.read()
    lines = reached(data, taken)
    mutants = drawn(20 * asked.count, asked.seed, sorted(lines))
    outcomes: Counter[str] = Counter()
    for mutant in mutants:
        path, (line, _) = Path(mutant.module_path), mutant.start_pos
        tests = within(lines[path][line], taken)
        if not tests:
            continue
        command = shlex.join([sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", *tests])
        result = mutate_and_test([mutant], command, LIMIT)
        if result.test_outcome == TestOutcome.INCOMPETENT:
            continue
        survives = result.test_outcome == TestOutcome.SURVIVED
        outcome = "survives" if survives else "hangs" if result.output == "timeout" else "killed"
        outcomes[outcome] += 1
        print(f"{outcome} {path}:{line} {mutant.operator_name}, "
              f"{len(tests)} of {len(lines[path][line])} tests", flush=True)  # fmt: skip
        if survives:
            print(result.diff, flush=True)
        if outcomes.total() == asked.count:
            break
    print(dict(outcomes))


if __name__ == "__main__":
    main()
