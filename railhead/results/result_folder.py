"""Replacing a folder of results by a new one, so that it is complete or not there at all."""

import csv
import errno
import fcntl
import glob
import io
import itertools
import json
import os
import shutil
import socket
import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from datetime import UTC, datetime
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tomli_w

from railhead.geometry.tables import NUMBER
from railhead.run import process
from railhead.scene.catalogue import copy_files, portable
from railhead.scene.scene import Scene
from railhead.scene.sections import ArgumentError, refuse_first

SUMMARY, SCENE = "summary.json", "scene.toml"
VERSION = version("railhead-contact")
UNITS = "N, mm, MPa, rad, s"
Attempt = Callable[[str], AbstractContextManager[None]]
"""Maps a file's name to a context in which the file is written; it keeps an error for later."""
MANIFEST = ".railhead"  # names of the files in a result folder that are replaced by the next one


def foreign(folder: Path) -> list[str]:
    """Sorted names of the files and folders in a folder that are not in the list of its result's
    files (MANIFEST); all where there is no list.
    """
    path = folder / MANIFEST
    listed = path.read_text("utf-8", errors="replace").splitlines() if path.is_file() else []
    return sorted(set(os.listdir(folder)) - {MANIFEST, *listed})


def check_folder(folder: Path, keeps: Collection[str] = ()) -> None:
    """Raise SceneError if results cannot be written to `folder`; called before anything is
    computed. Writes nothing, but finishes an exchange of folders that was killed.

    A result replaces an earlier one as a whole. The folder must be new, empty, or hold only files
    of a result and those named in `keeps`. A link to a folder is followed.
    """
    name, end = repr(str(folder)), "; give another folder"
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            (folder.parent / (_prefix(folder) + 16 * "x")).lstat()  # raises if the name is too long
        to_nothing = folder.is_symlink() and not folder.exists()
        refuse_first(
            (to_nothing, "folder", f"{name} is a link to nothing{end}"),
            (folder.exists() and not folder.is_dir(), "folder", f"{name} is a file{end}"),
            kind=ArgumentError,
        )
        target = folder.resolve()
        parent = next((each for each in target.parents if each.exists()), target)
        writable = parent.is_dir() and os.access(parent, os.W_OK)
        text = f"{str(parent)!r} cannot be written to{end}"
        refuse_first((not writable, "folder", text), kind=ArgumentError)
        if target.parent.is_dir() and process.rank() == 0:
            settle(target)
        if folder.is_dir():
            other = next((each for each in foreign(folder) if each not in keeps), "")
            kept, mount = "which cannot be replaced", os.path.ismount(folder)
            refuse_first(
                (mount, "folder", f"{name} is a mount point, {kept}{end}"),
                (target == Path.cwd(), "folder", f"{name} is the working directory, {kept}{end}"),
                (other, "folder", f"{name} holds {other!r}, which is no result{end}"),
                kind=ArgumentError,
            )
    except OSError as error:
        raise ArgumentError("folder", f"{name}: {error.strerror}{end}") from None


def other_result(folder: Path, command: str, scene: Scene) -> str:
    """What a folder holds, in words, where it holds another result than that of `command` (a word,
    'run') for this scene; '' where it is missing, empty or no folder, or holds this one.

    Another result is one whose scene.toml is missing, or names another command in its first line,
    or differs in any line after that: another scene, one of another version, or an edited one.
    """
    if not folder.is_dir() or not os.listdir(folder):
        return ""
    file = folder / SCENE
    known = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
    first, _, text = known.partition("\n")
    if f" {command} " not in first:
        return "another kind of result"
    same = text == scene_toml(command, scene).partition("\n")[2]
    return "" if same else "a result of another scene, version, or an edited scene.toml"


def check_free(folder: Path, command: str, scene: Scene, *, force: bool) -> None:
    """Raise SceneError if the result of `command` for this scene cannot be written to a folder, or
    would replace another one there without `force`.
    """
    check_folder(folder)
    if not force and (words := other_result(folder, command, scene)):
        text = f"{str(folder)!r} holds {words}; give another folder, or force=True to replace it"
        raise ArgumentError("folder", text)


