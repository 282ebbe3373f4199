"""Where a body is, its smooth stresses and the largest of them, and the force that they carry."""

from dataclasses import replace

import numpy as np
import pytest
from painted import LAME
from solved import solved

from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.flux import contact_force, pressure_force
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery, stress_at
from railhead.solver.system.fields import ContactFields
from railhead.theory.elastic.subsurface import von_mises

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
    assert np.all(at_ends | at_sides) and at_ends.any() and at_sides.any()


@pytest.mark.parametrize("cut", [True, False])
@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_linear_stress_is_recovered_exactly(blocks, cell: str, cut: bool) -> None:
    """u = (x z, y z, z^2), symmetric about x = 0 and y = 0, inside, on a face and on the axis."""
    fields = blocks(cell, 2, cut=cut).fields
    x, y, z = fields.points.T
    fields = replace(fields, displacement=1e-4 * np.column_stack([x * z, y * z, z * z]))
    found = Recovery(fields, np.flatnonzero(fields.body == 1))
    points = np.array([[1.0, 2.0, -3.0], [2.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
    x, y, z = points.T
    lam, mu = LAME
    strain = np.column_stack([z, z, 2 * z, np.zeros(3), x / 2, y / 2])
    exact = 1e-4 * (lam * 4 * z[:, None] * [1, 1, 1, 0, 0, 0] + 2 * mu * strain)
    assert found.at(points) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    for point, expected in zip(points, exact, strict=True):
        around = found.around(point)
        assert around(points) == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())
        assert around(point[None])[0] == pytest.approx(expected, abs=1e-9 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("case", "power", "limit"), [("sphere_on_plane", 1.0, 1e-3), ("long_roller", 0.5, 0.02)]
)
def test_below_the_middle_they_are_those_of_a_half_space(case, power, limit) -> None:
    """sigma_zz = -p0/(1 + z^2/a^2) of a sphere, of a line the root of it, on a head of finite depth
    (K. L. Johnson, Contact Mechanics, 1985, eq. 3.45 and 4.46).
    """
    result = solved(case)
    a, p0, body = result.hertz.patch.a, result.hertz.pressure.max, result.findings.axis.body
    z = a * np.array([0.3, 0.5, 1.0])
    found = result.stress_at(np.outer(z, [0.0, 0.0, -1.0 if body == "rail" else 1.0]), body=body)
    assert found[:, 2] == pytest.approx(-p0 / (1 + (z / a) ** 2) ** power, rel=limit)
    assert power < 1.0 or found[:, 0] == pytest.approx(found[:, 1], abs=1e-3 * p0)


def test_a_meridian_section_is_turned() -> None:
    """The point at y has the stress of the one at x, with both axes exchanged."""
    result = solved("sphere_on_plane")
    r = result.hertz.patch.a
    along, across = result.stress_at(np.array([[r, 0, r], [0, r, r]]))
    assert across == pytest.approx(along[[1, 0, 2, 3, 5, 4]], abs=1e-9)
    assert abs(along[4]) > 10 and abs(along[5]) < 1e-9


def test_the_half_that_was_left_out_mirrors_the_other() -> None:
    result = solved("hertz_ellipse", "mesh.patch_size=1.2")
    here, ahead, aside = result.stress_at(
        np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]])
    )
    assert ahead == pytest.approx(here * [1, 1, 1, -1, -1, 1], rel=1e-9)
    assert aside == pytest.approx(here * [1, 1, 1, -1, 1, -1], rel=1e-9) and here[2] < -300


def test_what_is_outside_or_no_point_is_said() -> None:
    result = solved("sphere_on_plane")
    assert np.isnan(result.stress_at(np.array([[0, 0, -1.0], [0, 0, 100.0]]))).all()
    assert result.stress_at(np.zeros((0, 3))).shape == (0, 6)
    fields = result.fields
    assert fields is not None
    for points, body in (([1.0, 2.0], None), ([[0, 0, np.nan]], None), ([[0, 0, 1.0]], "rail")):
        with pytest.raises(ValueError, match=r"\(n, 3\)|no deformable"):
            stress_at(fields, np.array(points), body)


