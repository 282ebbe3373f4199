"""The solution as arrays on rank 0, without mesh or PETSc: all that postprocessing needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.solver import compat
from railhead.solver.space.contact_interface import Gap
from railhead.solver.space.facets import FacetSet, facet_closure, pair
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.system.contact_system import ContactSystem
from railhead.solver.system.solution import PlasticStrain, Solution
from railhead.theory.array_types import Array


@dataclass(frozen=True, kw_only=True)
class ContactFields:
    """Values at q quadrature points on the f facets of the slave's contact surface, in space. Those
    from which the normal misses the other body, or where the exact gap is not finite, are left out.

    points: undeformed position (q, 3), mm.
    weights: area of each point (q,) in the meshed part, mm2: of a plane section times its
        thickness, of a meridian section of the whole turn.
    pressure: contact pressure (q,), MPa.
    indicator: pressure before its negative part is set to zero (q,), MPa.
    gap: gap of the deformed surfaces (q,) along the normals, mm, negative where they overlap.
    normals: (q, 3) outward unit normals of the slave's exact surface.
    facet: (q,) row of `facet_nodes` that belongs to the facet that each point lies on.
    xi: (q, 2) or, in a section, (q, 1) coordinates of each point in the reference facet.
    facet_nodes: (f, k) nodes of each facet as row numbers of `Fields.points`, corners first, basix
        order.
    facing: (f,) whether a whole facet faces the other body.
    """

    points: Array
    weights: Array
    pressure: Array
    indicator: Array
    gap: Array
    normals: Array
    facet: NDArray[np.int64]
    xi: Array
    facet_nodes: NDArray[np.int64]
    facing: NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Fields:
    """Solution at the n nodes of the m cells of the meshed part, in space; a plane section lies in
    its plane. Nodes are those of the displacement: of cells of degree 2 also on edges, in hexahedra
    and quadrilaterals inside faces and cells, too.

    points: undeformed position of the nodes (n, 3), mm.
    displacement: displacement of the nodes (n, 3), mm.
    cells: (m, k) nodes of each cell as row numbers of `points`, basix order.
    body: (m,) tag of the body that each cell belongs to.
    lame: (m, 2) Lame's constants lambda and mu of each cell, MPa.
    cell: 'tetrahedron', 'hexahedron', 'triangle' or 'quadrilateral'.
    degree: polynomial degree of the displacement.
    slave: tag of the body that the contact facets belong to.
    mirrors: unit normals of the symmetry planes x = 0 or y = 0 at which the model was cut, for a
        meridian section that of its axis; the meshed part lies at positive coordinates.
    contact: values at the contact points.
    kinematics: meaning of the mesh coordinates: a solid, plane strain, or a section that is
        revolved.
    plastic_strain: plastic strain in all m cells, zero where it is not followed; None where no body
        yields.
    rubs: whether unlike materials rub: they slip under pressure, and tractions change it.
    master_surface: gap at the nodes of the other contact surface that face the slave; None where
        that body is rigid, and where `gather` leaves it out.
    """

    points: Array
    displacement: Array
    cells: NDArray[np.int64]
    body: NDArray[np.int64]
    lame: Array
    cell: str
    degree: int
    slave: int
    mirrors: tuple[tuple[float, float, float], ...]
    contact: ContactFields
    kinematics: Kinematics = SOLID
    plastic_strain: PlasticStrain | None = None
    rubs: bool = False
    master_surface: MasterSurface | None = None

    @property
    def copies(self) -> int:
        """Number of copies of the meshed part, itself included, that make up the whole model."""
        return self.kinematics.copies(len(self.mirrors))


def gather(model: ContactSystem, solution: Solution, *, facing: bool = True) -> Fields | None:
    """Collect the fields of a solution from all ranks on rank 0; returns None on the other ranks
    (collective). facing: whether `master_surface` is computed.
    """
    comm, space = model.comm, model.bulk.space
    topology = space.mesh.topology
    own_cells = topology.index_map(topology.dim).size_local
    to_global = space.dofmap.index_map.local_to_global
    cell_dofs = compat.cell_dofs(space)[:own_cells]
    cells = np.asarray(to_global(cell_dofs.reshape(-1).astype(np.int32))).reshape(cell_dofs.shape)
    body = np.zeros(own_cells, dtype=np.int64)
    for side in (model.setup.fixed, model.setup.moving):
        members = model.cell_tags.find(side.tag)
        body[members[members < own_cells]] = side.tag

    interface, kinematics = model.interface, model.setup.kinematics
    gap = model.gaps(solution.displacement, solution.approach)
    offset = comm.exscan(len(interface.slave)) or 0

    def collected(**arrays: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """The arrays of all ranks by name, each joined along its first axis on rank 0."""
        return {
            name: np.concatenate(comm.gather(array) or [array]) for name, array in arrays.items()
        }

    nodal = collected(
        points=kinematics.lift(compat.dof_points(space)),
        displacement=kinematics.in_space(solution.displacement.array.reshape(-1, kinematics.dim)),
        cells=cells.astype(np.int64),
        body=body,
        lame=model.bulk.lame[:own_cells],
    )
    contact = collected(
        points=kinematics.lift(interface.points),
        weights=interface.weights,
        pressure=solution.pressure,
        indicator=solution.indicator,
        gap=gap,
        normals=kinematics.in_space(interface.normals),
        facet=interface.facet + offset,
        xi=interface.xi,
        facet_nodes=facet_dofs(interface.slave),
        facing=interface.facing,
    )
    plastic = solution.plastic_strain
    if plastic is not None:
        plastic = PlasticStrain(**collected(strain=plastic.strain, equivalent=plastic.equivalent))
    surface = None
    if facing and interface.master is not None:
        slave, master = interface.slave.gathered(comm), interface.master
        if comm.rank == 0:
            surface = master_surface(
                slave, master, model.setup.gap, nodal["points"], nodal["displacement"]
            )
    if comm.rank:
        return None
    return Fields(
        **nodal,
        cell=compat.cell_type(space.mesh),
        degree=model.setup.degree,
        slave=model.setup.slave,
        mirrors=tuple(normal for _, normal in model.setup.planes),
        contact=ContactFields(**contact),
        kinematics=kinematics,
        plastic_strain=plastic,
        rubs=solution.friction is not None and not model.setup.material_pair.like,
        master_surface=surface,
    )


ITERATIONS = 4  # of the search for the normal that ends at a node
MISS_PER_GAP, MISS_PER_FACET = 0.1, 0.02  # by which that normal may miss, of gap and facet length


@dataclass(frozen=True)
class MasterSurface:
    """Gap at n nodes of the master's contact surface: those of the f facets at each of whose nodes
    a normal of the slave ends. Without such facets n is 0.

    facet_nodes: (f, k) nodes of these facets as row numbers of `Fields.points`, corners first,
        basix order.
    nodes: (n,) all nodes of these facets, as row numbers of `Fields.points`.
    gap: gap between the deformed surfaces along the slave's normal (n,), mm, negative where they
        overlap.
    """

    facet_nodes: NDArray[np.int64]
    nodes: NDArray[np.int64]
    gap: Array


def facet_dofs(facets: FacetSet) -> NDArray[np.int64]:
    """Global block dofs (m, k) that lie on each of m facets, corners first, basix order."""
    closure = facet_closure(facets.cell, facets.degree)
    return np.take_along_axis(facets.dofs, closure[facets.local_facet], axis=1)


def master_surface(
    slave: FacetSet, master: FacetSet, exact: Gap, points: Array, displacement: Array
) -> MasterSurface:
    """Gap g0 + n . (u_master - u_slave) at the nodes of the master that face the slave; n is the
    slave's normal.

    The point of the slave that faces a node is searched by following the normal that the slave has
    at the last guess, four times (ITERATIONS). Nodes for which the normal still misses, or where
    the exact gap is not finite, are left out, and so are facets with such a node.

    slave, master: contact facets of all ranks.
    exact: exact initial gap and the slave's outward normals.
    points: position of all nodes of the mesh in space (n, 3), mm.
    displacement: displacement of these nodes in space (n, 3), mm.
    """
    faces = facet_dofs(master)
    nodes = np.unique(faces)
    kinematics = slave.kinematics
    placed = kinematics.flatten(points[nodes] - np.array(kinematics.offset))
    gap, normals = exact(points[nodes])
    for _ in range(ITERATIONS):
        partner, xi = pair(placed, kinematics.flatten(normals), slave)
        seen = np.isfinite(gap) & (partner >= 0)
        nodes, placed, partner, xi = nodes[seen], placed[seen], partner[seen], xi[seen]
        below = slave.tangents(partner, xi)[0]
        gap, normals = exact(kinematics.lift(below))
    gap = np.where(np.isfinite(gap), gap, np.nan)
    missed = placed - below - gap[:, None] * kinematics.flatten(normals)
    size = np.linalg.norm(slave.vertices[partner, 1] - slave.vertices[partner, 0], axis=1)
    seen = np.linalg.norm(missed, axis=1) < MISS_PER_GAP * gap + MISS_PER_FACET * size
    nodes, gap, normals = nodes[seen], gap[seen], normals[seen]
    partner, xi = partner[seen], xi[seen]
    phi, _ = slave.basis(partner, slave.reference(partner, xi))
    other = np.einsum("nd,ndc->nc", phi, displacement[slave.dofs[partner]])
    moved = np.einsum("nc,nc->n", normals, displacement[nodes] - other)
    faces = faces[np.isin(faces, nodes).all(axis=1)]
    used = np.isin(nodes, faces)
    return MasterSurface(faces, nodes[used], (gap + moved)[used])
