"""Rigid surfaces that hubs move: the same as bodies that move the other way."""

import itertools

import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes
from dolfinx import fem
from test_energy import neo_hookean

import railhead.solver as rs
from railhead.solver import compat

FLAT = (((-1, -1), (1, 0)), ((5, 5), (6, 6)))
DEEP = (((-1, -1, -1), (1, 1, 0)), ((5, 5, 5), (6, 6, 6)))


def block(shape: object, mu: float, moved: bool, law: str = "linear") -> tuple:
    """A block under a rigid shape, and the hub of the one that moves."""
    dim = len(getattr(shape, "centre", (0, 0)))
    cell, counts = ("triangle", ((8, 3), (1, 1))) if dim == 2 else ("hexahedron", ((3, 2, 2),) * 2)
    made = rs.Model(
        *two_boxes(cell, counts, FLAT if dim == 2 else DEEP),
        section="plane strain" if dim == 2 else None,
        degree=2 if dim == 2 else 1,
    )
    own = rs.Energy(neo_hookean(made)) if law == "energy" else rs.Elastic(10.0, 0.3)
    made.add(rs.Body(LOWER, own), rs.Body(UPPER, rs.Elastic(1.0, 0.3)), rs.Clamp(22))
    made.add(rs.Contact(11, shape, friction=mu))
    up = np.eye(dim)[-1]
    if moved:
        made.add(rs.Clamp(21))
    return made, made.add(rs.Hub(shape, -up) if moved else rs.Hub(21, up))


@pytest.mark.parametrize(
    ("shape", "mu", "law"),
    [
        (rs.Sphere((0, 1), 1), 0.0, "linear"),
        (rs.Sphere((0, 1), 1), 0.3, "linear"),
        (rs.Sphere((0, 1), 1), 0.3, "energy"),
        (rs.Plane((0, 0), (0.1, -1)), 0.2, "linear"),
        (rs.Sphere((0, 0, 1), 1), 0.3, "linear"),
        (rs.Cylinder((0, 0, 1), 1, (0, 1, 0)), 0.3, "linear"),
    ],
)
def test_a_rigid_surface_moves_or_the_body_moves_the_other_way(
    shape: object, mu: float, law: str
) -> None:
    """Pressed by a force, then moved across it: forces, motions and pressures agree."""
    told = []
    for moved, sign in ((True, 1), (False, -1)):
        made, hub = block(shape, mu, moved, law)
        across = 0.02 * sign * np.eye(made.kinematics.dim)[0]
        pressed = made.solve({hub: rs.Force(0.2)}, steps=1)
        shifted = pressed.then({hub: rs.Force(0.2, move=across)}, steps=2)
        assert pressed.converged and shifted.converged
        for each in (pressed, shifted):
            assert each.force(hub) == pytest.approx(0.2, rel=1e-6)
            total = (each.weights[:, None] * each.traction).sum(axis=0)
            told.append([each.motion(hub), each.pressure.max(), *total])
    np.testing.assert_allclose(told[:2], told[2:], rtol=2e-3, atol=2e-3 * 0.2)
    if isinstance(shape, rs.Plane):  # slides everywhere, at the angle of friction to its normal
        assert told[1][2] == pytest.approx(0.2 * (mu + 0.1) / (1 - 0.1 * mu), rel=1e-6)


def test_a_rigid_surface_without_a_free_direction_has_a_force_vector() -> None:
    made, hub = block(rs.Sphere((0, 1), 1), 0.2, True)
    top = rs.Hub(made.parts[3].primary)
    made.parts[-1] = top
    found = made.solve({top: rs.Move((0.0, -0.03))}, steps=1)
    again = found.then({top: rs.Move((0.0, 0.0))}, steps=1)
    left = found.then({top: rs.Move((0.0, 1.0))}, steps=1)
    np.testing.assert_allclose(found.force(top), found.force(made.parts[3]))
    np.testing.assert_allclose(found.motion(top), (0.0, -0.03))
    assert found.force(top)[1] < -0.1
    assert not left.touching and left.converged
    assert abs(again.force(top)[1]) < 1e-3


def test_facets_take_the_values_of_a_function() -> None:
    """Their mean is the motion; they go back by another one; also along a free direction."""
    for degree, slides in itertools.product((1, 2), (False, True)):
        mesh, *tags = two_boxes("triangle", ((4, 2), (1, 1)), FLAT)
        made = rs.Model(mesh, *tags, section="plane strain", degree=degree)
        made.add(rs.Body(LOWER, rs.Elastic(10.0, 0.3)), rs.Body(UPPER, rs.Elastic(1.0, 0.3)))
        made.add(rs.Contact(11, rs.Plane((0, 0), (0, -1)), friction=1.0), rs.Clamp(22))
        hub = made.add(rs.Hub(21, free=(0, 1) if slides else None, slides=slides))
        field = fem.Function(compat.vector_space(mesh, degree))
        field.interpolate(lambda x, slides=slides: [(1 - slides) * 0.01 * x[0], 0.02 + 0.01 * x[0]])
        found = made.solve({hub: rs.Move(field)}, steps=1)
        again = found.then({hub: rs.Move((0, 0))}, steps=1)
        low = np.isclose(compat.dof_points(field.function_space)[:, 1], -1)
        ends = [each.x.array.reshape(-1, 2)[low] for each in (found.u, field)]
        np.testing.assert_allclose(*(each[:, 1:] if slides else each for each in ends), atol=1e-14)
        np.testing.assert_allclose(found.motion(hub), 0.02 if slides else (0, 0.02), atol=1e-12)
        assert found.converged and found.pressure.max() > 0.1 and again.pressure.max() < 1e-6


BALL = rs.Sphere((0, 1), 1)


def solved(*more: object) -> None:
    """A block under a ball on a hub, with more parts."""
    made = block(BALL, 0.0, True)[0]
    made.add(*more)
    made.solve()


def moved_by_another_mesh(rigid: bool) -> None:
    """The ball, or the facets below the block, by a Function of another mesh."""
    made, hub = block(BALL, 0.0, rigid)
    elsewhere = compat.vector_space(two_boxes("triangle", ((1, 1), (1, 1)), FLAT)[0], 1)
    made.solve({hub: rs.Move(fem.Function(elsewhere))})


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: rs.Hub(BALL, free=(0, 1), slides=True), "slides is for facets"),
        (lambda: solved(rs.Hub(rs.Sphere((0, 1), 1))), "is not the primary of a Contact"),
        (lambda: solved(rs.Contact(11, rs.Cylinder((0, 1), 1, (0, 1)))), "is for solids"),
        (lambda: moved_by_another_mesh(True), "not the rigid surface"),
        (lambda: moved_by_another_mesh(False), "on the model's mesh"),
    ],
)
def test_what_a_rigid_hub_cannot_have_is_refused(make, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        make()


def test_a_force_that_lifts_a_rigid_surface_off_is_named() -> None:
    made, hub = block(rs.Sphere((0, 1), 1), 0.0, True)
    found = made.solve({hub: rs.Force(-1.0)}, steps=1)
    assert not found.converged and found.reason.startswith("nothing holds a rigid surface")
