"""Images of what symmetry left out, against exact fields on whole blocks."""

import numpy as np
import pytest
import pyvista as pv
from scipy.spatial import cKDTree

from railhead.postprocess import symmetry, vtu
from railhead.postprocess.findings import Surface
from railhead.theory.friction.solution import FrictionSolution

KINDS = [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1), ("hexahedron", 2)]


def made_whole(case):
    return pv.from_meshio(case.volume)


@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_images_are_upright_and_fill_the_blocks(blocks, cell: str, degree: int) -> None:
    """Nodes on the planes are shared, so nothing lies twice; edges keep their middles."""
    case = blocks(cell, degree)
    grid = made_whole(case)
    volume = grid.compute_cell_sizes(length=False, area=False)["Volume"]
    assert volume.min() > 0
    size = np.ptp(case.fields.points, axis=0) * [2, 2, 1]
    assert volume.sum() == pytest.approx(size.prod(), rel=1e-12)
    below = grid.extract_cells(grid["body"] == 1).points
    assert len(np.unique(below.round(9), axis=0)) == len(below)
    for number in (0, 17, grid.n_cells // 3, grid.n_cells - 1):
        found = grid.get_cell(number)
        for edge in found.edges if degree == 2 else ():
            assert edge.points[2] == pytest.approx(edge.points[:2].mean(0), abs=1e-12)
        if (cell, degree) == ("hexahedron", 2):
            for face in found.faces:
                assert face.points[8] == pytest.approx(face.points[:4].mean(0), abs=1e-12)


def test_images_of_quadratic_quadrilaterals_keep_their_middles() -> None:
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [0.0, 1.0]])
    after = np.roll(corners, -1, axis=0)
    cell = np.vstack([corners, (corners + after) / 2, [corners.mean(axis=0)]])
    image = (cell * [-1.0, 1.0])[symmetry._TURNED["quad9"]]
    first, following = image[:4], np.roll(image[:4], -1, axis=0)
    np.testing.assert_allclose(image[4:8], (first + following) / 2)
    np.testing.assert_allclose(image[8], first.mean(axis=0))
    x, y = first.T
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2 == pytest.approx(5.0)  # upright


@pytest.mark.parametrize("degree", [1, 2])
def test_images_hold_the_exact_fields(blocks, degree: int) -> None:
    """Every component at every node inside the rail's block is that of the closed form there."""
    case = blocks("hexahedron", degree, cut=False)
    exact = pv.from_meshio(vtu.volume_grid(case.fields, case.stress))
    exact, found = (
        grid.extract_cells(grid["body"] == 1)
        for grid in (exact, made_whole(blocks("hexahedron", degree)))
    )
    assert len(found.points) == len(exact.points)
    off, partner = cKDTree(exact.points).query(found.points)
    assert off.max() < 1e-9 and {-1.0, 1.0} <= set(np.sign(found.points[:, 0] * found.points[:, 1]))
    x, y, z = found.points.T
    p0, edge = case.ellipse.p0, (x / case.ellipse.a) ** 2 + (y / case.ellipse.b) ** 2
    smooth = (z < 0) | (np.abs(edge - 1) > 1e-6)  # at the edge they rise like a square root
    assert 0 < np.sum(~smooth) < 20
    for name, scale in (
        ("stress", p0),
        ("displacement", 0.1),
        ("principal_stresses", p0),
        ("von_mises", p0),
        ("max_shear", p0),
    ):
        expected = exact[name][partner][smooth]
        assert found[name][smooth] == pytest.approx(expected, abs=1e-9 * scale), name
    tensor = found["stress"].reshape(-1, 3, 3)
    for k in range(3):
        along = found[f"principal_direction_{k + 1}"]
        pulled = np.einsum("nij,nj->ni", tensor, along)
        value = found["principal_stresses"][:, [k]]
        assert pulled == pytest.approx(value * along, abs=1e-9 * p0)


def test_a_surface_moves_as_its_image_does() -> None:
    """A quarter of a dome under displacements u = (x, 2 y, 3): four quarters of the same field."""
    x = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    points = np.column_stack([x, -(x**2).sum(axis=1)])
    moved = np.column_stack([x * [1.0, 2.0], np.full(4, 3.0)])
    pieces = np.array([[0, 1, 2], [1, 3, 2]])
    found = symmetry.surface(
        Surface(
            points=points,
            local=x,
            triangles=pieces,
            pressure=np.arange(4.0),
            gap=np.zeros(4),
            displacement=moved,
        ),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    )
    assert len(found.points) == 16 and len(found.triangles) == 8
    expected = np.column_stack([found.points[:, :2] * [1.0, 2.0], np.full(16, 3.0)])
    np.testing.assert_array_equal(found.displacement, expected)


def test_tractions_of_a_half_are_those_of_the_whole() -> None:
    """Those of a wheel that pulls along, over |y|: even along the rail, odd across it."""
    y = np.array([0.5, 1.5])
    part = FrictionSolution(
        points=np.column_stack([y + 7, y, 0 * y]), weights=np.array([4.0, 2.0]), pressure=9 - y,
        bound=2 * y,
        traction=np.column_stack([3 - y, y, 0 * y]), slip=np.column_stack([-y, y, 0 * y]),
        sticks=y < 1, rigid_slip=np.zeros((2, 3)), rigid_motion=(1.0, 0.0, 0.0), force=(13.0, 0.0),
        moment=0.0,
    )  # fmt: skip
    found = symmetry.tractions(part, [(0.0, 1.0, 0.0)])
    assert found.weights @ found.pressure == 4 * 8.5 + 2 * 7.5
    assert (found.weights @ found.traction).tolist() == [4 * 2.5 + 2 * 1.5, 0.0, 0.0]
    assert found.friction_limit == 4 * 1.0 + 2 * 3.0
    np.testing.assert_array_equal(found.points[:, 0], np.abs(found.points[:, 1]) + 7)
    np.testing.assert_array_equal(found.slip[:, 1], found.points[:, 1])
    assert found.sticks.tolist() == [True, False] * 2 and len(found.rigid_slip) == 4


def test_plastic_strains_are_reflected_too(blocks) -> None:
    """Of a tensor of cells: what has one index across the plane turns its sign."""
    case = blocks("hexahedron", 1)
    grid = vtu.volume_grid(case.fields, case.stress)
    count = len(case.fields.cells)
    strain = np.arange(1.0, 1 + 9 * count).reshape(count, 9)
    grid.cell_data["plastic_strain"] = [strain]
    made = symmetry.grid(grid, [(1.0, 0.0, 0.0)]).cell_data["plastic_strain"][0]
    np.testing.assert_array_equal(made[:count], strain)
    np.testing.assert_array_equal(made[count:], strain * [1, -1, -1, -1, 1, 1, -1, 1, 1])
