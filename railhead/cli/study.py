"""Studies: entry points of the group railhead.studies, modules with a line STUDY and a function
`main(out, *, quick)`.

A study writes a CSV, a picture and a page into a folder that appears complete or not at all. One
that needs other programs has `install()` too, and KEEPS: names in its folder that a new run leaves.
"""

from __future__ import annotations

import difflib
from importlib.metadata import entry_points
from pathlib import Path
from typing import Protocol, cast

from railhead.scene.scene import SceneError

PAGE = "page.md"


class Study(Protocol):
    """What a study module provides; `quick` asks for a small part of it, `out` exists."""

    STUDY: str

    def main(self, out: Path, *, quick: bool) -> None:
        """Compute, and write <name>.csv, pictures and page.md into `out`."""


def names() -> list[str]:
    """Of all studies."""
    return sorted(entry_points(group="railhead.studies").names)


def load(name: str) -> Study:
    """Import a study of `names`."""
    (found,) = entry_points(group="railhead.studies", name=name)
    return cast(Study, found.load())


def canonical(name: str) -> str:
    """The name of a study from the name as typed; SceneError if there is none."""
    known, wanted = names(), name.replace("-", "_")
    if wanted in known:
        return wanted
    close = difflib.get_close_matches(wanted, known, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise SceneError("study", f"{name!r} is unknown; {hint}give one of {', '.join(known)}")


def run(name: str, folder: Path | None, *, quick: bool, install: bool = False) -> tuple[Path, str]:
    """Run a study; returns its folder [results/<study>] and the text of its page. install: first
    what it needs of other programs.

    Raises SceneError for an unknown name, a folder that holds something else, several ranks, or
    `install` where a study needs nothing.
    """
    name = canonical(name)
    folder = folder if folder is not None else Path("results") / name
    study = load(name)
    if install and not hasattr(study, "install"):
        raise SceneError("--install", f"{name} needs no other programs; leave it out")

    from railhead.results import result_folder

    result_folder.check_folder(folder, getattr(study, "KEEPS", ()))

    from mpi4py import MPI

    if MPI.COMM_WORLD.size > 1:
        raise SceneError("study", f"{name} measures one process; start it without mpirun")
    if install:
        study.install()  # type: ignore[attr-defined]
    with result_folder.replacing(folder) as work:
        study.main(work, quick=quick)
    return folder, (folder / PAGE).read_text(encoding="utf-8")
