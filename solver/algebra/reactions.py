"""Supported nodes: forces of their prescribed displacement, and reactions.

Of the unreduced stiffness K only the rows K_s at the supported dofs s are kept:

    forces     K u0 = K_s^T u0_s    for a u0 that is zero elsewhere (K is symmetric)
    reactions  (K u)_s = K_s u
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver.space.operators import select_rows


@dataclass(frozen=True)
class SupportReactions:
    """Rows of the stiffness matrix on all dofs that belong to the nodes of fixed faces and hub.

    rows: local numbers (k,) of the dofs that the rows belong to.
    matrix: the rows, distributed, N/mm.
    """

    rows: NDArray[np.int64]
    matrix: PETSc.Mat

    @classmethod
    def of(cls, stiffness: PETSc.Mat, nodes: NDArray[np.bool_], size: int = 3) -> SupportReactions:
        """Rows of a symmetric stiffness matrix for the marked nodes (n,) of this rank, with `size`
        dofs each (collective).
        """
        local = np.flatnonzero(np.repeat(nodes, size))
        return cls(local, select_rows(stiffness, local))

    def forces(self, prescribed: PETSc.Vec) -> PETSc.Vec:
        """Forces on all dofs, N, that hold a displacement (mm, on all dofs) which is zero off the
        supported nodes: the stiffness times that displacement.
        """
        held, out = self.matrix.createVecLeft(), prescribed.duplicate()
        held.array[:] = prescribed.array[self.rows]
        self.matrix.multTranspose(held, out)
        return out

    def at(self, displacement: PETSc.Vec) -> NDArray[np.float64]:
        """Elastic forces at the k supported dofs of this rank, N: the stiffness times a
        displacement on all dofs, mm.
        """
        return np.array((self.matrix * displacement).array)
