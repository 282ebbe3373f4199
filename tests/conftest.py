"""Small contact models on two blocks that the solver's and the verification tests share."""

from collections.abc import Callable

import numpy as np
import pytest

from cases.hard import blocks
from meshing import mesh
from solver.contact import ContactModel
from solver.setup import Setup


@pytest.fixture(scope="session")
def two_blocks() -> Callable[..., tuple[mesh.ContactMesh, Setup]]:
    """Mesh and set-up of two quarter blocks, non-matching: see `cases.hard.blocks`."""
    return blocks.two_blocks


@pytest.fixture(scope="session")
def solve() -> Callable[..., tuple[ContactModel, object]]:
    """Model and solution of a mesh and a Setup, from the points within a radius."""

    def run(made: mesh.ContactMesh, setup: Setup, radius: float = 2.0, **control: float):
        model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
        active = np.linalg.norm(model.interface.points, axis=1) < radius
        return model, model.solve(active=active, **control)

    return run
