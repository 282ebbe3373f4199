"""Keys that a kind of scene cannot use: refused where they are given, never silently ignored."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from railhead.scene.sections import SceneError

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

_WHEELSET = {"rail.gauge", "wheelset.yaw", "wheelset.back_to_back"}
_LINE = {"rail.width", "wheel.width", "wheelset.shift"}
#: What no half-space in point contact has.
HALF_SPACE = _WHEELSET | _LINE | {
    "rail.inclination", "rail.length", "rail.depth", "wheel.rim_depth", "wheel.segment_length",
}  # fmt: skip
#: By kind of scene: its name in a sentence and its keys. Solids use every key.
UNUSED: dict[str, tuple[str, frozenset[str]]] = {
    "half_space": ("point contact of half-spaces", frozenset(HALF_SPACE)),
    "half_space_along": ("line contact of half-spaces", frozenset(HALF_SPACE - _LINE)),
    "half_space_across": (
        "line contact of half-spaces along the rail", frozenset(HALF_SPACE - {"rail.length"}),
    ),
    "plane_along": ("section along the rail", frozenset(_WHEELSET | {"rail.inclination"})),
    "plane_across": ("section across the rail", frozenset(_WHEELSET | {"wheel.segment_length"})),
    "axisymmetric": (
        "meridian section",
        frozenset(_WHEELSET | {"rail.inclination", "rail.length", "wheel.width", "wheelset.shift"}),
    ),
}  # fmt: skip


def given(scene: Scene, kind: str) -> list[tuple[str, Any]]:
    """Keys and values, other than their defaults, that a scene of this kind cannot use."""
    found = []
    for key in sorted(UNUSED[kind][1]):
        section, leaf = key.split(".")
        table = getattr(scene, section)
        value = getattr(table, leaf)
        if value != type(table).model_fields[leaf].default:
            found.append((key, value))
    return found


def refuse(scene: Scene, kind: str) -> None:
    """Raise SceneError for the first of them."""
    for key, value in given(scene, kind):
        name, keys = UNUSED[kind]
        text = f"{value:g} is not allowed; a {name} has no use for it (nor for "
        raise SceneError(key, f"{text}{', '.join(sorted(keys - {key}))}); leave it out")


def without(data: Mapping[str, Any], keys: Iterable[str]) -> dict[str, Any]:
    """The tables of a scene without some dotted keys."""
    dropped = set(keys)
    return {
        section: {k: v for k, v in table.items() if f"{section}.{k}" not in dropped}
        if isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }
