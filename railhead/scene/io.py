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
    """The text of a UTF-8 file. Raises SceneError where the file is missing, unreadable or not
    UTF-8.
    """
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
    """Nested tables of a TOML file. Raises SceneError for an unreadable file or invalid TOML."""
    try:
        return tomllib.loads(_read_text(path))
    except SceneError:
        raise
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise SceneError(str(path), f"not valid TOML: {reason}") from None


def read_scene(path: str | Path) -> Scene:
    """The scene of a TOML file.

    Without a key `name` the scene is named after the file, with _ for characters that names may not
    have. A relative path of a profile starts at the folder of the file.
    Raises SceneError (one line), naming the file if it cannot be read, else the key.
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
    """TOML text of a scene with every key that has a value, in N, mm and MPa. Reading the text
    gives an equal scene.
    """
    return tomli_w.dumps(scene.model_dump(exclude_none=True))
