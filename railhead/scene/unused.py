"""Keys that a kind of scene cannot use: refused where they are given, never silently ignored."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from railhead.scene.sections import SceneError, Section

_WHEELSET = {"rail.gauge", "wheelset.yaw", "wheelset.back_to_back"}
_LINE = {"rail.width", "wheel.width", "wheelset.shift"}
#: Keys that a half-space in point contact cannot use.
HALF_SPACE = _WHEELSET | _LINE | {
    "rail.inclination", "rail.length", "rail.depth", "wheel.rim_depth", "wheel.segment_length",
}  # fmt: skip
#: By kind of scene: its name in a sentence and its keys. Solids use every key.
UNUSED_KEYS: dict[str, tuple[str, frozenset[str]]] = {
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


def set_but_unused(scene: Section, kind: str) -> list[tuple[str, Any]]:
    """Pairs (dotted key, value) of the keys that a kind of scene cannot use and whose values are
    not the defaults. scene: table of tables, a `Scene`; kind: a key of UNUSED_KEYS.
    """
    pairs = []
    for key in sorted(UNUSED_KEYS[kind][1]):
        section, leaf = key.split(".")
        table = getattr(scene, section)
        value = getattr(table, leaf)
        if value != type(table).model_fields[leaf].default:
            pairs.append((key, value))
    return pairs


def refuse(scene: Section, kind: str) -> None:
    """Raise SceneError for the first key that is set and that this kind of scene (a key of
    UNUSED_KEYS) cannot use.
    """
    for key, value in set_but_unused(scene, kind):
        name, keys = UNUSED_KEYS[kind]
        text = f"{value:g} is not allowed; a {name} has no use for it (nor for "
        raise SceneError(key, f"{text}{', '.join(sorted(keys - {key}))}); leave it out")


def drop_keys(data: Mapping[str, Any], keys: Iterable[str]) -> dict[str, Any]:
    """A copy of the nested tables of a scene without the given dotted keys."""
    dropped = set(keys)
    return {
        section: {k: v for k, v in table.items() if f"{section}.{k}" not in dropped}
        if isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }
