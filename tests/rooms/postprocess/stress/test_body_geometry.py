"""Where a body is."""

from dataclasses import replace

import numpy as np
import pytest

from railhead.postprocess.stress.body_geometry import Solid

KINDS = [("hexahedron", 1), ("tetrahedron", 2)]


def rail(case) -> Solid:
    return Solid(case.fields, np.flatnonzero(case.fields.body == 1))


@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_a_line_ends_with_the_body(blocks, cell: str, degree: int) -> None:
    """On the symmetry axis, in the middle and from a tangent plane above the body."""
    case = blocks(cell, degree)
    solid, deep, down = rail(case), 3 * case.ellipse.b, np.array([0.0, 0.0, -1.0])
    for start in ([0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.1, 0.1, 0.5]):
        above = start[2]
        found = solid.extent(np.array(start), down, 100.0)
        assert found == pytest.approx(deep + above, rel=1e-9)
        assert solid.extent(np.array(start), down, 0.4 * deep) == pytest.approx(0.4 * deep)


def test_a_line_ends_at_a_gap(blocks) -> None:
    """What comes after it is another part."""
    case = blocks("tetrahedron", 2)
    fields, deep = case.fields, 3 * case.ellipse.b
    middles = fields.points[fields.cells[:, :4]].mean(axis=1)[:, 2]
    kept = (fields.body == 1) & ~((-deep / 2 < middles) & (middles < -deep / 3))
    solid = Solid(fields, np.flatnonzero(kept))
    found = solid.extent(np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0]), deep)
    assert found == pytest.approx(deep / 3, rel=1e-9)


@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_a_body_holds_its_points(blocks, cell: str, degree: int) -> None:
    solid = rail(blocks(cell, degree))
    rng = np.random.default_rng(1)
    corners = solid._fields.points[solid.corners]
    for point in np.concatenate([corners.mean(axis=1)[::50], corners[::50, 0]]):
        assert solid.holds(point)
        assert not solid.holds(point + [0.0, 0.0, 1.01 * abs(point[2]) + 1e-3 * rng.random()])


@pytest.mark.parametrize("cut", [True, False])
@pytest.mark.parametrize(("cell", "degree"), KINDS)
def test_sharp_edges_of_a_block(blocks, cell: str, degree: int, cut: bool) -> None:
    """Two of three coordinates at their ends; a cut at a symmetry plane is no end."""
    case = blocks(cell, degree, cut=cut)
    edges, points = rail(case).sharp_edges(), case.fields.points[case.fields.points[:, 2] <= 0]
    ends = [np.abs(edges[:, axis]) > 0.999 * np.abs(points[:, axis]).max() for axis in (0, 1)]
    ends.append((edges[:, 2] < 0.999 * points[:, 2].min()) | (edges[:, 2] > -1e-9))
    assert np.all(np.sum(ends, axis=0) >= 2)
    length = np.ptp(points, axis=0) @ ([2, 2, 1] if cut else [4, 4, 4])
    steps = np.linalg.norm(np.diff(edges.reshape(5, -1, 3), axis=0), axis=2)
    assert steps.sum() == pytest.approx(length, rel=1e-9)


def test_a_round_body_has_no_sharp_edge_on_its_tread(blocks) -> None:
    """Six elements a turn bend by 60 degrees from one to the next: its ends and sides are sharp."""
    case = blocks("hexahedron", 1, cut=False)
    x, y, z = case.fields.points.T
    turn = np.radians(59.5) * np.round(12 * (x - x.min()) / np.ptp(x))
    bent = np.column_stack([(40 + z) * np.cos(turn), y, (40 + z) * np.sin(turn)])
    edges = Solid(replace(case.fields, points=bent), np.flatnonzero(case.fields.body == 1))
    found = edges.sharp_edges()
    angle = np.degrees(np.arctan2(found[:, 2], found[:, 0]))
    at_ends = (np.abs(angle) < 1e-6) | (np.abs(angle + 6) < 1e-6)
    at_sides = np.abs(found[:, 1]) > 0.999 * np.abs(y).max()
    assert np.all(at_ends | at_sides)
    assert at_ends.any() and at_sides.any()
