"""The solution as plain arrays on rank 0: all that postprocessing needs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from railhead.solver import compat
from railhead.solver.contact import ContactModel
from railhead.solver.interface.master_surface import Opposite, opposite, outer_nodes
from railhead.solver.solution import Plastic, Solution
from railhead.solver.space.cells import Array
from railhead.solver.space.kinematics import SOLID, Kinematics


@dataclass(frozen=True)
class ContactFields:
    """q quadrature points on f facets of the slave's contact surface, in space.

    points (q, 3) mm; weights (q,) mm2; pressure (q,) MPa; indicator (q,) MPa, the pressure before
    its negative part is cut off; gap (q,) mm, negative where the surfaces overlap; normals (q, 3)
    outwards from the slave; facet (q,) and xi (q, 2 or 1) place them;
    facet_nodes (f, k): nodes of each facet in `Fields.points`, corners first, basix order.
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


@dataclass(frozen=True)
class Fields:
    """n nodes, m cells of the modelled part, in space (a section lies in its plane).

    points (n, 3), displacement (n, 3) mm; cells (m, k) nodes in basix order; body (m,) cell tag;
    lame (m, 2) MPa; cell: see `compat.cell_type`; degree of the displacement; slave: tag of the
    body the contact facets belong to; mirrors: normals of the symmetry planes through x = 0 or
    y = 0 at which the model was cut; kinematics: what a section stands for; plastic: of the cells,
    None where nothing yields; opposite: the other contact surface, None where it is rigid.
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
    plastic: Plastic | None = None
    opposite: Opposite | None = None

    def among(self, chosen: NDArray[np.bool_]) -> Fields:
        """The same with some of the cells (m,) alone."""
        plastic = self.plastic
        if plastic is not None:
            plastic = Plastic(plastic.strain[chosen], plastic.equivalent[chosen])
        return replace(
            self, cells=self.cells[chosen], body=self.body[chosen], lame=self.lame[chosen],
            plastic=plastic,
        )  # fmt: skip


def gather(model: ContactModel, solution: Solution) -> Fields | None:
    """Collect on rank 0; None elsewhere (collective)."""
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
    gathered = [
        _to_root(comm, array)
        for array in (
            kinematics.lift(compat.dof_points(space)),
            kinematics.in_space(solution.displacement.array.reshape(-1, kinematics.dim)),
            cells,
            body,
            model.bulk.lame[:own_cells],
            kinematics.lift(interface.points),
            interface.weights,
            solution.pressure,
            solution.indicator,
            gap,
            kinematics.in_space(interface.normals),
            interface.facet + offset,
            interface.xi,
            outer_nodes(interface.slave),
        )
    ]
    plastic = solution.plastic
    if plastic is not None:
        strain, equivalent = (_to_root(comm, a) for a in (plastic.strain, plastic.equivalent))
        plastic = Plastic(strain, equivalent)
    slave, master = interface.slave.gathered(comm), interface.master
    master = None if master is None else master.gathered(comm)
    if comm.rank:
        return None
    points, displacement, cells, body, lame = gathered[:5]
    facing = None
    if master is not None:
        facing = opposite(slave, master, model.setup.gap, points, displacement)
    return Fields(
        points,
        displacement,
        cells.astype(np.int64),
        body,
        lame,
        compat.cell_type(space.mesh),
        model.setup.degree,
        model.setup.slave,
        tuple(normal for _, normal in model.setup.planes),
        ContactFields(*gathered[5:]),
        kinematics,
        plastic,
        facing,
    )


def _to_root(comm: MPI.Intracomm, array: NDArray[Any]) -> NDArray[Any]:
    parts = comm.gather(np.ascontiguousarray(array))
    return np.concatenate(parts) if parts is not None else array
