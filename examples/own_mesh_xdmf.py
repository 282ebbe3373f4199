"""Three bricks from bricks.xdmf, with tags of cells and facets, pressed on each other with 100 N.

docs/solver.md writes the file. Run it: mpirun -n 2 python examples/own_mesh_xdmf.py
"""

from mpi4py import MPI  # first: dolfinx of PyPI finds MPI by it

# isort: split
from dolfinx.io import XDMFFile

import railhead.solver as rs


def main() -> None:
    """Read, solve and print, on any number of processes."""
    comm = MPI.COMM_WORLD
    with XDMFFile(comm, "bricks.xdmf", "r") as file:
        mesh = file.read_mesh()
        for dim in (2, 3):
            mesh.topology.create_entities(dim)
            mesh.topology.create_connectivity(dim, 3)
        cell_tags = file.read_meshtags(mesh, name="cells")
        facet_tags = file.read_meshtags(mesh, name="facets")

    model = rs.Model(mesh, cell_tags, facet_tags, degree=1)
    for body in (1, 2, 3):
        model.add(rs.Body(body, rs.Elastic(1000, 0.3)))
        model.add(rs.Slide(10 * body + 2, normal=(0, 1, 0)))
        model.add(rs.Slide(10 * body + 3, normal=(1, 0, 0)))
    model.add(rs.Contact(secondary=21, primary=30), rs.Contact(secondary=20, primary=11))
    floor = model.add(rs.Slide(10, normal=(0, 0, 1)))
    plate = model.add(rs.Hub(31, free=(0, 0, -1), slides=True))
    solution = model.solve({plate: rs.Force(100)})

    low = comm.allreduce(float(min(solution.pressure, default=1e9)), op=MPI.MIN)
    high = comm.allreduce(float(max(solution.pressure, default=0.0)), op=MPI.MAX)
    if comm.rank == 0:
        print(f"{comm.size} processes: pressure {low:.2f} to {high:.2f} MPa")
        print(f"floor {solution.force(floor)[2]:.2f} N")


if __name__ == "__main__":
    main()
