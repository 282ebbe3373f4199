"""Unknowns per predicted cell, from meshes: what `planning/data/cells.json` holds.

A prediction is the integral of the element density times one constant for each kind of cell, which
holds gmsh's habits and the sharing of nodes. The constant is the geometric mean over the scenes.
"""

import itertools
from statistics import geometric_mean

from mpi4py import MPI

from railhead.planning import cost
from railhead.planning import plan as planning
from railhead.run import build
from railhead.scene import catalogue

Scenes = tuple[tuple[str, tuple[str, ...]], ...]
SOLID: Scenes = (
    ("hertz_ellipse", ()),
    ("hertz_ellipse", ("rail.crown_radius=60",)),
    ("hertz_ellipse", ("rail.crown_radius=10",)),
    ("s1002_60e1", ()),
    ("s1002_60e1", ("wheelset.shift=4",)),
    ("uic54_thesis", ()),
)
FLAT: Scenes = (("long_roller", ()), ("roller_on_block", ()), ("sphere_on_plane", ()))


def measure_cells() -> dict[str, dict[str, dict[str, float]]]:
    """{"solid" or "section": {cell: {order: unknowns per predicted cell}}}."""
    found: dict[str, dict[str, dict[str, float]]] = {"solid": {}, "section": {}}
    for kind, scenes in (("solid", SOLID), ("section", FLAT)):
        for cell, order in itertools.product(("tetrahedron", "hexahedron"), (1, 2)):
            typed = (f"mesh.cell={cell}", f"mesh.order={order}")
            shares = [share(name, *changes, *typed) for name, changes in scenes]
            constant = geometric_mean(shares) * cost.unknowns_per_cell(kind, cell, order)
            found[kind].setdefault(cell, {})[str(order)] = round(constant, 3)
    return found


def share(name: str, *changes: str) -> float:
    """Unknowns of the mesh of a shipped case with changes over those that were predicted."""
    plan = planning.make(catalogue.find(name).replace(changes))
    mesh = build.generate(plan, plan.grading(), MPI.COMM_WORLD)  # holds the model's communicator
    model = build.model(plan, mesh)
    unknowns = model.unknowns
    model.release()
    return unknowns / plan.unknowns
