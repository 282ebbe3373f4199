"""A measurement of a study in processes of its own, so that it begins with cold memory."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from railhead.cli import launch, study


def measured(module: str, argument: float, ranks: int = 1) -> dict[str, Any]:
    """What `python -m module argument` prints last, as JSON, started by mpirun for several ranks.

    Raises CalledProcessError where the process fails.
    """
    environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": str(study.ROOT)}
    launcher, environment = launch.under_mpirun(ranks, environment)
    command = [*launcher, sys.executable, "-m", module, str(argument)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def answer(measure: Callable[[float], dict[str, Any] | None]) -> None:
    """The other end: print what is measured at the argument of the command."""
    if (found := measure(float(sys.argv[1]))) is not None:
        print(json.dumps(found))