def test_no_search_starts_outside_the_body() -> None:
    """Above the rail the smooth stresses, extrapolated, are several times the largest ones."""
    fields = solved("hertz_ellipse", "mesh.patch_size=1.2").fields
    cells = np.flatnonzero(fields.body == 1)
    recovery = Recovery(fields, cells)
    search = Search(fields, Solid(fields, cells), recovery, np.zeros((0, 3)), 1.0)
    usual = search.highest(von_mises, np.zeros((0, 3)))
    above = np.array([[0.0, 0.0, 6.0]])
    assert usual is not None and von_mises(recovery.at(above))[0] > 2 * usual.value
    assert search.highest(von_mises, above) == usual


TOUCHED = 2.0  # mm, radius of a disc on the common plane


def touching(case, displacement, pressure):
    """The blocks with a displacement, touching where a pressure (x, y) is positive."""
    fields = case.fields
    top = fields.points[np.isclose(fields.points[:, 2], 0.0)]
    zeros, up = np.zeros(len(top)), np.tile([0.0, 0.0, 1.0], (len(top), 1))
    contact = ContactFields(
        points=top,
        weights=zeros + 1.0,
        pressure=pressure(*top[:, :2].T),
        indicator=zeros,
        gap=zeros,
        normals=up,
        facet=zeros.astype(int),
        xi=top[:, :2],
        facet_nodes=np.zeros((0, 3), dtype=int),
        facing=np.zeros(0, dtype=bool),
    )
    return replace(fields, displacement=displacement, contact=contact)


@pytest.mark.parametrize(
    ("cell", "degree"), [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1)]
)
def test_uniform_stress_times_the_area_of_the_weight(blocks, cell, degree) -> None:
    """A disc of radius r with the weight 1, falling as a cubic to 0 at 2 r."""
    case = blocks(cell, degree, cut=False)
    strain = np.array([[1.0, 0.2, 0.1], [0.2, -0.5, 0.3], [0.1, 0.3, -2.0]]) * 1e-3
    disc = lambda x, y: np.where(np.hypot(x, y) < TOUCHED, 1.0, 0.0)  # noqa: E731
    fields = touching(case, case.fields.points @ strain.T, disc)
    stress = LAME[0] * np.trace(strain) * np.eye(3) + 2 * LAME[1] * strain
    radius = 1.1 * np.hypot(*fields.contact.points[fields.contact.pressure > 0][:, :2].T).max()
    t = (np.arange(1000) + 0.5) / 1000
    area = np.pi * radius**2 * (1 + 2 * np.mean((1 + t) * (1 - 3 * t**2 + 2 * t**3)))
    for body in (1, 2):
        assert contact_force(fields, body) == pytest.approx(area * stress[:, 2], rel=0.02)


@pytest.mark.parametrize("cut", [True, False])
def test_hertz_load_around_the_patch(blocks, cut) -> None:
    """Exact displacements at the nodes of half-spaces, sides of the blocks included."""
    case = blocks("tetrahedron", 2, cut)
    fields = touching(case, case.fields.displacement, case.ellipse.pressure)
    for body in (1, 2):
        along, across, force = contact_force(fields, body) / case.ellipse.load
        assert force == pytest.approx(-1.0, rel=0.01) and abs(along) < 0.01 and abs(across) < 0.01


@pytest.mark.parametrize("slave", [1, 2])
def test_pressure_pushes_the_rail_away_from_the_wheel(blocks, slave) -> None:
    case = blocks("tetrahedron", 1)
    fields = touching(case, case.fields.displacement, lambda x, y: 0.0 * x + 2.0)
    contact = replace(fields.contact, normals=(1.5 - slave) * 2 * fields.contact.normals)
    fields = replace(fields, contact=contact, slave=slave)
    total = 4 * 2.0 * len(contact.points)
    assert pressure_force(fields) == pytest.approx([0.0, 0.0, -total])
