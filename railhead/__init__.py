"""Wheel-rail contact by finite elements, held against exact Hertz.

The names of `__all__` are all that a script needs; they are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from railhead.api import find, load, plan, solve, steels
    from railhead.cli.examined.geometry import locate, profile
    from railhead.meshing.mesh import MeshError
    from railhead.results.result import Result
    from railhead.scene.scene import (
        Effects,
        Friction,
        Mesh,
        Rail,
        Rolling,
        Scene,
        SceneError,
        Solver,
        Wear,
        Wheel,
        Wheelset,
    )
    from railhead.sweeps.creep_tables import creep_table
    from railhead.sweeps.parallel import Sweep, sweep
    from railhead.sweeps.wear.wear import wear

__version__ = "0.3.0"
__all__ = [
    "Effects",
    "Friction",
    "Mesh",
    "MeshError",
    "Rail",
    "Result",
    "Rolling",
    "Scene",
    "SceneError",
    "Solver",
    "Sweep",
    "Wear",
    "Wheel",
    "Wheelset",
    "creep_table",
    "find",
    "load",
    "locate",
    "plan",
    "profile",
    "solve",
    "steels",
    "sweep",
    "wear",
]
_HOMES = dict.fromkeys(__all__, "railhead.scene.scene") | {
    "MeshError": "railhead.meshing.mesh",
    **dict.fromkeys(("find", "load", "plan", "solve", "steels"), "railhead.api"),
    **dict.fromkeys(("locate", "profile"), "railhead.cli.examined.geometry"),
    "Result": "railhead.results.result",
    "creep_table": "railhead.sweeps.creep_tables",
    **dict.fromkeys(("Sweep", "sweep"), "railhead.sweeps.parallel"),
    "wear": "railhead.sweeps.wear.wear",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
