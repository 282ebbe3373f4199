"""MPI processes of a run: how many are worth it, and the restart under mpirun."""

import os
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from typing import NoReturn

import psutil

from railhead.planning.simulation_plan import Plan
from railhead.scene.sections import refuse_first

# Two processes take 0.86 of the time of one with 143 000 unknowns, 0.77 with 285 000 and 0.67 with
# a million (docs/ranks.md).
UNKNOWNS_PER_PROCESS = 100_000
# Temporary files of Open MPI 4, which takes 8.4 MB for two processes and waits for ever without.
TEMPORARY_BYTES = 32_000_000
# Open MPI 4 prints nothing about a status that is not 0; Open MPI 5 always does.
QUIET_LAUNCHER = {"OMPI_MCA_orte_execute_quiet": "1"}


def number_of_processes(plan: Plan) -> int:
    """Number of MPI processes that are worth it for the mesh of a plan: one for each full 100 000
    unknowns, at least one, at most the physical cores that this process may use. 1 without mpirun,
    or where the temporary folder lacks space for mpirun's own files.
    """
    cores = min(psutil.cpu_count(logical=False) or 1, len(os.sched_getaffinity(0)))
    if cores == 1 or shutil.which("mpirun") is None or not _has_space():
        return 1
    return max(1, min(cores, plan.unknowns // UNKNOWNS_PER_PROCESS))


def _has_space() -> bool:
    """Whether the temporary folder has 32 MB (TEMPORARY_BYTES) free for the files of Open MPI."""
    return shutil.disk_usage(tempfile.gettempdir()).free >= TEMPORARY_BYTES


def under_mpirun(ranks: int, environment: Mapping[str, str]) -> tuple[list[str], dict[str, str]]:
    """Words before a command that start it in `ranks` processes (none for one process), and a copy
    of the environment for it, in which root may use mpirun. Nothing is started.
    """
    if ranks == 1:
        return [], dict(environment)
    allowed = dict(environment) | QUIET_LAUNCHER
    if os.geteuid() == 0:  # what is not harmful for one process is not for two
        allowed |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return ["mpirun", "--oversubscribe", "-n", str(ranks)], allowed


def restart(ranks: int, arguments: Sequence[str]) -> NoReturn:
    """Replace this process by mpirun, which runs the same command in `ranks` processes.

    No child process is made: a signal ends both or neither, and the exit status is that of the
    ranks. arguments: those of the command, without its name.

    Raises SceneError for more ranks than processors, without mpirun, and without free disk space
    for the files of mpirun.
    """
    processors, needed = psutil.cpu_count() or 1, f"{TEMPORARY_BYTES / 1e6:.0f} MB"
    place = f"{tempfile.gettempdir()}; free some, or name another folder by TMPDIR"
    said = f"{ranks} is not allowed"
    refuse_first(
        (ranks > processors, "--ranks", f"{said}; give at most {processors}"),
        (not shutil.which("mpirun"), "--ranks", f"{said} without mpirun, which was not found"),
        (not _has_space(), "--ranks", f"{said} with less than {needed} free in {place}"),
    )
    launcher, environment = under_mpirun(ranks, os.environ)
    environment["TMPDIR"] = tempfile.gettempdir()
    environment.setdefault("TTY_COMPATIBLE", str(int(sys.stdout.isatty())))
    program = [sys.executable, "-c", "from railhead.cli import main; main()"]
    sys.stdout.flush()
    os.execvpe(launcher[0], [*launcher, *program, *arguments], environment)
