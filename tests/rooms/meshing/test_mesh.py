"""gmsh blocks and sections: tags, volumes, areas, sizes, quality."""

import math
import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI

from railhead.geometry import outlines, profiles
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
from railhead.solver import compat

pytestmark = pytest.mark.usefixtures("meshed_anew")
GRADING = Grading(centre=(0.0, 0.0, 0.0), a=4.3, b=3.5, angle=0.0, size=1.2, coarsest=20.0)
CELLS = ["tetrahedron", "hexahedron"]


def bodies(extent: str, *, half: bool) -> list[Body]:
    tread = profiles.cone(0, 50, "cylinder")
    wheel = outlines.block_section(tread, 0 if half else -50, 50, 60, outwards=-1, half=half)
    return [
        Body(RAIL, outlines.rail_section("54E1", extent, half=half), 80.0),
        Body(WHEEL, wheel, 60.0, (420.0, 420.0)),
    ]


@pytest.mark.parametrize(
    "cell, half",
    [
        ("tetrahedron", True),
        ("hexahedron", True),
        *(pytest.param(cell, False, marks=pytest.mark.slow) for cell in CELLS),
    ],
)
def test_volumes_are_those_of_the_swept_sections(cell: str, half: bool) -> None:
    """54E1: 69.78 cm2 times the length; wheel: a ring segment."""
    options = Options(cell, 2 if cell == "tetrahedron" else 1, half)
    with blocks.model(bodies("section", half=half), GRADING, options) as model:
        model.occ.synchronize()
        volume = {}
        for tag in (RAIL, WHEEL):
            parts = model.getEntitiesForPhysicalGroup(3, tag)
            elements = [model.mesh.getElements(3, part)[1][0] for part in parts]
            measured = [model.mesh.getElementQualities(e, "volume").sum() for e in elements]
            volume[tag] = sum(measured)
        assert blocks.qualities().min() > mesh.MIN_QUALITY
    share = 0.25 if half else 1.0
    tolerance = 3e-3 if cell == "tetrahedron" else 2e-2  # coarse cells cut the fillets
    assert volume[RAIL] == pytest.approx(share * 6978 * 160, rel=tolerance)
    ring = 100 * (420**2 - 360**2) / 2 * (120 / 420)
    assert volume[WHEEL] == pytest.approx(share * ring, rel=tolerance)


@pytest.mark.parametrize("cell", CELLS)
def test_faces_are_tagged_and_fine_only_in_the_patch(cell: str) -> None:
    made = mesh.generate(bodies("head", half=True), GRADING, Options(cell, 1, True), MPI.COMM_WORLD)
    for tag in (CONTACT + RAIL, CONTACT + WHEEL, SUPPORT + RAIL, SUPPORT + WHEEL):
        assert len(made.facet_tags.find(tag)) > 0
    for tag, axis in ((SYMMETRY_X, 0), (SYMMETRY_Y, 1)):
        found = _points(made, tag)
        assert len(found) and np.abs(found[:, axis]).max() < 1e-9
    top = _points(made, CONTACT + RAIL)
    area_per_node = np.pi * 3.0**2 / 4 / len(top[np.hypot(top[:, 0], top[:, 1]) < 3.0])
    assert 0.3 * 1.2**2 < area_per_node < 1.5 * 1.2**2


def _points(made: mesh.ContactMesh, tag: int) -> np.ndarray:
    """Corners (n, 3) of the tagged facets, mm."""
    space = compat.vector_space(made.mesh, 1)
    corners = fem.locate_dofs_topological(space, 2, made.facet_tags.find(tag))
    return compat.dof_points(space)[corners]


def test_flat_elements_are_refused_loudly() -> None:
    thin = outlines.block_section(
        profiles.cone(0, 40, "flat"), -40, 40, -1e-3, outwards=1, half=False
    )
    with pytest.raises(mesh.MeshError, match="quality"):
        mesh.generate(
            [Body(RAIL, thin, 40.0)], GRADING, Options("hexahedron", 1, True), MPI.COMM_WORLD
        )


TILTED = Grading(centre=(0.0, 5.0, -0.1), a=6.0, b=2.0, angle=0.05, size=0.3)
STRETCHED = replace(TILTED, angle=-0.3, stretch=2.0)
FUNCTIONS = {"Sqrt": math.sqrt, "Max": max, "Min": min, "Abs": abs}  # of gmsh's formulas


