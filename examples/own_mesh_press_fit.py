"""A hot ring shrinks on a shaft and is pulled off it.

On a solid shaft of its own length the ring would have Lame's pressure E e (1 - a^2/b^2)/2: thermal
strain e, radii a of the shaft and b of the ring. A longer shaft adds to it at the ends. The ring
slides from mu times the contact force on. Run it: python examples/own_mesh_press_fit.py
"""

import gmsh
import numpy as np
from mpi4py import MPI

import railhead.solver as rs

INNER, OUTER, LENGTH, REST = 10.0, 20.0, 15.0, 5.0  # mm; REST: of the shaft beyond the ring
STEEL, SHRINKS, MU = rs.Elastic(210e3, 0.3), -1e-3, 0.15


def meshed(size=1.0):
    """Meridian section of shaft 1 and ring 2: 11 and 12 may touch, 21 and 22 are the lower ends."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ, model, tags = gmsh.model.occ, gmsh.model, {}
    shaft = occ.addRectangle(0, -REST, 0, INNER, LENGTH + 2 * REST)
    ring = occ.addRectangle(INNER, 0, 0, OUTER - INNER, LENGTH)
    occ.synchronize()
    for body, surface in ((1, shaft), (2, ring)):
        model.addPhysicalGroup(2, [surface], body)
        for _, curve in model.getBoundary([(2, surface)], oriented=False):
            r0, z0, _, r1, z1, _ = model.getBoundingBox(1, curve)
            if abs(r0 - INNER) < 1e-5 and r1 - r0 < 1e-5:
                tags[10 + body] = curve
            elif z1 - z0 < 1e-5 and z0 < 1:
                tags[20 + body] = curve
    for tag, curve in tags.items():
        model.addPhysicalGroup(1, [curve], tag)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    model.mesh.generate(2)
    model.mesh.setOrder(2)
    found = rs.model_to_mesh(model, MPI.COMM_WORLD, 2)
    gmsh.finalize()
    return found


def main():
    """Shrink, pull, print."""
    model = rs.Model(*meshed(), section="axisymmetric")
    model.add(rs.Body(1, STEEL), rs.Body(2, STEEL, thermal_strain=SHRINKS))
    model.add(rs.Contact(secondary=12, primary=11, friction=MU), rs.Clamp(21))
    ring = model.add(rs.Hub(22, free=(0, 1), slides=True))
    state = model.solve(steps=4)
    lame = -STEEL.young_modulus * SHRINKS * (1 - (INNER / OUTER) ** 2) / 2
    mean = np.average(state.pressure, weights=state.weights)
    print(f"mean pressure {mean:.1f} MPa, Lame {lame:.1f} MPa")
    for moved in (0.005, 0.01, 0.02, 0.04):
        state = state.then({ring: rs.Move((0, moved))}, steps=2)
        limit = MU * state.weights @ state.pressure
        sticks = state.sticking.mean()
        print(f"moved {moved}: {state.force(ring):.0f} N of {limit:.0f} N, sticks {sticks:.2f}")
    state.write("press_fit")


if __name__ == "__main__":
    main()
