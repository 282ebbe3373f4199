"""The same scene on several ranks."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from railhead.cli import launch
from studies.hard.case import Deviation, Measured
from studies.hard.scenes import HALF_SPACE, off, quantities

SAME = 1e-6  # what solutions to 1e-8 of the force may differ by
TRACES = ("OMPI_", "PMIX_", "ORTE_", "OPAL_")


def summary(ranks: int, folder: Path) -> dict[str, Any]:
    """`railhead run uic54_thesis` on a coarse mesh; its summary.json."""
    # A process that has started MPI leaves its traces in the environment, which mpirun refuses.
    clean = {key: text for key, text in os.environ.items() if not key.startswith(TRACES)}
    launcher, environment = launch.under_mpirun(ranks, clean)
    command = [
        *launcher, sys.executable, "-c", "from railhead.cli import main; main()",
        "run", "uic54_thesis", "--quiet", "--no-pictures", "--out", f"ranks{ranks}",
        "--set", "mesh.patch_size=1.0",
    ]  # fmt: skip
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    text = (folder / f"ranks{ranks}" / "summary.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    if found["cost"]["ranks"] != ranks:
        raise RuntimeError(f"{found['cost']['ranks']} processes solved it, not {ranks}")
    return found


def against_one(ranks: int) -> Measured:
    """Patch, pressure and approach on several ranks against one."""
    with tempfile.TemporaryDirectory() as folder:
        one, more = (summary(count, Path(folder)) for count in (1, ranks))
    exact, found = quantities(one), quantities(more)
    return Measured(
        {name: Deviation(off(found[name], exact[name]), SAME) for name in HALF_SPACE},
        tuple(more["checks"]["failed"]),
        more["cost"]["newton_iterations"],
        more["cost"]["linear_iterations"],
    )