@pytest.mark.parametrize("grading", [TILTED, STRETCHED, replace(TILTED, also=(STRETCHED,))])
@pytest.mark.parametrize("y, z", [(5.0, -0.1), (6.0, 1.5), (-20.0, -9.0), (105.0, -0.1)])
def test_the_formula_of_sizes_gives_the_numbers(grading: Grading, y: float, z: float) -> None:
    """In the plane x = 0 through the centre of the patch."""
    for section in (True, False):
        found = eval(grading.expression(section=section), FUNCTIONS | {"x": 0.0, "y": y, "z": z})
        assert found == pytest.approx(grading.at(y, z), rel=1e-6)


def test_sizes_grow_with_the_distance_from_the_patch() -> None:
    assert TILTED.at(5.0, -0.1) == pytest.approx(0.3)
    assert TILTED.at(105.0, -0.1) == pytest.approx(0.3 + 0.3 * (100 - 2.3), rel=0.01)
    needle = replace(TILTED, a=18.0, stretch=3.0)  # far off half as long again: 0.45 of 0.3
    assert 3 * needle.at(105.0, -0.1) == pytest.approx(1.62 + 0.45 * (100 - 2.3), rel=0.01)


def test_layers_grow_away_from_the_patch() -> None:
    ends = np.array([0.0, *GRADING.layers(80.0)]) * 80.0
    steps = np.diff(ends)
    assert ends[-1] == pytest.approx(80.0) and steps[0] == pytest.approx(1.2, rel=0.1)
    assert np.all(np.diff(steps) > -1e-6)


def test_a_crash_of_gmsh_is_a_mesh_error(monkeypatch) -> None:
    monkeypatch.setattr(blocks, "qualities", lambda _: os.kill(os.getpid(), signal.SIGKILL))
    options = Options("tetrahedron", 1, True)
    block = outlines.block_section(profiles.cone(0, 40, "flat"), 0, 40, -30, outwards=1, half=True)
    with pytest.raises(mesh.MeshError, match=r"gmsh: it crashed \(signal 9\)"):
        mesh.generate([Body(RAIL, block, 40.0)], GRADING, options, MPI.COMM_WORLD)


FLAT = Grading(centre=(0.0, 0.0, 0.0), a=2.0, b=2.0, angle=0.0, size=0.4, coarsest=10.0)


def flat_bodies(*, half: bool, depth: float = 20.0) -> list[Body]:
    flat = profiles.single_radius(np.inf, 40.0)
    rail = outlines.block_section(flat, 0 if half else -40, 40, -30, outwards=1, half=half)
    return [
        Body(RAIL, rail, 0.0),
        Body(WHEEL, outlines.disc(50.0, depth, 40.0, half=half), 0.0),
    ]


def areas(made: list[Body], options: Options) -> dict[int, float]:
    found = {}
    with blocks.model(made, FLAT, options) as model:
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
    found = areas(flat_bodies(half=half), Options(cell, 2, half, "xz"))
    assert found[RAIL] == pytest.approx(share * 40 * 30, rel=1e-9)
    assert found[WHEEL] == pytest.approx(share * (50**2 - 30**2) / 2 * 40 / 50, rel=1e-3)
    if cell == "tetrahedron":  # half a disc
        found = areas(flat_bodies(half=half, depth=50.0), Options(cell, 2, half, "xz"))
        assert found[WHEEL] == pytest.approx(share * np.pi * 50**2 / 4, rel=1e-3)


@pytest.mark.parametrize("which, tag", [("xz", SYMMETRY_X), ("yz", SYMMETRY_Y)])
def test_edges_are_tagged_and_fine_in_the_patch(which: str, tag: int) -> None:
    options = Options("tetrahedron", 1, True, which)
    made = mesh.generate(flat_bodies(half=True), FLAT, options, MPI.COMM_WORLD)
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
        flat_bodies(half=True)[:1],
        FLAT,
        Options("tetrahedron", 1, True, "xz"),
        MPI.COMM_WORLD,
    )
    assert FLAT.predicted_triangles(30.0) / 2 == pytest.approx(made.cells, rel=0.35)