def set_aside(folder: Path) -> None:
    """Rename a result folder to NAME.1, or the first of .2, .3 ... that is free, and say so in one
    line on standard error. OSError: it cannot be renamed.
    """
    names = (folder.with_name(f"{folder.name}.{number}") for number in itertools.count(1))
    free = next(name for name in names if not os.path.lexists(name))
    folder.rename(free)
    was, now = map(os.path.relpath, (folder, free))
    text = f"the earlier result in {was}/ is another one; it is now {now}/"
    print(f"railhead: {text}", file=sys.stderr)


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Keep a result folder, which need not exist, for this process and the block. Raises SceneError
    where another process of this machine keeps it. The system frees it when the process ends.
    """
    name = sha256(os.fsencode(folder.resolve())).hexdigest()
    with socket.socket(socket.AF_UNIX) as mark:
        try:
            mark.bind(f"\0railhead-{name}")  # a name of Linux that is no file
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                text = f"{str(folder)!r} is in use by another command; wait for it, or give another"
                raise ArgumentError("folder", text) from None
        yield


def scene_toml(command: str, scene: Scene) -> str:
    """Text of scene.toml beside a result: a comment line with command, version of the program, date
    and units, then the scene.
    """
    return f"# railhead {command} {VERSION}, {now()}; {UNITS}\n{tomli_w.dumps(portable(scene))}"


@contextmanager
def result(
    folder: Path, command: str, scene: Scene, summary: dict[str, Any], *, aside: bool = False
) -> Iterator[tuple[Path, Attempt]]:
    """A temporary folder that replaces `folder` after the block, with scene.toml, copies of the
    files of the scene, and summary.json in it; and a function of a file's name that returns a
    context manager in which that file is written.

    aside: whether another result in the folder (`other_result`) is renamed (`set_aside`).
    OSError: these files cannot be written; or, after the exchange, with a line for each, files
        that could not be written in the block.
    """
    failures: list[str] = []
    other = partial(other_result, folder, command, scene) if aside else str
    with replacing(folder, other=other) as work:
        copy_files(scene.files, work)
        (work / SCENE).write_text(scene_toml(command, scene), encoding="utf-8")
        (work / SUMMARY).write_text(to_json(origin() | summary), encoding="utf-8")
        yield work, lambda name: attempt(failures, folder / name, work)
    if failures:
        raise OSError("\n".join(failures))


def origin() -> dict[str, Any]:
    """First entries of summary.json, which say where it is from: "railhead" (version), "date",
    "units".
    """
    return {"railhead": VERSION, "date": now(), "units": UNITS}


def signed(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of a table with program and date as their last columns."""
    origin = {"program": f"railhead {VERSION}", "date": now()}
    return [row | origin for row in rows]


