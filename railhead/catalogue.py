"""The cases that ship: modules of `railhead.cases` with a SCENE."""

from __future__ import annotations

import difflib
import importlib
import pkgutil
from pathlib import Path

from railhead.scene.io import read_scene
from railhead.scene.scene import Scene, SceneError


def shipped() -> dict[str, tuple[Scene, str]]:
    """Scene and one line of description, by name."""
    found = {}
    cases = importlib.import_module("railhead.cases")
    for module_info in pkgutil.iter_modules(cases.__path__):
        module = importlib.import_module(f"railhead.cases.{module_info.name}")
        if hasattr(module, "SCENE"):
            found[module_info.name] = (module.SCENE, (module.__doc__ or "").strip().split("\n")[0])
    return found


def find(name: str) -> Scene:
    """The scene of a shipped case, or of a TOML file; SceneError if there is neither."""
    known = shipped()
    if name in known:
        return known[name][0]
    if name.endswith(".toml") or Path(name).exists():
        return read_scene(name)
    close = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise SceneError(
        "case", f"{name!r} is unknown; {hint}give a .toml file or one of {', '.join(known)}"
    )
