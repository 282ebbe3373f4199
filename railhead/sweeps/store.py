"""The folder of a sweep: what was asked, and a record for each combination that is done.

A record appears whole or not at all, so a sweep that is killed loses what it was working on alone.
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

ASKED, RECORDS, GRIDS = "sweep.json", "records", "vtu"
SERIES = ("solution", "contact")  # of .vtu files


def begin(folder: Path, asked: Mapping[str, Any], *, resume: bool) -> None:
    """Make the folder of a new sweep, in the place of an earlier result; or go on with the one that
    is there. Raises SceneError where another sweep is or a file of this one is broken, OSError
    where nothing can be written."""
    if resume and folder.is_dir() and os.listdir(folder):
        _same(folder, json.loads(result_folder.to_json(dict(asked))))
        (folder / RECORDS).mkdir(exist_ok=True)
        if asked.get("vtu"):
            (folder / GRIDS).mkdir(exist_ok=True)
        return
    if (folder / ASKED).is_file():
        with claimed(folder):
            pass
    with result_folder.replacing(folder) as work:
        (work / RECORDS).mkdir()
        if asked.get("vtu"):
            (work / GRIDS).mkdir()
        (work / ASKED).write_text(result_folder.to_json(dict(asked)), encoding="utf-8")


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a sweep's folder. Raises SceneError where one is at work there."""
    with open(folder / ASKED) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            text = f"{str(folder)!r} is in use by a sweep that runs; wait for it, or give another"
            raise SceneError("--out", text) from None
        except OSError:
            pass  # a disk that knows no locks
        yield


def _same(folder: Path, asked: dict[str, Any]) -> None:
    try:
        there = _loaded(folder / ASKED)
    except FileNotFoundError:
        raise SceneError("--resume", f"{str(folder)!r} holds no sweep; leave it out") from None
    here, other = _flat(asked), _flat(there)
    for key in {**here, **other}:
        if here.get(key) != other.get(key):
            raise SceneError(
                "--resume",
                f"{str(folder)!r} holds another sweep, with {key} {other.get(key, 'not given')} "
                f"and not {here.get(key, 'left out')}; give the same, or another --out",
            )
    if list(here) != list(other):  # and so do the numbers of the combinations
        raise SceneError(
            "--resume", f"{str(folder)!r} holds this sweep with --over in another order; keep that"
        )


def _flat(table: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{above}.{key}" if above else key
        found |= _flat(value, name) if isinstance(value, Mapping) else {name: value}
    return found


def done(folder: Path) -> set[int]:
    """Numbers of the combinations that have a record."""
    files = (folder / RECORDS).glob("*.json")
    return {int(path.stem) for path in files if path.stem.isdecimal()}


def write(folder: Path, number: int, record: Mapping[str, Any]) -> None:
    """Keep what became of a combination."""
    path = _record(folder, number)
    half = path.with_name(f".{path.name}.{os.getpid()}")
    half.write_text(result_folder.to_json(dict(record)), encoding="utf-8")
    half.replace(path)


def read(folder: Path, number: int) -> dict[str, Any]:
    """A record that is done. SceneError: its file is broken."""
    return _loaded(_record(folder, number))


def _record(folder: Path, number: int) -> Path:
    return folder / RECORDS / f"{number:05d}.json"


def _loaded(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        found = None
    if not isinstance(found, dict):
        raise _broken(path)
    return found


def check(
    folder: Path, over: Callable[[int], Mapping[str, Any]], known: Callable[[dict[str, Any]], None]
) -> None:
    """Raises SceneError of a record that is broken, or that `known` raises for, or of another
    combination than has its number: `over` tells what changes in that."""
    for number in done(folder):
        kept, wanted = read(folder, number), json.loads(result_folder.to_json(dict(over(number))))
        try:
            known(kept)
            fits = kept["over"] == wanted
        except (LookupError, TypeError, ValueError, AttributeError):
            fits = False
        if not fits:
            raise _broken(_record(folder, number))


def forget_without_grids(folder: Path) -> None:
    """What is solved but has lost its .vtu files is solved again. Raises SceneError as `read`."""
    for number in done(folder):
        files = [grids(folder, number) / f"{name}.vtu" for name in SERIES]
        if not read(folder, number).get("fault") and not all(map(Path.is_file, files)):
            _record(folder, number).unlink()


def _broken(path: Path) -> SceneError:
    return SceneError("--resume", f"{str(path)!r} is broken; delete it and resume again")


def grids(folder: Path, number: int) -> Path:
    """Where the .vtu files of a combination are."""
    return folder / GRIDS / f"{number:05d}"


def keep(folder: Path, work: Path) -> None:
    """Copy what was asked, all records and .vtu files into the folder that takes the place of this
    one."""
    if (folder / GRIDS).is_dir():
        shutil.copytree(folder / GRIDS, work / GRIDS, copy_function=_linked)
    (work / RECORDS).mkdir()
    names = [ASKED, *(f"{RECORDS}/{number:05d}.json" for number in sorted(done(folder)))]
    for name in names:
        (work / name).write_bytes((folder / name).read_bytes())


def _linked(source: str, target: str) -> None:
    """The same file under another name; a copy where the disk knows no such thing."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)
