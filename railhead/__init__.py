"""Wheel-rail contact by finite elements, held against exact Hertz.

The names of `__all__` are all that a script needs; they are imported when they are first used.
"""

import sys
import warnings
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from railhead.api import find, load, plan, solve, steels
    from railhead.cli.geometry import locate, profile
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
    **dict.fromkeys(("locate", "profile"), "railhead.cli.geometry"),
    "Result": "railhead.results.result",
    "creep_table": "railhead.sweeps.creep_tables",
    **dict.fromkeys(("Sweep", "sweep"), "railhead.sweeps.parallel"),
    "wear": "railhead.sweeps.wear.wear",
}

_MOVED = {
    "railhead.display": "railhead.results.report.output_units",
    "railhead.meshing.profiles": "railhead.geometry.profiles",
    "railhead.meshing.surfaces": "railhead.geometry.surfaces",
    "railhead.solver.elasticity": "railhead.solver.material",
    "railhead.solver.kinematics": "railhead.solver.space.kinematics",
    "railhead.solver.contact_system": "railhead.solver.system.contact_system",
    "railhead.solver.setup": "railhead.solver.system.setup",
    "railhead.solver.solution": "railhead.solver.system.solution",
    "railhead.theory.indentation": "railhead.theory.elastic.indentation",
}
"""Present names, by the former ones, of modules that pages have shown; kept until 0.5."""


class _FormerNames:
    """Import of modules by the former names of `_MOVED`, with a DeprecationWarning."""

    def find_spec(self, name: str, *_: Any) -> ModuleSpec | None:
        return ModuleSpec(name, self) if name in _MOVED else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        text = f"{spec.name} is now called {_MOVED[spec.name]}"
        warnings.warn(text, DeprecationWarning, stacklevel=2)

    def exec_module(self, module: ModuleType) -> None:
        sys.modules[module.__name__] = import_module(_MOVED[module.__name__])


sys.meta_path.append(_FormerNames())


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
