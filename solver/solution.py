"""The solution of one load case, with what plasticity and friction add to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from petsc4py import PETSc

from railhead.solver.algebra.newton import NewtonResult
from railhead.solver.algebra.problem import Mask
from railhead.solver.space.cells import Array


@dataclass(frozen=True)
class PlasticStrain:
    """Plastic strain at the g Gauss points of each of m cells (m: of this rank, or of all).

    strain: plastic strain tensors in space (m, g, 3, 3).
    equivalent: equivalent plastic strain (m, g).
    """

    strain: Array
    equivalent: Array


@dataclass(frozen=True, kw_only=True)
class PlasticSolution:
    """Load history of bodies of which at least one yields.

    load_over_first_yield: load over the load of first yield.
    newton_results: results of Newton's method of all load steps, unloading included, in order.
    first_loading_steps: number of the first of them that lead up to the load for the first time.
    residual_state: solution after unloading, the bodies apart; None where none was called for.
    indentation_depth: largest residual displacement of each body's contact surface into the body,
        mm, by the body's tag; empty without a residual state.
    """

    load_over_first_yield: float
    newton_results: tuple[NewtonResult, ...]
    first_loading_steps: int
    residual_state: Solution | None = None
    indentation_depth: Mapping[int, float]


@dataclass(frozen=True, kw_only=True)
class FrictionSolution:
    """Tangential tractions and slip at n contact points of all ranks, at the last load step.

    Slip, motion and creepage are those of the wheel over the rail. A shift has slip in mm;
    steady rolling has slip over rolled distance, without dimension.

    points: position (n, 3), mm.
    weights: area of each point (n,) in the whole model, mm2.
    pressure: (n,) MPa.
    traction: tangential traction of the wheel on the rail (n, 3), MPa.
    slip: (n, 3), of a shift since the end of the load step before.
    sticks: (n,) whether a point with pressure sticks.
    rigid_motion: along, across and spin about the normal: creepages and spin in 1/mm, or, of a
        shift, mm and rad.
    force: of the wheel on the rail along and across, N.
    moment: about the normal at the origin, N mm.
    friction_limit: coefficient of friction times normal force, N.
    load_steps: (l, 4) force along and across (N) and rigid motion along and across at the end of
        each of l load steps.
    dissipated_energy: work of friction after the full tangential force was reached for the first
        time, N mm.
    coupling_iterations: how many times tractions and pressure were solved alternately.
    rigid_slip: slip of rigid bodies with the same motion (n, 3).
    newton_history: residuals of the longest of Newton's iterations, see `TangentialState.history`.
    without_creepage: for rolling, the same contact at zero creepage and spin.
    """

    points: Array
    weights: Array
    pressure: Array
    traction: Array
    slip: Array
    sticks: Mask
    rigid_motion: tuple[float, float, float]
    force: tuple[float, float]
    moment: float
    friction_limit: float
    load_steps: Array
    dissipated_energy: float
    coupling_iterations: int
    rigid_slip: Array
    newton_history: tuple[float, ...]
    without_creepage: FrictionSolution | None = None


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Answer of a contact model to one load case, at the n local points of its interface.

    Forces are those of the whole model, symmetric images included.

    displacement: values of the owned dofs of `bulk.space`, mm.
    pressure: contact pressure (n,), MPa.
    indicator: pressure before its negative part is cut off (n,), MPa; the active set is where it
        is positive.
    approach: motion of the hub along the direction of the setup, mm.
    load: resultant of the contact tractions against that direction, N.
    reaction: the same force at the support, N.
    penetration: largest overlap of the surfaces, mm.
    newton: result of Newton's method of the last load step, or of the one that failed.
    plastic_strain: of all cells of this rank; None where nothing yields.
    plasticity: load history; None where nothing yields.
    friction: tractions and slip; None without friction.
    reference: with friction, the frictionless solution of the same load case; without friction but
        with yield, the elastic one; otherwise None.
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
