"""Sections meshed as they are: areas, tags and sizes."""

import numpy as np
import pytest
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import StraightTread
from railhead.meshing import blocks, mesh
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

GRADING = Grading(centre=(0.0, 0.0, 0.0), a=2.0, b=2.0, angle=0.0, size=0.4, coarsest=10.0)


def bodies(*, half: bool, depth: float = 20.0) -> list[Body]:
    flat = profiles.single_radius(np.inf, 40.0)
    rail = outlines.block_section(flat, 0 if half else -40, 40, -30, outwards=1, half=half)
    return [
        Body(RAIL, rail, 0.0),
        Body(WHEEL, outlines.disc(50.0, depth, 40.0, half=half), 0.0),
    ]


def areas(made: list[Body], options: Options) -> dict[int, float]:
    found = {}
    with blocks.model(made, GRADING, options) as model:
        for body in made:
            elements = np.concatenate(
                [
                    model.mesh.getElements(2, part)[1][0]
                    for part in model.getEntitiesForPhysicalGroup(2, body.tag)
                ]
            )
            found[body.tag] = abs(model.mesh.getElementQualities(elements, "volume").sum())
        assert blocks.qualities(2).min() > mesh.MIN_QUALITY
    return found


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("half", [True, False])
def test_areas_of_block_and_ring(cell: str, half: bool) -> None:
    share = 1 if half else 2
    found = areas(bodies(half=half), Options(cell, 2, half, "xz"))
    assert found[RAIL] == pytest.approx(share * 40 * 30, rel=1e-9)
    assert found[WHEEL] == pytest.approx(share * (50**2 - 30**2) / 2 * 40 / 50, rel=1e-3)


@pytest.mark.parametrize("half", [True, False])
def test_area_of_half_a_disc(half: bool) -> None:
    found = areas(bodies(half=half, depth=50.0), Options("tetrahedron", 2, half, "xz"))
    assert found[WHEEL] == pytest.approx((1 if half else 2) * np.pi * 50**2 / 4, rel=1e-3)


@pytest.mark.parametrize("which, tag", [("xz", SYMMETRY_X), ("yz", SYMMETRY_Y)])
def test_edges_are_tagged_and_fine_in_the_patch(which: str, tag: int) -> None:
    options = Options("tetrahedron", 1, True, which)
    made = mesh.generate(bodies(half=True), GRADING, options, MPI.COMM_WORLD)
    assert made.mesh.geometry.dim == 2
    for face in (CONTACT + RAIL, CONTACT + WHEEL, SUPPORT + RAIL, SUPPORT + WHEEL, tag):
        assert len(made.facet_tags.find(face)) > 0
    x = made.mesh.geometry.x
    top = np.sort(x[np.abs(x[:, 1]) < 1e-12, 0])
    near = np.diff(top[top < 2.0])
    assert 0.25 < np.median(near[near > 1e-9]) < 0.5


def test_the_section_along_takes_the_grading_along() -> None:
    """turned(): what was x is the first coordinate, with its semi-axis."""
    turned = Grading(centre=(3.0, 1.0, 2.0), a=5.0, b=2.0, angle=0.1, size=0.3).turned()
    assert turned.centre == (0.0, 3.0, 2.0)
    assert (turned.a, turned.b, turned.angle) == (2.0, 5.0, 0.0)
    assert "(x-(3))" in turned.expression(section=True, coordinates=("x", "y"))


def test_predicted_triangles_are_those_of_gmsh() -> None:
    made = mesh.generate(
        bodies(half=True)[:1], GRADING, Options("tetrahedron", 1, True, "xz"), MPI.COMM_WORLD
    )
    assert GRADING.predicted_triangles(30.0) / 2 == pytest.approx(made.cells, rel=0.35)


def test_straight_tread_is_its_profile_everywhere() -> None:
    tread = StraightTread(profiles.cone(0.05, 60.0, "cone20"), 2.0, 3.0)
    points = np.array([[0.0, 3.0, 2.0], [40.0, 13.0, 2.5], [0.0, 3.0, 1.0]])
    value, gradient = tread.implicit(points)
    np.testing.assert_allclose(value, [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(gradient, [[0.0, 0.05, -1.0]] * 3)
