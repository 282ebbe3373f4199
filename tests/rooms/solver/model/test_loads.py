"""Constants that vary from cell to cell, thermal strain, surface loads and springs."""

import dolfinx
import numpy as np
import pytest
import ufl
from boxes import LOWER, UPPER, two_boxes

import railhead.solver as rs
from railhead.solver import compat

ENDS = (((0, -1), (1, 0)), ((0, 0), (1, 1)))
BODIES = LOWER, UPPER


def columns(cell: str = "triangle", section: str = "axisymmetric") -> tuple:
    """Mesh and tags of one box on another; and a Function (DG0) of it by the height z."""
    made = two_boxes(cell, ((3, 4), (4, 4)), ENDS)
    mesh = made[0]

    def field(value: object) -> object:
        middle = compat.node_points(mesh)[compat.cell_nodes(mesh)].mean(axis=1)
        return compat.cellwise_constant(mesh, np.asarray(value(middle[:, 1]), float))

    return rs.Model(*made, section=section), field


@pytest.mark.parametrize("section", ["axisymmetric", "plane stress"])
def test_layers_of_a_column_add_their_compliances(section: str) -> None:
    """Four layers a body, without Poisson's ratio: pressed by 1, each is shorter by height/E."""
    made, field = columns(section=section)
    young = field(lambda z: np.where(np.floor(4 * z) % 2 == 0, 1000.0, 250.0))
    made.add(*(rs.Body(tag, rs.Elastic(young, field(lambda z: 0 * z))) for tag in BODIES))
    made.add(rs.Slide(21, normal=(0, 1)), rs.Slide(30, normal=(1, 0)), rs.Contact(12, 11))
    made.add(rs.Pressure(22, 1.0))
    found = made.solve()
    np.testing.assert_allclose(found.pressure, 1.0, rtol=1e-8)
    top = found.u.x.array.reshape(-1, 2)[:, 1].min()
    assert top == pytest.approx(-(1 / 1000 + 1 / 250), rel=1e-8)


def test_yield_stress_and_hardening_of_cells() -> None:
    """Uniaxial plastic strain of each body, (7 - yield stress)/hardening, from one Function."""
    made, field = columns()
    steel = rs.Plastic(
        1000.0, 0.3, field(lambda z: 5.0 + (z > 0)), field(lambda z: 50 - 25 * (z > 0))
    )
    made.add(*(rs.Body(tag, steel) for tag in BODIES), rs.Slide(21, normal=(0, 1)))
    hub, _ = made.add(rs.Hub(22, free=(0, -1), slides=True), rs.Contact(12, 11))
    found = made.solve({hub: rs.Force(7.0 * np.pi)}, steps=4)
    assert found.converged
    dofs = compat.cell_dofs(found.plastic_strain.function_space)
    strain = found.plastic_strain.x.array.reshape(-1, 3, 3)[:, 1, 1]
    for tag, exact in ((LOWER, 2 / 50), (UPPER, 1 / 25)):
        np.testing.assert_allclose(strain[dofs[made._mesh[1].find(tag)]], -exact, rtol=1e-5)
    assert found.pressure.min() == pytest.approx(7.0, rel=1e-6)


@pytest.mark.parametrize("section", ["axisymmetric", "plane strain", "plane stress"])
def test_a_heated_column_between_plates(section: str) -> None:
    """Both ends are held, the sides are free: thermal strain e1, e2 of two bodies makes the stress
    (e1 + e2)/(1/E1 + 1/E2), with e (1 + nu) and E/(1 - nu^2) in plane strain."""
    made, field = columns("quadrilateral", section)
    young, hot = (1000.0, 500.0), (1e-3, 2e-3)
    thermal = field(lambda z: np.where(z < 0, *hot))
    for tag, modulus in zip(BODIES, young, strict=True):
        made.add(rs.Body(tag, rs.Elastic(modulus, 0.3), thermal_strain=thermal))
    floor, lid = made.add(rs.Slide(21, normal=(0, 1)), rs.Slide(22, normal=(0, 1)))
    made.add(rs.Contact(12, 11), rs.Slide(30, normal=(1, 0)))
    found = made.solve()
    exact = sum(hot) / sum(1 / each for each in young)
    if section == "plane strain":
        exact *= 1.3 / (1 - 0.3**2)
    np.testing.assert_allclose(found.pressure, exact, rtol=1e-8)
    area = np.pi if section == "axisymmetric" else 1.0
    np.testing.assert_allclose(found.force(floor), [0, exact * area], atol=1e-8)
    np.testing.assert_allclose(found.force(lid), [0, -exact * area], atol=1e-8)
    stress = found.stress.x.array.reshape(-1, 3, 3)
    np.testing.assert_allclose(stress[:, 1, 1], -exact, rtol=1e-8)


def test_tractions_forces_and_a_spring_are_in_balance() -> None:
    """A traction and a body force that vary across the mesh, on a foundation."""
    made, _ = columns("triangle", "plane strain")
    x = ufl.SpatialCoordinate(made._mesh[0])
    soft = rs.Elastic(1000.0, 0.0)
    made.add(
        rs.Body(LOWER, soft, force=(0, -1)), rs.Body(UPPER, soft, ufl.as_vector([0, -2 * x[0]]))
    )
    made.add(rs.Slide(30, normal=(1, 0)), rs.Contact(12, 11))
    made.add(rs.Traction(22, lambda x: np.column_stack([0 * x[:, 0], 6 * x[:, 0] ** 2 - 5])))
    spring = made.add(rs.Spring(21, (0.0, 50.0)))
    found = made.solve()
    assert found.converged
    np.testing.assert_allclose(found.force(spring), [0.0, 1.0 + 1.0 + 3.0], atol=1e-8)
    u = found.u.x.array.reshape(-1, 2)
    at = compat.dof_points(found.u.function_space)
    assert u[np.isclose(at[:, 1], -1), 1].mean() == pytest.approx(-5.0 / 50, rel=0.01)


