"""A record of what the program answers, to compare with after a change that must move no number.

    python tests/golden/record.py            solve all scenes and compare with record.json
    python tests/golden/record.py --keep     solve all scenes and write record.json anew
    python tests/golden/record.py NAME ...   only scenes whose names contain one of these words

This proves nothing about the truth of a number: `tests/verification` does. Two runs of one checkout
agree to every digit on one machine; another machine or another dolfinx needs a record of its own.
On several processes they agree to fewer digits: mesh and partition are the same to the bit, but
messages arrive in changing order, so that sums of forces round differently. What Newton's method
and half-spaces then end at differs within their tolerances.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

RECORD = Path(__file__).with_name("record.json")
TOLERANCE = 1e-9, 1e-10  # relative to the larger value, and absolute
ON_RANKS = 1e-6, 1e-5  # on several processes, where two runs differ by 3e-7, and by 4e-6 around 0
SKIPPED = (
    "cost",
    "seconds",
    "predicted",
    "memory",
    "version",
    "date",
    "railhead",
    "units",
    "would_cost",
    "speed",
    "history",
    "force_balance",
    "approach_reached",
)
"""Parts of keys whose values depend on the machine or the moment."""
SCENES = dict(
    line.split(": ", 1) for line in RECORD.with_name("scenes.txt").read_text().splitlines()
)
"""Words of the command by name."""


def main(arguments: list[str]) -> int:
    """Solve the scenes that are named, or all, and compare them with the record or keep them."""
    words = [each for each in arguments if not each.startswith("-")]
    names = [name for name in SCENES if not words or any(word in name for word in words)]
    with ThreadPoolExecutor(2) as pool:
        found = dict(zip(names, pool.map(_answer, names), strict=True))
    known = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    if "--keep" in arguments:
        RECORD.write_text(json.dumps(known | found, indent=0, sort_keys=True) + "\n")
        return 0
    differences = [
        f"{name}: {line}"
        for name in names
        for line in _differences(known.get(name, {}), found[name], _tolerance(name))
    ]
    print("\n".join(differences) or f"{len(names)} scenes as recorded")
    return 1 if differences else 0


def _tolerance(name: str) -> tuple[float, float]:
    """Relative and absolute tolerance of the values of a scene."""
    return ON_RANKS if "--ranks" in SCENES[name].split() else TOLERANCE


def _answer(name: str) -> dict[str, Any]:
    """Exit status, message, and all values of summary.json by dotted key."""
    command, *words = SCENES[name].split()
    options = ["--no-pictures"] if command != "plan" else []
    with tempfile.TemporaryDirectory() as folder:
        if command not in ("plan", "locate"):
            options += ["--out", f"{folder}/result"]
        done = subprocess.run(
            [str(Path(sys.executable).with_name("railhead")), command, *words, *options, "--json"],
            capture_output=True,
            text=True,
            env=os.environ
            | {"OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1"}
            | {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"},
            check=False,
        )
    values: dict[str, Any] = {"status": done.returncode}
    if done.returncode:
        values["message"] = " ".join(done.stderr.split())
    if done.stdout.strip():
        _flatten(json.loads(done.stdout), "", values)
    print(f"{name}: status {done.returncode}, {len(values)} values", file=sys.stderr)
    return values


def _flatten(value: Any, path: str, out: dict[str, Any]) -> None:
    """Numbers and words of nested lists and tables by dotted key, in `out`."""
    if any(word in path for word in SKIPPED):
        return
    if isinstance(value, dict):
        for key, inner in value.items():
            _flatten(inner, f"{path}.{key}" if path else key, out)
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            _flatten(inner, f"{path}.{number}", out)
    else:
        out[path] = float(f"{value:.12g}") if isinstance(value, float) else value


def _differences(
    known: dict[str, Any], found: dict[str, Any], tolerance: tuple[float, float]
) -> list[str]:
    """A line for each key that is new, gone or of another value."""
    out = []
    for key in sorted(known.keys() | found.keys()):
        if key not in found or key not in known:
            out.append(f"{key} {'is gone' if key in known else 'is new'}")
        elif not _equal(known[key], found[key], tolerance):
            out.append(f"{key}: {known[key]} -> {found[key]}")
    return out


def _equal(one: Any, other: Any, tolerance: tuple[float, float]) -> bool:
    if isinstance(one, float) and isinstance(other, float | int):
        return math.isclose(one, other, rel_tol=tolerance[0], abs_tol=tolerance[1])
    return bool(one == other)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
