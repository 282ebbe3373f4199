"""Contact of two bodies on a dolfinx mesh, elastic or with yield, with or without friction.

The solver knows nothing of scenes, files or pictures.

PETSc's signal handlers and the log handler that ffcx gives to the root logger belong to a program,
not to a library: neither is left behind.
"""

import logging

import petsc4py

petsc4py.init(["railhead", "-no_signal_handler"])  # without effect where PETSc runs already
_handlers = logging.root.handlers[:]
import ffcx  # noqa: E402, F401

logging.root.handlers[:] = _handlers
