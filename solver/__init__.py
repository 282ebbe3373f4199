"""Contact of bodies on a dolfinx mesh, elastic or with yield, with or without friction.

`import railhead.solver as rs` gives `rs.Model` and its parts (docs/solver.md). The solver knows
nothing of scenes, files or pictures.

PETSc's signal handlers, and the log handler and the way of Python's warnings into the log that ffcx
brings, belong to a program, not to a library: none is left behind. From pkg_resources the ffcx and
ufl of Debian 12 want their own versions alone. Its import takes longer than theirs, so they are
given `importlib.metadata.distribution` under its name.
"""

import importlib
import logging
import sys
import warnings
from importlib import metadata
from types import SimpleNamespace
from typing import Any

import petsc4py

petsc4py.init(["railhead", "-no_signal_handler"])  # without effect where PETSc runs already
_handlers, _shown = logging.root.handlers[:], warnings.showwarning
_stand_in: Any = SimpleNamespace(get_distribution=metadata.distribution)
_stands_in = sys.modules.setdefault("pkg_resources", _stand_in) is _stand_in
import ffcx  # noqa: E402, F401
import ufl  # noqa: E402, F401

if _stands_in:
    del sys.modules["pkg_resources"]
logging.root.handlers[:] = _handlers
if warnings.showwarning is not _shown:
    logging.captureWarnings(False)

_NAMES = {
    "compat": "model_to_mesh",
    "model.model": "Model Solution",
    "model.parts": "Body Elastic Energy Force Move Plastic Pressure Spring Traction",
    "space.supports": "Clamp Hub Slide",
    "space.rigid": "Cylinder Plane Sphere",
    "system.surfaces": "Contact Tie",
}
__all__ = [name for names in _NAMES.values() for name in names.split()]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """The model and its parts, imported at their first use: most of the program does without them.
    Raises AttributeError for any other missing name.
    """
    for room, names in _NAMES.items():
        if name in names.split():
            return getattr(importlib.import_module(f"railhead.solver.{room}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
