"""Random valid scenes, by one recipe for seeded numbers and for hypothesis; random scene files that
are wrong, or right at the edge of what a float can hold."""

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from railhead.planning import simulation_plan as planning
from railhead.scene.scene import Scene, SceneError

FINE = 2 / 3  # of the default resolution: the cheapest that the checks let pass with some room
MOST = 40_000  # predicted unknowns


class Source:
    """Random choices of which a scene is made, the same for the same seed."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)

    def number(self, low: float, high: float) -> float:
        """A number from low to high."""
        return float(self._generator.uniform(low, high))

    def choice(self, options: Sequence[Any]) -> Any:
        """One of the options."""
        return options[int(self._generator.integers(len(options)))]


def scene(source: Source) -> Scene:
    """Any combination of profiles, extents, positions, materials, cells and methods.

    Valid as input; the plan may still refuse a pair that makes no point contact.
    """

    def decades(low: float, high: float) -> float:
        return float(10 ** source.number(low, high))

    def material() -> dict[str, Any]:
        return {
            "young_modulus": source.choice([207e3, decades(3, 6)]),
            "poisson_ratio": source.choice([0.3, source.number(0.0, 0.49)]),
        }

    rail = {"profile": source.choice(["54E1", "60E1", "arc"]), **material()}
    rail["extent"] = source.choice(["head", "section", "half-space"])
    if rail["profile"] == "arc":
        rail |= {"crown_radius": decades(1.3, 3), "extent": source.choice(["head", "half-space"])}
    if rail["extent"] != "half-space":
        rail["inclination"] = source.choice([0.0, 1 / 20, 1 / 40, source.number(-0.1, 0.1)])
    wheel = {"profile": source.choice(["cylinder", "cone20", "cone40", "S1002", "arc"])}
    wheel |= {"rolling_radius": source.number(150, 600), **material()}
    if wheel["profile"] == "arc":
        sign = source.choice([1, -1])
        wheel["transverse_radius"] = sign * decades(2.5, 4)
    if rail["extent"] == "half-space":
        wheel["profile"] = source.choice(["cylinder", wheel["profile"].replace("S1002", "cone20")])
        if wheel["profile"] != "arc":
            wheel.pop("transverse_radius", None)
        elif 1 / wheel["transverse_radius"] + 1 / rail.get("crown_radius", 300.0) <= 0:
            wheel["transverse_radius"] = -wheel["transverse_radius"]
    rigid = source.choice(["", "", "", "", "", "rail", "wheel"])
    if rigid:
        (rail if rigid == "rail" else wheel)["young_modulus"] = math.inf
    cell = source.choice(["tetrahedron", "tetrahedron", "tetrahedron", "hexahedron"])
    shift = source.choice([0.0, 0.0, source.number(-8, 8)])
    method = source.choice(["nitsche", "nitsche", "penalty"])
    theta = source.choice([1, 1, 0, -1])
    return Scene.from_mapping(
        {
            "name": "random",
            "load": decades(1, 5.5),
            "rail": rail,
            "wheel": wheel,
            "wheelset": {"shift": 0.0 if rail["extent"] == "half-space" else shift},
            "mesh": {"cell": cell},
            "solver": {"method": method, "theta": theta if method == "nitsche" else None},
        }
    )


def wild(source: Source) -> Scene:
    """A random scene (`scene`) with up to two further keys that few people use. Raises SceneError
    where they do not go together."""

    def number(key: str, low: float, high: float) -> str:
        return f"{key}={source.number(low, high)!r}"

    def decades(key: str, low: float, high: float) -> str:
        return f"{key}={10 ** source.number(low, high)!r}"

    given = scene(source)
    makes = (
        lambda: decades("solver.gamma_factor", -3, 4),
        lambda: f"mesh.order={source.choice([1, 2])}",
        lambda: number("rail.poisson_ratio", 0.45, 0.4999),
        lambda: number("wheel.poisson_ratio", 0.45, 0.4999),
        lambda: decades("approach", -4, -1),
        lambda: number("wheelset.yaw", -0.02, 0.02),
        lambda: "rail.gauge=1435",
        lambda: decades("wheel.width", 0.5, 2),
        lambda: decades("wheel.rim_depth", 0.3, 1.7),
        lambda: decades("rail.length", 1, 3),
        lambda: f"solver.linear={source.choice(['direct', 'multigrid'])}",
        lambda: f"solver.max_newton={source.choice([2, 5, 100])}",
        lambda: "rail.crown_radius=inf" if given.rail.profile == "arc" else "wheelset.shift=0",
        lambda: "friction.coefficient=0.3",
    )
    return given.replace([source.choice(makes)() for _ in range(source.choice([0, 1, 2]))])


def plans(given: Scene) -> planning.Plan | None:
    """The plan of a scene; None where it is refused in one line. Raises ValueError for a longer
    refusal, and for a plan with numbers that are not finite and positive."""
    try:
        made = planning.make(given)
    except SceneError as error:
        if len(str(error).splitlines()) != 1:
            raise ValueError(f"more than one line: {error}") from None
        return None
    numbers = [made.patch_size, made.reach, made.hertz.p0, made.hertz.a, made.hertz.b]
    if not (np.isfinite(numbers).all() and min(numbers) > 0 and made.unknowns > 0):
        raise ValueError(f"plan with {numbers}, {made.unknowns} unknowns")
    return made


def runnable(seed: int, fits: Callable[[Scene], bool]) -> Scene:
    """The first scene from a seed on that fits and that the plan accepts with at most MOST
    predicted unknowns at FINE of the default resolution, which it is given."""
    for drawn in itertools.count(seed):
        given = scene(Source(drawn))
        made = plans(given) if fits(given) else None
        if made is None:
            continue
        coarse = made.at_resolution(FINE * made.default_resolution)
        if coarse.unknowns <= MOST:
            return given.replace([f"mesh.patch_size={coarse.patch_size!r}"])
    raise AssertionError


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
"""Keys with the range of their exponents of ten, far beyond what is physical."""
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
    """Set a key such as 'rail.profile' of the tables of a scene."""
    section, dot, leaf = key.rpartition(".")
    (tables.setdefault(section, {}) if dot else tables)[leaf] = value


def _keys() -> list[str]:
    """All keys of a scene, as 'load' or 'rail.profile'."""
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
    """Write a scene file that is wrong or extreme, and the profile file that it may name; returns
    the kind of change, a key of MUTATIONS or 'bytes'."""
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
