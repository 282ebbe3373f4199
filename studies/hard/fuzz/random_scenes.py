"""Random valid scenes: one recipe for seeded numbers and for hypothesis."""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from railhead.planning import plan as planning
from railhead.scene.scene import Scene, SceneError

FINE = 2 / 3  # of the default resolution: the cheapest that the checks let pass with some room
MOST = 40_000  # predicted unknowns


class Source(Protocol):
    """Where choices come from."""

    def number(self, low: float, high: float) -> float:
        """A number between the two."""
        ...

    def choice(self, options: Sequence[Any]) -> Any:
        """One of them."""
        ...


class Seeded:
    """A source that repeats itself for the same seed."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)

    def number(self, low: float, high: float) -> float:
        return float(self._generator.uniform(low, high))

    def choice(self, options: Sequence[Any]) -> Any:
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
    """One of them with up to two keys that few people touch. Raises SceneError where they do not go
    together."""

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
    """The plan, None where it refuses the pair in one line; raises ValueError for a plan with
    numbers that are not finite."""
    try:
        made = planning.make(given)
    except SceneError as error:
        if len(str(error).splitlines()) != 1:
            raise ValueError(f"more than one line: {error}") from None
        return None
    numbers = [made.patch_size, made.reach, made.estimate.p0, made.estimate.a, made.estimate.b]
    if not (np.isfinite(numbers).all() and min(numbers) > 0 and made.unknowns > 0):
        raise ValueError(f"plan with {numbers}, {made.unknowns} unknowns")
    return made


def runnable(seed: int, fits: Callable[[Scene], bool], most: int = MOST) -> Scene:
    """The first scene from a seed on that fits and that the plan accepts with at most so many
    predicted unknowns at FINE of the default resolution, which it is given."""
    for drawn in itertools.count(seed):
        given = scene(Seeded(drawn))
        made = plans(given) if fits(given) else None
        if made is None:
            continue
        coarse = made.at_resolution(FINE * made.sizing.default_resolution)
        if coarse.unknowns <= most:
            return given.replace([f"mesh.patch_size={coarse.patch_size!r}"])
    raise AssertionError
