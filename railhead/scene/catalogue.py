"""The cases that ship: modules of `railhead.cases` with a SCENE."""

from __future__ import annotations

import ast
import difflib
import importlib
from pathlib import Path

from railhead.scene.io import read_scene
from railhead.scene.scene import Scene, SceneError


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
    """The scene of a shipped case of this name, or of a TOML file at this path. Raises SceneError
    if there is neither.
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
