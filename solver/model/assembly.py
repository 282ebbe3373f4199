"""What serves all loads of a model: stiffness, supports and surfaces, assembled once."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from ufl.algorithms import extract_coefficients

from railhead.solver import compat
from railhead.solver.algebra.linear import Direct, Preconditioner
from railhead.solver.algebra.multigrid import Hierarchy, PMultigrid
from railhead.solver.algebra.newton import CONVERGED, NewtonResult
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import DIFFERENT, Stiffness
from railhead.solver.algebra.stiffness import assemble
from railhead.solver.material import Hardening, Material, backs
from railhead.solver.model.applied import Applied
from railhead.solver.model.energy import Energies
from railhead.solver.model.parts import (
    Body,
    Contact,
    Elastic,
    Energy,
    Part,
    Plastic,
    Pressure,
    Spring,
    Traction,
    compatible,
    movers,
)
from railhead.solver.model.problem import HubLoads, State, prescribed_motions
from railhead.solver.plasticity.plastic_problem import YieldPoints, bulk_points
from railhead.solver.plasticity.radial_return import History
from railhead.solver.space.contact_interface import ContactLaw, Interface
from railhead.solver.space.kinematics import Kinematics
from railhead.solver.space.operators import vector
from railhead.solver.space.rigid import RigidSurface
from railhead.solver.space.supports import (
    Clamp,
    Hub,
    Reduction,
    Slide,
    held,
    masks,
    must_exist,
    reduce,
    translation,
)
from railhead.solver.space.vectors import unit
from railhead.solver.system.contact_system import DIRECT_BELOW
from railhead.solver.system.surfaces import Surfaces, Tie
from railhead.theory.array_types import Array, Mask

STIFFER = 2.0  # than the primary body, from which on the roles are exchanged (degree 1: + 10 %)
LOCKS = 0.49  # Poisson's ratio from which on cells without mean dilatation are warned of
ON_AXIS = 1e-9  # radius of a node on the axis, over the largest


class Assembly:
    """A model on its mesh. Its arguments are those of `Model`; raises ValueError as `Model.solve`.

    bulk, stiffness: displacement space, and the stiffness on all dofs.
    contacts: as they were given. surfaces: of all contacts, with the roles that are solved.
    secondary: material of the secondary body of each.
    law: contact law of all contacts: symmetric, or with theta = 0 where something has friction.
    applied: loads of bodies and facets, and springs.
    masks: of each clamp, slide and hub, the nodes of this rank on its facets.
    movers: of each contact the hub that moves its rigid surface; None: it stays, or has facets.
    remembers: whether states have a history or surfaces have tangential tractions.
    stepped: whether the answer depends on the way of the loads: with yield or friction.
    """

    def __init__(
        self,
        mesh: Any,
        cell_tags: Any,
        facet_tags: Any,
        section: str | None,
        degree: int,
        kinematics: Kinematics,
        parts: Sequence[Part],
        u: Any = None,
    ) -> None:
        self.comm, self.section = mesh.comm, section
        self.cell_tags, self.facet_tags = cell_tags, facet_tags
        self.kinematics = kinematics
        self.bodies = [each for each in parts if isinstance(each, Body)]
        contacts = [each for each in parts if isinstance(each, Contact)]
        supports = [each for each in parts if isinstance(each, Clamp | Slide | Hub)]
        if not contacts:
            raise ValueError("a model needs a Contact")
        compatible(contacts, supports, any(isinstance(each, Spring) for each in parts))
        tags = [each.tag for each in self.bodies]
        if len(set(tags)) < len(tags):
            raise ValueError(f"a body is named twice: {tags}")
        for tag in tags:
            must_exist("cell", cell_tags, tag, self.comm)
        loads = [each for each in parts if isinstance(each, Pressure | Traction | Spring)]
        self.movers = movers(contacts, supports)
        meshed = [each.tag for each in supports + loads]
        facets: list[Any] = [tag for tag in meshed if not isinstance(tag, RigidSurface)]
        for tag in facets + [tag for each in contacts for tag in each.tags]:
            must_exist("facet", facet_tags, tag, self.comm)
        self.energies = self._energies(u, degree, contacts)
        self.materials = self._materials()
        self.bulk, self.stiffness = assemble(
            *(mesh, cell_tags, self.materials, degree, self.kinematics),
            space=None if u is None else u.function_space,
        )
        self.masks = masks(self.bulk.space, facet_tags, supports)
        tagged = cell_tags, facet_tags
        self.applied = Applied(self.bulk, self.stiffness, tagged, section, parts)
        self.stiffness = self.applied.sprung(self.stiffness)
        for tag in tags:
            nu = self._typical(self.materials[tag]).poisson_ratio
            if nu > LOCKS and not kinematics.mean_dilatation:
                text = f"body {tag} with Poisson's ratio {nu:.5g} may be far too stiff"
                self.warn(f"{text}: cells lock without mean_dilatation=True")
        self.contacts, contacts = contacts, [self._softer_first(each) for each in contacts]
        on = [self._bodies_at(each.secondary) for each in contacts]
        for each, found in zip(contacts, on, strict=True):
            if len(found) > 1:
                raise ValueError(
                    f"secondary surface {each.secondary} lies on the bodies {found}: give each of "
                    "them a tag and a Contact"
                )
        self._tags = [found[0] for found in on]
        self.secondary = [self._typical(self.materials[tag]) for tag in self._tags]
        suited = [ContactLaw().suited(each.young_modulus, each.lame) for each in self.secondary]
        rubs = any(each.friction for each in contacts)
        rubs_or_bends = rubs or self.energies
        self.law = ContactLaw(theta=0 if rubs_or_bends else min(law.theta or 0 for law in suited))
        factors = [law.gamma_factor for law in suited]
        self.surfaces = Surfaces(
            contacts, self.bulk, facet_tags, self.comm, factors, deformed=bool(self.energies)
        )
        yields = any(each.hardening for each in self.materials.values())
        self.remembers = yields or rubs or bool(self.energies)
        self.stepped = yields or any(0 < each.friction < np.inf for each in contacts)
        self._unknowns: dict[tuple[Hub, ...], Unknowns] = {}
        self._factors: tuple[Interface, Unknowns, Direct] | None = None

    def warn(self, text: str) -> None:
        """A warning, of the first rank."""
        if not self.comm.rank:
            warnings.warn(text, stacklevel=4)

    def _softer_first(self, contact: Contact) -> Contact:
        """The contact as it is solved (collective): with its surfaces exchanged, and a warning,
        where the secondary body is more than twice as stiff (STIFFER) as the primary one. With a
        given gap, and where a surface is rigid or lies on several bodies, it stays as it is.

        Nitsche's parameter grows with the stiffness of the secondary body. Where that is much
        stiffer, the pressure follows the mesh of the soft body (ten times, degree 1: 35 % off).
        """
        tags = contact.tags
        bodies = [self._bodies_at(tag) for tag in tags]
        if contact.gap is not None or [len(each) for each in bodies] != [1, 1]:
            return contact
        secondary, primary = (self._typical(self.materials[tag]) for (tag,) in bodies)
        if plane_modulus(secondary) <= STIFFER * plane_modulus(primary):
            return contact
        self.warn(
            f"surface {tags[0]} is that of the stiffer body: the contact points lie on surface "
            f"{tags[1]}, as with secondary={tags[1]}"
        )
        return replace(contact, secondary=tags[1], primary=tags[0])

    def _materials(self) -> dict[int, Material]:
        """Elastic constants and flow curve of each body, by the tag of the body (collective).
        Raises ValueError on all ranks where some rank holds a value that is out of range.
        """
        found, problem = {}, ""
        try:
            for body in self.bodies:
                cells = self.cell_tags.find(body.tag)
                if self.energies and isinstance(body.material, Energy):
                    found[body.tag] = Material(*self.energies.moduli(cells))
                elif isinstance(body.material, Elastic):
                    found[body.tag] = body.material.over(cells).material(self.section)
        except ValueError as error:
            problem = str(error)
        for each in filter(None, self.comm.allgather(problem)):
            raise ValueError(each)
        return found

    def _energies(self, u: Any, degree: int, contacts: Sequence[Contact]) -> Energies | None:
        """Energies of all bodies where one has its own; None: all have a linear law (collective).
        Raises ValueError for what does not go with an energy.
        """
        if not any(isinstance(body.material, Energy) for body in self.bodies):
            return None
        mean, no = self.kinematics.mean_dilatation, "does not go with an Energy"
        for problem, wrong in {
            "plane stress": self.section == "plane stress",
            "mean_dilatation": mean,
            "Plastic": any(isinstance(body.material, Plastic) for body in self.bodies),
            "thermal_strain": any(body.thermal_strain != 0 for body in self.bodies),
            "a gap": any(each.gap is not None for each in contacts),
            "Tie": any(isinstance(each, Tie) for each in contacts),
        }.items():
            if wrong:
                raise ValueError(f"{problem} {no}")
        psi = {}
        for body in self.bodies:
            if isinstance(body.material, Energy):
                psi[body.tag] = body.material.psi
                if u is None or u not in extract_coefficients(psi[body.tag]):
                    raise ValueError(f"the energy of body {body.tag} must depend on model.u")
            else:
                lam, mu = Material(body.material.young_modulus, body.material.poisson_ratio).lame
                psi[body.tag] = self.kinematics.stored(u, lam, mu)
        return Energies(u, degree, self.cell_tags, self.kinematics.revolved, psi)

    def _typical(self, material: Material) -> Material:
        """A material with the mean of Young's moduli and the largest of Poisson's ratios of the
        body (collective).
        """
        young, nu = np.atleast_1d(material.young_modulus), np.atleast_1d(material.poisson_ratio)
        every = self.comm.allgather((young.sum(), young.size, nu.max(initial=0.0)))
        total, count, largest = zip(*every, strict=True)
        return Material(sum(total) / sum(count), max(largest), material.hardening)

    def hardening(self, number: int, pairing: Interface) -> Hardening | None:
        """Law of yield at the points of this rank that belong to a contact, by its number."""
        law, own = self.secondary[number].hardening, pairing.contact == number
        cells = pairing.slave.numbers[pairing.facet[own]]
        return law and law.at(np.searchsorted(self.cell_tags.find(self._tags[number]), cells))

    def _bodies_at(self, tag: int) -> list[int]:
        """Tags of the bodies that the facets with a tag belong to, in order (collective)."""
        dim, topology = self.kinematics.dim, self.bulk.space.mesh.topology
        topology.create_connectivity(dim - 1, dim)
        links = topology.connectivity(dim - 1, dim).links
        values = dict(zip(self.cell_tags.indices, self.cell_tags.values, strict=True))
        own = {int(values[links(facet)[0]]) for facet in self.facet_tags.find(tag)}
        return sorted(set().union(*self.comm.allgather(own)))

    def _closing(self, pairing: Interface, hub: Hub) -> Array:
        """Change of the gaps (n,) where a hub moves by 1 along its free direction, with the bodies
        that it holds (collective).
        """
        free = unit("free", hub.free)
        if isinstance(hub.tag, RigidSurface):
            return np.where(self.moved_by(pairing, hub), pairing.normals @ free, 0.0)
        own = np.isin(self.cell_tags.values, self._bodies_at(hub.tag))
        motion = translation(self.bulk.space, self.cell_tags.indices[own], free)
        return np.asarray((pairing.gap * vector(self.stiffness, motion)).array)

    def moved_by(self, pairing: Interface, hub: Hub) -> Mask:
        """Points (n,) opposite a rigid surface that a hub moves."""
        return np.isin(pairing.contact, [k for k, each in enumerate(self.movers) if each is hub])

    def rigid_motions(self, motions: Mapping[Hub, Array]) -> Array:
        """Motion (contacts, c) of the rigid surface of each contact, zero where it has none."""
        dim = self.kinematics.dim
        zero = np.zeros(dim)
        return np.array([zero if hub is None else motions[hub][:dim] for hub in self.movers])

    def _free(self, loads: HubLoads) -> tuple[Hub, ...]:
        """Hubs whose motion along their free direction is unknown."""
        return tuple(hub for hub, load in loads.items() if not np.isnan(load[0]))

    def unknowns(self, loads: HubLoads) -> Unknowns:
        """Free unknowns under these loads; kept for each set of free hubs (collective)."""
        free = self._free(loads)
        if free not in self._unknowns:
            self._unknowns[free] = Unknowns(self, free)
        return self._unknowns[free]

    def reduce(self, space: Any, free: tuple[Hub, ...]) -> Reduction:
        """Map from free unknowns to the dofs of a space where these hubs are free (collective)."""
        supports = held(space, self.facet_tags, self.masks, free)
        if self.kinematics.revolved:
            r = np.abs(compat.dof_points(space)[:, 0])
            largest = max(self.comm.allgather(float(np.max(r, initial=0.0))))
            supports.planes.append((r < ON_AXIS * largest, np.array([1.0, 0.0])))
        return reduce(supports, self.comm)

    @property
    def bulk_points(self) -> Array:
        """Positions (nodes, c) of this rank's nodes."""
        return compat.dof_points(self.bulk.space)

    @cached_property
    def size(self) -> float:
        """Largest coordinate of a node, beside the origin (collective)."""
        local = float(np.abs(self.bulk_points).max(initial=0.0))
        return float(self.comm.allreduce(local, op=MPI.MAX))

    def preconditioner(
        self, problem: ContactProblem, pairing: Interface, loads: HubLoads
    ) -> Preconditioner:
        """Preconditioner of a problem: the last factorisation, where contact points and free hubs
        are the same; p-multigrid for a large solid of degree 2 without friction.
        """
        unknowns, last = self.unknowns(loads), self._factors
        large = unknowns.reduction.unknowns > DIRECT_BELOW[self.kinematics.dim, self.bulk.degree]
        rubs = any(each.friction for each in self.surfaces.contacts)
        bonds = rubs or self.applied.springs
        if large and self.bulk.degree == 2 and self.kinematics.dim == 3 and not bonds:
            return PMultigrid(problem, unknowns.hierarchy)
        if last is None or last[0] is not pairing or last[1] is not unknowns:
            last = self._factors = pairing, unknowns, Direct(problem)
        last[2].problem = problem
        return last[2]

    def prescribed(self, loads: HubLoads) -> PETSc.Vec:
        """Displacement on all dofs that hubs prescribe."""
        dim = self.kinematics.dim
        values = np.zeros((len(self.bulk_points), dim))
        for hub, load in loads.items():
            values[self.masks[hub]] += load[1 : 1 + dim] + load[1 + dim :].reshape(-1, dim)
        return vector(self.stiffness, values)

    def gathered(self, displacement: PETSc.Vec, motions: Mapping[Hub, Array]) -> Array:
        """Displacement (nodes, c) at all nodes of all ranks, and after these of the rigid surface
        of each contact, from the motions of hubs (collective).
        """
        every = np.concatenate(self.comm.allgather(displacement.array))
        return np.concatenate([every.reshape(-1, self.kinematics.dim), self.rigid_motions(motions)])

    def tangent(self, displacement: PETSc.Vec) -> tuple[PETSc.Mat, PETSc.Vec]:
        """Stiffness of bodies and springs at a displacement, and the forces that this needs, on all
        dofs (collective).
        """
        if self.energies is None:
            return self.stiffness, self.stiffness * displacement
        tangent, forces = self.energies.linear(displacement)
        for each in self.applied.springs.values():
            forces.axpy(1.0, each * displacement)
        return self.applied.sprung(tangent), forces

    def pair(self, displacement: PETSc.Vec, motions: Mapping[Hub, Array]) -> Interface:
        """Contact points at a displacement and motions of hubs (collective)."""
        every = self.gathered(displacement, motions)
        face = self.surfaces.pair(every)
        if self.energies is None:
            return face
        return self.energies.deformed(face, displacement, every, self.surfaces.curvature(face))

    def gap(
        self, pairing: Interface, displacement: PETSc.Vec, motions: Mapping[Hub, Array]
    ) -> Array:
        """Gap (n,) at a displacement and motions of hubs."""
        moved = self.rigid_motions(motions)[pairing.contact]
        along = np.einsum("nc,nc->n", pairing.normals, moved)
        return np.asarray(pairing.initial_gap + (pairing.gap * displacement).array + along)

    def first_touch(self, pairing: Interface, loads: HubLoads) -> Mask:
        """Points (n,) of this rank that touch first where hubs move along their forces; see
        `Interface.nearest` (collective).

        A patch of the area A with gaps up to h, over the smallest one, carries about

            F = E* sqrt(A) (2 h - mean of the gap in A)      or, in a section, E* (2 h - mean)

        which is Hertz's force to 13 % in both. Gaps are those along the motion, or of the surfaces
        where no force closes them.
        """
        closing = np.zeros(len(pairing.contact))
        for hub in self._free(loads):
            closing -= self._closing(pairing, hub) * np.sign(loads[hub][0] or 1.0)
        force = sum(abs(loads[hub][0]) for hub in self._free(loads))

        def touching(number: int, gaps: Array, area: Array) -> int:
            """Number of points that carry the force of all hubs."""
            total, material = np.cumsum(area), self.secondary[number]
            size = np.sqrt(total) if self.kinematics.load_power == 3 else 1.0
            modulus = plane_modulus(material) / len(self.surfaces.contacts[number].tags)
            over = gaps - gaps[0]
            carried = modulus * size * (2 * over - np.cumsum(over * area) / total)
            return int(np.searchsorted(carried, force))

        return pairing.nearest(closing, touching)

    def rest(self) -> State:
        """State without loads, before which there is no history (collective)."""
        zero = {
            hub: np.append(np.nan, np.zeros(self.kinematics.dim * (1 + on.sum())))
            for hub, on in self.masks.items()
            if isinstance(hub, Hub)
        }
        motions = prescribed_motions(zero)
        u = self.stiffness.createVecLeft()
        u.set(0.0)
        pairing = self.pair(u, motions)
        count, size = len(pairing.contact), 3 + len(self.kinematics.shears)
        count_backs = backs(self.materials.values())
        gauss = len(self.unknowns(zero).points.points) if self.remembers else 0
        return State(
            displacement=u,
            loads=zero,
            motions=motions,
            share=0.0,
            nodal=np.zeros_like(self.bulk_points),
            bulk=History.virgin(gauss, size, count_backs),
            surface=History.virgin(count, size, count_backs),
            pairing=pairing,
            outdated=False,
            pressure=np.zeros(count),
            gap=pairing.initial_gap,
            traction=np.zeros(pairing.tangents.shape[:2]),
            slip=np.zeros_like(pairing.normals),
            sticking=np.zeros(count, dtype=bool),
            result=NewtonResult(u, np.zeros(count), CONVERGED),
        )


