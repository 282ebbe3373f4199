"""The result folder: complete or not there at all."""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import signal
import tempfile
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead import process, quantities, spreadsheet
from railhead.scene.io import to_toml
from railhead.scene.scene import SceneError

if TYPE_CHECKING:
    import meshio

    from railhead.postprocess.findings import Array, Findings
    from railhead.result import Result

Page = Callable[[Path, "Findings | None", "tuple[meshio.Mesh, meshio.Mesh] | None"], None]
SUMMARY = "summary.json"
TABLE = "result.csv"
MANIFEST = ".railhead"  # names of the files in a result folder that are replaced by the next one


def foreign(folder: Path) -> list[str]:
    """Names in a folder that no result put there."""
    names, own = set(os.listdir(folder)), {MANIFEST}
    if MANIFEST in names:
        text = (folder / MANIFEST).read_text(encoding="utf-8", errors="replace")
        own |= set(text.splitlines())
    return sorted(names - own)


def check_folder(folder: Path, keeps: Collection[str] = ()) -> None:
    """Raise SceneError if results cannot go to `folder`, before anything is computed.

    A result takes the place of an earlier one as a whole, so the folder must be new, empty, or
    hold nothing else (but what it `keeps`); a link to one is followed.
    """
    try:
        problem = _obstacle(folder, keeps)
    except OSError as error:
        problem = f"{str(folder)!r}: {error.strerror}"
    except ValueError as error:  # a null character
        problem = f"{str(folder)!r}: {error}"
    if problem:
        raise SceneError("--out", f"{problem}; give another folder")


def _obstacle(folder: Path, keeps: Collection[str]) -> str:
    """Why results cannot go to a folder; empty if they can."""
    name = repr(str(folder))
    with suppress(FileNotFoundError, NotADirectoryError):
        folder.lstat()  # Python 3.14's `exists` hides that a name is too long
    if folder.is_symlink() and not folder.exists():
        return f"{name} is a link to nothing"
    if folder.exists() and not folder.is_dir():
        return f"{name} is a file"
    if folder.is_dir():
        if folder.samefile(os.curdir) or os.path.ismount(folder):
            kind = "a mount point" if os.path.ismount(folder) else "the working directory"
            return f"{name} is {kind}, which cannot be replaced"
        if others := [other for other in foreign(folder) if other not in keeps]:
            return f"{name} holds {others[0]!r}, which is no result"
    parent = folder.resolve().parent
    while not parent.exists():
        parent = parent.parent
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        return f"{str(parent)!r} cannot be written to"
    return ""


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """A temporary folder that takes the place of `folder` when the block ends without an error.

    `folder` holds the earlier result or the new one, whole, at every moment; of two that end
    together the later one stays. What somebody else put into it in the meantime is kept. A
    termination signal that comes during the exchange is too late and is ignored. OSError: the
    files cannot be written.
    """
    folder = folder.resolve()
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))

    def remove() -> None:
        shutil.rmtree(work, ignore_errors=True)

    with process.undoing(remove), process.unfinished(work):
        try:
            yield work
            names = "".join(f"{name}\n" for name in sorted(os.listdir(work)))
            (work / MANIFEST).write_text(names, encoding="utf-8")
            with _undisturbed():
                work.chmod(0o755)
                try:
                    os.rename(work, folder)
                except OSError:
                    if not folder.is_dir():
                        raise
                    _exchange(work, folder)
                    for name in foreign(work):
                        os.rename(work / name, folder / name)
        finally:
            with _undisturbed():
                remove()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Ignore signals that end the process for a moment; they reach the main thread only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, signal.SIG_IGN) for number in process.SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _exchange(one: Path, other: Path) -> None:
    """Swap two folders, on Linux in one step (renameat2 with RENAME_EXCHANGE)."""
    swap = getattr(ctypes.CDLL(None), "renameat2", None)
    here, exchange = -100, 2
    if swap and swap(here, os.fsencode(one), here, os.fsencode(other), exchange) == 0:
        return
    aside = one.with_name(f"{one.name}.old")
    os.rename(other, aside)
    os.rename(one, other)
    os.rename(aside, one)


def write_grids(result: Result, folder: Path, *, whole: bool = False) -> Array | None:
    """Write the files for ParaView and return the stresses at the nodes (n, 6), MPa; None, and
    no files, where nothing touches."""
    from railhead.postprocess import files, stress

    left, found, fields = result.level.left, result.findings, result.fields
    if fields is None or found is None:
        return None
    residual = None if left is None else left.residual
    stresses, rubbing = stress.nodal(fields), result.level.solution.rubbing
    files.write(fields, stresses, found, residual, rubbing, folder, whole=whole)
    return stresses


def write(
    result: Result, folder: Path, *, pictures: bool, page: Page | None = None, whole: bool = False
) -> list[str]:
    """Write all files of a result, and what `page` adds; returns their names. whole: the files for
    ParaView have the images of what symmetry left out."""
    from railhead.postprocess import gallery, plastic_plots, shakedown_plot, traction_plots
    from railhead.subject import subject

    with replacing(folder) as work:
        found, grids = result.findings, None
        if found is not None:
            after = result.level.after.items()
            needed = tuple(
                f"{name.replace('_', ' ')}: {each.why}" for name, each in after if each.needed
            )
            found = replace(found, notes=needed, subject=subject(result.plan, result.load))
        stresses = write_grids(result, work, whole=whole)
        left, rubbing, fields = result.level.left, result.level.solution.rubbing, result.fields
        residual = None if left is None else left.residual
        if fields is not None and found is not None and stresses is not None and pictures:
            poisson, elastic = result.plan.shown.poisson_ratio, result.level.plain
            grids = gallery.draw(fields, stresses, found, result.ellipse, poisson, work)
            if residual is not None and elastic is not None and elastic.findings:
                exact = result.ellipse if len(found.patch.each) < 2 else None
                plastic_plots.draw(
                    fields, residual, found, elastic.findings, exact, work / "plastic.png"
                )
            if rubbing is not None:
                traction_plots.draw(
                    rubbing, found, result.plan.scene.friction.coefficient,
                    work / "friction.png", mirrored=result.plan.half_y,
                )  # fmt: skip
                friction = result.summary["result"]["friction"]
                if "p0_over_k" in friction:
                    shakedown_plot.draw(
                        friction, poisson, work / "shakedown.png", found.subject.title
                    )
        (work / "scene.toml").write_text(to_toml(result.plan.scene), encoding="utf-8")
        (work / SUMMARY).write_text(as_json(result), encoding="utf-8")
        table = quantities.everything(result.summary)
        (work / TABLE).write_bytes(spreadsheet.encoded(table))
        if page is not None:
            page(work, found, grids)
        return sorted(path.name for path in work.iterdir())


def as_json(result: Result) -> str:
    """summary.json of a solved scene."""
    return to_json(result.summary)


def to_json(summary: dict[str, Any]) -> str:
    """JSON; infinite numbers (rigid bodies, flat profiles) are written as the word."""
    return json.dumps(_plain(summary), indent=2, allow_nan=False) + "\n"


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return value
