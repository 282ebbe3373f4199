"""Contact of two bodies on a dolfinx mesh, elastic or with yield, with or without friction.

The solver knows nothing of scenes, files or pictures.

PETSc's signal handlers, and the log handler and the way of Python's warnings into the log that ffcx
brings, belong to a program, not to a library: none is left behind.
"""

import logging
import warnings

import petsc4py

petsc4py.init(["railhead", "-no_signal_handler"])  # without effect where PETSc runs already
_handlers, _shown = logging.root.handlers[:], warnings.showwarning
import ffcx  # noqa: E402, F401

logging.root.handlers[:] = _handlers
if warnings.showwarning is not _shown:
    logging.captureWarnings(False)
