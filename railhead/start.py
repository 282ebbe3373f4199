"""The command's entry: the process is set up before anything heavy is imported."""

import ctypes
import os

from railhead.ending import prompt


def prepare() -> None:
    """Set up a process that does nothing else than what the command does."""
    # Small dense blocks only: more BLAS threads cost more than they bring. Before numpy loads.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # PETSc's signal handlers would take the place of the command's own (see cli.main).
    options = os.environ.get("PETSC_OPTIONS", "")
    if "-no_signal_handler" not in options:
        os.environ["PETSC_OPTIONS"] = f"{options} -no_signal_handler"
    # Keep freed memory instead of returning it to the system for every temporary array: a fifth of
    # the time of a run otherwise goes into fresh pages (mallopt(3): M_TRIM_THRESHOLD,
    # M_MMAP_THRESHOLD).
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(-1, 2**31 - 1)
        libc.mallopt(-3, 2**30)


def main() -> None:
    """Run the command; see `railhead.cli.main`."""
    with prompt():
        from railhead import cli

        cli.main()
