"""A disc on a block of the same steel is moved to and fro under a constant load (fretting).

Shares of the contact that stick, beside those of Cattaneo and Mindlin: sqrt(1 - T/(mu N)) up to the
first turn, sqrt(1 - (T1 - T)/(2 mu N)) after it. Run it: python examples/own_mesh_friction_loop.py
"""

import gmsh
import numpy as np
from mpi4py import MPI

import railhead.solver as rs

RADIUS, E, NU, MU, LOAD = 8.0, 200.0, 0.3, 0.2, 10.0  # mm, MPa, N a millimetre of depth
HALF = np.sqrt(8 * LOAD * RADIUS * (1 - NU**2) / (np.pi * E))  # half width of the contact


def tag_of(body, low, high):
    """Tag of a curve of the block or the disc between two heights: 11 and 12 may touch, 21 is held,
    22 moves."""
    if body == 1:
        return 11 if low > -1e-6 else 21 if high < -19.9 else 1
    return 22 if low > RADIUS - 1e-6 else 12


def meshed(cells=12):
    """Block 1 and half a disc 2, with so many cells on the half width."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ, model, tags = gmsh.model.occ, gmsh.model, {}
    block = occ.addRectangle(-20, -20, 0, 40, 20)
    window = [(2, occ.addRectangle(-RADIUS, 0, 0, 2 * RADIUS, RADIUS))]
    disc = occ.intersect([(2, occ.addDisk(0, RADIUS, 0, RADIUS, RADIUS))], window)[0][0][1]
    occ.synchronize()
    for body, surface in ((1, block), (2, disc)):
        model.addPhysicalGroup(2, [surface], body)
        for _, curve in model.getBoundary([(2, surface)], oriented=False):
            heights = model.getBoundingBox(1, curve)[1::3]
            tags.setdefault(tag_of(body, *heights), []).append(curve)
    for tag, curves in tags.items():
        model.addPhysicalGroup(1, curves, tag)
    field = model.mesh.field.add("MathEval")
    size = f"{HALF / cells}+0.3*Max(0,Sqrt(x*x+y*y)-{1.4 * HALF})"
    model.mesh.field.setString(field, "F", size)
    model.mesh.field.setAsBackgroundMesh(field)
    for option in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    model.mesh.generate(2)
    model.mesh.setOrder(2)
    found = rs.model_to_mesh(model, MPI.COMM_WORLD, 2)
    gmsh.finalize()
    return found


def main():
    """Solve the loop, print it, and write a series for ParaView."""
    model = rs.Model(*meshed(), section="plane strain")
    model.add(*(rs.Body(body, rs.Elastic(E, NU)) for body in (1, 2)))
    model.add(rs.Contact(secondary=12, primary=11, friction=MU))
    floor, top = model.add(rs.Clamp(21), rs.Hub(22, free=(0, -1)))
    state, turn = model.solve({top: rs.Force(LOAD)}), 0.0
    for move in (0.015, 0.029, 0.01, -0.015):
        state = state.then({top: rs.Force(LOAD, move=(move, 0))}, steps=4)
        state.write("friction_loop")
        force = -state.force(floor)[0]
        turn = max(turn, force)
        loaded = force if turn == force else (turn - force) / 2
        exact = np.sqrt(1 - loaded / (MU * LOAD))
        sticks = state.weights[state.sticking].sum() / state.weights[state.pressure > 0].sum()
        print(f"moved {move}: T {force:.4f} N, sticks {sticks:.3f}, Mindlin {exact:.3f}")


if __name__ == "__main__":
    main()
