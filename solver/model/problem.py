"""The equations of a model, contact with yield and friction; and its state between two
solutions.

Along tangents t the secondary surface carries the traction (Chouly 2014, theta = 0)

    lambda = projection of t . sigma n - tau s on the disc of radius mu p

where s is the slip since the last step. History is the displacement then; no traction is stored.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from railhead.solver.algebra.coulomb import projected
from railhead.solver.algebra.newton import NewtonResult, NewtonStep
from railhead.solver.algebra.reduced_stiffness import DIFFERENT
from railhead.solver.plasticity.plastic_problem import PlasticProblem
from railhead.solver.plasticity.radial_return import History
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.operators import add_transposed, blockwise
from railhead.solver.space.supports import Hub
from railhead.theory.array_types import Array, Mask

HubLoads = Mapping[Hub, Array]
"""Of each hub an array (1 + c + k c,): the force along its free direction, NaN where it is moved;
its motion (c,), of a hub with a force across the free direction; and by how much the motion of each
of its k nodes on this rank is another."""


def prescribed_motions(loads: HubLoads) -> dict[Hub, Array]:
    """Motions (c + k c,) that loads prescribe to hubs."""
    return {hub: load[1:].copy() for hub, load in loads.items()}


@dataclass(frozen=True, kw_only=True)
class State:
    """State of a model with n contact points on this rank.

    displacement: on all dofs that this process owns.
    loads: of all hubs; motions: of each hub (c + k c,), as in its load.
    share: of the bodies' forces that acts.
    nodal: force that each node of this rank needs from outside (nodes, c): of supports and hubs.
    bulk, surface: plastic histories at Gauss points and contact points.
    pairing: contact points; outdated: whether points have slid by too much since they were paired.
    pressure, gap: at the points (n,). traction: along the tangents there (n, k).
    slip: of the secondary surface past the primary one, since rest (n, c).
    sticking: whether a point with friction touches and does not slide (n,).
    result: Newton's method in the last step; history: all of its steps so far.
    number: of solutions since rest.
    """

    displacement: PETSc.Vec
    loads: HubLoads
    motions: Mapping[Hub, Array]
    share: float
    nodal: Array
    bulk: History
    surface: History
    pairing: Interface
    outdated: bool
    pressure: Array
    gap: Array
    traction: Array
    slip: Array
    sticking: Mask
    result: NewtonResult
    history: tuple[NewtonStep, ...] = ()
    number: int = 0


@dataclass(kw_only=True)
class FrictionalProblem(PlasticProblem):
    """Contact problem with friction and yield, in one load step. n points have k tangents.

    coefficient: of friction (n,), infinite at points that are bonded.
    slip: matrix of the slip s, n k rows, per free unknown.
    shear: matrix of t . sigma n, n k rows, per free unknown.
    start_slip, start_shear: at zero free unknowns (n, k); of the slip since the last step.
    shear_dyads: sym(t x n) in Mandel's notation (n, k, m).
    """

    coefficient: Array
    slip: PETSc.Mat
    shear: PETSc.Mat
    start_slip: Array
    start_shear: Array
    shear_dyads: Array

    def __post_init__(self) -> None:
        """Start with all points sticking."""
        super().__post_init__()
        self.trial_operator = self.slip.copy()
        tau = self.slip.createVecLeft()
        tau.array[:] = -np.repeat(self.tau, self.start_slip.shape[1])
        self.trial_operator.diagonalScale(L=tau)
        self.trial_operator.axpy(1.0, self.shear, DIFFERENT)
        self.bonded = self.held = np.isinf(self.coefficient)
        self.direction = np.zeros(self.start_slip.shape)

    def branches(self, active: Mask) -> Mask:
        """State of the points that the tangent depends on (2, n): which touch, and which slide."""
        return np.stack([active, active & self.direction.any(axis=1)])

    def all_slides(self, active: Mask) -> bool:
        """Whether all points of all ranks that touch, (n,), with friction slide (collective)."""
        rubs = active & (self.coefficient > 0)
        local = [int(rubs.sum()), int((rubs & ~self.slides).sum())]
        touching, sticking = self.slip.comm.tompi4py().allreduce(np.array(local))
        return bool(touching and not sticking)

    @property
    def slip_increment(self) -> Array:
        """Slip (n, k) in the step at points that slide, the excess of the trial traction over tau;
        zero at points that stick, are apart or have no friction.
        """
        slides = self.slides & self.traction.any(axis=1)
        return np.asarray(self.excess * (slides / self.tau)[:, None])

    def _friction(self, y: PETSc.Vec, pressure: Array) -> None:
        """Tangential tractions (n, k) and their derivatives at the free unknowns y. A point that
        would slide the other way round than in the last step is linearised as one that sticks; not
        in sections, where many turn at once and this doubles the steps.
        """
        trial = (self.trial_operator * y).array.reshape(self.start_slip.shape)
        trial = trial + self.start_shear - self.tau[:, None] * self.start_slip
        plastic = np.einsum("nkm,nm->nk", self.shear_dyads, self._surface[0].plastic)
        trial = trial - 2 * self.surface.mu[:, None] * plastic
        rubs = np.where(self.bonded, 0.0, self.coefficient)
        bound = np.where(self.held, np.inf, rubs * np.maximum(pressure, 0.0))
        self.traction, self.derivative, direction, self.slides = projected(trial, bound)
        turned = (trial.shape[1] > 1) & ((direction * self.direction).sum(axis=1) < 0)
        self.derivative[turned], direction[turned] = np.eye(trial.shape[1]), 0.0
        self.direction = direction
        self.pull, self.excess = rubs[:, None] * direction, self.traction - trial

    def projection(self, active: Mask) -> Array:
        """Derivative (n, k, k) of the traction by the trial traction: 1 where points stick, the
        part normal to it times the share where they slide, 0 at points that do not touch.
        """
        rubs = active & (self.coefficient > 0)
        return np.asarray(rubs[:, None, None] * self.derivative)

    def apply_tangent(
        self, active: Mask, rows: tuple[PETSc.Mat, PETSc.Mat], x: PETSc.Vec, out: PETSc.Vec
    ) -> None:
        """Write the product of the tangent with x into `out`, with the derivative of the tangential
        tractions; arguments as of `ContactProblem.apply_tangent`.
        """
        super().apply_tangent(active, rows, x, out)
        normal = -np.where(active, (self.normal_operator * x).array, 0.0)
        along = (self.trial_operator * x).array.reshape(self.start_slip.shape)
        change = np.einsum("nij,nj->ni", self.projection(active), along)
        change += self.pull * normal[:, None]
        add_transposed(self.slip, -self.area[:, None] * change, out)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """Residual of equilibrium in the free unknowns; pressure: at y (n,), computed last."""
        r = super().residual(y, pressure)
        self._friction(y, pressure)
        add_transposed(self.slip, -self.area[:, None] * self.traction, r)
        return r

    def assembled_tangent(self, active: Mask) -> PETSc.Mat:
        """Tangent at an active set (n,) as an assembled matrix, without the part of yield."""
        out = super().assembled_tangent(active)
        rows = blockwise(self.projection(active), self.trial_operator)
        pull = (self.pull * active[:, None])[..., None]
        rows.axpy(-1.0, blockwise(pull, self.normal_operator), DIFFERENT)
        weights = rows.createVecLeft()
        weights.array[:] = -np.repeat(self.area, self.start_slip.shape[1])
        rows.diagonalScale(L=weights)
        out.axpy(1.0, self.slip.transposeMatMult(rows), DIFFERENT)
        out.setOption(PETSc.Mat.Option.SYMMETRIC, False)
        return out

    def predictor(self, active: Mask) -> PETSc.Vec:
        """Right-hand side of the linear problem in which the active points (n,) touch and stick and
        plastic strain stays as it is in the history.
        """
        held, self.held = self.held, active & (self.coefficient > 0)
        rhs = super().predictor(active)
        self.held, self.direction = held, np.zeros_like(self.direction)
        return rhs