class Unknowns:
    """Free unknowns of a model in which some hubs move freely along their free direction.

    hubs: these hubs, in the order of `Reduction.places`.
    reduction: map from free unknowns to dofs. stiffness: that of the free unknowns.
    """

    def __init__(self, model: Assembly, hubs: tuple[Hub, ...]) -> None:
        self._model, self.hubs = model, hubs
        self.reduction = model.reduce(model.bulk.space, hubs)
        self.stiffness = Stiffness.reduced(model.stiffness.copy(), self.reduction)

    def motions(self, loads: HubLoads, y: PETSc.Vec) -> dict[Hub, Array]:
        """Motions of hubs, as in their loads, at free unknowns y (collective)."""
        out = prescribed_motions(loads)
        for hub, place in zip(self.hubs, self.reduction.places, strict=True):
            along = self._model.comm.allreduce(float(y.array[place]) if place >= 0 else 0.0)
            out[hub][: self._model.kinematics.dim] += along * unit("free", hub.free)
        return out

    def started(self, loads: HubLoads, motions: Mapping[Hub, Array]) -> dict[Hub, Array]:
        """Motions of hubs that start a step from other motions: as prescribed, and as they were
        along free directions.
        """
        out = prescribed_motions(loads)
        for hub in self.hubs:
            free = unit("free", hub.free)
            out[hub][: len(free)] += (motions[hub][: len(free)] @ free) * free
        return out

    def rows(self, pairing: Interface, matrix: PETSc.Mat, directions: Array) -> PETSc.Mat:
        """Rows of the free unknowns from rows on all dofs of the motion along directions (n, k, c)
        of the primary surfaces of a pairing, k a point, with those of rigid surfaces (collective).
        """
        out = matrix.matMult(self.reduction.matrix)
        for number, hub in enumerate(self.hubs):
            if hub.rigid:
                own = self._model.moved_by(pairing, hub)[:, None]
                values = own * (directions @ unit("free", hub.free))
                out.axpy(1.0, self.reduction.column(number, values.ravel()), DIFFERENT)
        return out

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """Linear cells as the coarse level of a solid of degree 2 (collective)."""
        model = self._model
        return Hierarchy.of(
            model.bulk,
            model.cell_tags,
            model.materials,
            self.reduction,
            lambda space: model.reduce(space, self.hubs),
        )

    @cached_property
    def points(self) -> YieldPoints:
        """Gauss points of the bodies that yield (collective)."""
        model = self._model
        return bulk_points(
            model.bulk,
            model.cell_tags,
            model.materials,
            lambda points: np.ones(len(points), dtype=bool),
            self.reduction,
            model.comm,
        )


def plane_modulus(material: Material) -> float:
    """Modulus E/(1 - nu^2) of a material."""
    return float(material.young_modulus / (1 - material.poisson_ratio**2))
