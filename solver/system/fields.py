"""The solution as arrays on rank 0, without mesh or PETSc: all that postprocessing needs."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.solver import compat
from railhead.solver.space.cells import CellSet
from railhead.solver.space.facets import FacetSet, facet_closure
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

    @property
    def copies(self) -> int:
        """Number of copies of the meshed part, itself included, that make up the whole model."""
        return self.kinematics.copies(len(self.mirrors))


def gather(model: ContactSystem, solution: Solution) -> Fields | None:
    """Collect the fields of a solution from all ranks on rank 0; returns None on the other ranks
    (collective).
    """
    comm, cells = model.comm, CellSet.owned(model.bulk)
    interface, kinematics = model.interface, model.setup.kinematics
    gap = model.gaps(solution.displacement, solution.approach)
    offset = comm.exscan(len(interface.slave)) or 0

    def collected(**arrays: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """The arrays of all ranks by name, each joined along its first axis on rank 0."""
        return {
            name: np.concatenate(comm.gather(array) or [array]) for name, array in arrays.items()
        }

    nodal = collected(
        points=kinematics.lift(compat.dof_points(model.bulk.space)),
        displacement=kinematics.in_space(solution.displacement.array.reshape(-1, kinematics.dim)),
        cells=cells.dofs,
        body=cells.tags(model.cell_tags).astype(np.int64),
        lame=cells.lame,
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
    if comm.rank:
        return None
    return Fields(
        **nodal,
        cell=cells.cell,
        degree=model.setup.degree,
        slave=model.setup.slave,
        mirrors=tuple(normal for _, normal in model.setup.planes),
        contact=ContactFields(**contact),
        kinematics=kinematics,
        plastic_strain=plastic,
        rubs=solution.friction is not None and not model.setup.material_pair.like,
    )


def facet_dofs(facets: FacetSet) -> NDArray[np.int64]:
    """Global block dofs (m, k) that lie on each of m facets, corners first, basix order."""
    closure = facet_closure(facets.cell, facets.degree)
    return np.take_along_axis(facets.dofs, closure[facets.local_facet], axis=1)
