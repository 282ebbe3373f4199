"""Input that a contact model cannot have, and answers without contact."""

import re
from dataclasses import replace

import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes
from dolfinx.mesh import meshtags

from railhead.solver.contact import ContactModel
from railhead.solver.material import Material
from railhead.solver.space.cells import Bulk, CellSet
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.kinematics import Kinematics
from railhead.solver.system.pressed_surfaces import surface_tangents
from railhead.solver.system.setup import ContactBody, FrictionSettings, Setup

STEEL = Material(207000.0, 0.3)
PLANE = Kinematics(np.eye(3)[:2])


def flat(points: np.ndarray, height: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    return np.full(len(points), height), np.tile([0.0, 1.0, 0.0], (len(points), 1))


def boxes(cell: str = "triangle"):
    return two_boxes(cell, ((3, 2), (4, 2)), (((0, -1), (1, 0)), ((0, 0), (1, 1))))


SETUP = Setup(
    fixed=ContactBody(LOWER, 11, 21, STEEL),
    moving=ContactBody(UPPER, 12, 22, STEEL),
    slave=LOWER,
    gap=flat,
    degree=2,
    direction=(0.0, -1.0, 0.0),
    kinematics=PLANE,
)
FRICTION = FrictionSettings(
    coefficient=lambda points: np.full(len(points), 0.3),
    rolling=False,
    axes=np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]),
    origin=(0.0, 0.0, 0.0),
    rigid_slip=lambda points: np.stack(
        [
            np.tile(way, (len(points), 1))
            for way in ([1.0, 0, 0], [0, 0, -1.0], [0, 0, 0], [0, 0, 0])
        ]
    ),
    creepage=(0.0, 0.0, 0.0),
    force_controlled=((0, 300.0),),
)


def solved(setup: Setup = SETUP, cell: str = "triangle", **control: float):
    model = ContactModel(*boxes(cell), setup)
    return model.solve(active=np.ones(len(model.interface.points), bool), **control)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (
            lambda: replace(SETUP, direction=(0.0, -2.0, 0.0)),
            r"direction must be unit vectors .*0\.0, -2\.0",
        ),
        (
            lambda: replace(SETUP, planes=((30, (1.0, 1.0, 0.0)),)),
            "planes must be unit vectors",
        ),
        (
            lambda: replace(FRICTION, axes=np.diag([1.0, 1.0, -1.0])),
            "axes must be right-handed",
        ),
        (
            lambda: Kinematics(np.array([[1.0, 0, 0], [0.6, 0.8, 0]])),
            "axes must be unit vectors at right angles",
        ),
        (
            lambda: surface_tangents(np.array([[0.0, 1.0], [-1.0, 0.0]])),
            "normal lies along the mesh's first axis",
        ),
        (lambda: replace(FRICTION, load_steps=()), "load_steps must hold at least one step"),
        (
            lambda: solved(replace(SETUP, gap=lambda points: flat(points, np.inf)), load=100.0),
            "surface 11 has nothing opposite its points",
        ),
    ],
)
def test_what_no_contact_can_have_is_refused(make, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make()


def test_a_cell_without_a_body() -> None:
    mesh, cells, facets = boxes()
    values = np.where(np.arange(len(cells.values)) < 3, 7, cells.values)
    cells = meshtags(mesh, 2, cells.indices, values.astype(np.int32))
    with pytest.raises(ValueError, match=re.escape("3 cells belong to no body: the bodies' tags")):
        ContactModel(mesh, cells, facets, SETUP)


def test_mean_dilatation_of_biquadratic_cells() -> None:
    """Their divergence at the centroid is not its mean: 151 % off in a converged solution."""
    mean = replace(SETUP, kinematics=replace(PLANE, mean_dilatation=True))
    with pytest.raises(ValueError, match="mean dilatation needs triangles or tetrahedra"):
        ContactModel(*boxes("quadrilateral"), mean)
    ContactModel(*boxes("quadrilateral"), replace(mean, degree=1))


def test_a_rank_without_contact_facets_in_a_ring_with_mean_dilatation() -> None:
    ring = replace(SETUP, kinematics=replace(PLANE, revolved=True, mean_dilatation=True))
    bulk: Bulk = ContactModel(*boxes(), ring).bulk
    none = FacetSet.on(bulk, np.zeros(0, np.int32))
    assert none.divergence(np.zeros(0, np.int64), np.zeros((0, 2))).shape == (0, 6, 2)
    assert len(CellSet.of(bulk, np.zeros(0, np.int64))) == 0


def test_a_force_that_friction_cannot_carry() -> None:
    """900 N with a coefficient of 0.3 carry 270 N."""
    found = solved(replace(SETUP, friction=FRICTION), load=900.0)
    assert not found.newton.converged
    assert found.newton.reason == ("friction: a force of 300 N is above what it can carry, 270 N")
    assert solved(replace(SETUP, friction=FRICTION), load=1100.0).newton.converged


def test_bodies_that_do_not_touch_are_an_answer() -> None:
    apart = replace(SETUP, gap=lambda points: flat(points, 0.5), load_control=False)
    found = solved(apart, approach=0.1)
    assert found.newton.converged and not found.touching and found.load == 0.0
    assert abs(found.reaction) < 1e-6
    near = solved(apart, approach=0.51)
    assert near.newton.converged and near.touching and near.load > 100.0
