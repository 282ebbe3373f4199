"""Bodies with an energy of their own, in finite strain, and contact of deformed surfaces."""

import dolfinx
import numpy as np
import pytest
import ufl
from boxes import LOWER, UPPER, two_boxes
from scipy.integrate import simpson
from scipy.optimize import brentq

import railhead.solver as rs
from railhead.solver import compat

MU, LAM = 1.0, 2.0
SQUARE = (((0, -1), (1, 0)), ((0, 0), (1, 1)))
CUBE = (((0, 0, -1), (1, 1, 0)), ((0, 0, 0), (1, 1, 1)))


def neo_hookean(model: rs.Model, revolved: bool = False) -> object:
    """mu/2 (tr F^T F - d - 2 ln J) + lambda/2 (ln J)^2."""
    u, hoop = model.u, 0.0
    f = ufl.Identity(len(u)) + ufl.grad(u)
    if revolved:
        hoop = u[0] / ufl.SpatialCoordinate(u.function_space.mesh)[0]
    log = ufl.ln(ufl.det(f) * (1 + hoop))
    trace = ufl.tr(f.T * f) - len(u) + hoop * (2 + hoop)
    return MU / 2 * (trace - 2 * log) + LAM / 2 * log**2


def uniaxial(stretch: float, ways: int) -> tuple[float, float]:
    """Force per area before deformation, and stress, of free sides; ways: sides that move."""
    side = brentq(lambda a: MU * (a * a - 1) + LAM * np.log(a**ways * stretch), 0.5, 2.0)
    force = (MU * (stretch**2 - 1) + LAM * np.log(side**ways * stretch)) / stretch
    return force, force / side**ways


@pytest.mark.parametrize(
    ("cell", "section", "secondary", "steps", "stretch"),
    [
        ("triangle", "plane strain", 12, 1, 0.7),
        ("triangle", "plane strain", 11, 8, 0.4),
        ("quadrilateral", "plane strain", 11, 1, 0.7),
        ("triangle", "axisymmetric", 12, 1, 0.7),
        ("tetrahedron", None, 12, 1, 0.7),
    ],
)
def test_blocks_pressed_to_30_and_60_percent(
    cell: str, section: str, secondary: int, steps: int, stretch: float
) -> None:
    """Meshes that do not match, no friction: the uniaxial closed form at every point."""
    dim, revolved = 2 + (section is None), section == "axisymmetric"
    counts = ((2, 1, 1), (1, 2, 1)) if dim == 3 else ((3, 2), (4, 3))
    model = rs.Model(*two_boxes(cell, counts, CUBE if dim == 3 else SQUARE), section=section)
    psi, up = neo_hookean(model, revolved), np.eye(dim)[-1]
    model.add(*(rs.Body(tag, rs.Energy(psi)) for tag in (LOWER, UPPER)))
    for axis in range(dim - 1):
        model.add(rs.Slide(30 + 2 * axis, normal=np.eye(dim)[axis]))
    model.add(rs.Contact(secondary, 23 - secondary))
    floor, lid = model.add(rs.Slide(21, normal=up), rs.Hub(22, free=-up, slides=True))
    found = model.solve({lid: rs.Move(2 * (stretch - 1) * up)}, steps=steps)
    force, stress = uniaxial(stretch, 1 if section == "plane strain" else 2)
    assert found.converged and len(found.history) <= 8 * steps
    np.testing.assert_allclose(found.pressure, -stress, rtol=1e-6)
    area = np.pi if revolved else 1.0
    assert (found.force(lid), found.force(floor)[-1]) == pytest.approx(
        (-force * area, -force * area), rel=1e-06
    )
    tensor = found.stress.x.array.reshape(-1, 3, 3)
    np.testing.assert_allclose(tensor[:, dim - 1, dim - 1], stress, rtol=1e-6)


def test_work_of_a_rigid_cylinder_is_the_energy() -> None:
    """A cylinder of radius 1 is pressed by 0.3 into a block: energy and force agree."""
    made = two_boxes("triangle", ((8, 8), (1, 1)), (((0, -2), (2, 0)), ((5, 0), (6, 1))))
    made[0].geometry.x[:] *= np.abs(made[0].geometry.x) / 2  # finer at the contact
    model = rs.Model(*made, section="plane strain")
    psi = neo_hookean(model)
    model.add(rs.Body(LOWER, rs.Energy(psi)), rs.Body(UPPER, rs.Elastic(1.0, 0.3)))
    model.add(rs.Contact(11, rs.Sphere((0, 1), 1)), rs.Slide(30, (1, 0)), rs.Clamp(22))
    base, work, force = model.add(rs.Hub(21)), [0.0], [0.0]
    energy = compat.form(psi * ufl.dx, made[0])
    way = np.linspace(0, 0.3, 13)
    found = model.solve()
    for depth in way[1:]:
        found = found.then({base: rs.Move((0, depth))})
        assert found.converged and len(found.history) <= 12
        model.u.x.array[:] = found.u.x.array
        work.append(dolfinx.fem.assemble_scalar(energy))
        force.append(found.force(base)[1])
    assert simpson(force, x=way) == pytest.approx(work[-1], rel=2e-3)


def test_a_body_pushed_along_a_surface_without_friction_is_named() -> None:
    """It parts from the other one, and its rigid motions have no stiffness at all: that ended in an
    error of linear algebra."""
    ends = ((-2, -1), (2, 0)), ((0, 0), (1, 1))
    model = rs.Model(*two_boxes("triangle", ((8, 2), (4, 3)), ends), section="plane strain")
    law = rs.Energy(neo_hookean(model))
    model.add(rs.Body(LOWER, law), rs.Body(UPPER, law), rs.Clamp(21), rs.Contact(12, 11))
    model.add(rs.Traction(22, (0.02, -0.1)))
    found = model.solve()
    assert not found.converged and "nothing holds the body around (0.5, 0.5)" in found.reason


def test_what_does_not_go_with_an_energy_is_refused() -> None:
    def model(section: str = "plane strain") -> rs.Model:
        return rs.Model(*two_boxes("triangle", ((1, 1), (1, 1)), SQUARE), section=section)

    for given in (1.0, ufl.Identity(2)):
        with pytest.raises(ValueError, match="psi must be a UFL expression of a number"):
            rs.Energy(given)
    for section, part, told in (
        ("plane stress", rs.Contact(12, 11), "plane stress does not go with an Energy"),
        ("plane strain", rs.Tie(12, 11), "Tie does not go with an Energy"),
    ):
        made = model(section)
        law = rs.Energy(neo_hookean(made))
        made.add(rs.Body(LOWER, law), rs.Body(UPPER, law), rs.Clamp(21), part)
        with pytest.raises(ValueError, match=told):
            made.solve()
    made, other = model(), model()
    made.add(rs.Body(LOWER, rs.Energy(neo_hookean(other))), rs.Body(UPPER, rs.Elastic(1.0, 0.3)))
    made.add(rs.Clamp(21), rs.Contact(12, 11))
    with pytest.raises(ValueError, match="must depend on model.u"):
        made.solve()