def now() -> str:
    """Present date and time, UTC, to the second, as in ISO 8601."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def draw(drawings: Mapping[str, Callable[[Path], Any]], folder: Path, attempt: Attempt) -> None:
    """Draw pictures by name of their PNG file into a folder; an error is kept by `attempt`."""
    for name, drawing in drawings.items():
        with attempt(name):
            drawing(folder / name)


@contextmanager
def attempt(failures: list[str], path: Path, work: Path) -> Iterator[None]:
    """Catch an error of the block, remove the files that the block began in the folder `work`, and
    add a line to `failures` that names `path`.
    """
    before = set(work.iterdir())
    try:
        yield
    except Exception as error:  # of matplotlib, VTK or the disk: the numbers are worth having
        for begun in set(work.iterdir()) - before:
            begun.unlink()
        failures.append(f"{path}: {' '.join(f'{type(error).__name__}: {error}'.split())}")


@contextmanager
def replacing(
    folder: Path, later: Collection[str] = (), other: Callable[[], str] = str
) -> Iterator[Path]:
    """A temporary folder that replaces `folder` when the block ends without an error.

    later: names of files that are written into `folder` afterwards and belong to the result, too.
    other: returns "" where what is in the folder may be replaced. Else that is renamed, as
        `set_aside`. No other process changes the folder between both.
    The earlier result is renamed to `.NAME.earlier`, then the new one to its name. Whenever the
    process is killed, one of both is complete; `settle` finishes the exchange. Files that others
    put into `folder` are kept. Of two results written at once, the later one remains. OSError: the
    files cannot be written.
    """
    folder = folder.resolve()
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = _temporary(folder)
    try:
        yield work
        names = sorted({*os.listdir(work), *later})
        (work / MANIFEST).write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
        work.chmod(0o755)
        with _locked(folder.parent):
            _settle(folder)
            if other():
                set_aside(folder)
            try:
                if folder.is_dir():
                    os.rename(folder, _earlier(folder))
                os.rename(work, folder)
            finally:
                _settle(folder)
    except OSError as error:
        error.filename = error.filename or str(folder)  # a full disk names none
        raise
    finally:
        shutil.rmtree(work, ignore_errors=True)


def settle(folder: Path) -> None:
    """Finish the exchange of folders after a process that was killed in `replacing`, and remove its
    temporary folders. OSError: a folder cannot be changed.
    """
    with _locked(folder.parent):
        _settle(folder)
        for work in folder.parent.glob(glob.escape(_prefix(folder)) + "*"):
            process_id = work.name.removeprefix(_prefix(folder)).partition(".")[0]
            if process_id.isdecimal() and not os.path.exists(f"/proc/{process_id}"):
                shutil.rmtree(work, ignore_errors=True)


def _settle(folder: Path) -> None:
    """Finish the exchange of folders: restore the earlier result, or move foreign files from it to
    the new one and remove it. The parent folder must be locked.
    """
    earlier = _earlier(folder)
    if not earlier.is_dir():
        return
    if not folder.exists():
        os.rename(earlier, folder)
        return
    for name in foreign(earlier):
        os.rename(earlier / name, folder / name)
    doomed = _temporary(folder)
    os.rename(earlier, doomed)  # half of it must not be taken for files of others
    shutil.rmtree(doomed, ignore_errors=True)


def _earlier(folder: Path) -> Path:
    """Path of the earlier result during an exchange of folders."""
    return folder.parent / f".{folder.name}.earlier"


def _prefix(folder: Path) -> str:
    """Beginning of the names of temporary folders that processes of this machine make for a result
    folder.
    """
    return f".{folder.name}.{os.uname().nodename}."


def _temporary(folder: Path) -> Path:
    """Make a temporary folder beside a result folder, named after this process; its path."""
    return Path(tempfile.mkdtemp(prefix=f"{_prefix(folder)}{os.getpid()}.", dir=folder.parent))


@contextmanager
def _locked(parent: Path) -> Iterator[None]:
    """Lock a folder against exchanges by other processes for the block. The system releases the
    lock when the process ends.
    """
    handle = os.open(parent, os.O_RDONLY)
    try:
        with suppress(OSError):  # a disk that knows no locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def to_json(summary: dict[str, Any]) -> str:
    """JSON text of plain data, ending in a line break; infinite numbers are written as "inf" and
    "-inf". Raises ValueError for NaN.
    """
    return json.dumps(_plain(summary), indent=2, allow_nan=False) + "\n"


def from_json(path: Path) -> dict[str, Any]:
    """The table of a JSON file as `to_json` writes it. Raises ValueError for anything else, and for
    a whole number that no float holds; OSError where it cannot be read.
    """

    def refused(name: str) -> float:
        """Raises ValueError for a number that JSON does not know."""
        raise ValueError(f"{name} is no number")

    def whole(digits: str) -> int:
        """A whole number below 1e18."""
        return int(digits) if len(digits) < 19 else int(refused(digits))

    if path.exists() and not path.is_file():
        raise ValueError(f"{path.name} is no regular file")
    try:
        text = path.read_text(encoding="utf-8")
        table = json.loads(text, parse_constant=refused, parse_int=whole)
    except RecursionError as error:
        raise ValueError(f"{path.name} is nested too deep") from error
    if not isinstance(table, dict):
        raise ValueError(f"{path.name} is no table")
    return table


def _plain(value: object) -> object:
    """Plain data with tuples as lists and infinite numbers as words."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return value


# Tables that Excel opens by a double click and everything else reads: comma-separated values with
# decimal points, in UTF-8 with its mark, lines ending in CR LF.

ENCODING = "utf-8-sig"


def encoded(rows: Iterable[Mapping[str, object]]) -> bytes:
    """Bytes of a .csv file: a line for each row, columns in the order of their first appearance;
    None is an empty cell. Text that a spreadsheet would compute begins with an apostrophe.
    """
    rows = [{name: _harmless(cell) for name, cell in row.items()} for row in rows]
    columns = dict.fromkeys(name for row in rows for name in row)
    file = io.StringIO(newline="")
    writer = csv.DictWriter(file, list(columns))
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue().encode(ENCODING)


def _harmless(cell: object) -> object:
    """A cell, with an apostrophe before text that a spreadsheet takes for a formula."""
    computed = isinstance(cell, str) and cell.startswith(("=", "+", "-", "@", "\t", "\r"))
    return f"'{cell}" if computed and not NUMBER.fullmatch(str(cell)) else cell
