"""The result folder: complete or not there at all."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from railhead.run import Result
from railhead.scene import Scene, SceneError
from railhead.scene_io import to_toml

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
    """A temporary folder that takes the place of `folder` when the block ends without an error."""
    folder = folder.absolute()
    folder.parent.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        yield work
        work.chmod(0o755)
        old = Path(tempfile.mkdtemp(prefix=f".{folder.name}.old.", dir=folder.parent))
        try:
            if folder.exists():
                os.rename(folder, old / "result")
            os.rename(work, folder)
        finally:
            shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def write(result: Result, folder: Path, *, pictures: bool) -> list[str]:
    """Write summary, scene, VTU files and pictures; returns the file names."""
    from postprocess import gallery

    with replacing(folder) as work:
        if result.fields is not None and result.findings is not None:
            gallery.draw(
                result.fields,
                result.findings,
                result.ellipse,
                _poisson(result.plan.scene),
                work,
                pictures=pictures,
            )
        (work / "scene.toml").write_text(to_toml(result.plan.scene), encoding="utf-8")
        (work / SUMMARY).write_text(as_json(result), encoding="utf-8")
        return sorted(path.name for path in work.iterdir())


def _poisson(scene: Scene) -> float:
    return scene.rail.poisson_ratio


def as_json(result: Result) -> str:
    """summary.json; infinite numbers (rigid bodies, flat profiles) are written as the word."""
    return json.dumps(_plain(result.summary), indent=2, allow_nan=False) + "\n"


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return value
