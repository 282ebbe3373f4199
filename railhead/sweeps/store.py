"""The folder of a sweep: what was requested, and a record of each scene that is solved.

A record appears whole or not at all, so a sweep that is killed loses only what was running.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from railhead.results import result_folder
from railhead.scene.scene import SceneError

REQUEST, RECORDS, VTU = "sweep.json", "records", "vtu"
SERIES = ("solution", "contact")  # of .vtu files


def begin(folder: Path, request: Mapping[str, Any], *, resume: bool) -> None:
    """Make the folder of a new sweep in the place of an earlier result, or with `resume` continue
    the sweep in the folder. request: all that determines the records. Raises SceneError for
    another sweep, a folder in use or a broken file, OSError where nothing can be written.
    """
    if resume and folder.is_dir() and os.listdir(folder):
        _check_request(folder, json.loads(result_folder.to_json(dict(request))))
        _make_folders(folder, request)
        return
    if (folder / REQUEST).is_file():
        with claimed(folder):
            pass
    with result_folder.replacing(folder) as work:
        _make_folders(work, request)
        (work / REQUEST).write_text(result_folder.to_json(dict(request)), encoding="utf-8")


def _make_folders(folder: Path, request: Mapping[str, Any]) -> None:
    """Make the folders of records and, where requested, of .vtu files."""
    for name in (RECORDS, VTU) if request.get("vtu") else (RECORDS,):
        (folder / name).mkdir(exist_ok=True)


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Lock the folder of a sweep against other sweeps for the block. Raises SceneError where
    another sweep works there.
    """
    with open(folder / REQUEST) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            text = f"{str(folder)!r} is in use by a sweep that runs; wait for it, or give another"
            raise SceneError("--out", text) from None
        except OSError:
            pass  # a disk that knows no locks
        yield


def _check_request(folder: Path, request: dict[str, Any]) -> None:
    """Raise SceneError where the sweep in the folder differs from the requested one."""
    name = repr(str(folder))
    if not (folder / REQUEST).is_file():
        raise SceneError("--resume", f"{name} holds no sweep; leave it out")
    here, other = _flat(request), _flat(_load(folder / REQUEST))
    for key in {**here, **other}:
        if here.get(key) != other.get(key):
            raise SceneError(
                "--resume",
                f"{name} holds another sweep, with {key} {other.get(key, 'not given')} and not "
                f"{here.get(key, 'left out')}; give the same, or another --out",
            )
    if list(here) != list(other):  # the numbers of the scenes differ, too
        raise SceneError(
            "--resume", f"{name} holds this sweep with --over in another order; keep that"
        )


def _flat(table: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Values of nested tables by dotted key. above: prefix of the keys."""
    values: dict[str, Any] = {}
    for key, value in table.items():
        values |= (
            _flat(value, f"{above}{key}.") if isinstance(value, Mapping) else {above + key: value}
        )
    return values


def done(folder: Path) -> set[int]:
    """Numbers of the scenes that have a record."""
    files = (folder / RECORDS).glob("*.json")
    return {int(path.stem) for path in files if path.stem.isdecimal()}


def write(folder: Path, number: int, record: Mapping[str, Any]) -> None:
    """Write the record of scene `number`; the file appears whole or not at all. Raises OSError."""
    path = _record(folder, number)
    part = path.with_name(f".{path.name}.{os.getpid()}")
    part.write_text(result_folder.to_json(dict(record)), encoding="utf-8")
    part.replace(path)


def read(folder: Path, number: int) -> dict[str, Any]:
    """Record of scene `number`. Raises SceneError where its file is broken."""
    return _load(_record(folder, number))


def check(folder: Path, matches: Callable[[int, dict[str, Any]], bool]) -> None:
    """Raise SceneError for the first record that cannot be read or does not belong to its scene.

    matches: function of number and record; returns whether they belong together, raises
        LookupError, TypeError, ValueError or AttributeError for data that is no record.
    """
    for number in done(folder):
        try:
            good = matches(number, read(folder, number))
        except (LookupError, TypeError, ValueError, AttributeError):
            good = False
        if not good:
            raise _broken(_record(folder, number))


def drop_without_vtu(folder: Path) -> None:
    """Remove the records of solved scenes whose .vtu files are missing, so that these scenes are
    solved again.
    """
    for number in done(folder):
        files = [vtu_folder(folder, number) / f"{name}.vtu" for name in SERIES]
        if not read(folder, number).get("fault") and not all(map(Path.is_file, files)):
            _record(folder, number).unlink()


def vtu_folder(folder: Path, number: int) -> Path:
    """Folder of the .vtu files of scene `number`."""
    return folder / VTU / f"{number:05d}"


def copy(folder: Path, target: Path) -> None:
    """Put request, records and .vtu files of a sweep into the folder `target` that will replace the
    sweep's folder: as hard links, or as copies where the disk has none.
    """
    shutil.copy2(folder / REQUEST, target / REQUEST)
    unfinished = shutil.ignore_patterns(".*")
    for name in (RECORDS, VTU):
        if (folder / name).is_dir():
            shutil.copytree(folder / name, target / name, ignore=unfinished, copy_function=_link)


def _link(source: str, target: str) -> None:
    """Make a hard link, or a copy where the disk has no links."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def _record(folder: Path, number: int) -> Path:
    """Path of the record of scene `number`."""
    return folder / RECORDS / f"{number:05d}.json"


def _load(path: Path) -> dict[str, Any]:
    """The table of a JSON file. Raises SceneError for anything else."""
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise _broken(path)
    return table


def _broken(path: Path) -> SceneError:
    """The error that reports a broken file of a sweep."""
    return SceneError("--resume", f"{str(path)!r} is broken; delete it and resume again")
