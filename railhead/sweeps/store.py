"""The folder of a sweep: what was requested, and a record of each scene that is solved.

A record appears whole or not at all, so a sweep that is killed loses only what was running.
"""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

import numpy as np

from railhead.results import result_folder
from railhead.scene.catalogue import INPUT
from railhead.scene.scene import SceneError, dotted
from railhead.sweeps import sweep_table

REQUEST, RECORDS, VTU, TABLE = "sweep.json", "records", "vtu", "sweep.csv"
FIELDS = "fields"  # folder of the arrays of each scene, and name of the file of all of them
PICTURES = ("sweep.png", "patches.png")
BESIDE = (".svg", ".pdf")  # what pictures may have beside them
SERIES = ("solution", "contact")  # names of the .vtu files of a scene
AGAIN = ".again.json"  # end of the name of a record of a scene that is to be tried again
ADVICE = "give another folder, or --force to replace it"
Other = Literal["refuse", "move", "replace"]
LATER = (
    INPUT,
    RECORDS,
    VTU,
    FIELDS,
    f"{FIELDS}.npz",
    TABLE,
    sweep_table.REPORT,
    *PICTURES,
    *(f"{Path(name).stem}{suffix}" for name in PICTURES for suffix in BESIDE),
    *(f"{name}.pvd" for name in SERIES),
)


def begin(
    folder: Path,
    request: Mapping[str, Any],
    other: Other = "refuse",
    later: Collection[str] = LATER,
) -> None:
    """Leave the sweep in a folder as it is if it is the requested one, to be continued; else make
    the folder of a new one. Nothing is solved.

    request: all that determines the records.
    other: another result in the folder is an error ("refuse"), is moved aside ("move"), or is
        removed ("replace", which removes the requested sweep, too).
    later: names of what is written into the folder afterwards.
    Raises SceneError for another result or a broken file, OSError where nothing can be written.
    """
    if folder.is_dir() and os.listdir(folder):
        try:
            if other != "replace":
                _check_request(folder, json.loads(result_folder.to_json(dict(request))))
                return
        except SceneError:
            if other == "refuse":
                raise
            result_folder.set_aside(folder)
    with result_folder.replacing(folder, {RECORDS, *later}) as work:
        (work / REQUEST).write_text(result_folder.to_json(dict(request)), encoding="utf-8")


def _check_request(folder: Path, request: dict[str, Any]) -> None:
    """Raise SceneError unless the folder holds the requested sweep with its keys in the same
    order; also for another kind of result and a file that cannot be read.
    """
    name = repr(str(folder))
    if not (folder / REQUEST).is_file():
        raise SceneError("--out", f"{name} holds another kind of result; {ADVICE}")
    tables = request, _load(folder / REQUEST)
    here, other = (dict(dotted(table)) for table in tables)
    for key in {**here, **other}:
        if here.get(key) != other.get(key):
            raise SceneError(
                "--out",
                f"{name} holds another sweep, with {key} {other.get(key, 'not given')} and not "
                f"{here.get(key, 'left out')}; {ADVICE}",
            )
    if list(here) != list(other):  # the numbers of the scenes differ, too
        raise SceneError("--out", f"{name} holds this sweep with --over in another order; {ADVICE}")


def done(folder: Path) -> set[int]:
    """Numbers of the scenes that have a record, whether or not they passed; not of those that are
    to be tried again.
    """
    files = (folder / RECORDS).glob("*.json")
    return {int(path.stem) for path in files if path.stem.isdecimal()}


def write(folder: Path, number: int, record: Mapping[str, Any], *, again: bool = False) -> None:
    """Write the record of scene `number`; the file appears whole or not at all. again: whether it
    is kept only until the scene is tried again. Raises OSError where it cannot be written.
    """
    path = _record(folder, number)
    path = path.with_suffix(AGAIN) if again else path
    write_whole(folder, path, result_folder.to_json(dict(record)).encode())


def write_whole(folder: Path, path: Path, content: bytes) -> None:
    """Write a file of the sweep in `folder` that appears whole or not at all. OSError: it cannot
    be written.
    """
    part = folder / RECORDS / f".{path.name}.{os.getpid()}"
    part.parent.mkdir(exist_ok=True)
    part.write_bytes(content)
    part.replace(path)


def read(folder: Path, number: int) -> dict[str, Any]:
    """Record of scene `number` (`sweep_table.record`, and "over", its values). Raises SceneError
    where its file is broken, OSError where there is none.
    """
    return _load(_record(folder, number))


def records(folder: Path) -> dict[int, tuple[dict[str, Any], dict[str, Any]]]:
    """Record and row of the table (`sweep_table.row`) by number of the scene, in that order, also
    of scenes that are to be tried again. Raises SceneError for a broken file, and for one that is
    no record.
    """
    found = {}
    for path in sorted((folder / RECORDS).glob("[0-9]*.json")):
        number = path.name.partition(".")[0]
        if number.isdecimal():
            record = _load(path)
            try:
                found[int(number)] = record, sweep_table.row(record)
            except (LookupError, TypeError, ValueError, AttributeError):
                raise broken(path) from None
    return found


def request(folder: Path) -> tuple[str, list[str]]:
    """Name of the scene of the sweep in a folder, and dotted keys whose values change. Raises
    SceneError for a broken file.
    """
    found = _load(folder / REQUEST)
    try:
        return str(found["scene"]["name"]), list(found["over"])
    except (LookupError, TypeError):
        raise broken(folder / REQUEST) from None


def check(folder: Path, values: Callable[[int], Mapping[str, object]]) -> None:
    """Raise SceneError for the first record that cannot be read or does not belong to its scene.
    Records that were being written when a sweep was killed, and those of scenes that are to be
    tried again, are removed.

    values: returns the values of the changing keys in a scene by dotted key, of its number.
    """
    for part in (*(folder / RECORDS).glob(".*"), *(folder / RECORDS).glob(f"*{AGAIN}")):
        part.unlink()
    for number, (record, _) in records(folder).items():
        good = False
        with suppress(LookupError):
            good = record["over"] == json.loads(result_folder.to_json(dict(values(number))))
        if not good:
            raise broken(_record(folder, number))


def write_fields(folder: Path, number: int, fields: Mapping[str, Any]) -> None:
    """Write the arrays of scene `number` by their names. OSError: they cannot be written."""
    path = folder / FIELDS / f"{number:05d}.npz"
    path.parent.mkdir(exist_ok=True)
    content = io.BytesIO()
    np.savez(content, **fields)
    write_whole(folder, path, content.getvalue())


def join_fields(folder: Path) -> None:
    """Write the arrays of all scenes of a sweep one after the other into one file, and "row", the
    number of the scene of each point, from 0. Points of a scene without an array have NaN in it.
    OSError: it cannot be written.
    """
    paths = sorted((folder / FIELDS).glob("*.npz"))
    each = [dict(np.load(path)) for path in paths]
    counts = [len(fields["pressure"]) for fields in each]
    shapes = {name: values.shape[1:] for fields in each for name, values in fields.items()}
    joined = {
        name: np.concatenate(
            [
                fields.get(name, np.full((count, *shape), np.nan))
                for fields, count in zip(each, counts, strict=True)
            ]
        )
        for name, shape in sorted(shapes.items())
    }
    row = np.repeat([int(path.stem) for path in paths], counts)
    np.savez_compressed(folder / f"{FIELDS}.npz", row=row, **joined)


def vtu_folder(folder: Path, number: int) -> Path:
    """Path of the folder of the .vtu files of scene `number`; it is not made."""
    return folder / VTU / f"{number:05d}"


def _record(folder: Path, number: int) -> Path:
    """Path of the record of scene `number`."""
    return folder / RECORDS / f"{number:05d}.json"


def _load(path: Path) -> dict[str, Any]:
    """The table of a JSON file. Raises SceneError for anything else."""
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        table = None
    if not isinstance(table, dict):
        raise broken(path)
    return table


def broken(path: Path) -> SceneError:
    """The error that reports a broken file of a sweep."""
    return SceneError("--out", f"{str(path)!r} is broken; delete it and start again")
