"""What serves all loads of a model: stiffness, supports and surfaces, assembled once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx.fem.petsc import assemble_vector
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.linear import Direct, Preconditioner
from railhead.solver.algebra.multigrid import Hierarchy, PMultigrid
from railhead.solver.algebra.newton import CONVERGED, NewtonResult
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.material import History, assemble, backs
from railhead.solver.model.parts import Body, Contact, Part
from railhead.solver.model.problem import HubLoads, State
from railhead.solver.plasticity.plastic_problem import YieldPoints, bulk_points
from railhead.solver.space.contact_interface import ContactLaw, Interface
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import vector
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
    unit,
)
from railhead.solver.system.contact_system import DIRECT_BELOW
from railhead.solver.system.surfaces import Surfaces
from railhead.theory.array_types import Array, Mask

SECTIONS = (None, "plane strain", "plane stress", "axisymmetric")
ON_AXIS = 1e-9  # radius of a node on the axis, over the largest


class Assembly:
    """A model on its mesh. Its arguments are those of `Model`; raises ValueError as `Model.solve`.

    bulk, stiffness: displacement space, and the stiffness on all dofs.
    surfaces: of all contacts. secondary: material of the secondary body of each.
    law: contact law of all contacts: symmetric, or with theta = 0 where something has friction.
    body_force: on all dofs.
    masks: of each clamp, slide and hub, the nodes of this rank on its facets.
    remembers: whether the answer depends on the way of the loads: with yield or friction.
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
    ) -> None:
        self.comm, self.section = mesh.comm, section
        self.cell_tags, self.facet_tags = cell_tags, facet_tags
        self.kinematics = kinematics
        self.bodies = [each for each in parts if isinstance(each, Body)]
        contacts = [each for each in parts if isinstance(each, Contact)]
        supports = [each for each in parts if isinstance(each, Clamp | Slide | Hub)]
        if not contacts:
            raise ValueError("a model needs a Contact")
        _compatible(contacts, supports)
        self.materials = {each.tag: each.material.material(section) for each in self.bodies}
        if len(self.materials) < len(self.bodies):
            raise ValueError(f"a body is named twice: {[each.tag for each in self.bodies]}")
        for body in self.bodies:
            must_exist("cell", cell_tags, body.tag, self.comm)
        for tag in [each.tag for each in supports] + [tag for c in contacts for tag in c.tags]:
            must_exist("facet", facet_tags, tag, self.comm)
        self.bulk, self.stiffness = assemble(
            mesh, cell_tags, self.materials, degree, self.kinematics
        )
        self.masks = masks(self.bulk.space, facet_tags, supports)
        self.body_force = self._body_force()
        on = [self._bodies_at(each.secondary) for each in contacts]
        for each, found in zip(contacts, on, strict=True):
            if len(found) > 1:
                raise ValueError(
                    f"secondary surface {each.secondary} lies on the bodies {found}: give each of "
                    "them a tag and a Contact"
                )
        self.secondary = [self.materials[found[0]] for found in on]
        suited = [ContactLaw().suited(each.young_modulus, each.lame) for each in self.secondary]
        rubs = any(each.friction for each in contacts)
        self.law = ContactLaw(theta=0 if rubs else min(law.theta or 0 for law in suited))
        factors = [law.gamma_factor for law in suited]
        self.surfaces = Surfaces(contacts, self.bulk, facet_tags, self.comm, factors)
        yields = any(each.hardening for each in self.materials.values())
        self.remembers = yields or rubs
        self._unknowns: dict[tuple[Hub, ...], Unknowns] = {}
        self._factors: tuple[Interface, Unknowns, Direct] | None = None

    def _bodies_at(self, tag: int) -> list[int]:
        """Tags of the bodies that the facets with a tag belong to, in order (collective)."""
        dim, topology = self.kinematics.dim, self.bulk.space.mesh.topology
        topology.create_connectivity(dim - 1, dim)
        links = topology.connectivity(dim - 1, dim).links
        values = dict(zip(self.cell_tags.indices, self.cell_tags.values, strict=True))
        own = {int(values[links(facet)[0]]) for facet in self.facet_tags.find(tag)}
        return sorted(set().union(*self.comm.allgather(own)))

    def _translation(self, hub: Hub) -> PETSc.Vec:
        """Unit translation of the bodies at a hub along its free direction (collective)."""
        own = np.isin(self.cell_tags.values, self._bodies_at(hub.tag))
        free = unit("free", hub.free)
        return vector(
            self.stiffness, translation(self.bulk.space, self.cell_tags.indices[own], free)
        )

    def _body_force(self) -> PETSc.Vec:
        """Forces of the bodies' `force` on all dofs (collective)."""
        mesh, dim = self.bulk.space.mesh, self.kinematics.dim
        out = vector(self.stiffness, np.zeros(self.stiffness.getLocalSize()[0]))
        given = [each for each in self.bodies if each.force is not None]
        if not given:
            return out
        values = np.zeros((len(self.bulk.lame), dim))
        for body in given:
            values[self.cell_tags.find(body.tag)] = np.asarray(body.force, float)
        load = ufl.as_vector([compat.cellwise_constant(mesh, each.copy()) for each in values.T])
        r = ufl.SpatialCoordinate(mesh)[0]
        size = 2 * np.pi * r if self.kinematics.revolved else 1.0
        form = size * ufl.inner(load, ufl.TestFunction(self.bulk.space)) * ufl.dx
        found = assemble_vector(compat.form(form, mesh))
        found.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
        out.array[:] = found.array[: len(out.array)]
        return out

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

    def preconditioner(
        self, problem: ContactProblem, pairing: Interface, loads: HubLoads
    ) -> Preconditioner:
        """Preconditioner of a problem: the last factorisation, where contact points and free hubs
        are the same; p-multigrid for a large solid of degree 2 without friction.
        """
        unknowns, last = self.unknowns(loads), self._factors
        large = unknowns.reduction.unknowns > DIRECT_BELOW[self.kinematics.dim, self.bulk.degree]
        rubs = any(each.friction for each in self.surfaces.contacts)
        if large and self.bulk.degree == 2 and self.kinematics.dim == 3 and not rubs:
            return PMultigrid(problem, unknowns.hierarchy)
        if last is None or last[0] is not pairing or last[1] is not unknowns:
            last = self._factors = pairing, unknowns, Direct(problem)
        last[2].problem = problem
        return last[2]

    def prescribed(self, loads: HubLoads) -> PETSc.Vec:
        """Displacement on all dofs that hubs prescribe."""
        values = np.zeros((len(self.bulk_points), self.kinematics.dim))
        for hub, load in loads.items():
            values[self.masks[hub]] += load[1:]
        return vector(self.stiffness, values)

    def gathered(self, displacement: PETSc.Vec) -> Array:
        """Displacement (nodes, c) at all nodes of all ranks (collective)."""
        every = self.comm.allgather(displacement.array)
        return np.concatenate(every).reshape(-1, self.kinematics.dim)

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
            motion = (pairing.gap * self._translation(hub)).array
            closing -= motion * np.sign(loads[hub][0] or 1.0)
        force = sum(abs(loads[hub][0]) for hub in self._free(loads))

        def touching(number: int, gaps: Array, area: Array) -> int:
            """Number of points that carry the force of all hubs."""
            total, material = np.cumsum(area), self.secondary[number]
            size = np.sqrt(total) if self.kinematics.load_power == 3 else 1.0
            modulus = material.young_modulus / (1 - material.poisson_ratio**2)
            modulus /= len(self.surfaces.contacts[number].tags)
            over = gaps - gaps[0]
            carried = modulus * size * (2 * over - np.cumsum(over * area) / total)
            return int(np.searchsorted(carried, force))

        return pairing.nearest(closing, touching)

    def rest(self) -> State:
        """State without loads, before which there is no history (collective)."""
        moved = np.append(np.nan, np.zeros(self.kinematics.dim))
        zero = {hub: moved for hub in self.masks if isinstance(hub, Hub)}
        u = self.stiffness.createVecLeft()
        u.set(0.0)
        pairing = self.surfaces.pair(self.gathered(u))
        count, size = len(pairing.contact), 3 + len(self.kinematics.shears)
        count_backs = backs(self.materials.values())
        gauss = len(self.unknowns(zero).points.points) if self.remembers else 0
        return State(
            displacement=u,
            loads=zero,
            motions={hub: load[1:] for hub, load in zero.items()},
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


def _compatible(contacts: Sequence[Contact], supports: Sequence[Clamp | Slide | Hub]) -> None:
    """Raise ValueError for a pair of surfaces that is there twice, for facets that are held twice,
    and where nothing holds the bodies.
    """
    pairs = [
        {str(each.secondary), str(each.gap if each.primary is None else each.primary)}
        for each in contacts
    ]
    for contact, pair in zip(contacts, pairs, strict=True):
        if pairs.count(pair) > 1:
            raise ValueError(f"{contact}: these surfaces have a second Contact")
    for part in supports:
        for other in supports:
            along = isinstance(other, Slide) and getattr(part, "slides", False)
            fits = isinstance(part, Slide) or along or part is other
            if part.tag == other.tag and not fits:
                raise ValueError(f"{part}: {other} holds the same facets")
    stays = [each for each in supports if getattr(each, "free", None) is None]
    if not stays and len(supports) < 2 and all(len(each.tags) == 2 for each in contacts):
        raise ValueError("nothing holds the bodies: give a Clamp, a Slide or a second Hub")


def kinematics(mesh: Any, section: str | None, mean: bool) -> Kinematics:
    """Meaning of the mesh's coordinates in a section (collective). Raises ValueError for a mesh
    with another number of coordinates or negative radii, and for an unknown section.
    """
    if section not in SECTIONS:
        raise ValueError(f"section {section!r} is unknown; give one of {SECTIONS}")
    dim = mesh.geometry.dim
    if dim != (3 if section is None else 2):
        raise ValueError(f"section {section!r} does not fit a mesh with {dim} coordinates")
    if dim != mesh.topology.dim:
        cells = mesh.topology.dim
        raise ValueError(f"cells of dimension {cells} need {cells} coordinates each, not {dim}")
    if section is None:
        return replace(SOLID, mean_dilatation=mean)
    revolved = section == "axisymmetric"
    r = mesh.geometry.x[:, 0]
    ends = [float(np.max(each, initial=0.0)) for each in (r, -r)]
    largest, beyond = np.max(mesh.comm.allgather(ends), axis=0)
    if revolved and beyond > ON_AXIS * largest:
        raise ValueError(f"an axisymmetric mesh has r from 0 on, not from {-beyond:.6g}")
    return Kinematics(np.eye(3)[:2], revolved=revolved, mean_dilatation=mean)
