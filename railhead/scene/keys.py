"""Keys of a scene as texts: assignments, dotted keys, keys that name files, and those that a kind
of scene cannot use.
"""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from railhead.scene.sections import SceneError, Section
from railhead.scene.units import show

#: Keys whose values are words, even where they look like numbers: TOML reads 54E1 as 540.0.
WORDS = (
    "name",
    "rail.profile",
    "wheel.profile",
    "wheelset.other_rail",
    "wheelset.other_wheel",
)
#: Keys whose values may name files.
FILE_KEYS = (
    *(f"rail.{key}" for key in ("profile", "stress_strain", "surface.file")),
    *(f"wheel.{key}" for key in ("profile", "stress_strain", "surface.file")),
    *(f"{key}.sections" for key in ("rail", "wing")),
    "wing.stress_strain",
    *("wheelset.other_rail", "wheelset.other_wheel"),
    *("wear.positions", "wear.law"),
)
OTHER_NAMES = {"friction.tangential_load": "friction.force_along"}
_SOLID = {  # of a wheelset, and of surfaces along the rail
    "rail.surface",
    "wheel.surface",
    "rail.gauge",
    "rail.gauge_height",
    "wheel.tape_circle",
    "wheelset.yaw",
    "wheelset.roll",
    "wheelset.back_to_back",
    "wheelset.side",
    "wheelset.other_rail",
    "wheelset.other_wheel",
    "wheelset.other_radius",
}
_LINE = {"rail.width", "wheel.width", "wheelset.shift"}
#: Keys that a half-space in point contact cannot use.
HALF_SPACE = (
    _SOLID
    | _LINE
    | {
        "rail.inclination",
        "rail.length",
        "rail.depth",
        "wheel.rim_depth",
        "wheel.segment_length",
    }
)
#: By kind of scene: its name in a sentence and its keys. Solids use every key.
UNUSED_KEYS: dict[str, tuple[str, frozenset[str]]] = {
    "half_space": ("point contact of half-spaces", frozenset(HALF_SPACE)),
    "half_space_along": ("line contact of half-spaces", frozenset(HALF_SPACE - _LINE)),
    "half_space_across": (
        "line contact of half-spaces along the rail",
        frozenset(HALF_SPACE - {"rail.length"}),
    ),
    "plane_along": ("section along the rail", frozenset(_SOLID | {"rail.inclination"})),
    "plane_across": ("section across the rail", frozenset(_SOLID | {"wheel.segment_length"})),
    "axisymmetric": (
        "meridian section",
        frozenset(_SOLID | _LINE | {"rail.inclination", "rail.length"}),
    ),
}


def assignment(text: str) -> tuple[str, object]:
    """Split the text "key=value" into key and value.

    A value that is a TOML scalar or array becomes a number, a boolean, a string or a list; any
    other value and that of a key in _WORDS remains a string. Raises SceneError for a text without
    key and equals sign.
    """
    key, equals, value = (part.strip() for part in str(text).partition("="))
    if not (key and equals):
        raise SceneError("assignment", f"{show(text)} is not key=value; write e.g. load=110kN")
    known = (str,) if key in WORDS else (str, int, float, bool, list)
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    if len(parsed) == 1 and isinstance(parsed["value"], known):
        return key, parsed["value"]
    return key, value


def assigned(texts: Iterable[str]) -> dict[str, object]:
    """Values by dotted key of texts "key=value". Raises SceneError for anything else."""
    if isinstance(texts, str) or not isinstance(texts, Iterable):
        text = f"{show(texts)} is no list of texts; give one, e.g. ['load=110kN']"
        raise SceneError("assignments", text)
    return dict(map(assignment, texts))


def dotted(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and values of nested tables or sections. above: prefix of the keys with its dot,
    'mesh.'.
    """
    for key, value in table.items():
        if isinstance(value, Section):
            value = value.model_dump()
        if isinstance(value, Mapping):
            yield from dotted(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def file_entries(data: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], str]]:
    """Table and key of each text in the nested tables of a scene that may name a file
    (FILE_KEYS).
    """
    for key in FILE_KEYS:
        *above, leaf = key.split(".")
        table: Any = data
        for name in above:
            table = table.get(name) if isinstance(table, Mapping) else None
        if isinstance(table, dict) and isinstance(table.get(leaf), str):
            yield table, leaf


def set_but_unused(scene: Section, kind: str) -> list[tuple[str, str]]:
    """Pairs (dotted key, value as text) of the keys that a kind of scene cannot use and whose
    values are not the defaults. kind: a key of UNUSED_KEYS.
    """
    pairs = []
    for key in sorted(UNUSED_KEYS[kind][1]):
        section, leaf = key.split(".")
        table = getattr(scene, section)
        value = getattr(table, leaf)
        if value != type(table).model_fields[leaf].default:
            value = getattr(value, "kind", value)  # of a surface
            pairs.append((key, show(value) if isinstance(value, str) else f"{value:g}"))
    return pairs


def refuse_unused(scene: Section, kind: str) -> None:
    """Raise SceneError for the first key that is set and that this kind of scene (a key of
    UNUSED_KEYS) cannot use.
    """
    for key, value in set_but_unused(scene, kind):
        name, keys = UNUSED_KEYS[kind]
        text = f"{value} is not allowed; a {name} has no use for it (nor for "
        raise SceneError(key, f"{text}{', '.join(sorted(keys - {key}))}); leave it out")


def without_keys(data: Mapping[str, Any], keys: Iterable[str]) -> dict[str, Any]:
    """Tables of a scene, new ones, without the given keys 'table.key'; keys that are not there do
    not count.
    """
    dropped = set(keys)
    return {
        section: {k: v for k, v in table.items() if f"{section}.{k}" not in dropped}
        if isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }
