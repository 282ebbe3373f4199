"""Scenes: the cases that ship (modules of `railhead.cases` with a SCENE), and TOML files."""

import ast
import difflib
import importlib
import os
import re
import shutil
import tomllib
import unicodedata
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path
from typing import Any

from railhead.geometry.measured import EXTENSIONS
from railhead.scene.keys import file_entries
from railhead.scene.scene import MAX_NAME_BYTES, Scene, SceneError
from railhead.scene.units import show


def shipped() -> dict[str, str]:
    """First line of the docstring of each case by the name of the case. The modules are parsed, not
    imported.
    """
    descriptions = {}
    for path in importlib.import_module("railhead.cases").__path__:
        for file in sorted(Path(path).glob("[!_]*.py")):
            text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
            descriptions[file.stem] = text.split("\n")[0]
    return descriptions


def find(name: str | Path) -> Scene:
    """The scene of a shipped case of this name, or else of a TOML file at this path. Raises
    SceneError if there is neither, and where the file cannot be read or holds no valid scene.
    """
    known, name = shipped(), str(name)
    if name in known:
        scene: Scene = importlib.import_module(f"railhead.cases.{name}").SCENE
        return scene
    if name.endswith(".toml") or Path(name).exists():
        return read_scene(name)
    close = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise SceneError(
        "case", f"{name!r} is unknown; {hint}give a .toml file or one of {', '.join(known)}"
    )


INPUT = "input"  # folder in a result folder with the files that the scene names


def as_path(value: object, name: str) -> Path:
    """The value of an argument `name` as a path. Raises SceneError for what is neither text nor a
    path.
    """
    try:
        return Path(value)  # type: ignore[arg-type]
    except TypeError:
        raise SceneError(name, f"{show(value)} is no path; give text or a pathlib.Path") from None


def _read_toml(path: Path) -> dict[str, Any]:
    """Nested tables of a TOML file. Raises SceneError where the file is missing, unreadable, not
    UTF-8 or invalid TOML.
    """
    try:
        if os.path.isfile(path):
            return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:  # bytes that are no text, too
        reason = " ".join(str(error).split())
        raise SceneError(str(path), f"not valid TOML, which is UTF-8 text: {reason}") from None
    raise SceneError(str(path), "is no file; give the path of a TOML file")


def read_scene(path: str | Path) -> Scene:
    """The scene of a TOML file.

    Without a key `name` the scene is named after the file, with _ for characters that names may not
    have. Relative paths of its files start at the folder of the file.
    Raises SceneError (one line), naming the file if it cannot be read, else the key.
    """
    path = as_path(path, "path")
    data = _read_toml(path)
    stem = unicodedata.normalize("NFC", path.stem)  # else an accent is a character of its own
    short = re.sub(r"[^\w.-]", "_", stem).encode()[:MAX_NAME_BYTES].decode(errors="ignore")
    data.setdefault("name", short)
    for table, key in file_entries(data):
        if key in ("file", "sections") or table[key].lower().endswith(EXTENSIONS):
            table[key] = str(path.parent / table[key])
    return Scene.from_mapping(data)


def places(files: Iterable[Path]) -> dict[str, str]:
    """Where the copies of files lie in a result folder, by path: input/HASH/NAME, with the first
    twelve digits of the file's SHA-256; of a table of sections they are beside it, and the digits
    are those of all of them. OSError: a file cannot be read.
    """
    from railhead.geometry.sections import named  # numpy, which a list of cases does not need

    found: dict[str, str] = {}
    for path in files:
        group = {path: path.name} | named(path)
        digits = sha256(b"".join(each.read_bytes() for each in group)).hexdigest()[:12]
        found |= {str(each): f"{INPUT}/{digits}/{name}" for each, name in group.items()}
    return found


def portable(scene: Scene) -> dict[str, Any]:
    """Nested tables of the keys of a scene that have a value, with files named by their places in a
    result folder. OSError: a file cannot be read.
    """
    at, data = places(scene.files), scene.model_dump(exclude_none=True)
    for table, key in file_entries(data):
        table[key] = at.get(table[key], table[key])
    return data


def copy_files(files: Iterable[Path], folder: Path) -> None:
    """Copy files to their places in a result folder, with the sections that they name. OSError: one
    cannot be copied.
    """
    for path, place in places(files).items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, folder / place)
