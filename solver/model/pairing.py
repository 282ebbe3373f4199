"""Contact points of all contacts of a model, where the bodies are now.

From a point x of the secondary surface its outward normal n meets the primary one at X. Both keep
their material points until the next pairing, so that

    g(u) = n . (X + u_primary - x - u_secondary)
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.friction.pressed_surfaces import rows, rows_at
from railhead.solver.material.elasticity import Material
from railhead.solver.model.parts import Contact, Plane, Sphere
from railhead.solver.space import contact_interface, pieces
from railhead.solver.space.cells import Bulk
from railhead.solver.space.contact_interface import ContactLaw, Interface
from railhead.solver.space.facets import FacetSet, pair
from railhead.solver.space.operators import assemble_rows
from railhead.theory.array_types import Array, Index, Mask

BENT = 1e-3  # 1 - cosine between facets of degree 1 that stand for a curved surface
FACING = -0.1  # largest product of the normals of surfaces that face each other
DRIFT = 0.1  # of a facet, by which a point may slide before pairs are made anew


@dataclass(frozen=True, kw_only=True)
class Pairing:
    """n contact points of this rank, with k tangents each.

    interface: contact points with the matrices of gap and normal stress.
    contact: number of the contact of each point (n,).
    tangents: (n, k, c).
    slip: matrix of t . (u_secondary - u_primary), n k rows, on all dofs.
    shear: matrix of t . sigma n of the secondary body, n k rows, on all dofs.
    foot: (partner (n,), coordinates there (n, c - 1)) of the points opposite; partner -1: rigid.
    missed: share of each secondary surface that has nothing opposite.
    """

    interface: Interface
    contact: Index
    tangents: Array
    slip: PETSc.Mat
    shear: PETSc.Mat
    foot: tuple[Index, Array]
    missed: list[float]


class Surfaces:
    """The surfaces of all contacts of a model.

    contacts: in their order.
    secondary, primary: facets of each contact, of this rank and of all ranks; rigid ones have none.
    law: contact law of all contacts: symmetric, or with theta = 0 where something has friction.
    bound: smallest stable parameter of each secondary facet.
    """

    def __init__(
        self,
        contacts: Sequence[Contact],
        bulk: Bulk,
        facet_tags: Any,
        materials: Sequence[Material],
        comm: MPI.Intracomm,
    ) -> None:
        """materials: those of the secondary body of each contact (collective)."""
        self.contacts, self.comm, self.bulk = contacts, comm, bulk
        tags = [each.primary if isinstance(each.primary, int) else None for each in contacts]
        none = np.zeros(0, np.int32)
        self.secondary = [FacetSet.on(bulk, facet_tags.find(each.secondary)) for each in contacts]
        masters = [FacetSet.on(bulk, none if t is None else facet_tags.find(t)) for t in tags]
        self.primary = [each.gathered(comm) for each in masters]
        self.slave, self.other = FacetSet.joined(self.secondary), FacetSet.joined(self.primary)
        suited = [ContactLaw().suited(each.young_modulus, each.lame) for each in materials]
        theta = (
            0 if any(each.friction for each in contacts) else min(law.theta or 0 for law in suited)
        )
        self.law = ContactLaw(theta=theta)
        factor = [law.gamma_factor for law in suited]
        self.bound = np.repeat(factor, [len(each) for each in self.secondary])
        self.bound *= contact_interface.trace_bound(
            self.slave,
            2 * self.slave.degree,
            lambda facet, xi, _: self.slave.normals(facet, self.slave.tangents(facet, xi)[1]),
        )
        for each, surface in zip(contacts, self.primary, strict=True):
            own = surface.flat_normals
            straight = each.gap is None and surface.geometry_degree == 1 and len(own)
            if straight and (own @ own[0]).min() < 1 - BENT:
                self._warn(
                    f"facets {each.primary} are straight on a curved surface, which adds some 10 % "
                    "to the pressure: take a mesh of degree 2, or give the gap"
                )

    def _warn(self, text: str) -> None:
        """Warn on rank 0."""
        if self.comm.rank == 0:
            warnings.warn(text, stacklevel=5)

    def pair(self, displacement: Array) -> Pairing:
        """Contact points and the points opposite at a displacement (dofs, c) of all block dofs
        (collective). Raises ValueError where a contact has no point opposite.
        """
        found, missed, slaves, others = [], [], 0, 0
        for number, contact in enumerate(self.contacts):
            slave, other = self.secondary[number], self.primary[number]
            order = contact_interface.quadrature_order(slave)
            if len(other):
                here = slave.moved(displacement)
                at, weights = pieces.quadrature(here, other.moved(displacement), order)
                weights = weights * slave.measure(*at) / here.measure(*at)
            else:
                at, weights = slave.quadrature(order)
            normals, now, change, foot = self.opposite(number, at, displacement)
            keep, gap = np.isfinite(now), now - change
            sums = slave.quadrature(order)[1].sum(), weights[keep].sum()
            whole, met = (self.comm.allreduce(float(each)) for each in sums)
            if not met:
                raise ValueError(f"surface {contact.secondary} has nothing opposite its points")
            missed.append(1 - met / whole)
            facet, partner = at[0][keep] + slaves, foot[0][keep]
            partner = np.where(partner >= 0, partner + others, -1)
            every = at[1], weights, normals, gap, foot[1]
            numbers = np.full(len(facet), number)
            found.append((numbers, facet, partner, *(each[keep] for each in every)))
            slaves, others = slaves + len(slave), others + len(other)
        numbers, facet, partner, xi, weights, normals, gap, eta = (
            np.concatenate(each) for each in zip(*found, strict=True)
        )
        points = self.slave.tangents(facet, xi)[0]
        dim = self.slave.kinematics.dim
        owned = dim * self.bulk.space.dofmap.index_map.size_local
        interface = contact_interface.assembled(
            self.slave,
            None,
            ((facet, xi), weights, points, normals),
            gap,
            (self.other, partner, eta) if len(self.other) else None,
            self.bound,
            owned,
            self.comm,
        )
        tangents = tangents_of(normals)
        total, count = self.comm.allreduce(owned), len(facet) * (dim - 1)
        reference = self.slave.reference(facet, xi)
        stress = contact_interface.shear_stress(self.slave, facet, reference, normals, tangents)
        slip = [rows_at(self.slave, facet, xi, tangents)]
        if len(self.other):
            met = (partner >= 0)[:, None, None]
            slip.append(rows_at(self.other, np.maximum(partner, 0), eta, -tangents * met))
        return Pairing(
            interface=interface,
            contact=numbers,
            tangents=tangents,
            slip=assemble_rows(slip, count, owned, total, self.comm),
            shear=assemble_rows([rows(self.slave, facet, stress)], count, owned, total, self.comm),
            foot=(partner, eta),
            missed=missed,
        )

    def opposite(
        self, number: int, at: tuple[Index, Array], displacement: Array
    ) -> tuple[Array, Array, Array, tuple[Index, Array]]:
        """What points of a contact's secondary surface meet along their outward unit normals.

        number: of the contact. at: facets (n,) and coordinates (n, c - 1) of the points.
        displacement: (dofs, c) of all block dofs.
        Returns the normals (n, c), the gap now (n,), infinite where nothing is opposite, the part
        of it that the displacement makes (n,), and facet (n,) and coordinates (n, c - 1) opposite.
        """
        contact, slave, other = self.contacts[number], self.secondary[number], self.primary[number]
        x, tangent = slave.tangents(*at)
        normals, own = slave.normals(at[0], tangent), slave.values(*at, displacement)
        partner, eta = np.full(len(x), -1), np.zeros_like(at[1])
        if isinstance(contact.primary, Plane | Sphere):
            now = contact.primary.distance(x + own, normals)
            return normals, now, -np.einsum("nc,nc->n", normals, own), (partner, eta)
        if contact.gap is None:
            moved = other.moved(displacement)
            partner, eta = pair(x + own, normals, moved)
        else:
            gap, given = (np.asarray(each, float) for each in contact.gap(x))
            normals = given[:, : x.shape[1]]
            if len(other):
                partner, eta = pair(x, normals, other)
        met, at = partner >= 0, (np.maximum(partner, 0), eta)
        opposite = other.values(*at, displacement) if len(other) else np.zeros_like(own)
        change = np.einsum("nc,nc->n", normals, opposite - own)
        if contact.gap is not None:
            return (
                normals,
                np.where(met | (not len(other)), gap + change, np.inf),
                change,
                (partner, eta),
            )
        now = np.einsum("nc,nc->n", normals, moved.tangents(*at)[0] - x - own)
        reach = np.linalg.norm(moved.vertices[:, 1] - moved.vertices[:, 0], axis=1)[at[0]]
        met &= np.einsum("nc,nc->n", normals, moved.flat_normals[at[0]]) < FACING
        return normals, np.where(met & (now > -reach), now, np.inf), change, (partner, eta)

    def outdated(
        self, pairing: Pairing, displacement: Array, gap: Array, active: Mask
    ) -> tuple[bool, float]:
        """Whether some points that touch have slid by more than a tenth (DRIFT) of a facet since
        they were paired, and the largest change of the gap that pairing anew makes there
        (collective).

        displacement: (dofs, c) of all block dofs. gap: now, by the pairing (n,). active: (n,)
            points of the pairing that touch.
        """
        drift = change = 0.0
        face, (partner, eta) = pairing.interface, pairing.foot
        starts = np.cumsum([0, *(len(each) for each in self.secondary)])
        begins = np.cumsum([0, *(len(each) for each in self.primary)])
        for number, (contact, other) in enumerate(zip(self.contacts, self.primary, strict=True)):
            on = np.flatnonzero((pairing.contact == number) & active)
            if contact.gap is not None or not len(on):
                continue
            at = face.facet[on] - starts[number], face.xi[on]
            _, now, _, new = self.opposite(number, at, displacement)
            met = np.isfinite(now)
            change = max(change, float(np.max(np.abs(now - gap[on])[met], initial=0.0)))
            drift = max(drift, float(not met.all()))
            if len(other):
                moved, old = other.moved(displacement), (partner[on] - begins[number], eta[on])
                here, there = (moved.tangents(np.maximum(f, 0), e)[0] for f, e in (new, old))
                size = np.linalg.norm(moved.vertices[:, 1] - moved.vertices[:, 0], axis=1)[old[0]]
                slid = np.linalg.norm(here - there, axis=1) / size
                drift = max(drift, float(np.max(slid[met], initial=0.0)))
        drift, change = (self.comm.allreduce(each, op=MPI.MAX) for each in (drift, change))
        return drift > DRIFT, change


def tangents_of(normals: Array) -> Array:
    """Orthonormal tangents (n, c - 1, c) at unit normals (n, c)."""
    if normals.shape[1] == 2:
        return np.stack([normals[:, 1], -normals[:, 0]], axis=1)[:, None]
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normals, first)], axis=1)
