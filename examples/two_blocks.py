"""A block with a round face on a flat one: contact on a mesh of your own, under a given load.

The lower block stands on its bottom. A rigid hub on the top of the upper block pushes it down with
5 kN; how far it moves is an unknown. The lower face of the upper block is that of a ball of radius
500 mm, so Hertz's formula is an answer to compare with. A quarter is meshed; the cells are curved
hexahedra. Needs dolfinx and this package. Run it: python examples/two_blocks.py
"""

import math

from mpi4py import MPI  # first: dolfinx of PyPI finds MPI by it

# isort: split
import matplotlib.pyplot as plt
import numpy as np
from dolfinx import mesh

import railhead.solver as rs
from railhead.solver import compat

LOAD, RADIUS, SIZE = 5000.0, 500.0, 12.0  # N, mm, mm: half width and height of a block
STEEL = rs.Elastic(207000.0, 0.3)  # Young's modulus in MPa, Poisson's ratio
LOWER, UPPER = 1, 2  # tags of the cells of each body
CONTACT, SUPPORT, PLANE_X, PLANE_Y = 10, 20, 30, 31  # of facets: CONTACT + body, SUPPORT + body
FINE, NEAR, COARSE = 6, 3.3, [4.2, 5.4, 7.0, 9.2, SIZE]  # cells to 3.3 mm, and the ends of others


def two_blocks(radius: float = RADIUS):
    """A quarter of both blocks, which share no node, with the tags of its cells and facets.

    radius: of the lower face of the upper block, mm; infinite: both faces are flat.
    """
    ends = np.concatenate([np.linspace(0, NEAR, FINE + 1), COARSE])
    count, nodes, points = len(ends) - 1, [], []
    for low, high in (([0, 0, -1], [1, 1, 0]), ([0, 0, 0], [1, 1, 1])):
        box = mesh.create_box(MPI.COMM_SELF, [low, high], [count] * 3, mesh.CellType.hexahedron)
        space = compat.vector_space(box, 2)  # its points: corners, and middles of edges and faces
        x = compat.dof_points(space)
        nodes.append(compat.cell_dofs(space) + sum(map(len, points)))
        points.append(np.sign(x) * np.interp(np.abs(x), np.arange(count + 1) / count, ends))
    points[1][:, 2] += (points[1][:, :2] ** 2).sum(axis=1) / (2 * radius)
    cells, x = np.concatenate(nodes), np.concatenate(points)
    if MPI.COMM_WORLD.rank > 0:  # the first process gives the mesh, dolfinx distributes it
        cells, x = cells[:0], x[:0]
    both = compat.cells_mesh(MPI.COMM_WORLD, cells, x, "hexahedron", degree=2)

    cell_map = both.topology.index_map(3)
    every = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    body = np.where(mesh.compute_midpoints(both, 3, every)[:, 2] < 0, LOWER, UPPER)
    both.topology.create_connectivity(2, 3)
    outer = mesh.exterior_facet_indices(both.topology)
    cell_of = both.topology.connectivity(2, 3)
    facet = body[[cell_of.links(f)[0] for f in outer]]
    x, y, z = np.abs(mesh.compute_midpoints(both, 2, outer)).T
    places = [x < 1e-9, y < 1e-9, z < 0.5, z > SIZE - 1e-9]
    facet = np.select(places, [PLANE_X, PLANE_Y, CONTACT + facet, SUPPORT + facet], 0)
    return (
        both,
        mesh.meshtags(both, 3, every, body.astype(np.int32)),
        mesh.meshtags(both, 2, outer, facet.astype(np.int32)),
    )


def solve(radius: float = RADIUS, gap=None):
    """Contact points (n, 3) in mm and pressure (n,) in MPa of all processes, and the solution.

    radius: as of `two_blocks`. gap: a function of it, see `rs.Contact`; None: from the mesh.
    """
    model = rs.Model(*two_blocks(radius))
    model.add(rs.Body(LOWER, STEEL), rs.Body(UPPER, STEEL))
    model.add(rs.Contact(secondary=CONTACT + LOWER, primary=CONTACT + UPPER, gap=gap))
    model.add(rs.Slide(PLANE_X, normal=(1, 0, 0)), rs.Slide(PLANE_Y, normal=(0, 1, 0)))
    model.add(rs.Clamp(SUPPORT + LOWER))
    top = model.add(rs.Hub(SUPPORT + UPPER, free=(0, 0, -1)))
    solution = model.solve({top: rs.Force(LOAD / 4)})  # of the quarter
    parts = MPI.COMM_WORLD.allgather((solution.points, solution.pressure))
    points, pressure = (np.concatenate(each) for each in zip(*parts, strict=True))
    return points, pressure, solution


def hertz() -> tuple[float, float]:
    """Radius of the patch (mm) and largest pressure (MPa) of a ball between half-spaces.

    a = (3 F R / 4 E*)^(1/3), p0 = 3 F / (2 pi a^2), 1/E* = 2 (1 - nu^2)/E: Johnson, Contact
    Mechanics (1985), equations 4.22 and 4.24.
    """
    modulus = STEEL.young_modulus / (2 * (1 - STEEL.poisson_ratio**2))
    a = (3 * LOAD * RADIUS / (4 * modulus)) ** (1 / 3)
    return a, 3 * LOAD / (2 * math.pi * a**2)


def main() -> None:
    """Solve, print and draw the pressure over the distance from the axis."""
    points, pressure, solution = solve()
    a, p0 = hertz()
    if MPI.COMM_WORLD.rank > 0:
        return
    radius = np.linalg.norm(points[:, :2], axis=1)
    print(f"converged: {solution.converged}, in {len(solution.history)} Newton steps")
    print(f"pressure near the axis {pressure[radius.argmin()]:.1f} MPa, Hertz {p0:.1f} MPa")
    print(f"largest pressure {pressure.max():.1f} MPa")
    r = np.linspace(0, a, 200)
    plt.plot(radius, pressure, ".", label="finite elements")
    plt.plot(r, p0 * np.sqrt(1 - (r / a) ** 2), label="Hertz")
    plt.xlim(0, 2 * a)
    plt.xlabel("distance from the axis, mm")
    plt.ylabel("pressure, MPa")
    plt.legend()
    plt.savefig("two_blocks.png")


if __name__ == "__main__":
    main()
