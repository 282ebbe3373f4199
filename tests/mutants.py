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
from itertools import accumulate
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


COVERAGE, REPORT = ROOT / ".coverage", ROOT / "results" / "tests.xml"


def name(test: str) -> str:
    """Name of a test's file and its own."""
    file, _, own = test.partition("::")
    return f"{Path(file).stem}::{own}"


def reached() -> dict[Path, dict[int, list[str]]]:
    """Tests that reach each line of each file of PLACES, the shortest first, up to SECONDS."""
    taken = {
        f"{case.attrib['classname'].rpartition('.')[2]}::{case.attrib['name']}": float(
            case.attrib["time"]
        )
        for case in ElementTree.parse(REPORT).iter("testcase")
    }
    data = CoverageData(str(COVERAGE))
    data.read()
    found: dict[Path, dict[int, list[str]]] = {}
    for file in data.measured_files():
        path = Path(file).resolve().relative_to(ROOT)
        if str(path).startswith(PLACES):
            lines = data.contexts_by_lineno(file)
            found[path] = {line: shortest(tests, taken) for line, tests in lines.items()}
    return found


def shortest(contexts: list[str], taken: dict[str, float]) -> list[str]:
    """The tests of coverage's contexts, the shortest first: up to SECONDS of them, one at least.
    taken: seconds of each test by its `name`."""
    tests = {each.rpartition("|")[0] for each in contexts}
    known = sorted((test for test in tests if name(test) in taken), key=lambda t: taken[name(t)])
    total = list(accumulate(taken[name(test)] for test in known))
    return [test for i, test in enumerate(known) if i == 0 or total[i] <= SECONDS]


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


def main() -> None:
    given = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    given.add_argument("count", type=int)
    given.add_argument("--seed", type=int, default=1)
    asked = given.parse_args()
    lines = reached()
    outcomes: Counter[str] = Counter()
    for mutant in drawn(20 * asked.count, asked.seed, sorted(lines)):
        path, (line, _) = Path(mutant.module_path), mutant.start_pos
        tests = lines[path].get(line, [])
        command = shlex.join([sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", *tests])
        result = mutate_and_test([mutant], command, LIMIT) if tests else None
        if result is None or result.test_outcome == TestOutcome.INCOMPETENT:
            continue
        survives = result.test_outcome == TestOutcome.SURVIVED
        outcome = "survives" if survives else "hangs" if result.output == "timeout" else "killed"
        outcomes[outcome] += 1
        print(f"{outcome} {path}:{line} {mutant.operator_name}, {len(tests)} tests", flush=True)
        if survives:
            print(result.diff, flush=True)
        if outcomes.total() == asked.count:
            break
    print(dict(outcomes))


if __name__ == "__main__":
    main()
