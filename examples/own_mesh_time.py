"""Time that a gap from the meshes takes, beside a given one and the rest of the assembly.

An eighth of a ball on a block, quadratic tetrahedra: python examples/own_mesh_time.py
"""

import time
from typing import Any

import gmsh
import numpy as np
from mpi4py import MPI

import railhead.solver as rs
from railhead.solver.compat import model_to_mesh
from railhead.solver.model.assembly import Assembly
from railhead.solver.space.kinematics import SOLID

RADIUS, GAP = 10.0, 0.02


def meshed() -> tuple[Any, Any, Any]:
    """Mesh, and tags of cells and facets: 11 and 12 meet, 21 is held."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    block, ball = occ.addBox(0, 0, -8, 8, 8, 8), occ.addSphere(0, 0, RADIUS + GAP, RADIUS)
    box = occ.addBox(0, 0, 0, RADIUS, RADIUS, RADIUS + GAP)
    ball = occ.intersect([(3, ball)], [(3, box)])[0][0][1]
    occ.synchronize()
    for body, volume in ((1, block), (2, ball)):
        gmsh.model.addPhysicalGroup(3, [volume], body)
        for _, side in gmsh.model.getBoundary([(3, volume)], oriented=False):
            x, y, z = gmsh.model.occ.getCenterOfMass(2, side)
            if min(x, y) > 1e-6 and abs(z + 4) > 1e-6 and z < RADIUS:
                gmsh.model.addPhysicalGroup(2, [side], 21 if z < -7 else 10 + body)
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", "0.08+0.22*Max(0,Sqrt(x*x+y*y+z*z)-1.2)")
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    for option in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    found = model_to_mesh(gmsh.model, MPI.COMM_WORLD, 3)
    gmsh.finalize()
    return found


def exact(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gap and normals of the ball."""
    normals = (points - [0, 0, RADIUS + GAP]) / RADIUS
    down = np.minimum(normals[:, 2], -1e-9)
    return np.where(normals[:, 2] < -1e-3, points[:, 2] / -down, np.inf), normals


def main() -> None:
    """Assemble four times each way, and print the least times."""
    mesh = meshed()
    for name, gap in (("from the meshes", None), ("given", exact)):
        parts = [rs.Body(body, rs.Elastic(1000, 0.3)) for body in (1, 2)]
        parts += [rs.Contact(secondary=12, primary=11, gap=gap), rs.Clamp(21)]
        taken = []
        for _ in range(4):
            begun = [time.process_time()]
            model = Assembly(*mesh, None, 2, SOLID, parts)
            begun.append(time.process_time())
            face = model.surfaces.pair(np.zeros((len(model.bulk_points), 3)))
            begun.append(time.process_time())
            assert face.gap and face.stress
            taken.append(np.diff([*begun, time.process_time()]))
        body, pair, contact = np.min(taken, axis=0)
        print(
            f"{model.stiffness.getSize()[0]} unknowns, gap {name}: bodies {body:.2f} s, "
            f"pairing {pair:.2f} s, contact matrices {contact:.2f} s"
        )


if __name__ == "__main__":
    main()
