"""What serves all loads of a model: stiffness, supports and surfaces, assembled once."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI
from petsc4py import PETSc
from ufl.algorithms import extract_coefficients

from railhead.solver import compat
from railhead.solver.algebra.linear import Direct, Preconditioner
from railhead.solver.algebra.multigrid import Hierarchy, PMultigrid
from railhead.solver.algebra.newton import CONVERGED, NewtonResult
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import DIFFERENT, Stiffness
from railhead.solver.material import Hardening, History, Material, assemble, backs
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
    cell_values,
)
from railhead.solver.model.problem import HubLoads, State
from railhead.solver.plasticity.plastic_problem import YieldPoints, bulk_points
from railhead.solver.space.contact_interface import ContactLaw, Interface
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import assemble_rows, transposed, vector, weighted_product
from railhead.solver.space.supports import (
    Clamp,
    Hub,
    Reduction,
    Slide,
    finite,
    held,
    masks,
    must_exist,
    reduce,
    translation,
    unit,
)
from railhead.solver.system.contact_system import DIRECT_BELOW
from railhead.solver.system.surfaces import Surfaces, Tie
from railhead.theory.array_types import Array, Mask

SECTIONS = (None, "plane strain", "plane stress", "axisymmetric")
STIFFER = 2.0  # than the primary body, from which on the roles are exchanged (degree 1: + 10 %)
LOCKS = 0.49  # Poisson's ratio from which on cells without mean dilatation are warned of
LEAST_FACETS = {1: 5.0, 2: 1.2}  # on the half width of discs, of a degree: below, pressures are off
# by a tenth and more
FLAT, ALL = 1e-6, 0.9  # range of the gap over a facet, and share of points, of contacts at once
ON_AXIS = 1e-9  # radius of a node on the axis, over the largest


class Assembly:
    """A model on its mesh. Its arguments are those of `Model`; raises ValueError as `Model.solve`.

    bulk, stiffness: displacement space, and the stiffness on all dofs.
    contacts: as they were given. surfaces: of all contacts, with the roles that are solved.
    secondary: material of the secondary body of each.
    law: contact law of all contacts: symmetric, or with theta = 0 where something has friction.
    body_force: of bodies and loaded facets, on all dofs, with that of thermal strain.
    thermal: stress (cells,) that thermal strain has where it is held, of all local cells.
    springs: stiffness of each spring on all dofs.
    masks: of each clamp, slide and hub, the nodes of this rank on its facets.
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
        _compatible(contacts, supports, any(isinstance(each, Spring) for each in parts))
        tags = [each.tag for each in self.bodies]
        if len(set(tags)) < len(tags):
            raise ValueError(f"a body is named twice: {tags}")
        for tag in tags:
            must_exist("cell", cell_tags, tag, self.comm)
        loads = [each for each in parts if isinstance(each, Pressure | Traction | Spring)]
        for tag in [e.tag for e in supports + loads] + [tag for c in contacts for tag in c.tags]:
            must_exist("facet", facet_tags, tag, self.comm)
        self.energies = self._energies(u, degree, contacts)
        self.materials = self._materials()
        self.bulk, self.stiffness = assemble(
            *(mesh, cell_tags, self.materials, degree, self.kinematics),
            space=None if u is None else u.function_space,
        )
        self.masks = masks(self.bulk.space, facet_tags, supports)
        self.thermal = self._thermal()
        self.body_force = self._body_force()
        self.springs: dict[Spring, PETSc.Mat] = {}
        for load in loads:
            self._load(load)
        self.stiffness = self._sprung(self.stiffness)
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
        """A contact whose secondary body is not the stiffer one by far, or a gap is given for it
        (collective). Nitsche's parameter goes with the stiffness of the secondary body: beside a
        soft one its pressure would be that of the mesh (ten times as stiff, degree 1: + 35 %).
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

    def coarse(self, pairing: Interface, pressure: Array) -> None:
        """Warn of contacts that touch on a part of a curved surface with too few facets from the
        largest pressure to the edge (collective); pressure: at the points (n,).
        """
        on = pressure > 0
        size = np.bincount(pairing.facet, pairing.weights)[pairing.facet[on]]
        size = size / self.kinematics.measure(pairing.points[on])
        found = pairing.contact[on], pressure[on], size, pairing.initial_gap[on], pairing.points[on]
        every = [np.concatenate(parts) for parts in zip(*self.comm.allgather(found), strict=True)]
        least, dim = LEAST_FACETS[self.bulk.degree], self.kinematics.dim
        for number in np.unique(every[0]):
            p, sizes, gap, x = (each[every[0] == number] for each in every[1:])
            length = float(np.mean(sizes)) ** (1 / (dim - 1))
            facets = np.linalg.norm(x - x[p.argmax()], axis=1).max() / length
            whole = self.comm.allreduce(int((pairing.contact == number).sum()))
            tied = isinstance(self.contacts[number], Tie)
            if not tied and facets < least and np.ptp(gap) > FLAT * length and len(p) < ALL * whole:
                self.warn(
                    f"contact {number} has {facets:.1f} facets from its largest pressure to its "
                    f"edge: with less than {least} its pressure may be off by a tenth"
                )

    def _materials(self) -> dict[int, Material]:
        """Material of each body by its tag (collective). Raises ValueError on all ranks for values
        that it may not have.
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

    def _thermal(self) -> Array:
        """Stress (cells,) by which thermal strain e lowers the normal stresses of the elastic law:
        (3 lambda + 2 mu) e or, in plane stress, (2 lambda + 2 mu) e of its constants.
        """
        lam, mu = self.bulk.lame.T
        out = np.zeros(len(lam))
        for body in self.bodies:
            cells = self.cell_tags.find(body.tag)
            given = cell_values("thermal_strain", body.thermal_strain, cells)
            out[cells] = finite(f"Body {body.tag}", "thermal_strain", given, *np.shape(given))
        return np.asarray(out * ((2 if self.section == "plane stress" else 3) * lam + 2 * mu))

    def thermal_at(self, pairing: Interface) -> Array:
        """The stress of `_thermal` at contact points of this rank (n,)."""
        return self.thermal[pairing.slave.numbers[pairing.facet]]

    def _load(self, load: Pressure | Traction | Spring) -> None:
        """Add a load of facets to the forces, or a spring to the foundations (collective). Raises
        ValueError for values that do not fit.
        """
        dim, space = self.kinematics.dim, self.bulk.space
        facets = FacetSet.on(self.bulk, self.facet_tags.find(load.tag))
        at, weights = facets.quadrature(2 * self.bulk.degree + 2)
        x, tangents = facets.tangents(*at)
        every = np.tile(np.eye(dim), (len(x), 1, 1))
        total = self.comm.allreduce(self.stiffness.getLocalSize()[0])
        local = dim * space.dofmap.index_map.size_local
        rows = assemble_rows([facets.rows_at(*at, every)], dim * len(x), local, total, self.comm)
        if isinstance(load, Spring):
            each = weights[:, None] * _at_points(load, "stiffness", load.stiffness, x, dim)
            if self.comm.allreduce(int((each < 0).sum())):
                raise ValueError(f"{load}: stiffness must not be negative")
            self.springs[load] = weighted_product(rows, each.ravel(), rows)
            return
        if isinstance(load, Pressure):
            value = _at_points(load, "value", load.value, x, 1)
            values = -value * facets.normals(at[0], tangents)
        else:
            values = _at_points(load, "vector", load.vector, x, dim)
        self.body_force.axpy(1.0, transposed(rows, (weights[:, None] * values).ravel()))

    def _sprung(self, stiffness: PETSc.Mat) -> PETSc.Mat:
        """Stiffness on all dofs with that of the springs (collective)."""
        if not self.springs:
            return stiffness
        matrix = stiffness.convert("aij")
        for each in self.springs.values():
            matrix.axpy(1.0, each, DIFFERENT)
        matrix.setBlockSize(self.kinematics.dim)
        matrix = matrix.convert("baij")
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return matrix

    def spring_force(self, spring: Spring, displacement: PETSc.Vec) -> Array:
        """Force (c,) of a spring on the bodies (collective)."""
        nodal = (self.springs[spring] * displacement).array.reshape(-1, self.kinematics.dim)
        return np.asarray(self.comm.allreduce(-nodal.sum(axis=0)))

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
        hot = self.comm.allreduce(bool(self.thermal.any()), op=MPI.LOR)
        if not given and not hot:
            return out
        values = np.zeros((len(self.bulk.lame), dim))
        v, more = ufl.TestFunction(self.bulk.space), 0
        for body in given:
            cells = self.cell_tags.find(body.tag)
            if hasattr(body.force, "ufl_shape"):
                inside = np.zeros(len(values))
                inside[cells] = 1.0
                more += compat.cellwise_constant(mesh, inside) * ufl.inner(body.force, v)
            else:
                values[cells] = np.asarray(body.force, float)
        load = ufl.as_vector([compat.cellwise_constant(mesh, each.copy()) for each in values.T])
        r = ufl.SpatialCoordinate(mesh)[0]
        revolved = self.kinematics.revolved
        if hot:
            swells = self.kinematics.dilatation(v, r) if revolved else ufl.div(v)
            more += compat.cellwise_constant(mesh, self.thermal) * swells
        form = (2 * np.pi * r if revolved else 1.0) * (ufl.inner(load, v) + more) * ufl.dx
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
        bonds = rubs or self.springs
        if large and self.bulk.degree == 2 and self.kinematics.dim == 3 and not bonds:
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

    def tangent(self, displacement: PETSc.Vec) -> tuple[PETSc.Mat, PETSc.Vec]:
        """Stiffness of bodies and springs at a displacement, and the forces that this needs, on all
        dofs (collective).
        """
        if self.energies is None:
            return self.stiffness, self.stiffness * displacement
        tangent, forces = self.energies.linear(displacement)
        for each in self.springs.values():
            forces.axpy(1.0, each * displacement)
        return self._sprung(tangent), forces

    def pair(self, displacement: PETSc.Vec) -> Interface:
        """Contact points at a displacement, see `Surfaces.pair` (collective)."""
        every = self.gathered(displacement)
        face = self.surfaces.pair(every)
        return self.energies.deformed(face, displacement, every) if self.energies else face

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
            modulus = plane_modulus(material) / len(self.surfaces.contacts[number].tags)
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
        pairing = self.pair(u)
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


