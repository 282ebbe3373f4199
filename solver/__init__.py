"""Contact of bodies on a dolfinx mesh, elastic or with yield, with or without friction.

`import railhead.solver as rs` gives `rs.Model` and its parts (docs/solver.md). The solver knows
nothing of scenes, files or pictures.

PETSc's signal handlers, and the log handler and the way of Python's warnings into the log that ffcx
brings, belong to a program, not to a library: none is left behind.
"""

import importlib
import logging
import warnings
from typing import Any

import petsc4py

petsc4py.init(["railhead", "-no_signal_handler"])  # without effect where PETSc runs already
_handlers, _shown = logging.root.handlers[:], warnings.showwarning
import ffcx  # noqa: E402, F401

logging.root.handlers[:] = _handlers
if warnings.showwarning is not _shown:
    logging.captureWarnings(False)

_PARTS = "Body Clamp Contact Elastic Force Hub Move Plane Plastic Slide Sphere"
__all__ = ["Model", "Solution", *_PARTS.split()]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """The model and its parts, imported at their first use: most of the program does without them.
    Raises AttributeError for any other missing name.
    """
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    room = "parts" if name in _PARTS.split() else "model"
    return getattr(importlib.import_module(f"railhead.solver.model.{room}"), name)
