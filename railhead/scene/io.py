"""Scenes as TOML files."""

import re
import stat
import tomllib
import unicodedata
from pathlib import Path
from typing import Any

import tomli_w

from railhead.geometry.measured.extensions import EXTENSIONS
from railhead.scene.scene import MAX_NAME_BYTES, Scene, SceneError


def _read_text(path: Path) -> str:
    """Return the text of a UTF-8 file; raise SceneError if there is none."""
    try:
        is_file = stat.S_ISREG(path.stat().st_mode)
        text = path.read_text(encoding="utf-8-sig") if is_file else ""
    except UnicodeDecodeError as error:
        reason = f"byte {error.start} is not UTF-8; give a TOML file, which is UTF-8 text"
        raise SceneError(str(path), reason) from None
    except (FileNotFoundError, NotADirectoryError, ValueError):  # ValueError: a zero byte
        raise SceneError(str(path), "no such file; give the path of a TOML file") from None
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror}") from None
    if not is_file:
        raise SceneError(str(path), "not a file; give the path of a TOML file")
    return text


def _read_toml(path: Path) -> dict[str, Any]:
    """Return the tables of a TOML file; raise SceneError if it is not one."""
    try:
        return tomllib.loads(_read_text(path))
    except SceneError:
        raise
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise SceneError(str(path), f"not valid TOML: {reason}") from None


def read_scene(path: str | Path) -> Scene:
    """Return the scene that a TOML file describes.

    Without a ``name`` the scene takes the file's, with ``_`` for characters a name may not have.
    A relative path of a profile starts at the file's folder.
    Raises SceneError: one line, naming the file if it cannot be read, else the key.
    """
    path = Path(path)
    data = _read_toml(path)
    stem = unicodedata.normalize("NFC", path.stem)  # else an accent is a character of its own
    short = re.sub(r"[^\w.-]", "_", stem).encode()[:MAX_NAME_BYTES].decode(errors="ignore")
    data.setdefault("name", short)
    for section in filter(lambda table: isinstance(table, dict), data.values()):
        profile = section.get("profile")
        if isinstance(profile, str) and profile.lower().endswith(EXTENSIONS):
            section["profile"] = str(path.parent / profile)
    return Scene.from_mapping(data)


def to_toml(scene: Scene) -> str:
    """Return a TOML text with every key of `scene`, in N, mm and MPa, that reads back equal to it.

    Keys without a value are left out.
    """
    return tomli_w.dumps(scene.model_dump(exclude_none=True))
