"""Two steel blocks in contact, by Nitsche's method, on a mesh of your own, under a given load.

The lower block stands on its bottom face. A rigid hub on the top face of the upper block pushes it
down with 5 kN; how far it moves is an unknown. Between the blocks is the gap of a ball of radius
500 mm on a plane, so Hertz's formula is an answer to compare with. Needs dolfinx and this package;
wheels and rails do not occur. Run it: python examples/two_blocks.py
"""

import math

import matplotlib.pyplot as plt
import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from railhead.solver import compat
from railhead.solver.contact import ContactModel
from railhead.solver.material.elasticity import Material
from railhead.solver.system.setup import ContactBody, Setup

LOAD, RADIUS, SIZE = 5000.0, 500.0, 12.0  # N, mm, mm: half width and height of a block
STEEL = Material(207000.0, 0.3)  # Young's modulus in MPa, Poisson's ratio
LOWER, UPPER = 1, 2  # tags of the cells of each body
CONTACT, SUPPORT, PLANE_X, PLANE_Y = 10, 20, 30, 31  # of facets: CONTACT + body, SUPPORT + body


def ball_gap(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gap (n,) in mm and outward unit normal (n, 3) of the lower face at its points (n, 3)."""
    gap = (points[:, 0] ** 2 + points[:, 1] ** 2) / (2 * RADIUS)
    return gap, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def two_blocks(cells: int = 12):
    """A quarter of both blocks, which share no node, with the tags of its cells and facets.

    cells: along each edge of a block. They are smaller towards the contact. Faces of different
    meshes may meet as well; then the pressure at single points scatters more.
    """
    boxes = [
        mesh.create_box(MPI.COMM_SELF, corners, [n, n, n], mesh.CellType.hexahedron)
        for corners, n in (([[0, 0, -1], [1, 1, 0]], cells), ([[0, 0, 0], [1, 1, 1]], cells))
    ]
    points = np.concatenate([box.geometry.x for box in boxes])
    points = SIZE * np.sign(points) * np.abs(points) ** 1.5
    nodes = [compat.cell_nodes(box) for box in boxes]
    nodes[1] = nodes[1] + len(boxes[0].geometry.x)
    if MPI.COMM_WORLD.rank > 0:  # the first process gives the mesh, dolfinx distributes it
        nodes, points = [np.empty((0, 8))], np.empty((0, 3))
    both = compat.straight_mesh(MPI.COMM_WORLD, np.concatenate(nodes), points, "hexahedron")

    cell_map = both.topology.index_map(3)
    every = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    body = np.where(mesh.compute_midpoints(both, 3, every)[:, 2] < 0, LOWER, UPPER)
    both.topology.create_connectivity(2, 3)
    outer = mesh.exterior_facet_indices(both.topology)
    cell_of = both.topology.connectivity(2, 3)
    facet = body[[cell_of.links(f)[0] for f in outer]]
    x, y, z = np.abs(mesh.compute_midpoints(both, 2, outer)).T
    places = [x < 1e-9, y < 1e-9, z < 1e-9, z > SIZE - 1e-9]
    facet = np.select(places, [PLANE_X, PLANE_Y, CONTACT + facet, SUPPORT + facet], 0)
    return (
        both,
        mesh.meshtags(both, 3, every, body.astype(np.int32)),
        mesh.meshtags(both, 2, outer, facet.astype(np.int32)),
    )


def solve():
    """Contact points (n, 3) in mm and pressure (n,) in MPa of all processes, and the solution."""
    setup = Setup(
        fixed=ContactBody(LOWER, CONTACT + LOWER, SUPPORT + LOWER, STEEL),
        moving=ContactBody(UPPER, CONTACT + UPPER, SUPPORT + UPPER, STEEL),
        slave=LOWER,
        gap=ball_gap,
        degree=2,
        planes=((PLANE_X, (1.0, 0.0, 0.0)), (PLANE_Y, (0.0, 1.0, 0.0))),  # of symmetry
    )
    model = ContactModel(*two_blocks(), setup)
    near = np.linalg.norm(model.interface.points, axis=1) < 2.0  # where the iterations start from
    solution = model.solve(load=LOAD, active=near)
    parts = MPI.COMM_WORLD.allgather((model.interface.points, solution.pressure))
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
    print(f"{solution.load:.6g} N in {len(solution.newton.history)} Newton steps")
    radius = np.linalg.norm(points[:, :2], axis=1)
    print(f"pressure near the axis {pressure[radius.argmin()]:.1f} MPa, Hertz {p0:.1f} MPa")
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