def plane_modulus(material: Material) -> float:
    """Modulus E/(1 - nu^2) of a material."""
    return float(material.young_modulus / (1 - material.poisson_ratio**2))


def _compatible(
    contacts: Sequence[Contact], supports: Sequence[Clamp | Slide | Hub], springs: bool
) -> None:
    """Raise ValueError for a pair of surfaces that is there twice, for facets that are held twice,
    and where nothing holds the bodies; springs: whether there are some.
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
    held = stays or len(supports) > 1 or springs
    if not held and all(len(each.tags) == 2 for each in contacts):
        raise ValueError("nothing holds the bodies: give a Clamp, a Slide or a second Hub")


def _at_points(load: Any, name: str, given: Any, x: Array, size: int) -> Array:
    """Values (n, size) of a load's attribute at points (n, c), from a number, a vector or a
    function of points. Raises ValueError for others, and for what is not finite.
    """
    values = np.asarray(given(x) if callable(given) else given)
    if size == 1:
        values = values[..., None]
    if values.shape == (size,) or (not values.shape and name == "stiffness"):
        values = np.broadcast_to(values, (len(x), size))
    right = values.shape == (len(x), size) and values.dtype.kind in "iuf"
    if not right or not np.isfinite(values).all():
        raise ValueError(f"{load}: {name} must be finite, {size} number(s) at each point")
    return values


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
