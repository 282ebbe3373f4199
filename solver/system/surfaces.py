"""Contact surfaces of a mesh, and their contact points where the bodies are now.

From a point x of the secondary surface its outward normal n meets the primary one at X. Both keep
their material points until the next pairing, so that

    g(u) = n . (X + u_primary - x - u_secondary)
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.solver.space import contact_interface, pieces
from railhead.solver.space.cells import Bulk
from railhead.solver.space.contact_interface import Interface, tangents_of
from railhead.solver.space.facets import FacetSet, pair
from railhead.solver.space.rigid import RigidSurface
from railhead.solver.space.vectors import finite
from railhead.theory.array_types import Array, Index

SECTION_QUADRATURE = 15  # degree of the contact quadrature in a section, where points are cheap:
# it follows the edge of the patch, and the pressure's error falls tenfold
BENT = 1e-3  # 1 - cosine between facets of degree 1 that stand for a curved surface
FACING = -0.1  # largest product of the normals of surfaces that face each other
OUTWARD = 0.5  # product, at least in the mean, of normals given with a gap and those of facets
ALMOST = 1e-9  # least product of the normals of a surface and a rigid one that it meets
TURN = 2e-3  # of a unit normal of a rigid surface, from which on tangential forces would be off
ROUNDING = 1e-13  # of the largest coordinate, by which no gap is known
GapFunction = Callable[[Array], tuple[Array, Array]]
"""Points (n, c) of the secondary surface -> gap (n,) along its outward normals, infinite where
they miss the primary surface, and these unit normals (n, c or 3)."""


@dataclass(frozen=True)
class Contact:
    """Two surfaces that may touch, by the tags of their facets. The secondary one carries the
    contact points; it is best the one of the softer body or, of like bodies, the finer one.

    primary: tag, or a rigid `Plane`, `Sphere` or `Cylinder`, which stays where no `Hub` moves it.
    friction: Coulomb's coefficient.
    gap: None: from the facets, curved as they are. A function (see `GapFunction`) holds for motions
        that are small beside the radii; with it, primary None is a rigid surface that stays.
    """

    secondary: int
    primary: int | RigidSurface | None
    friction: float = 0.0
    gap: GapFunction | None = None

    def __post_init__(self) -> None:
        """Raises ValueError for a coefficient that is no number or negative, for a surface on
        itself, and where the primary surface is given neither by a tag, a shape nor a gap, or by
        a shape and a gap.
        """
        if isinstance(self, Tie):
            whole = [isinstance(each, int | np.integer) for each in (self.secondary, self.primary)]
            if not all(whole) or self.friction != math.inf or self.gap is not None:
                raise ValueError("Tie takes two tags: Tie(secondary=, primary=)")
        elif finite("Contact", "friction", self.friction) < 0:
            raise ValueError(f"friction must not be negative, not {self.friction!r}")
        if self.primary == self.secondary:
            raise ValueError(f"surface {self.secondary} on itself: self-contact is not there")
        if self.primary is None and self.gap is None:
            raise ValueError("Contact needs a primary surface, or a gap")
        if isinstance(self.primary, RigidSurface) and self.gap is not None:
            raise ValueError(f"gap says where {self.primary} is: give one of them")

    @property
    def tags(self) -> list[int]:
        """Tags of the facets of its surfaces."""
        if isinstance(self.primary, RigidSurface | None):
            return [self.secondary]
        return [self.secondary, self.primary]


@dataclass(frozen=True)
class Tie(Contact):
    """Two surfaces that are bonded where they lie opposite each other at rest: they neither part
    nor slip, and keep their distance.
    """

    friction: float = math.inf


class Surfaces:
    """The surfaces of all contacts of a mesh.

    contacts: in their order.
    secondary, primary: facets of each contact, of this rank and of all ranks; rigid ones have none.
    deformed: whether normals and areas are those of the deformed surfaces, else of the undeformed.
    cut: whether contact points lie on the pieces into which the facets of both surfaces cut each
        other, so that a constant pressure stays constant; otherwise on whole secondary facets.
    bound: smallest stable parameter of each secondary facet, times the factor of its contact.
    """

    def __init__(
        self,
        contacts: Sequence[Contact],
        bulk: Bulk,
        facet_tags: Any,
        comm: MPI.Intracomm,
        factors: Sequence[float] = (1.0,),
        cut: bool = True,
        deformed: bool = False,
    ) -> None:
        """factors: one of each contact (collective). Raises ValueError for a gap that is no number,
        gives no outward unit normals, or other numbers of values than of points.
        """
        self.contacts, self.comm, self.bulk, self.cut = contacts, comm, bulk, cut
        self.deformed = deformed
        none = np.zeros(0, np.int32)
        self.secondary = [FacetSet.on(bulk, facet_tags.find(each.secondary)) for each in contacts]
        others = [[*map(facet_tags.find, each.tags[1:]), none][0] for each in contacts]
        masters = [FacetSet.on(bulk, facets) for facets in others]
        self.primary = [each.gathered(comm) for each in masters]
        self.slave, self.other = FacetSet.joined(self.secondary), FacetSet.joined(self.primary)
        for each, surface in zip(contacts, self.secondary, strict=True):
            fits = each.gap is None or _fits(each.gap, surface)
            if not all(comm.allgather(fits)):
                raise ValueError(
                    f"gap of surface {each.secondary} must give, for n points, n gaps (infinite: a "
                    "miss) and n outward unit normals"
                )
        self._number = np.repeat(np.arange(len(contacts)), [len(each) for each in self.secondary])
        at, weights = self.slave.quadrature(2 * self.slave.degree)
        bound = contact_interface.trace_bound(self.slave, at, weights, self._normals(*at))
        self.bound = np.asarray(factors)[self._number] * bound
        for each, *surfaces in zip(contacts, self.secondary, masters, strict=True):
            for tag, surface in zip(each.tags, surfaces, strict=False):
                if each.gap is not None or surface.geometry_degree > 1:
                    continue
                every = np.concatenate(comm.allgather(surface.flat_normals))
                if comm.rank == 0 and (every @ every[0]).min() < 1 - BENT:
                    text = (
                        f"facets {tag} are straight on a curved surface, which adds some 10 to 27 "
                        "% to the pressure: take a mesh of degree 2, or give the gap"
                    )
                    warnings.warn(text, stacklevel=4)

    def _normals(self, facet: Index, xi: Array) -> Array:
        """Outward unit normals (n, c) at coordinates xi (n, c - 1) on facets (n,) of all secondary
        surfaces: those given with the gap, or of the facets.
        """
        points, tangents = self.slave.tangents(facet, xi)
        out = self.slave.normals(facet, tangents)
        for number, contact in enumerate(self.contacts):
            own = self._number[facet] == number
            if contact.gap is not None:
                out[own] = contact.gap(points[own])[1][:, : out.shape[1]]
        return out

    def _shapes(self, number: int, displacement: Array) -> list[FacetSet]:
        """Secondary and primary surface of a contact, deformed where that counts."""
        both = self.secondary[number], self.primary[number]
        return [each.moved(displacement) if self.deformed else each for each in both]

    def pair(self, displacement: Array) -> Interface:
        """Contact points and the points opposite at a displacement (dofs, c) of all block dofs and,
        after these, of the rigid surface of each contact (collective). A contact whose surfaces
        have left each other has no points. Raises ValueError where a contact has nothing opposite
        at rest, or overlaps by more than a facet.
        """
        found, missed, slaves, others, now_at = [], [], 0, 0, displacement
        for number, contact in enumerate(self.contacts):
            bonded = isinstance(contact, Tie)
            displacement = 0 * now_at if bonded else now_at
            slave, other = self._shapes(number, displacement)
            order = 2 * slave.degree + 1 if slave.kinematics.dim == 3 else SECTION_QUADRATURE
            known = None
            at, weights = slave.quadrature(order)
            whole = weights.sum()
            if len(other) and self.cut:
                here, there = (
                    each[number].moved(displacement) for each in (self.secondary, self.primary)
                )
                at, weights, known = pieces.quadrature(here, there, order)
                if not self.deformed and here is not slave:
                    weights = weights * slave.measure(*at) / here.measure(*at)
            normals, outward, now, change, foot = self.opposite(number, at, displacement, known)
            keep, gap = np.isfinite(now), np.where(bonded & np.isfinite(now), 0.0, now - change)
            whole, met = self.comm.allreduce(np.array([whole, weights[keep].sum()]))
            deep = self.comm.allreduce(int(np.isneginf(now).sum()))
            if (deep and not displacement.any()) or not (met or displacement.any() and not deep):
                raise ValueError(
                    f"surface {contact.secondary} has nothing opposite its points: "
                    + ("the overlap is above a facet's length" if deep else "their normals miss")
                )
            missed.append(1 - met / whole)
            facet, partner = at[0][keep] + slaves, foot[0][keep]
            partner = np.where(partner >= 0, partner + others, -1)
            every = at[1], weights, normals, outward, gap, foot[1]
            numbers = np.full(len(facet), number)
            found.append((numbers, facet, partner, *(each[keep] for each in every)))
            slaves, others = slaves + len(slave), others + len(other)
        numbers, facet, partner, xi, weights, normals, outward, gap, eta = (
            np.concatenate(each) for each in zip(*found, strict=True)
        )
        index_map = self.bulk.space.dofmap.index_map
        return Interface(
            slave=self.slave,
            master=self.other if len(self.other) else None,
            facet=facet,
            xi=xi,
            partner=partner,
            eta=eta,
            points=self.slave.tangents(facet, xi)[0],
            weights=weights,
            initial_gap=gap,
            normals=normals,
            outward=outward,
            tangents=tangents_of(normals),
            contact=numbers,
            missed=missed,
            trace_bound=self.bound[facet],
            local_dofs=self.slave.kinematics.dim * index_map.size_local,
            comm=self.comm,
        )

    def curvature(self, face: Interface) -> Array:
        """Curvature (n, c, c) of rigid surfaces opposite contact points; zero on facets."""
        dim = face.normals.shape[1]
        out = np.zeros((len(face.contact), dim, dim))
        for number, contact in enumerate(self.contacts):
            if isinstance(contact.primary, RigidSurface):
                own = face.contact == number
                out[own] = contact.primary.curvature(face.normals[own])
        return out

    def opposite(
        self, number: int, at: tuple[Index, Array], displacement: Array, known: Index | None
    ) -> tuple[Array, Array, Array, Array, tuple[Index, Array]]:
        """What points of a contact's secondary surface meet along their outward unit normals.

        The contact's normal n is between those of both surfaces: bodies in contact bend towards
        each other by their compliances c = (1 - nu^2)/E, so that n ~ c_p n_s - c_s n_p is normal to
        their interface (Hertz), whichever surface is secondary. A gap of one's own has its own n.

        number: of the contact. at: facets (n,) and coordinates (n, c - 1) of the points.
        displacement: as of `pair`. known: see `facets.pair`.
        Returns n and n_s (n, c), the gap now along n (n,), infinite where nothing is opposite and
        -inf where surfaces overlap by more than a facet, the part of it that the displacement makes
        (n,), and facet (n,) and coordinates (n, c - 1) opposite.
        """
        contact, (slave, other) = self.contacts[number], self._shapes(number, displacement)
        here, (x, tangent) = at[0], slave.tangents(*at)
        normals, own = slave.normals(here, tangent), slave.values(*at, displacement)
        place = x if self.deformed else x + own
        partner, eta = np.full(len(x), -1), np.zeros_like(at[1])
        if isinstance(contact.primary, RigidSurface):
            motion = displacement[number - len(self.contacts)]
            far, up = contact.primary.distance(place - motion, normals)
            if not displacement.any():
                far = np.where(far > -slave.lengths[here], far, -np.inf)
            now = far * np.maximum(-np.einsum("nc,nc->n", normals, up), ALMOST)
            return -up, normals, now, np.einsum("nc,nc->n", up, own - motion), (partner, eta)
        if contact.gap is None:
            moved = self.primary[number].moved(displacement)
            partner, eta = pair(place, normals, moved, known)
        else:
            gap, given = (np.asarray(each, float) for each in contact.gap(x))
            normals = given[:, : x.shape[1]]
            if len(other):
                partner, eta = pair(x, normals, other, known)
        foot, at = (partner, eta), (np.maximum(partner, 0), eta)
        opposite = other.values(*at, displacement) if len(other) else np.zeros_like(own)
        if contact.gap is not None:
            change = np.einsum("nc,nc->n", normals, opposite - own)
            met = np.isfinite(gap) & ((partner >= 0) | (not len(other)))
            return normals, normals, np.where(met, gap + change, np.inf), change, foot
        shares = compliance(other.lame[at[0]]), compliance(slave.lame[here])
        between = shares[0] * normals - shares[1] * other.normals(at[0], other.tangents(*at)[1])
        between = between / np.linalg.norm(between, axis=1)[:, None]
        change = np.einsum("nc,nc->n", between, opposite - own)
        now = np.einsum("nc,nc->n", between, moved.tangents(*at)[0] - place)
        reach = moved.lengths[at[0]]
        facing = np.einsum("nc,nc->n", normals, moved.flat_normals[at[0]]) < FACING
        now = np.where((partner >= 0) & facing, now, np.inf)
        return between, normals, np.where(now > -reach, now, -np.inf), change, foot

    def outdated(
        self, face: Interface, displacement: Array, gap: Array, pressure: Array
    ) -> tuple[float, float, float]:
        """By how much of a facet points that touch have slid since they were paired, infinite where
        no point of a contact touches or the normal of a rigid surface has turned; the largest
        change of the gap that pairing anew makes there; and the share of the force at points that
        have nothing opposite any more (collective).

        displacement: as of `pair`. gap, pressure: now, at the points of `face` (n,).
        """
        drift = change = lost = 0.0
        force = pressure * face.weights
        starts = np.cumsum([0, *(len(each) for each in self.secondary)])
        begins = np.cumsum([0, *(len(each) for each in self.primary)])
        for number, (contact, other) in enumerate(zip(self.contacts, self.primary, strict=True)):
            on = np.flatnonzero((face.contact == number) & (pressure > 0))
            if contact.gap is not None or isinstance(contact, Tie):
                continue
            if not self.comm.allreduce(len(on)):
                drift = np.inf
            if not len(on):
                continue
            at = face.facet[on] - starts[number], face.xi[on]
            old = face.partner[on] - begins[number], face.eta[on]
            normals, _, now, _, new = self.opposite(number, at, displacement, old[0])
            met = np.isfinite(now)
            moved = np.abs(now - gap[on]) - ROUNDING * np.abs(face.points[on]).max()
            change = max(change, float(np.max(moved[met], initial=0.0)))
            drift = max(drift, float(not met.all()))
            lost += float(force[on][~met].sum())
            if not len(other) and np.abs(normals - face.normals[on])[met].max(initial=0.0) > TURN:
                drift = np.inf
            if len(other):
                there = other.moved(displacement)
                ends = [there.tangents(np.maximum(f, 0), e)[0] for f, e in (new, old)]
                slid = np.linalg.norm(ends[0] - ends[1], axis=1) / there.lengths[old[0]]
                drift = max(drift, float(np.max(slid[met], initial=0.0)))
        drift, change = (self.comm.allreduce(each, op=MPI.MAX) for each in (drift, change))
        lost, total = self.comm.allreduce(np.array([lost, force.sum()]))
        return drift, change, lost / total if lost else 0.0


def compliance(lame: Array) -> Array:
    """(1 - nu^2)/E (n, 1), from Lame's constants (n, 2)."""
    lam, mu = lame.T[..., None]
    return np.asarray((lam + 2 * mu) / (4 * mu * (lam + mu)))


def _fits(gap: GapFunction, surface: FacetSet) -> bool:
    """Whether a gap gives one value and one unit normal for each of some points of a surface, and
    the normals point out of it, in the mean over what is met.
    """
    at, _ = surface.quadrature(1)
    points, tangents = surface.tangents(*at)
    try:
        distance, normals = (np.asarray(each, float) for each in gap(points))
        met, count = np.isfinite(distance), points.shape[1]
        sizes = np.linalg.norm(normals[met], axis=1)
        out = (normals[:, :count] * surface.normals(at[0], tangents)).sum(axis=1)[met]
    except (TypeError, ValueError, IndexError):
        return False
    fits = len(normals) == len(points) == distance.size and out.sum() >= OUTWARD * out.size
    return bool(fits) and not np.isnan(distance).any() and bool(np.allclose(sizes, 1, atol=0.01))
