"""How far a load beside the web twists a rail: what `planning/data/twist.json` holds.

The head of a metre of rail on a held foot is solved under a wheel at some inclinations. The
rotation of its flanks at the wheel is C M / E, M the moment of the contact force about the centre
that they turn about (see `railhead.planning.references.rail_twist`).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.planning import plan as planning
from railhead.planning.references.rail_twist import lever
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene import catalogue

PROFILES = ("54E1", "60E1")
SLOPES = ("0", "1:40", "1:10")  # off the tread's 1:20, where the force goes through the web
FLANK: dict[str, Any] = {
    "x": 25.0,
    "y": 20.0,
    "z": (-35.0, -15.0),
}  # mm: nodes of the head beside the wheel


def measure_twist() -> dict[str, Any]:
    """{"centre_mm": below the crown, "compliance": {profile: C, 1/mm3}}, two digits each."""
    solutions = {profile: [solved(profile, slope) for slope in SLOPES] for profile in PROFILES}
    turns = {profile: [turn(each) for each in own] for profile, own in solutions.items()}
    centre = two_digits([depth for own in turns.values() for _, depth in own])
    return {
        "centre_mm": centre,
        "compliance": {
            profile: two_digits(
                [
                    angle
                    * each.plan.scene.rail.young_modulus
                    / (-each.solution.load * lever(each.plan.contact, centre))
                    for each, (angle, _) in zip(own, turns[profile], strict=True)
                ]
            )
            for profile, own in solutions.items()
        },
    }


def solved(profile: str, inclination: str) -> MeshSolution:
    """A whole rail under half an axle."""
    scene = catalogue.find("uic54_22t5_axle").replace(
        [
            f"rail.profile={profile}",
            f"rail.inclination={inclination}",
            "mesh.patch_size=5",
            "effects.rail_section=on",
            "effects.plasticity=off",
        ]
    )
    return mesh_and_solve(planning.make(scene), Progress(quiet=True), MPI.COMM_WORLD)


def turn(mesh_solution: MeshSolution) -> tuple[float, float]:
    """Rotation of the head at the wheel, rad, and depth of the point below the crown that it turns
    about, mm: u_y = c - angle z and u_z = d + angle y, fitted to its flanks."""
    assert mesh_solution.fields is not None
    points, moved = mesh_solution.fields.points, mesh_solution.fields.displacement
    x, y, z = points.T
    low, high = FLANK["z"]
    flank = (np.abs(x) < FLANK["x"]) & (np.abs(y) > FLANK["y"]) & (z > low) & (z < high)
    y, z, (_, across, up) = y[flank], z[flank], moved[flank].T
    one, none = np.ones_like(y), np.zeros_like(y)
    table = np.block(
        [[one[:, None], none[:, None], -z[:, None]], [none[:, None], one[:, None], y[:, None]]]
    )
    aside, _, angle = np.linalg.lstsq(table, np.concatenate([across, up]), rcond=None)[0]
    return float(angle), float(-aside / angle)


def two_digits(values: Sequence[float]) -> float:
    """The mean, rounded to what the fit is worth."""
    mean = float(np.mean(values))
    return round(mean, 1 - math.floor(math.log10(abs(mean))))
