"""The result folder: complete or not there at all."""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import signal
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.scene import SceneError
from railhead.scene_io import to_toml

if TYPE_CHECKING:
    from railhead.run import Result

SUMMARY = "summary.json"


def check_folder(folder: Path) -> None:
    """Raise SceneError if results cannot go to `folder`, before anything is computed."""
    if folder.exists() and not folder.is_dir():
        raise SceneError("--out", f"{str(folder)!r} is a file; give a folder")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / SUMMARY).is_file():
        raise SceneError(
            "--out", f"{str(folder)!r} holds files that are not a result; give a new folder"
        )
    parent = folder.absolute().parent
    while not parent.exists():
        parent = parent.parent
    if not os.access(parent, os.W_OK):
        raise SceneError("--out", f"{str(parent)!r} cannot be written to; give another folder")


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """A temporary folder that takes the place of `folder` when the block ends without an error.

    `folder` holds the earlier result or the new one, whole, at every moment; of two that end
    together the later one stays. A termination signal that comes during the exchange is too late
    and is ignored. OSError: the files cannot be written.
    """
    folder = folder.absolute()
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        yield work
        with _undisturbed():
            work.chmod(0o755)
            try:
                os.rename(work, folder)
            except OSError:
                if not folder.is_dir():
                    raise
                _exchange(work, folder)
    finally:
        with _undisturbed():
            shutil.rmtree(work, ignore_errors=True)


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Ignore termination signals for a moment; they reach the main thread only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handler = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, handler)


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


def write(result: Result, folder: Path, *, pictures: bool) -> list[str]:
    """Write summary, scene, VTU files and pictures; returns the file names."""
    from postprocess import gallery

    with replacing(folder) as work:
        if result.fields is not None and result.findings is not None:
            after = result.level.after.items()
            needed = tuple(f"{name}: {each.why}" for name, each in after if each.needed)
            gallery.draw(
                result.fields,
                replace(result.findings, notes=needed),
                result.ellipse,
                result.plan.shown.poisson_ratio,
                work,
                pictures=pictures,
            )
        (work / "scene.toml").write_text(to_toml(result.plan.scene), encoding="utf-8")
        (work / SUMMARY).write_text(as_json(result), encoding="utf-8")
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
