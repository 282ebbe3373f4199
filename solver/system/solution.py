"""The solution of one load case, with what plasticity and friction add to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:  # half-spaces have such solutions, too, without a solver
    from petsc4py import PETSc

    from railhead.solver.algebra.newton import NewtonResult
    from railhead.theory.array_types import Array, Mask


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
    first_loading_steps: number of results that lead up to the full load for the first time; these
        come first in `newton_results`.
    residual_state: solution after unloading, with the bodies apart, converged or not; where
        lowering the load fails, that of the failed step, in contact. None where the load is not
        removed.
    indentation_depth: body tag -> largest residual displacement of the contact surface into that
        body, mm, of each deformable body; empty without a residual state.
    """

    load_over_first_yield: float
    newton_results: tuple[NewtonResult, ...]
    first_loading_steps: int
    residual_state: Solution | None = None
    indentation_depth: Mapping[int, float]


@dataclass(frozen=True, kw_only=True)
class GridTraction:
    """Pressure and tractions in the cells of a grid over one patch, in a plane.

    origin: (3,), mm. axes: (3, 3), unit vectors in space along x, along y and out of the rail.
    x, y: cell centres (nx,), (ny,), mm.
    pressure: (nx, ny), MPa.
    traction: of the wheel on the rail along x and y (2, nx, ny), MPa.
    """

    origin: Array
    axes: Array
    x: Array
    y: Array
    pressure: Array
    traction: Array


@dataclass(frozen=True, kw_only=True)
class FrictionSolution:
    """Tangential tractions and slip at n contact points of all ranks, at the last load step; the
    same on all ranks. Vectors are in space.

    The points are quadrature points of the slave or cells of a grid over the patches; of a model
    cut at symmetry planes those of the meshed part alone. Slip, motion and creepage are those of
    the wheel over the rail. A shift has slip in mm. Steady rolling has slip over rolled distance,
    without dimension. Where half-spaces stand in the place of bodies, load_steps is empty, and
    dissipated_energy, coupling_iterations and newton_steps are 0.

    points: position (n, 3), mm.
    weights: area of each point (n,) in the whole model, mm2.
    pressure: contact pressure (n,), MPa, zero at points that do not touch.
    bound: largest traction that friction allows (n,), MPa: its coefficient times the pressure.
    traction: tangential traction of the wheel on the rail (n, 3), MPa.
    slip: (n, 3) at each point; for a shift it is that since the end of the load step before.
    sticks: (n,) whether a point with pressure sticks.
    rigid_motion: (along, across, spin about the normal): for rolling, two creepages and the spin in
        1/mm; for a shift, all of it from rest over all load steps, mm, mm and rad.
    force: (along, across), force of the wheel on the rail, N, of the whole model.
    moment: moment of the tractions of the wheel on the rail about the normal at the origin of the
        friction settings, N mm; zero with symmetry planes.
    load_steps: (l, 4) at the end of each of l load steps: force along and across (N), rigid motion
        along and across.
    dissipated_energy: work of friction after the full tangential force was reached for the first
        time, N mm; zero for rolling.
    coupling_iterations: number of times, over all load steps, that the tractions were solved.
    rigid_slip: slip (n, 3) of rigid bodies with the motion `rigid_motion`, in the unit of `slip`;
        for rolling the fourth motion of `FrictionSettings.rigid_slip` is included. Of solids whose
        tractions are those of half-spaces the strain of the pressed surfaces is included.
    newton_steps: largest number of steps of Newton's method on the tractions.
    without_creepage: where the wheel rolls, the tractions at the same pressure without any rigid
        slip; otherwise None.
    misread: of rolling solids with half-spaces for their tractions, the same where what is read of
        the bodies differs by what two readings of it differ by; otherwise None.
    inside: (n,) share of the area of each point in the patch; None: whole areas.
    coarse: the same on a grid of half as many cells each way; None where there is none.
    rise_rail, rise_wheel: of the temperature of each surface above the bulk of its body, (n,), K;
        None without heat.
    grids: of bodies whose tractions are those of half-spaces, whole patches; else empty.
    """

    points: Array
    weights: Array
    pressure: Array
    bound: Array
    traction: Array
    slip: Array
    sticks: Mask
    rigid_motion: tuple[float, float, float]
    force: tuple[float, float]
    moment: float
    load_steps: Array
    dissipated_energy: float
    coupling_iterations: int
    rigid_slip: Array
    newton_steps: int
    without_creepage: FrictionSolution | None = None
    misread: FrictionSolution | None = None
    inside: Array | None = None
    coarse: FrictionSolution | None = None
    rise_rail: Array | None = None
    rise_wheel: Array | None = None
    grids: tuple[GridTraction, ...] = ()

    @property
    def used(self) -> float:
        """Sum of the sizes of all tractions over the limit mu N, 0 to 1."""
        sizes = np.linalg.norm(self.traction, axis=1)
        return float(self.weights @ sizes) / self.friction_limit

    @property
    def friction_limit(self) -> float:
        """Integral of the bound over the whole model, N: largest tangential force, mu N."""
        return float(self.weights @ self.bound)


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
