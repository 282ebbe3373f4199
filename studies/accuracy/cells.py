"""Unknowns per predicted cell, from meshes: what `planning/cost/data/cells.json` holds.

A prediction is the integral of the element density times one constant for each kind of cell, which
holds gmsh's habits and the sharing of nodes. The constant is the geometric mean over the scenes.
"""

from __future__ import annotations

from statistics import geometric_mean

from railhead.planning import plan as planning
from railhead.planning.cost import prediction
from railhead.planning.plan import Plan
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
KINDS = [(cell, order) for cell in ("tetrahedron", "hexahedron") for order in (1, 2)]


def measure_cells() -> dict[str, dict[str, dict[str, float]]]:
    """{"solid" or "section": {cell: {order: unknowns per predicted cell}}}."""
    found: dict[str, dict[str, dict[str, float]]] = {"solid": {}, "section": {}}
    for kind, scenes in (("solid", SOLID), ("section", FLAT)):
        for cell, order in KINDS:
            typed = (f"mesh.cell={cell}", f"mesh.order={order}")
            shares = [share(planned(name, *changes, *typed)) for name, changes in scenes]
            constant = geometric_mean(shares) * prediction.unknowns_per_cell(kind, cell, order)
            found[kind].setdefault(cell, {})[str(order)] = round(constant, 3)
    return found


def planned(name: str, *changes: str) -> Plan:
    """The plan of a shipped case with changes."""
    return planning.make(catalogue.find(name).replace(changes))


def share(plan: Plan) -> float:
    """Unknowns of the mesh over those that were predicted."""
    from mpi4py import MPI

    from railhead.run import build

    mesh = build.generate(plan, plan.grading(), MPI.COMM_WORLD)  # holds the model's communicator
    model = build.model(plan, mesh)
    unknowns = model.unknowns
    model.release()
    return unknowns / plan.unknowns
