"""Small contact models on two blocks that the solver's and the verification tests share."""

from collections.abc import Callable

import numpy as np
import pytest

from railhead.meshing import mesh
from railhead.solver.contact import ContactModel
from railhead.solver.setup import Setup
from railhead.studies.hard import blocks


@pytest.fixture(scope="session")
def two_blocks() -> Callable[..., tuple[mesh.ContactMesh, Setup]]:
    """Mesh and set-up of two quarter blocks, non-matching: see `studies.hard.blocks`."""
    return blocks.two_blocks


@pytest.fixture(scope="session")
def solve() -> Callable[..., tuple[ContactModel, object]]:
    """Model and solution of a mesh and a Setup, from the points within a radius."""

    def run(made: mesh.ContactMesh, setup: Setup, radius: float = 2.0, **control: float):
        model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
        active = np.linalg.norm(model.interface.points, axis=1) < radius
        return model, model.solve(active=active, **control)

    return run
