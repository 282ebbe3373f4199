"""What a solution says beside pressure and displacement, and its files."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes

import railhead.solver as rs

YOUNG, YIELD, HARDENING = 1000.0, 5.0, 50.0


def columns(*law: object) -> tuple[rs.Solution, rs.Hub, rs.Contact]:
    """Two round columns that yield, pressed with 7 per area."""
    ends = (((0, -1), (1, 0)), ((0, 0), (1, 1)))
    made = rs.Model(*two_boxes("triangle", ((3, 2), (4, 2)), ends), section="axisymmetric")
    steel = rs.Plastic(YOUNG, 0.3, YIELD, *law)
    made.add(rs.Body(LOWER, steel), rs.Body(UPPER, steel), rs.Slide(21, normal=(0, 1)))
    pair, hub = made.add(rs.Contact(12, 11), rs.Hub(22, free=(0, -1), slides=True))
    return made.solve({hub: rs.Force(7.0 * np.pi)}), hub, pair


def test_plastic_strain_and_back_stress_of_a_column() -> None:
    """Uniaxial, by Armstrong and Frederick: stress - yield stress = C/g (1 - exp(-g p)) with the
    strain p along the axis, minus half of it across, and a back stress of 2/3 of that."""
    found, hub, pair = columns(0.0, [(HARDENING, 10.0)])
    way = -np.diag([-0.5, 1.0, -0.5])
    along = -np.log(1 - (7.0 - YIELD) * 10.0 / HARDENING) / 10.0 * way
    strain = found.plastic_strain.x.array.reshape(-1, 3, 3)
    np.testing.assert_allclose(strain, np.tile(along, (len(strain), 1, 1)), atol=1e-6)
    back = found.back_stress.x.array.reshape(-1, 3, 3)
    np.testing.assert_allclose(back, np.tile(4 / 3 * way, (len(back), 1, 1)), atol=1e-6)
    np.testing.assert_allclose(found.force(pair), [0.0, 7.0 * np.pi], atol=1e-6)


def block(*moves: float) -> list[rs.Solution]:
    """A block pressed with 10 on a rigid plane, then moved along it, mu 0.3."""
    made = rs.Model(
        *two_boxes("quadrilateral", ((8, 1), (8, 4)), (((0, -1), (2, 0)), ((0, 0), (2, 1)))),
        section="plane strain",
    )
    soft = rs.Elastic(YOUNG, 0.3)
    made.add(rs.Body(LOWER, soft), rs.Body(UPPER, soft), rs.Clamp(21), rs.Clamp(11))
    made.add(rs.Contact(12, rs.Plane((0, 0), (0, 1)), friction=0.3))
    hub = made.add(rs.Hub(22, free=(0, -1)))
    found = [made.solve({hub: rs.Force(10.0)})]
    for move in moves:
        found.append(found[-1].then({hub: rs.Force(10.0, move=(move, 0))}, steps=1))
    return found


def test_points_stick_or_slip_against_their_traction() -> None:
    pressed, held, slid, further = block(0.003, 0.4, 0.8)
    more = held.slip - pressed.slip
    assert 0 < held.sticking.sum() < len(held.sticking)
    assert not more[held.sticking].any() and np.abs(more[~held.sticking]).max(axis=1).all()
    across = held.traction + held.pressure[:, None] * held.normals
    size = np.linalg.norm(across, axis=1)
    limit = 0.3 * held.pressure
    np.testing.assert_allclose(size[~held.sticking], limit[~held.sticking], atol=1e-9)
    assert (size[held.sticking] < limit[held.sticking]).all()
    assert ((across * more).sum(axis=1) <= 0).all()
    assert not slid.sticking.any() and not further.sticking.any()
    # all slides: what friction takes is mu N times the way
    more = further.slip - slid.slip
    taken = -(further.weights[:, None] * further.traction * more).sum()
    assert taken == pytest.approx(0.3 * 10.0 * 0.4, rel=1e-6)


def test_files_of_a_solution_have_its_values(tmp_path: Path) -> None:
    found, hub, _ = columns(HARDENING)
    found.write(tmp_path / "column")
    found.then({hub: rs.Force(0.0)}).write(tmp_path / "column")
    names = sorted(path.name for path in (tmp_path / "column").iterdir())
    assert names == [f"{kind}_000{k}.vtu" for kind in ("bodies", "contact") for k in (1, 2)]
    bodies = meshio.read(tmp_path / "column" / "bodies_0001.vtu")
    area = meshio.read(tmp_path / "column" / "contact_0001.vtu")
    assert set(bodies.cell_data["body"][0]) == {LOWER, UPPER}
    stress = bodies.point_data["stress"].reshape(-1, 3, 3)
    np.testing.assert_allclose(stress[:, 1, 1], -7.0, rtol=1e-5)
    np.testing.assert_allclose(bodies.point_data["von_mises"], 7.0, rtol=1e-5)
    plastic = bodies.point_data["plastic_strain"].reshape(-1, 3, 3)
    np.testing.assert_allclose(plastic[:, 1, 1], -(7.0 - YIELD) / HARDENING, rtol=1e-4)
    top = bodies.points[:, 1].argmax()
    assert bodies.point_data["displacement"][top, 1] == pytest.approx(-found.motion(hub))
    count = len(found.points)
    np.testing.assert_allclose(area.points[:count, :2], found.points)
    for name in ("pressure", "traction", "gap", "slip"):
        given = area.point_data[name][:count].reshape(count, -1)
        expected = getattr(found, name).reshape(count, -1)
        np.testing.assert_allclose(given[:, : expected.shape[1]], expected)
    np.testing.assert_allclose(area.point_data["pressure"], 7.0, rtol=1e-5)


def test_files_of_hexahedra_and_facets(tmp_path: Path) -> None:
    """Facets have the mean of their points, so that they carry the same force."""
    ends = (((0, 0, -1), (1, 1, 0)), ((0, 0, 0), (1, 1, 1)))
    made = rs.Model(*two_boxes("hexahedron", ((2, 2, 1), (3, 3, 1)), ends), degree=1)
    soft = rs.Elastic(YOUNG, 0.0)
    made.add(rs.Body(LOWER, soft), rs.Body(UPPER, soft), rs.Clamp(21), rs.Contact(12, 11))
    found = made.solve({made.add(rs.Hub(22)): rs.Move((0, 0, -0.01))})
    found.write(tmp_path)
    grid = meshio.read(tmp_path / "contact_0001.vtu")
    assert found.plastic_strain is None
    assert [(block.type, len(block.data)) for block in grid.cells][1] == ("quad", 9)
    sides = np.diff(grid.points[grid.cells[1].data], axis=1)
    assert np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() == pytest.approx(1.0)
    np.testing.assert_allclose(grid.point_data["pressure"], 5.0, rtol=1e-6)
    volume = meshio.read(tmp_path / "bodies_0001.vtu")
    assert volume.cells[0].type == "hexahedron" and len(volume.cells[0].data) == 4 + 9
    np.testing.assert_allclose(volume.point_data["stress"][:, 8], -5.0, rtol=1e-6)
