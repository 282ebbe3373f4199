"""The held nodes: what they prescribe and what they carry, without the whole stiffness matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver.space.operators import chosen


@dataclass(frozen=True)
class SupportReactions:
    """Rows of the unreduced K at the held nodes (fixed faces and hub): all that is needed of it
    once the free unknowns have their own. rows (k,): the local dofs they belong to."""

    rows: NDArray[np.int64]
    matrix: PETSc.Mat

    @classmethod
    def of(cls, stiffness: PETSc.Mat, nodes: NDArray[np.bool_], size: int = 3) -> SupportReactions:
        """Keep the rows of the marked nodes (n,), `size` dofs each, of a symmetric matrix."""
        local = np.flatnonzero(np.repeat(nodes, size))
        return cls(local, chosen(stiffness, local))

    def forces(self, prescribed: PETSc.Vec) -> PETSc.Vec:
        """K u0 in N, for a u0 in mm that is zero off the held nodes (K is symmetric)."""
        held, out = self.matrix.createVecLeft(), prescribed.duplicate()
        held.array[:] = prescribed.array[self.rows]
        self.matrix.multTranspose(held, out)
        return out

    def reactions(self, displacement: PETSc.Vec) -> NDArray[np.float64]:
        """(k,) K u at the held dofs, N."""
        return np.array((self.matrix * displacement).array)
