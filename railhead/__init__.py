"""Wheel-rail contact by finite elements, held against exact Hertz."""

import ctypes
import os

# Small dense blocks only: more BLAS threads cost more than they bring. Set before numpy loads.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# PETSc's signal handlers would take the place of the command's own (see cli.main).
os.environ["PETSC_OPTIONS"] = os.environ.get("PETSC_OPTIONS", "") + " -no_signal_handler"

# Keep freed memory instead of returning it to the system for every temporary array: a fifth of the
# time of a run otherwise goes into fresh pages (mallopt(3): M_TRIM_THRESHOLD, M_MMAP_THRESHOLD).
_libc = ctypes.CDLL(None)
if hasattr(_libc, "mallopt"):
    _libc.mallopt(-1, 2**31 - 1)
    _libc.mallopt(-3, 2**30)

__version__ = "0.2.0"
