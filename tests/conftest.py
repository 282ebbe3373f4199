"""Small contact models on two blocks that the solver's and the verification tests share."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from meshing import mesh, outlines, profiles
from meshing.bodies import Body, Options
from meshing.sizing import Grading
from meshing.surfaces import ParabolicGap
from meshing.tags import CONTACT, RAIL, SUPPORT, SYMMETRY_X, SYMMETRY_Y, WHEEL
from solver.contact import ContactModel, Setup, Side
from solver.elasticity import Material

STEEL = Material(207000.0, 0.3)
GAP = ParabolicGap(1 / 2000, 1 / 1600, 1)  # 3 kN on steel touch over about 3 mm


def block(tag: int, size: float) -> Body:
    """A quarter cube with a flat contact face at z = 0, held at the opposite face."""
    outwards = 1 if tag == RAIL else -1
    flat = profiles.single_radius(np.inf, size, "flat")
    section = outlines.block_section(
        flat, 0.0, size, -outwards * size, outwards=outwards, half=True
    )
    return Body(tag, section, size)


def side(tag: int, material: Material) -> Side:
    return Side(tag, CONTACT + tag, SUPPORT + tag, material)


@pytest.fixture(scope="session")
def two_blocks() -> Callable[..., tuple[mesh.ContactMesh, Setup]]:
    """Mesh and set-up of two quarter blocks, non-matching: override any field of the Setup."""

    def make(
        size: float = 10.0,
        h: float = 2.0,
        cell: str = "tetrahedron",
        materials: tuple[Material, Material] = (STEEL, STEEL),
        wheel_size: float = 1.0,
        **changes: object,
    ) -> tuple[mesh.ContactMesh, Setup]:
        grading = Grading((0.0, 0.0, 0.0), 0.3 * size, 0.3 * size, 0.0, h)
        sizes = {RAIL: size, WHEEL: wheel_size * size}
        bodies = [
            block(tag, edge)
            for (tag, edge), material in zip(sizes.items(), materials, strict=True)
            if np.isfinite(material.young_modulus)
        ]
        made = mesh.generate(bodies, grading, Options(cell, 1, True), MPI.COMM_WORLD)
        setup = Setup(
            fixed=side(RAIL, materials[0]),
            moving=side(WHEEL, materials[1]),
            slave=RAIL,
            gap=GAP,
            degree=2,
            planes=((SYMMETRY_X, (1.0, 0.0, 0.0)), (SYMMETRY_Y, (0.0, 1.0, 0.0))),
        )
        return made, replace(setup, **changes)

    return make


@pytest.fixture(scope="session")
def solve() -> Callable[..., tuple[ContactModel, object]]:
    """Model and solution of a mesh and a Setup, from the points within a radius."""

    def run(made: mesh.ContactMesh, setup: Setup, radius: float = 2.0, **control: float):
        model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
        active = np.linalg.norm(model.interface.points, axis=1) < radius
        return model, model.solve(active=active, **control)

    return run
