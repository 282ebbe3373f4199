"""Does any scene break the program, or get a wrong number with status 0? Fuzzed scenes go through
the command line, and results are compared with exact Hertz or boundary elements."""

import itertools
import json
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any

import tomli_w

from railhead.results.checks import DEFAULT_TOLERANCE
from railhead.scene import quantities
from railhead.scene.catalogue import read_scene
from railhead.scene.scene import SceneError
from studies import tables
from studies.hard.case import Deviation
from studies.hard.fuzz_scenes import FINE, Source, plans, wild, write
from studies.hard.references import PATCH, against_boundary_elements, deviations
from studies.processes import attempts

MOST = 15_000  # predicted unknowns that are solved
SECONDS = 180.0  # of a command, at most


Fuzzed = dict[str, Any]
"""What a scene file ended in.

kind: "valid", or what is wrong with it; command: "run", or "plan" where a run would be too dear;
said: the failed checks or the one line; quantity: nearest to what is allowed, or furthest above, of
those that have a reference; fault: what must not happen, else empty.
"""


NO_NUMBERS: Fuzzed = {"deviation": None, "allowed": None, "fault": ""}


def ended(seed: int, kind: str, **changes: Any) -> Fuzzed:
    """A row of the table: seed, kind and `changes`, that is further columns; the rest is empty."""
    empty: Fuzzed = {"command": "run", "status": None, "said": "", "reference": "", "quantity": ""}
    return {"seed": seed, "kind": kind} | empty | NO_NUMBERS | changes


def valid(seed: int) -> str:
    """Text of a scene file that the plan accepts and whose mesh is cheap: two thirds (FINE) of the
    usual elements per semi-axis, in one of five scenes 0.05 to 1.5 times as many."""
    for attempt in itertools.count():
        source = Source(1_000_000 * attempt + seed)
        try:
            given = wild(source)
        except SceneError:
            continue
        if (made := plans(given)) is not None:
            share = source.choice([FINE, FINE, FINE, FINE, source.number(0.05, 1.5)])
            made = made.at_resolution(share * made.default_resolution)
            if made.unknowns <= MOST:
                scene = given.replace([f"mesh.patch_size={made.patch_size!r}"])
                return tomli_w.dumps(scene.model_dump(exclude_none=True))
    raise AssertionError


def fuzz(seed: int, broken: bool) -> Fuzzed:
    """Run the command with a random scene, valid or broken, and judge how it ends."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.toml"
        if broken:
            return _judged(seed, write(Source(seed), file), file, _affordable(file))
        file.write_text(valid(seed), encoding="utf-8")
        return _judged(seed, "valid", file, [])


def _affordable(file: Path) -> list[str] | None:
    """Options of a run that is cheap enough; None where there are none."""
    try:
        given = read_scene(file)
        made = plans(given)
    except Exception:
        made = None  # the command meets it again
    if made is None:
        return []
    options = []
    if given.mesh.patch_size is None:
        made = made.at_resolution(FINE * made.default_resolution)
        options = ["--set", f"mesh.patch_size={made.patch_size!r}"]
    dear = made.unknowns > MOST or given.accuracy is not None or given.budget is not None
    return None if dear else options


def command_line(arguments: list[str]) -> tuple[int | None, str, str]:
    """Status, standard output and error of `railhead` in a process of its own; the status is None
    where an exception got through or a signal ended it. Raises TimeoutExpired after SECONDS."""
    start = [sys.executable, "-P", "-c", "from railhead.cli import main; main()"]
    done = subprocess.run(
        [*start, *arguments], capture_output=True, text=True, check=False, timeout=SECONDS
    )
    broken = done.returncode < 0 or "Traceback (most recent call last)" in done.stderr
    return None if broken else done.returncode, done.stdout, done.stderr


def _judged(seed: int, kind: str, file: Path, options: list[str] | None) -> Fuzzed:
    """Run the command with a scene file and judge its end; options None: plan it only."""
    out = file.parent / "result"
    command = "plan" if options is None else "run"
    options = [] if options is None else [*options, "--no-pictures", "--json", "--out", str(out)]
    status, text, errors = command_line([command, str(file), *options])
    # Beside an error a line may ask about a unit.
    lines = [line for line in errors.strip().splitlines() if not line.endswith("meant?")]
    said, reference, fault = " ".join(errors.split())[-300:], "", ""
    found: dict[str, Deviation] = {}
    if status is None:
        fault = f"traceback: {said}"
    elif status == 2:
        if len(lines) != 1 or out.exists():
            fault = f"{len(lines)} lines, {'something' if out.exists() else 'nothing'} written"
    elif command == "plan":
        fault = "" if status == 0 else f"status {status}"
    elif not text:
        named = status == 1 and len(lines) == 1 and "NOT MESHED" in lines[0]
        fault = "" if named else f"status {status} without a result"
    elif "NaN" in text:
        fault = "a result with NaN"
    else:
        summary = json.loads(
            text, object_hook=lambda table: {k: inf if v == "inf" else v for k, v in table.items()}
        )
        failed = summary["checks"]["failed"]
        said = " ".join(failed)
        if (status == 0) != (not failed) or status not in (0, 1):
            fault = f"status {status}, failed checks: {said or 'none'}"
        reference, found = truth(summary)
    name, worst = max(found.items(), key=lambda item: item[1].share, default=("", None))
    numbers = {"deviation": worst.value, "allowed": worst.allowed} if worst else {}
    if status == 0 and worst and not worst.share <= 1:
        fault = f"{name} off by {worst.value:.3g}, {worst.allowed:.3g} allowed"
    ways = {"command": command, "status": status, "said": said, "reference": reference}
    return ended(seed, kind, **ways, quantity=name, **numbers, fault=fault)


def truth(summary: dict[str, Any]) -> tuple[str, dict[str, Deviation]]:
    """Name of the reference of a result, and deviations from it; '' and none where there is none.
    Both references are elastic and without friction. So a scene with yield or friction is judged by
    its elastic, frictionless answer, which has no estimate."""
    if summary["result"] is None:
        return "", {}
    for kind in summary.keys() & {"elastic", "frictionless"}:
        summary = {**summary, "result": summary[kind], "accuracy": {"bound": {}}}
    if summary["scene"]["rail"]["extent"] == "half-space":
        exact = quantities.numeric_values(summary["hertz"])
        return "exact Hertz", deviations(summary, exact, PATCH, DEFAULT_TOLERANCE)
    second = summary["half_space"]
    if second is None or "reason" in second or "reason" in second["allowance"]:
        return "", {}
    return "boundary elements", against_boundary_elements(summary, second, DEFAULT_TOLERANCE)


SCENES, SEED = 500, 2024
OUTCOMES = (0, 1, 2, None)  # status


def main(out: Path, *, quick: bool) -> None:
    """Write fuzz.csv and page.md; quick: 40 scenes."""
    jobs = [(SEED + index, index % 2 == 1) for index in range(40 if quick else SCENES)]
    ends = list(attempts(fuzz, jobs))
    found = [
        end.value or ended(seed, "broken" if broken else "valid", said=end.fault, fault=end.fault)
        for (seed, broken), end in zip(jobs, ends, strict=True)
    ]
    tables.publish(out, page(found, [end.seconds for end in ends]), fuzz=found)


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
            _counts(kind, own)
            for kind, own in (tables.groups(found, "kind") | {"all": found}).items()
        ],
        seconds=seconds,
        failed=failed.most_common(),
    )


def _counts(kind: str, own: Sequence[Fuzzed]) -> list[Any]:
    """Cells of a table: counts of one kind by status, the largest share of what is allowed,
    faults."""
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
