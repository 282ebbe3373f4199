"""A bolt holds a sleeve with pretension, and is pulled at its head.

Bolt and sleeve of the length L are springs k = E A/L. Pretension by a shank that shrinks by e is
e L/(1/k_b + 1/k_s). A pull F at the head raises the force of the bolt by F k_b/(k_b + k_s) alone,
until the head lifts off. A head that bends is softer. Run it: python examples/own_mesh_bolt.py
"""

import gmsh
import numpy as np
from mpi4py import MPI

import railhead.solver as rs

SHANK, HOLE, OUTER, LENGTH, HEAD = 5.0, 5.5, 10.0, 40.0, 8.0  # radii and lengths, mm
STEEL, SHRINKS = rs.Elastic(210e3, 0.3), -1e-3


def meshed(size=1.0):
    """Meridian section of shank 1, sleeve 2 and head 3, which is one piece with the shank: 12 and
    13 may touch, 21 and 22 are the lower ends, 23 is the top of the head."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ, model, tags = gmsh.model.occ, gmsh.model, {}
    shank = occ.addRectangle(0, 0, 0, SHANK, LENGTH)
    head = occ.addRectangle(0, LENGTH, 0, OUTER, HEAD)
    occ.fragment([(2, shank)], [(2, head)])
    sleeve = occ.addRectangle(HOLE, 0, 0, OUTER - HOLE, LENGTH)
    occ.synchronize()
    for body, surface in ((1, shank), (2, sleeve), (3, head)):
        model.addPhysicalGroup(2, [surface], body)
        for _, curve in model.getBoundary([(2, surface)], oriented=False):
            r0, low, _, r1, high, _ = model.getBoundingBox(1, curve)
            if high - low > 1e-5 or (body != 2 and low > 1 and r1 < SHANK + 0.1):
                continue
            touches = abs(low - LENGTH) < 1e-5
            tags[10 + body if touches else 20 + body] = curve
    for tag, curve in tags.items():
        model.addPhysicalGroup(1, [curve], tag)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    model.mesh.generate(2)
    found = rs.model_to_mesh(model, MPI.COMM_WORLD, 2)
    gmsh.finalize()
    return found


def main():
    """Tighten, pull, print."""
    model = rs.Model(*meshed(), section="axisymmetric")
    model.add(rs.Body(1, STEEL, thermal_strain=SHRINKS), rs.Body(2, STEEL), rs.Body(3, STEEL))
    model.add(rs.Contact(secondary=12, primary=13, friction=0.2), rs.Clamp(22))
    foot = model.add(rs.Clamp(21))
    head = model.add(rs.Hub(23, free=(0, 1)))
    areas = np.pi * np.array([SHANK**2, OUTER**2 - HOLE**2])
    bolt, sleeve = STEEL.young_modulus * areas / LENGTH
    tight = -SHRINKS * LENGTH / (1 / bolt + 1 / sleeve)
    state = model.solve({head: rs.Force(0)}, steps=4)
    for pull in (0.0, 4000.0, 8000.0, 12000.0, 16000.0):
        state = state.then({head: rs.Force(pull)}, steps=2)
        felt = -state.force(foot)[1]
        springs = max(tight + pull * bolt / (bolt + sleeve), pull)
        clamped = state.weights @ state.pressure
        print(
            f"pull {pull:.0f} N: bolt {felt:.0f} N (springs {springs:.0f}), sleeve {clamped:.0f} N"
        )
    state.write("bolt")


if __name__ == "__main__":
    main()
