"""The cord of a rubber seal between two plates, squeezed by 25 %.

A quarter of the section of the cord is meshed, from its middle down, in plane strain, with a
neo-Hookean energy. The middle is pushed down on a rigid plate by half of the squeeze. For small
strain Johnson, Contact Mechanics (1985), equation 5.57, has the squeeze of a force.
Run it: python examples/own_mesh_seal.py
"""

from mpi4py import MPI  # first: dolfinx of PyPI finds MPI by it

# isort: split
import gmsh
import numpy as np
import ufl

import railhead.solver as rs

D, E, NU, SQUEEZE = 5.0, 6.0, 0.49, 0.25  # mm, MPa


def cord():
    """Mesh and tags of a quarter of the cord: surface 10, middle 20, symmetry 30."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    box = occ.addRectangle(0, -D, 0, D, D)
    occ.intersect([(2, occ.addDisk(0, 0, 0, D / 2, D / 2))], [(2, box)])
    occ.synchronize()
    (body,) = gmsh.model.getEntities(2)
    gmsh.model.addPhysicalGroup(2, [body[1]], 1)
    for _, curve in gmsh.model.getBoundary([body], oriented=False):
        x0, y0, _, x1, y1, _ = gmsh.model.getBoundingBox(1, curve)
        tag = 20 if y1 - y0 < 1e-3 else 30 if x1 - x0 < 1e-3 else 10
        gmsh.model.addPhysicalGroup(1, [curve], tag)
    gmsh.option.setNumber("Mesh.MeshSizeMax", D / 30)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    found = rs.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 2)
    gmsh.finalize()
    return found


model = rs.Model(*cord(), section="plane strain")
F = ufl.Identity(2) + ufl.grad(model.u)
mu, lam = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
log = ufl.ln(ufl.det(F))
psi = mu / 2 * (ufl.tr(F.T * F) - 2 - 2 * log) + lam / 2 * log**2
model.add(rs.Body(1, rs.Energy(psi)), rs.Slide(30, normal=(1, 0)))
model.add(rs.Contact(secondary=10, primary=rs.Plane((0, -D / 2), (0, 1))))
middle = model.add(rs.Hub(20, free=(0, -1), slides=True))
solution = model.solve()
for squeeze in np.linspace(0, SQUEEZE, 6)[1:]:
    solution = solution.then({middle: rs.Move((0, -squeeze * D / 2))})
    force = 2 * solution.force(middle)
    compliance = 2 * force * (1 - NU**2) / (np.pi * E)
    half_width = np.sqrt(compliance * D)
    johnson = compliance * (2 * np.log(2 * D / half_width) - 1) / D
    text = f"squeeze {squeeze:.2f} (small strain {johnson:.4f}): {force:.3f} N/mm"
    if not MPI.COMM_WORLD.rank:
        print(f"{text}, largest pressure {solution.pressure.max():.3f} MPa")
