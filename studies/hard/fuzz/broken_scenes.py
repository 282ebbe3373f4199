"""Random scene files that are wrong, or right at the edge of what a float can hold."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import tomli_w

from railhead.scene.scene import Scene
from studies.hard.fuzz.random_scenes import Source, scene

Tables = dict[str, Any]
ODD: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -math.inf,
    0,
    -1,
    1e308,
    -1e308,
    5e-324,
    2**62,
    True,
    "",
    " ",
    "abc",
    "25 kg",
    "1e999 N",
    "1:0",
    "-0",
    "0x10",
    "none",
    "auto",
    "é\n",
    [],
    [1.0],
    {},
    {"x": 1},
)
EXTREME = {
    "load": (-300, 300),
    "approach": (-300, 300),
    "rail.crown_radius": (-6, 12),
    "wheel.rolling_radius": (-6, 12),
    "rail.young_modulus": (-6, 12),
    "rail.length": (-6, 9),
    "wheel.young_modulus": (-6, 12),
    "mesh.patch_size": (-6, 12),
    "wheel.width": (-6, 9),
    "wheel.rim_depth": (-6, 9),
    "rail.depth": (-6, 9),
    "rail.width": (-6, 9),
    "wheel.segment_length": (-6, 9),
    "solver.gamma_factor": (-30, 30),
}
"""Keys with decades, far beyond what is physical."""
POINTS = {
    "empty": "",
    "header only": "y,z\n",
    "one point": "0,0\n",
    "words": "y,z\na,b\nc,d\n",
    "not finite": "\n".join(f"{y},nan" for y in range(-30, 31)),
    "one y": "\n".join("0,0" for _ in range(20)),
    "flat": "\n".join(f"{y},0" for y in range(-30, 31)),
    "hollow": "\n".join(f"{y},{y * y / 600}" for y in range(-30, 31)),
    "jagged": "\n".join(f"{y},{(-1) ** y}" for y in range(-30, 31)),
    "steps": "\n".join(f"{y},{-abs(y) // 10}" for y in range(-30, 31)),
    "kilometres": "\n".join(f"{y * 1e6},{-((y * 1e6) ** 2) / 600}" for y in range(-30, 31)),
    "nanometres": "\n".join(f"{y * 1e-9},{-((y * 1e-9) ** 2) / 600}" for y in range(-30, 31)),
    "huge": "\n".join(f"{y},{1e300 * y * y}" for y in range(-30, 31)),
    "three columns": "\n".join(f"{y},{-y * y / 600},1" for y in range(-30, 31)),
}


def _put(tables: Tables, key: str, value: Any) -> None:
    section, dot, leaf = key.rpartition(".")
    (tables.setdefault(section, {}) if dot else tables)[leaf] = value


def _keys() -> list[str]:
    named = []
    for name, field in Scene.model_fields.items():
        inner = getattr(field.annotation, "model_fields", None)
        named += [f"{name}.{leaf}" for leaf in inner] if inner else [name]
    return named


def _unknown(source: Source, tables: Tables, folder: Path) -> None:
    section = source.choice(["", "rail.", "wheel.", "mesh.", "solver.", "effects.", "wheels."])
    _put(tables, section + source.choice(["lod", "radius", "x" * 500, "é", "", "Load"]), 1.0)


def _odd(source: Source, tables: Tables, folder: Path) -> None:
    key = source.choice(_keys())
    _put(tables, key, source.choice(ODD))
    if key == "approach":
        tables.pop("load")


def _table(source: Source, tables: Tables, folder: Path) -> None:
    tables[source.choice(["rail", "wheel", "mesh", "solver", "load"])] = source.choice(ODD)


def _load(source: Source, tables: Tables, folder: Path) -> None:
    if source.choice([True, False]):
        tables["approach"] = 0.05
    else:
        tables.pop("load")


def _extreme(source: Source, tables: Tables, folder: Path) -> None:
    key = source.choice(list(EXTREME))
    value = float(10.0 ** source.number(*EXTREME[key]))
    if key == "approach":
        tables.pop("load")
    if key in ("rail.crown_radius", "rail.depth", "rail.width"):
        tables["rail"] |= {"profile": "arc", "crown_radius": 300.0, "extent": "head"}
    _put(tables, key, value)


def _points(source: Source, tables: Tables, folder: Path) -> None:
    body = source.choice(["rail", "wheel"])
    name = source.choice([*POINTS, "missing", "binary", "folder"])
    file = folder / "profile.csv"
    if name == "binary":
        file.write_bytes(bytes(range(256)))
    elif name == "folder":
        file.mkdir()
    elif name != "missing":
        file.write_text(POINTS[name], encoding="utf-8")
    for radius in ("crown_radius", "transverse_radius"):
        tables[body].pop(radius, None)
    tables[body]["profile"] = "profile.csv"


MUTATIONS: dict[str, Callable[[Source, Tables, Path], None]] = {
    "unknown key": _unknown,
    "odd value": _odd,
    "odd table": _table,
    "load": _load,
    "extreme value": _extreme,
    "profile": _points,
}


def write(source: Source, file: Path) -> str:
    """Write a scene file and what it names beside it; returns what is wrong with it."""
    kind = source.choice([*MUTATIONS, "odd value", "extreme value", "extreme value", "bytes"])
    tables = scene(source).model_dump(exclude_none=True)
    if kind in MUTATIONS:
        MUTATIONS[kind](source, tables, file.parent)
    try:
        content = bytearray(tomli_w.dumps(tables).encode())
    except (TypeError, ValueError):  # what TOML cannot say
        content = bytearray(repr(tables).encode(errors="replace"))
    if kind == "bytes":
        for _ in range(5):
            place = int(source.number(0, len(content) - 1))
            content[place] = int(source.number(0, 255))
        del content[int(source.number(0, 2 * len(content))) :]
    file.write_bytes(bytes(content))
    return kind
