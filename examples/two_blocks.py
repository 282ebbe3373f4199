"""A block with a round face on a flat one: contact on a mesh of your own, under a given load.

The lower block stands on its bottom. A rigid hub on the top of the upper block pushes it down with
5 kN; how far it moves is an unknown. The lower face of the upper block is that of a ball of radius
500 mm, so Hertz's formula is an answer to compare with. A quarter is meshed; the cells are curved
hexahedra. Needs dolfinx, gmsh and this package. Run it: python examples/two_blocks.py
"""

from mpi4py import MPI  # first: dolfinx of PyPI finds MPI by it

# isort: split
import gmsh
import matplotlib.pyplot as plt
import numpy as np

import railhead.solver as rs

LOAD, RADIUS, SIZE = 5000.0, 500.0, 12.0  # N, mm, mm: half width and height of a block
CELLS, GROWTH = 8, 1.3  # along each edge, and of each over the last one
STEEL = rs.Elastic(207000.0, 0.3)  # Young's modulus in MPa, Poisson's ratio
# Hertz, 1/E* = 2 (1 - nu^2)/E: Johnson, Contact Mechanics (1985), equations 4.22 and 4.24
MODULUS = STEEL.young_modulus / (2 * (1 - STEEL.poisson_ratio**2))
A = (3 * LOAD * RADIUS / (4 * MODULUS)) ** (1 / 3)  # mm
P0 = 3 * LOAD / (2 * np.pi * A**2)  # MPa


def two_blocks():
    """A quarter of bodies 1 and 2: facets 10 + body touch, 30 and 31 are symmetry planes."""
    gmsh.initialize(["", "-v", "0"])
    model, occ = gmsh.model, gmsh.model.occ
    lower, block = (occ.addBox(0, 0, z, SIZE, SIZE, SIZE) for z in (-SIZE, 0))
    ball = occ.addSphere(0, 0, RADIUS, RADIUS)
    occ.rotate([(3, ball)], 0, 0, RADIUS, 1, 0, 0, np.pi / 2)  # its poles are no place to mesh
    upper = occ.intersect([(3, block)], [(3, ball)])[0][0][1]
    occ.synchronize()
    tags = {}
    for body, volume in ((1, lower), (2, upper)):
        model.addPhysicalGroup(3, [volume], body)
        for _, face in model.getBoundary([(3, volume)], oriented=False):
            x0, y0, z0, x1, y1, z1 = model.getBoundingBox(2, face)
            touches = z1 - z0 < 1 and abs(z0) < 1
            names = {30: x1 < 1e-3, 31: y1 < 1e-3, 10 + body: touches, 20 + body: z1 - z0 < 1}
            tags.setdefault(next((tag for tag, here in names.items() if here), 0), []).append(face)
    for tag, faces in tags.items():
        model.addPhysicalGroup(2, faces, tag)
    every = [(2, face) for faces in tags.values() for face in faces]
    for _, curve in model.getBoundary(every, combined=False, oriented=False):
        ends = model.getBoundary([(1, curve)], combined=False)
        inner, outer = (np.linalg.norm(model.getValue(0, abs(point), [])) for _, point in ends)
        grows = GROWTH if inner < outer else 1 / GROWTH
        model.mesh.setTransfiniteCurve(curve, CELLS + 1, coef=grows)
    for dim, face in every:
        model.mesh.setTransfiniteSurface(face)
        model.mesh.setRecombine(dim, face)
    for volume in (lower, upper):
        model.mesh.setTransfiniteVolume(volume)
    model.mesh.generate(3)
    model.mesh.setOrder(2)
    found = rs.model_to_mesh(model, MPI.COMM_WORLD, 3)
    gmsh.finalize()
    return found


model = rs.Model(*two_blocks())
model.add(rs.Body(1, STEEL), rs.Body(2, STEEL), rs.Contact(secondary=11, primary=12))
model.add(rs.Slide(30, normal=(1, 0, 0)), rs.Slide(31, normal=(0, 1, 0)), rs.Clamp(21))
top = model.add(rs.Hub(22, free=(0, 0, -1)))
solution = model.solve({top: rs.Force(LOAD / 4)})  # of the quarter

radius, p = np.linalg.norm(solution.points[:, :2], axis=1), solution.pressure
print(f"converged: {solution.converged}, in {len(solution.history)} Newton steps")
print(f"pressure near the axis {p[radius.argmin()]:.1f} MPa, Hertz {P0:.1f} MPa")
print(f"largest pressure {p.max():.1f} MPa")
r = np.linspace(0, A, 200)
plt.plot(radius, p, ".", label="finite elements")
plt.plot(r, P0 * np.sqrt(1 - (r / A) ** 2), label="Hertz")
plt.gca().set(xlim=(0, 2 * A), xlabel="distance from the axis, mm", ylabel="pressure, MPa")
plt.legend()
plt.savefig("two_blocks.png")