STEEL = rs.Elastic(1.0, 0.3)


def linear(mesh: dolfinx.mesh.Mesh) -> dolfinx.fem.Function:
    """A field that is not one number in each cell."""
    return dolfinx.fem.Function(compat._space(mesh, ("Lagrange", 1)))


@pytest.mark.parametrize(
    "wrong, told",
    [
        (lambda bad, _: rs.Body(LOWER, rs.Elastic(bad, 0.3)), "one number in each cell"),
        (lambda _, field: rs.Body(LOWER, rs.Elastic(field, 0.3)), "young_modulus must be positive"),
        (lambda bad, _: rs.Body(LOWER, STEEL, thermal_strain=bad), "one number in each cell"),
        (lambda bad, _: rs.Body(LOWER, STEEL, force=bad), "force must be a vector of 2 components"),
        (lambda *_: rs.Pressure(22, np.nan), "value must be finite"),
        (lambda *_: rs.Traction(22, (1, 2, 3)), "vector must be finite"),
        (lambda *_: rs.Spring(22, "stiff"), "stiffness must be finite"),
    ],
)
def test_fields_and_loads_that_do_not_fit_are_refused(wrong, told: str) -> None:
    made, field = columns()
    part = wrong(linear(made._mesh[0]), field(lambda z: z))
    below = () if isinstance(part, rs.Body) else (rs.Body(LOWER, STEEL),)
    with pytest.raises(ValueError, match=told):
        made.add(part, *below, rs.Body(UPPER, STEEL), rs.Clamp(21), rs.Contact(12, 11))
        made.solve()


@pytest.mark.parametrize("secondary", [11, 12])
def test_a_tie_is_pulled_and_sheared_like_one_piece(secondary: int) -> None:
    """Boxes that do not match: every point carries the uniform tension, and the surface the shear
    force, after a second solution, too."""
    made, _ = columns("quadrilateral", "plane strain")
    made.add(*(rs.Body(tag, rs.Elastic(1000.0, 0.0)) for tag in BODIES), rs.Slide(30, (1, 0)))
    made.add(rs.Clamp(21), rs.Tie(secondary, 23 - secondary), rs.Traction(22, (0, 2.0)))
    pulled = made.solve()
    assert pulled.converged and len(pulled.history) <= 3
    np.testing.assert_allclose(pulled.pressure, -2.0, rtol=1e-8)
    assert pulled.u.x.array.reshape(-1, 2)[:, 1].max() == pytest.approx(2 * 2.0 / 1000)
    sheared, _ = columns("quadrilateral", "plane strain")
    sheared.add(*(rs.Body(tag, rs.Elastic(1000.0, 0.0)) for tag in BODIES))
    sheared.add(rs.Tie(secondary, 23 - secondary), rs.Slide(30, normal=(0, 1)), rs.Clamp(21))
    sheared.add(rs.Slide(22, normal=(0, 1)), rs.Traction(22, (3.0, 0)))
    found = sheared.solve().then({})
    assert found.converged and found.sticking.all() and not found.slip.any()
    side = 1 if secondary == 12 else -1
    assert found.weights @ found.traction[:, 0] == pytest.approx(-3.0 * side, rel=1e-9)
    with pytest.raises(ValueError, match="Tie takes two tags"):
        rs.Tie(11, rs.Plane((0, 0), (0, 1)))


@pytest.mark.parametrize("secondary", [11, 12])
def test_a_given_gap_between_two_bodies(secondary: int) -> None:
    """A wedge in place of the flat meshes: the upper column turns until it is closed, and sinks."""
    made, _ = columns("quadrilateral", "plane stress")
    made.add(*(rs.Body(tag, rs.Elastic(1000.0, 0.0)) for tag in BODIES), rs.Clamp(21))
    side = 1 if secondary == 11 else -1

    def gap(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return 2e-3 + 1e-3 * x[:, 0], np.tile([0.0, side], (len(x), 1))

    lid = made.add(rs.Contact(secondary, 23 - secondary, gap=gap), rs.Hub(22))[1]
    field = made.u.copy()
    field.interpolate(lambda x: [1e-3 * x[1], -2e-3 - 1e-3 * x[0] - 1e-3])
    found = made.solve({lid: rs.Move(field)})
    assert found.converged
    np.testing.assert_allclose(found.pressure, 1000.0 * 1e-3 / 2, rtol=1e-3)


def test_points_that_turn_round_do_not_hold_newton_up() -> None:
    """A ball's gap between blocks of quadratic hexahedra, pressed in one step with friction: two
    linearisations took turns for 50 steps, until the load was cut."""
    ends = (((0, 0, -1), (1, 1, 0)), ((0, 0, 0), (1, 1, 1)))
    made = rs.Model(*two_boxes("hexahedron", ((4, 4, 3), (4, 4, 3)), ends))

    def gap(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return (x[:, :2] ** 2).sum(axis=1) / 40, np.tile([0, 0, 1.0], (len(x), 1))

    made.add(*(rs.Body(tag, rs.Elastic(100.0, 0.3)) for tag in BODIES), rs.Clamp(21))
    made.add(rs.Contact(11, 12, gap=gap, friction=0.3), rs.Slide(32, normal=(0, 1, 0)))
    found = made.solve({made.add(rs.Hub(22, free=(0, 0, -1))): rs.Force(1.0)}, steps=1)
    assert found.converged and len(found.history) <= 12
