"""How elastic bodies respond to one load case.

A response is made for each load case. It presses the bodies, presses them again under the
tangential tractions that friction finds, and unloads them. Bodies that yield have a response with a
history instead (`solver.plasticity.load_stepping.PlasticResponse`).
"""

from __future__ import annotations

import numpy as np

from railhead.solver.system.contact_system import ContactSystem, LoadCase
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array, Index


class ElasticResponse:
    """Response of elastic bodies to one load case, which has no history.

    system: contact system.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system

    def press(self, case: LoadCase) -> Solution:
        """Frictionless elastic solution of a load case (collective)."""
        return self.system.press(case)

    def start_friction_step(self) -> None:
        """Mark the start of a friction load step; elastic bodies have no history, so that nothing
        is done.
        """

    def press_again(self, solution: Solution, case: LoadCase) -> Solution:
        """Solution of a load case whose force includes that of tangential tractions; solution: the
        last one, without effect on elastic bodies.
        """
        return self.press(case)

    def plastic_shear_stress(self, points: Index, tangents: Array, normals: Array) -> Array:
        """Shear stress t . sigma . n that plastic strain takes (p, k), MPa: zero for elastic
        bodies.

        points: numbers (p,) of contact points of this rank.
        tangents: unit tangents t (p, k, c).
        normals: unit normals n (p, c).
        """
        return np.zeros(tangents.shape[:2])

    def unload(self, solution: Solution) -> Solution:
        """The solution itself, because elastic bodies leave no residual state."""
        return solution
