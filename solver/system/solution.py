"""The solution of one load case, with what plasticity and friction add to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from petsc4py import PETSc

    from railhead.solver.algebra.newton import NewtonResult
    from railhead.theory.array_types import Array
    from railhead.theory.friction.solution import FrictionSolution


@dataclass(frozen=True)
class PlasticStrain:
    """Plastic strain at the g Gauss points of each of m cells: the cells of one rank, or in
    `Fields` of all.

    strain: plastic strain tensors in space (m, g, 3, 3), without dimension.
    equivalent: equivalent plastic strain (m, g).
    """

    strain: Array
    equivalent: Array


@dataclass(frozen=True, kw_only=True)
class PlasticSolution:
    """Load history of bodies of which at least one yields.

    load_over_first_yield: load over the load of first yield, from the largest von Mises stresses
        of elastic solutions.
    newton_results: results of Newton's method in all load steps, in order, failed ones and the
        halves of a halved step included. Where the load is removed those of friction and of
        unloading are included, else neither.
    loading_steps: number of results that lead up to the full load; these come first in
        `newton_results`.
    residual_state: solution after unloading, with the bodies apart, converged or not; where
        lowering the load fails, that of the failed step, in contact. None where the load is not
        removed.
    indentation_depth: body tag -> largest residual displacement of the contact surface into that
        body, mm, of each deformable body; empty without a residual state.
    """

    load_over_first_yield: float
    newton_results: tuple[NewtonResult, ...]
    loading_steps: int
    residual_state: Solution | None = None
    indentation_depth: Mapping[int, float]


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Answer of a contact model to one load case, at the n contact points of this rank.

    Forces are those of the whole model, symmetric images included. Displacement and fields at
    points are this rank's part; single numbers and `friction` are the same on all ranks.

    displacement: displacement at the dofs that this process owns, in the order of `bulk.space`, mm;
        None after pickling.
    pressure: contact pressure (n,), MPa, never negative.
    indicator: pressure before its negative part is set to zero (n,), MPa; positive on the active
        set.
    approach: rigid displacement of the hub, or of a rigid moving body, along the direction of the
        setup, mm; the far field comes on top.
    load: component of the contact tractions' resultant on the moving body against that direction,
        N. At an inclined contact it is not the normal force.
    reaction: force against that direction by which the support holds the fixed body, N; where that
        body is rigid, force along the direction by which the hub pushes. Without further forces it
        equals `load` at equilibrium. Zero where symmetry planes alone hold the fixed body.
    penetration: largest overlap of the deformed surfaces at the contact points of all ranks, mm, at
        least zero.
    newton: result of Newton's method in the last load step, or in the step that failed; its
        `reason` also tells that friction did not settle.
    plastic_strain: plastic strain in all cells of this rank; None where no body yields.
    plasticity: load history; None where no body yields.
    friction: tangential tractions and slip; None without friction, where pressing did not converge,
        and where a solid with half-spaces for its tractions did not.
    reference: with friction, the frictionless solution of the same load case, whose own reference
        is the elastic one if bodies yield; without friction but with yield, the elastic solution;
        otherwise None.
    """

    displacement: PETSc.Vec
    pressure: Array
    indicator: Array
    approach: float
    load: float
    reaction: float
    penetration: float
    newton: NewtonResult
    plastic_strain: PlasticStrain | None = None
    plasticity: PlasticSolution | None = None
    friction: FrictionSolution | None = None
    reference: Solution | None = None

    @property
    def touching(self) -> bool:
        """Whether the bodies touch at any contact point of any rank."""
        return bool(self.newton.history and self.newton.history[-1].active)

    def __getstate__(self) -> dict[str, Any]:
        """The attributes without the displacement, a PETSc vector, which cannot be pickled."""
        return {**self.__dict__, "displacement": None}
