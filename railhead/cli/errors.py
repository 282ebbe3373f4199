"""What ends a command too early, as one line on standard error and an exit status."""

import errno
import re
import sys
from pathlib import Path

import click

from railhead.run import process
from railhead.scene.scene import SceneError
from railhead.scene.sections import ArgumentError

SOLVED, CHECK_FAILED, WRONG_INPUT = 0, 1, 2  # exit statuses
OUT_OF_MEMORY = re.compile("failed to map segment|annot allocate|bad_alloc|ut of memory")


def told(error: Exception) -> int:
    """Print an error of input, meshing, files or memory in one line; returns the exit status. Any
    other error is raised. Of several MPI processes the first one, and one without memory, ends all,
    as others may wait for it.
    """
    meshing, mpi = (sys.modules.get(name) for name in ("railhead.meshing.mesh", "mpi4py.MPI"))
    status, short = CHECK_FAILED, False
    if isinstance(error, SceneError | click.ClickException):
        if isinstance(error, ArgumentError):
            name = "out" if error.key == "folder" else error.key
            error = SceneError(f"--{name}", error.text.replace("force=True", "--force"))
        text = error.format_message() if isinstance(error, click.ClickException) else str(error)
        say(" ".join(text.split()))
        status = WRONG_INPUT
    elif isinstance(error, OSError) and error.errno != errno.ENOMEM:
        not_written(error)
    elif short := isinstance(error, MemoryError) or bool(OUT_OF_MEMORY.search(str(error))):
        say("NOT SOLVED: out of memory", first=False)
    elif meshing and isinstance(error, meshing.MeshError):
        say(f"NOT MESHED: {error}")
    else:
        raise error
    if mpi and mpi.COMM_WORLD.size > 1 and (short or not mpi.COMM_WORLD.rank):
        mpi.COMM_WORLD.Abort(status)
    return status


def say(text: str, *, first: bool = True) -> None:
    """Print a line to standard error. first: on the first MPI process only."""
    mpi = sys.modules.get("mpi4py.MPI")
    if not first or (mpi.COMM_WORLD.rank if mpi else process.rank()) == 0:
        click.echo(f"railhead: {text}", err=True)


def not_written(error: OSError) -> int:
    """Print an error of writing files to standard error, a line for each file; returns exit status
    1.
    """
    from railhead.planning import cost

    where, cache = str(error.filename or ""), cost.cache_file().parents[1]
    hint = ""
    if where and (cache.is_relative_to(where) or Path(where).is_relative_to(cache)):
        hint = " (the cache of compiled forms; XDG_CACHE_HOME names another folder)"
    for line in f"{where + ': ' if where else ''}{error.strerror or error}{hint}".splitlines():
        say(f"NOT WRITTEN: {line}")
    return CHECK_FAILED
