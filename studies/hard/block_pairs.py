"""Two quarter blocks pressed together: contact set-ups that no scene can say."""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing import mesh
from railhead.meshing.bodies import (
    CONTACT,
    RAIL,
    SUPPORT,
    SYMMETRY_X,
    SYMMETRY_Y,
    WHEEL,
    Body,
    Options,
)
from railhead.meshing.grading import Grading
from railhead.solver.contact import ContactModel
from railhead.solver.material import Material
from railhead.solver.system.setup import ContactBody, Setup
from railhead.solver.system.solution import Solution

STEEL = Material(207000.0, 0.3)
GAP = ParabolicGap(1 / 2000, 1 / 1600, 1)  # 3 kN on steel touch over about 3 mm


@dataclass(frozen=True, kw_only=True)
class TwoSizes(Grading):
    """A grading whose finest size above the height `lift`/2 is `ratio` times larger."""

    lift: float = 0.0
    ratio: float = 1.0

    def expression(self, *, section: bool = False, coordinates: str = "yz") -> str:
        """The size as a gmsh MathEval formula."""
        above = f"Max(0,Min(1,1e6*(z-({self.lift / 2:.15g}))))"
        more = f"({(self.ratio - 1) * self.size:.15g})"
        return f"{super().expression(section=section, coordinates=coordinates)}+{more}*{above}"


def block(
    tag: int, size: float, lift: float = 0.0, length: float | None = None, *, half: bool = True
) -> Body:
    """A cube (half: a quarter of one) with a flat contact face at z = lift, held opposite.

    length: half of the edge along x, mm, if it is not `size` as the others.
    """
    outwards = 1 if tag == RAIL else -1
    flat = profiles.single_radius(np.inf, size, "flat")
    section = outlines.block_section(
        flat, 0.0 if half else -size, size, -outwards * size, outwards=outwards, half=half
    )
    section = [curve.moved(np.eye(2), np.array([0.0, lift])) for curve in section]
    return Body(tag, section, length or size)


def side(tag: int, material: Material) -> ContactBody:
    """One block."""
    return ContactBody(tag, CONTACT + tag, SUPPORT + tag, material)


@functools.lru_cache(maxsize=16)
def meshed(
    size: float,
    h: float,
    cell: str,
    rigid: tuple[bool, bool],
    wheel_size: float,
    ratio: float,
    fine: tuple[float, float],
    length: float | None,
    half: bool,
) -> mesh.ContactMesh:
    """Mesh of `two_blocks`, made once in a process; rigid: rail and wheel."""
    lift = 0.0 if ratio == 1.0 else 1e-3 * size
    along, across = np.array(fine) * size
    grading = TwoSizes(
        centre=(0.0, 0.0, 0.0), a=along, b=across, angle=0.0, size=h, lift=lift, ratio=ratio
    )
    lifted = {RAIL: (size, 0.0), WHEEL: (wheel_size * size, lift)}
    bodies = [
        block(tag, edge, height, length, half=half)
        for (tag, (edge, height)), absent in zip(lifted.items(), rigid, strict=True)
        if not absent
    ]
    return mesh.generate(bodies, grading, Options(cell, 1, True), MPI.COMM_WORLD)


def two_blocks(
    size: float = 10.0,
    h: float = 2.0,
    cell: str = "tetrahedron",
    materials: tuple[Material, Material] = (STEEL, STEEL),
    wheel_size: float = 1.0,
    ratio: float = 1.0,
    fine: tuple[float, float] = (0.3, 0.3),
    length: float | None = None,
    *,
    half: bool = True,
    own: bool = False,
    **changes: Any,
) -> tuple[mesh.ContactMesh, Setup]:
    """Mesh and set-up, non-matching; `changes` override fields of the Setup. The mesh is shared
    unless it is to be the caller's `own`: only of that may points be moved.

    h: element size, mm, within fine * size of the origin (along, across), on the wheel times
    `ratio`; wheel_size:
    edge of the wheel's block over the rail's; half: y = 0 is a symmetry plane as x = 0 is.
    """
    rigid = (np.isinf(materials[0].young_modulus), np.isinf(materials[1].young_modulus))
    make = meshed.__wrapped__ if own else meshed
    made = make(size, h, cell, rigid, wheel_size, ratio, fine, length, half)
    planes = ((SYMMETRY_X, (1.0, 0.0, 0.0)), (SYMMETRY_Y, (0.0, 1.0, 0.0)))
    usual = {
        "fixed": side(RAIL, materials[0]),
        "moving": side(WHEEL, materials[1]),
        "slave": RAIL,
        "gap": GAP,
        "degree": 2,
        "planes": planes if half else planes[:1],
    }
    return made, Setup(**{**usual, **changes})


def contact_model(**changes: Any) -> ContactModel:
    """Contact model of `two_blocks`."""
    made, setup = two_blocks(**changes)
    return ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)


def press(
    model: ContactModel, radius: float = 2.0, load: float = 3000.0, approach: float = 0.0
) -> Solution:
    """Its solution from the contact points within a radius (mm) of the axis. The load (N) counts
    under load control, otherwise the approach (mm)."""
    active = np.linalg.norm(model.interface.points, axis=1) < radius
    if model.setup.load_control:
        return model.solve(active=active, load=load)
    return model.solve(active=active, approach=approach)
