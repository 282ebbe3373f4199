"""The folder of a command that does many jobs: what was asked, and a record of each finished job.

A record appears whole or not at all, so a command that is killed loses only what was running.
"""

import json
import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Literal

from railhead.results import result_folder
from railhead.scene.catalogue import INPUT
from railhead.scene.keys import dotted
from railhead.scene.scene import SceneError
from railhead.scene.sections import ArgumentError
from railhead.theory import array_types
from railhead.theory.array_types import Array, packed

REQUEST, RECORDS = "sweep.json", "records"
TRANSFER = "transfer"  # key of sweep.json that is found, not asked
ADVICE = "give another folder, or force=True to replace it"
Other = Literal["refuse", "move", "replace"]


def begin(
    folder: Path,
    request: Mapping[str, Any],
    other: Other = "refuse",
    later: Collection[str] = (),
) -> None:
    """Leave what is in a folder as it is if the same was requested there, to be continued; else
    make a new folder. No job is done.

    request: all that determines the records.
    other: another result in the folder is an error ("refuse"), is moved aside ("move"), or is
        removed ("replace", which removes what was requested before, too).
    later: names of what is written into the folder afterwards, beside records and input.
    Raises SceneError for another result or a broken file, OSError where nothing can be written.
    """
    if folder.is_dir() and os.listdir(folder):
        try:
            if other != "replace":
                _check_request(folder, json.loads(result_folder.to_json(dict(request))))
                for part in (folder / RECORDS).glob(".*"):  # begun when a command was killed
                    part.unlink()
                return
        except SceneError:
            if other == "refuse":
                raise
            result_folder.set_aside(folder)
    with result_folder.replacing(folder, {RECORDS, INPUT, *later}) as work:
        (work / REQUEST).write_text(result_folder.to_json(dict(request)), encoding="utf-8")


def _check_request(folder: Path, request: dict[str, Any]) -> None:
    """Raise SceneError unless the folder holds what is requested, with its keys in the same order;
    also for another kind of result and a file that cannot be read.
    """
    name = repr(str(folder))
    if not (folder / REQUEST).is_file():
        raise ArgumentError("folder", f"{name} holds another kind of result; {ADVICE}")
    known = load(folder / REQUEST)
    known.pop(TRANSFER, None)
    tables = request, known
    here, other = (dict(dotted(table)) for table in tables)
    for key in {**here, **other}:
        if here.get(key) != other.get(key):
            raise ArgumentError(
                "folder",
                f"{name} holds another sweep, with {key} {other.get(key, 'not given')} and not "
                f"{here.get(key, 'left out')}; {ADVICE}",
            )
    if list(here) != list(other):  # the numbers of the scenes differ, too
        raise ArgumentError(
            "folder", f"{name} holds this sweep with keys in another order; {ADVICE}"
        )


def done(folder: Path) -> set[int]:
    """Numbers of the jobs that have a record."""
    return {int(p.stem) for p in (folder / RECORDS).glob("*.json") if p.stem.isdecimal()}


def write(
    folder: Path, number: int, record: Mapping[str, Any], arrays: Mapping[str, Array] | None = None
) -> None:
    """Write the record of job `number`, plain data, after its arrays by name, where it has some.
    Raises OSError where it cannot be written.
    """
    path = record_path(folder, number)
    if arrays is not None:
        write_whole(folder, path.with_suffix(".npz"), packed(arrays))
    write_whole(folder, path, result_folder.to_json(dict(record)).encode())


def write_whole(folder: Path, path: Path, content: bytes) -> None:
    """Write a file of `folder` that appears whole or not at all. OSError: it cannot be written."""
    part = folder / RECORDS / f".{path.name}.{os.getpid()}"
    part.parent.mkdir(exist_ok=True)
    part.write_bytes(content)
    part.replace(path)


def read(folder: Path, number: int) -> dict[str, Any]:
    """Record of job `number`. Raises SceneError where its file is broken, OSError where there is
    none.
    """
    return load(record_path(folder, number))


def read_arrays(folder: Path, number: int) -> dict[str, Array]:
    """Arrays of job `number` by name. Raises SceneError for a broken file or none."""
    path = record_path(folder, number).with_suffix(".npz")
    try:
        return array_types.read_arrays(path)  # type: ignore[return-value]
    except (OSError, ValueError):
        raise broken(path) from None


def record_path(folder: Path, number: int) -> Path:
    """Path of the record of job `number`."""
    return folder / RECORDS / f"{number:05d}.json"


def load(path: Path) -> dict[str, Any]:
    """The table of a JSON file. Raises SceneError for anything else."""
    try:
        return result_folder.from_json(path)
    except ValueError:
        raise broken(path) from None


def broken(path: Path) -> SceneError:
    """The error that reports a broken file of a folder."""
    return ArgumentError("folder", f"{str(path)!r} is broken; delete it and start again")
