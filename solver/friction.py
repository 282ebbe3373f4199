"""Friction on a contact that is pressed: a shift from rest, and steady rolling at a creepage.

At the contact points, with the jump J u = t . (u_wheel - u_rail) along two tangents t, the traction
of the wheel on the rail is (Kalker 1990; Chouly and Hild's method in the tangent plane)

    lambda = projection of q on the disc of radius mu p,   q = +-S_t u + tau (G u + s)

with S_t u = t . sigma(u_slave) . n, positive where the slave is the rail. A shift: G = J and s the
rigid one, mm. Rolling along +x: G u = 1.5 J u - 2 J u(x + d) + 0.5 J u(x + 2 d), which is
-d dJ/dx by upstream differences of second order, and s = d times the rigid slip. (Differences that
are symmetric would not dissipate.) Conventions as in `theory.rolling`.

The bodies are condensed once: with A the tangent of the pressed contact, whose active set stays,
tractions c at the nodes of the slave's facets move everything by -A^-1 J^T W c, so that

    q = q0 + tau s + D c,   p = p0 + D_p c,   c = L lambda(q, p)

L being the L2 projection from the points to the nodes. Newton's method on c is dense. It starts
where all sticks, and no point crosses the disc in one step: one that would slip the other way round
sticks for a step. Without these two rules it does not converge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver.cells import Array, Index
from railhead.solver.contact import ContactModel, Solution
from railhead.solver.facets import FacetSet
from railhead.solver.linear import factorise
from railhead.solver.operators import rows
from railhead.solver.pairing import pair

UPSTREAM = ((0.0, 1.5), (1.0, -2.0), (2.0, 0.5))  # in steps d, of -d times the derivative
STEP = 0.5  # d over the size of the elements
STEPS = 60  # of Newton's method
TOLERANCE = 1e-8  # change of the tractions over the largest mu p
BLOCK = 200  # right-hand sides at a time


@dataclass(frozen=True)
class Tractions:
    """k tangents at n points. traction (n, k) MPa of the wheel on the rail; slip (n, k): wheel over
    rail, mm of a shift, of 1 when rolling; sticks (n,); pressure (n,) MPa; steps: of Newton's
    method; converged."""

    traction: Array
    slip: Array
    sticks: NDArray[np.bool_]
    pressure: Array
    nodal: Array
    steps: int
    converged: bool


class Friction:
    """The pressed contact, condensed for tractions."""

    def __init__(
        self, model: ContactModel, solution: Solution, coefficient: float, *, rolling: bool
    ) -> None:
        """solution: frictionless, of the model; coefficient of friction > 0."""
        interface, problem = model.interface, model.problem
        slave = interface.slave
        active = solution.pressure > 0
        touched = np.unique(interface.facet[active])
        points = np.flatnonzero(np.isin(interface.facet, touched))
        self.points = points
        self.weights = interface.weights[points]
        self.coefficient, self.rolling = coefficient, rolling
        self.pressed = solution.pressure[points]
        self.parts = model.setup.parts
        normals = interface.normals[points]
        wheel = model.setup.slave == model.setup.moving.tag
        self.tangents = tangents(normals * (-1.0 if wheel else 1.0))
        self.x = interface.points[points]
        facet, xi = interface.facet[points], interface.xi[points]
        count = self.tangents.shape[1]
        corners = slave.vertices[touched]
        size = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2).mean()
        self.step = STEP * float(size)
        master = None
        for side in (model.setup.fixed, model.setup.moving):
            if side.tag != model.setup.slave and not side.rigid:
                master = FacetSet.on(model.bulk, model.facet_tags.find(side.contact))
        sign = -1.0 if wheel else 1.0
        owned = model.setup.kinematics.dim * model.owned

        def jump(shift: float) -> PETSc.Mat:
            at = self.x + shift * self.tangents[:, 0]
            here = (facet, xi) if shift == 0 else pair(at, normals, slave)
            there = None if master is None else pair(at, normals, master)
            if (here[0] < 0).any() or (there is not None and (there[0] < 0).any()):
                raise ValueError("the surfaces end upstream of the patch")
            blocks = [_along(slave, here, self.tangents, -sign)]
            if there is not None and master is not None:
                blocks.append(_along(master, there, self.tangents, sign))
            total = model.reduction.matrix.getSize()[0]
            return rows(blocks, count * len(points), owned, total, model.comm)

        here = jump(0.0)
        reduce = model.reduction.matrix
        self.tau = np.repeat(problem.tau[points], count)
        change = here.copy()
        if rolling:
            change.scale(UPSTREAM[0][1])
            for share, weight in UPSTREAM[1:]:
                change.axpy(weight, jump(share * self.step), PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        tau = here.createVecLeft()
        tau.array[:] = self.tau
        q = change.copy()
        q.diagonalScale(L=tau)
        reference = slave.reference(facet, xi)
        stress = _shear(slave, facet, reference, normals, self.tangents)
        dim = model.setup.kinematics.dim
        dofs = dim * slave.dofs[facet][:, :, None] + np.arange(dim)
        dofs = np.repeat(dofs, count, axis=0)
        shear = rows([(dofs, stress)], count * len(points), owned, reduce.getSize()[0], model.comm)
        if problem.law.sigma:
            q.axpy(sign, shear, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        u = solution.displacement
        self.start = (q * u).array.copy()
        self.moved = (change * u).array.copy()
        # nodes of the slave
        phi, _ = slave.basis(facet, reference)
        used, place = np.unique(slave.dofs[facet], return_inverse=True)
        place = place.reshape(phi.shape)
        traces = sp.csr_matrix(
            (phi.ravel(), (np.repeat(np.arange(len(points)), phi.shape[1]), place.ravel())),
            shape=(len(points), len(used)),
        )
        on = np.abs(traces).sum(axis=0).A1 > 1e-9  # dofs off the facets
        traces = sp.csr_matrix(traces[:, np.flatnonzero(on)])
        self.traces = sp.kron(traces, sp.eye(count)).tocsr()
        weights = np.repeat(self.weights, count)
        mass = (self.traces.T @ sp.diags(weights) @ self.traces).toarray()
        self.project = scipy.linalg.solve(mass, (self.traces.T @ sp.diags(weights)).toarray(), assume_a="pos")
        # compliance
        forces = here.matMult(reduce)
        table = _scipy(forces)
        columns = (table.T @ sp.diags(weights) @ self.traces).tocsc()
        tangent = problem.assembled_tangent(active)
        pc = PETSc.PC().create(model.comm)
        pc.setOperators(tangent)
        factorise(pc, problem.law.symmetric)
        pc.setUp()
        factor = pc.getFactorMatrix()
        q_table, p_table = _scipy(q.matMult(reduce)), -_scipy(problem.trace)[points]
        g_table = _scipy(change.matMult(reduce))
        n, k = columns.shape
        self.D, self.Dp, self.Dg = np.empty((q_table.shape[0], k)), np.empty((len(points), k)), np.empty((q_table.shape[0], k))
        for first in range(0, k, BLOCK):
            part = -columns[:, first : first + BLOCK].toarray()
            rhs = PETSc.Mat().createDense(part.shape, array=np.asfortranarray(part), comm=model.comm)
            out = PETSc.Mat().createDense(part.shape, comm=model.comm)
            out.setUp()
            factor.matSolve(rhs, out)
            x = out.getDenseArray()
            self.D[:, first : first + BLOCK] = q_table @ x
            self.Dp[:, first : first + BLOCK] = p_table @ x
            self.Dg[:, first : first + BLOCK] = g_table @ x
        self.count = count
        self.Dp[self.pressed <= 0] = 0

    def at(self, slip: Array, start: Tractions | None = None, settled: Array | None = None) -> Tractions:
        """slip (n, k): rigid, of the wheel over the rail: of 1, or mm of a shift."""
        k, n = self.count, len(self.points)
        scale = self.step if self.rolling else 1.0
        s = (slip * scale).ravel()
        base = self.start + self.tau * s - (0 if settled is None else self.tau * settled)
        m = self.D.shape[1]
        L = self.project
        c = np.zeros(m) if start is None else start.nodal
        stick = np.ones(n, dtype=bool)
        direction = np.zeros((n, k))
        if start is not None:
            stick = start.sticks.copy()
        top = self.coefficient * self.pressed.max()
        first = start is None
        converged = False
        active = self.pressed > 0
        for step in range(1, STEPS + 1):
            q = (base + self.D @ c).reshape(n, k)
            p = np.maximum(self.pressed + self.Dp @ c, 0) * active
            bound = self.coefficient * p
            if first:
                sticks = active.copy()
            else:
                size = np.linalg.norm(q, axis=1)
                sticks = (size <= bound) & active
                across = (~stick) & ~sticks & (np.einsum("nk,nk->n", q, direction) < 0)
                sticks |= across & active
            size = np.maximum(np.linalg.norm(q, axis=1), 1e-300)
            unit = q / size[:, None]
            # linearisation lambda = value + P (q_new - q) + w (p_new - p)
            value = np.where(sticks[:, None], q, bound[:, None] * unit)
            value[~active] = 0
            P = np.zeros((n, k, k))
            P[sticks] = np.eye(k)
            slips = ~sticks & active
            P[slips] = (bound[slips] / size[slips])[:, None, None] * (np.eye(k) - unit[slips][:, :, None] * unit[slips][:, None, :])
            W = np.where(slips[:, None], self.coefficient * unit, 0.0)
            PD = np.einsum("nij,njm->nim", P, self.D.reshape(n, k, m)) + W[:, :, None] * self.Dp[:, None, :]
            tangent = np.eye(m) - L @ PD.reshape(n * k, m)
            residual = c - L @ value.ravel()
            dc = np.linalg.solve(tangent, -residual)
            c = c + dc
            same = np.array_equal(sticks, stick) and not first
            stick, direction = sticks, unit
            first = False
            change = np.abs(dc).max() / top
            if change < TOLERANCE and same:
                converged = True
                break
        q = (base + self.D @ c).reshape(n, k)
        p = np.maximum(self.pressed + self.Dp @ c, 0) * active
        bound = self.coefficient * p
        size = np.maximum(np.linalg.norm(q, axis=1), 1e-300)
        traction = q * np.minimum(1, bound / size)[:, None]
        moved = (self.moved + self.Dg @ c).reshape(n, k)
        total = (moved + s.reshape(n, k) - (0 if settled is None else settled.reshape(n, k))) / scale
        return Tractions(traction, total, size <= bound, p, c, step, converged)

    def forces(self, found: Tractions, normal: float | None = None) -> tuple[float, float, float]:
        f = self.weights @ found.traction * self.parts
        local = self.x
        moment = 0.0
        if self.count == 2:
            moment = float(self.weights @ (local[:, 0] * found.traction[:, 1] - local[:, 1] * found.traction[:, 0])) * self.parts
        return float(f[0]), float(f[1]) if self.count == 2 else 0.0, moment


def tangents(normals: Array) -> Array:
    """(n, k, c): along x on the surface, and across, from the normals out of the rail (n, c)."""
    along = np.zeros_like(normals)
    along[:, 0] = 1.0
    along -= np.einsum("nc,nc->n", along, normals)[:, None] * normals
    along /= np.linalg.norm(along, axis=1)[:, None]
    if normals.shape[1] == 2:
        return along[:, None]
    return np.stack([along, np.cross(normals, along)], axis=1)


def _along(surface: FacetSet, place: tuple[Index, Array], t: Array, sign: float) -> tuple[Index, Array]:
    facet, xi = place
    phi, _ = surface.basis(facet, surface.reference(facet, xi))
    n, k, dim = t.shape
    dofs = dim * surface.dofs[facet][:, :, None] + np.arange(dim)
    values = sign * phi[:, None, :, None] * t[:, :, None, :]
    return np.repeat(dofs, k, axis=0), values.reshape(n * k, *values.shape[2:])


def _shear(slave: FacetSet, facet: Index, reference: Array, normals: Array, t: Array) -> Array:
    """(n k, d, c) coefficients of t . sigma(u) . n."""
    _, gradient = slave.basis(facet, reference)
    mu = slave.lame[facet, 1]
    normal = np.einsum("ndc,nc->nd", gradient, normals)
    along = np.einsum("ndc,nkc->nkd", gradient, t)
    values = along[:, :, :, None] * normals[:, None, None, :] + normal[:, None, :, None] * t[:, :, None, :]
    values = mu[:, None, None, None] * values
    return np.asarray(values.reshape(-1, *values.shape[2:]))


def _scipy(matrix: PETSc.Mat) -> sp.csr_matrix:
    indptr, indices, values = matrix.getValuesCSR()
    return sp.csr_matrix((values, indices, indptr), shape=matrix.getSize())
