"""docs/scene.md names every key of a scene, with its default."""

import re
from pathlib import Path

from pydantic_core import PydanticUndefined

from railhead.scene.bodies import Surface
from railhead.scene.keys import dotted
from railhead.scene.scene import Scene

PAGE = Path(__file__).parents[4] / "docs" / "scene.md"


def stated() -> dict[str, str]:
    """Defaults by dotted key, as the page says them."""
    found: dict[str, str] = {}
    for part in PAGE.read_text(encoding="utf-8").split("\n## ")[1:]:
        tables = re.findall(r"\[([\w.]+)\]", part.split("\n")[0]) or [""]
        for key, default in re.findall(r"^\| `(\w+)` \| (\S+) \|", part, re.MULTILINE):
            for table in tables:
                dotted = f"{table}.{key}".lstrip(".")
                assert dotted not in found, dotted
                found[dotted] = default
    return found


def said(default: object) -> str:
    if default is PydanticUndefined:
        return "-"
    if default is None or isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, tuple):
        return ",".join(map(said, default))
    return f"{default:g}" if isinstance(default, float) else str(default)


def test_every_key_stands_on_its_page_with_its_default() -> None:
    known = {key: said(value) for key, value in dotted(Scene(load=1).model_dump())}
    known["load"] = "none"
    for table in ("rail.surface", "wheel.surface"):  # tables that are left out
        del known[table]
        known |= {
            f"{table}.{key}": said(each.default) for key, each in Surface.model_fields.items()
        }
    assert stated() == known
