"""Input that a model cannot have, and what its parts say."""

import itertools
import re
import warnings

import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes
from curved import meshed
from dolfinx.mesh import meshtags

import railhead.solver as rs
from railhead.solver import compat
from railhead.solver.space.contact_interface import tangents_of

SOFT = rs.Elastic(1000.0, 0.3)
ENDS = (((0, -1), (1, 0)), ((0, 0), (1, 1)))


def boxes():
    return two_boxes("triangle", ((3, 2), (4, 2)), ENDS)


def model(**changes: object) -> rs.Model:
    made = rs.Model(*boxes(), **{"section": "plane strain", **changes})
    made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, SOFT), rs.Clamp(21))
    return made


def solved(
    *parts: object, loads: dict | None = None, steps: int | None = None, **changes: object
) -> rs.Solution:
    made = model(**changes)
    made.add(rs.Contact(secondary=12, primary=11), *parts)
    return made.solve(loads, steps=steps)


def turned() -> rs.Model:
    """Boxes on both sides of the axis."""
    both = (((-1, -1), (1, 0)), ((-1, 0), (1, 1)))
    return rs.Model(*two_boxes("triangle", ((3, 2), (4, 2)), both), section="axisymmetric")


def on_both_bodies() -> rs.Model:
    """The facets 11 and 12 of both boxes have the tag 12."""
    mesh, cells, facets = boxes()
    tags = np.where(facets.values == 11, 12, facets.values)
    facets = meshtags(mesh, facets.dim, facets.indices, tags)
    made = rs.Model(mesh, cells, facets, section="plane strain")
    made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, SOFT), rs.Clamp(21))
    made.add(rs.Contact(12, rs.Plane((0, 0), (0, 1))))
    return made


def surface():
    """Triangles in space, and tags of some of its cells and edges."""
    mesh = boxes()[0]
    x = np.column_stack([compat.node_points(mesh), np.zeros(len(mesh.geometry.x))])
    made = compat.cells_mesh(mesh.comm, compat.cell_nodes(mesh), x, "triangle")
    first = np.zeros(1, np.int32)
    return made, meshtags(made, 2, first, first), meshtags(made, 1, first, first)


def floating() -> rs.Model:
    """Boxes that only a force touches."""
    made = rs.Model(*boxes(), section="plane strain")
    made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, SOFT), rs.Contact(12, 11))
    made.add(rs.Hub(22, free=(0, -1)))
    return made


def given(gap: float, normal: tuple[float, float]) -> object:
    """The same gap and normal at all points."""
    return lambda x: (np.full(len(x), float(gap)), np.tile(np.array(normal, float), (len(x), 1)))


def pushed(load: object) -> rs.Solution:
    """Boxes under a load of a plate on which the upper one slides."""
    hub = rs.Hub(22, free=(0, -1), slides=True)
    return solved(hub, loads={hub: load})


def placed(hub: rs.Hub, friction: float = 0.0) -> tuple[rs.Model, rs.Hub]:
    """Boxes that touch, and a hub of the upper one."""
    made = model()
    made.add(rs.Contact(secondary=12, primary=11, friction=friction))
    return made, made.add(hub)


def held(load: object) -> tuple[rs.Solution, rs.Model]:
    """Boxes under a load of a hub that no force may move, and their model."""
    made, hub = placed(rs.Hub(22))
    return made.solve({hub: load}), made


@pytest.mark.parametrize(
    "make, told",
    [
        (lambda: rs.Elastic(-1.0, 0.3), "young_modulus must be positive"),
        (lambda: rs.Elastic(1.0, 0.5), "poisson_ratio must be in"),
        (lambda: rs.Contact(12, 12), "self-contact is not there"),
        (lambda: rs.Contact(12, None), "needs a primary surface, or a gap"),
        (lambda: rs.Contact(12, 11, friction=-0.1), "friction must not be negative"),
        (lambda: rs.Hub(22, slides=True), "needs a free direction"),
        (lambda: rs.Hub(22, free=(0, -1), slides="yes"), "slides must be True or False"),
        (lambda: rs.Elastic("x", 0.3), "young_modulus must be 1 finite number"),
        (lambda: rs.Elastic(1.0, None), "poisson_ratio must be 1 finite number"),
        (lambda: rs.Contact(12, 11, friction=None), "friction must be 1 finite number"),
        (lambda: rs.Sphere((0, 0), None), "radius must be 1 finite number"),
        (
            lambda: rs.Contact(12, rs.Plane((0, 0), (0, -1)), gap=given(0, (0, -1))),
            "give one of them",
        ),
        (lambda: model().add(rs.Contact(None, 11)), "a tag must be a whole number of 32 bits"),
        (lambda: model().add(rs.Clamp(2**40)), "a tag must be a whole number of 32 bits"),
        (lambda: model(degree=1.0), "degree 1.0 is not there"),
        (lambda: model(mean_dilatation="no"), "mean_dilatation must be True or False"),
        (lambda: pushed(rs.Move(None)), "motion must be 2 finite number"),
        (lambda: solved().force(21), "21 is no support or contact of the model"),
        (lambda: solved().motion(rs.Clamp(21)), "is no hub of the model"),
        (lambda: rs.Model(*surface(), section=None), "cells of dimension 2 need 2 coordinates"),
        (lambda: rs.Plastic(1.0, 0.3, 0.0), "yield_stress must be positive"),
        (lambda: rs.Sphere((0, 0), -1.0), "radius must be positive"),
        (lambda: rs.Plastic(1.0, 0.3, 1.0).material("plane stress"), "not there in plane stress"),
        (lambda: turned(), "r from 0 on, not from -1"),
        (lambda: solved(steps=-1), "steps must be a whole number from 1 on, not -1"),
        (lambda: solved(steps=0), "steps must be a whole number from 1 on, not 0"),
        (lambda: solved(rs.Body(LOWER, SOFT)), "a body is named twice"),
        (
            lambda: solved(rs.Contact(12, None, gap=lambda x: (0 * x[:, 0], [(0, -2)] * len(x)))),
            "gap of surface 12 must give",
        ),
        (lambda: solved(rs.Contact(12, None, gap=lambda x: x[:, 0])), "gap of surface 12 must"),
        (lambda: solved(rs.Contact(12, rs.Plane((0, 0, 0), (0, 1)))), "point must be 2 finite"),
        (lambda: model().add(rs.Slide(30, normal=(1, 0, 0))), "normal must be 2 finite number"),
        (lambda: model().add(rs.Slide(30, normal=1)), "normal must be 2 finite number"),
        (lambda: model().add(rs.Body(3, SOFT, force=-2.0)), "force must be 2 finite number"),
        (lambda: model().add(rs.Body(3, SOFT, force=(0, np.nan))), "force must be 2 finite"),
        (lambda: solved(rs.Contact(12, rs.Sphere((0, np.nan), 1))), "centre must be 2 finite"),
        (lambda: solved(rs.Contact([12], 30)), "a tag must be a whole number"),
        (lambda: rs.Model(*boxes()[:2], None, section="plane strain"), "must be MeshTags of cells"),
        (lambda: solved(rs.Contact(11, 12)), "these surfaces have a second Contact"),
        (lambda: solved(rs.Contact(12, 11)), "these surfaces have a second Contact"),
        (lambda: on_both_bodies().solve(), "secondary surface 12 lies on the bodies [1, 2]"),
        (lambda: solved(rs.Clamp(22), rs.Hub(22)), "holds the same facets"),
        (lambda: solved(rs.Hub(22, (0, 1), True), rs.Hub(22, (1, 0), True)), "holds the same"),
        (
            lambda: solved(rs.Contact(12, None, gap=given(np.nan, (0, -1)))),
            "gap of surface 12 must",
        ),
        (lambda: solved(rs.Contact(12, None, gap=given(0, (0, 1)))), "n outward unit normals"),
        (lambda: solved(rs.Contact(12, None, gap=given(0, (1, 0)))), "n outward unit normals"),
        (lambda: pushed(rs.Move((0.5, -0.01))), "moves across the free direction"),
        (lambda: pushed(rs.Force(1.0, move=(0.5, 0))), "moves across the free direction"),
        (lambda: pushed(rs.Force("10")), "value must be 1 finite number"),
        (lambda: solved(steps=True), "steps must be a whole number from 1 on, not True"),
        (lambda: floating().solve(), "nothing holds the bodies"),
        (lambda: model(section="plain strain"), "section 'plain strain' is unknown"),
        (lambda: model(section=None), "does not fit a mesh with 2 coordinates"),
        (lambda: model(degree=3), "degree 3 is not there"),
        (lambda: model().solve(), "a model needs a Contact"),
        (lambda: solved(rs.Clamp(77)), "no facet carries the tag 77"),
        (lambda: solved(rs.Body(7, SOFT)), "no cell carries the tag 7"),
        (lambda: solved(rs.Slide(30, normal=(0, 0))), "normal must have a direction"),
        (lambda: solved(rs.Contact(12, 31)), "their normals miss"),
        (
            lambda: solved(rs.Contact(12, None, gap=lambda x: (x[:, 0] + np.inf, x))),
            "surface 12 has nothing opposite",
        ),
        (lambda: solved(loads={rs.Hub(22): rs.Move((0, 0))}), "is no hub of the model"),
        (lambda: model().add(rs.Body(LOWER, "steel")), "needs a material"),
        (lambda: pushed(10), "10 is no load of a hub"),
        (lambda: solved(loads=5), "loads must be a dict"),
        (lambda: rs.Model(None, *boxes()[1:]), "mesh must be a dolfinx Mesh, not None"),
        (lambda: held(rs.Force(1.0)), "has no free direction for a force"),
        (lambda: held(rs.Move((0, 0, -1))), "motion must be 2 finite number"),
        (lambda: held(rs.Move((0, 0)))[1].add(rs.Clamp(21)), "nothing can be added"),
    ],
)
def test_wrong_input_is_one_line(make, told: str) -> None:
    with pytest.raises((TypeError, ValueError), match=re.escape(told)) as found:
        make()
    assert "\n" not in str(found.value)


def test_a_body_that_nothing_stops_does_not_converge() -> None:
    """Pulled away from the other one under a force: an answer with a reason, and no way on."""
    made, hub = placed(rs.Hub(22, free=(0, 1)))
    found = made.solve({hub: rs.Force(1.0)})
    assert not found.converged and found.reason and found.history
    with pytest.raises(ValueError, match="there is no state to go on from"):
        found.then({hub: rs.Force(0.5)})


def test_a_force_above_what_friction_carries_is_said() -> None:
    """It converged with a motion of 1e10: the residual was below the rounding of that motion."""
    made, hub = placed(rs.Hub(22, free=(1, 0)), 0.3)
    pressed = made.solve({hub: rs.Force(0.0, move=(0, -0.01))}, steps=1)
    limit = 0.3 * pressed.weights @ pressed.pressure
    assert pressed.then({hub: rs.Force(0.9 * limit, move=(0, -0.01))}, steps=1).converged
    found = pressed.then({hub: rs.Force(1.2 * limit, move=(0, -0.01))}, steps=1)
    assert not found.converged and "above what friction carries" in found.reason


def test_no_friction_is_no_reason() -> None:
    """A load above what the block carries without hardening."""
    made = model()
    made.parts[1] = rs.Body(UPPER, rs.Plastic(1000.0, 0.3, 5.0))
    made.add(rs.Contact(secondary=12, primary=11))
    found = made.solve({made.add(rs.Hub(22, free=(0, -1), slides=True)): rs.Force(30.0)})
    assert not found.converged and "friction" not in found.reason


def test_forces_of_bodies_grow_with_the_steps_and_then_stay() -> None:
    """The weight of a block that rests with friction: at once, it yielded and did not converge."""
    ends = (((-1, -1), (2, 0)), ((0, 0), (1, 1)))
    made = rs.Model(*two_boxes("triangle", ((6, 2), (4, 3)), ends), section="plane strain")
    made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, rs.Plastic(1000.0, 0.3, 3.0, 20.0), (0, -2.0)))
    floor = made.add(rs.Clamp(21))
    made.add(rs.Contact(secondary=12, primary=11, friction=0.3))
    found = made.solve()
    for solution in (found, found.then({}, steps=1)):
        assert solution.converged
        np.testing.assert_allclose(solution.weights @ solution.pressure, 2.0, rtol=1e-6)
        np.testing.assert_allclose(solution.force(floor), [0.0, 2.0], atol=1e-6)


def test_a_block_that_is_moved_off_another_presses_no_more() -> None:
    """In one step and in several; it kept the points that it was paired with, and its force."""
    for steps in (1, 4):
        made, hub = placed(rs.Hub(22))
        pressed = made.solve({hub: rs.Move((0, -0.01))})
        gone = pressed.then({hub: rs.Move((3.0, -0.01))}, steps=steps)
        assert gone.converged and not gone.touching and gone.missed[0] == pytest.approx(1.0)
        np.testing.assert_allclose(gone.force(hub), 0.0, atol=1e-9)
        back = gone.then({hub: rs.Move((0, -0.01))}, steps=steps)
        np.testing.assert_allclose(back.force(hub), pressed.force(hub), rtol=1e-4, atol=1e-9)


def test_a_block_with_friction_is_lifted_off_another() -> None:
    """From a press and from rest; a step between two states without contact was taken back."""
    made, hub = placed(rs.Hub(22), 0.3)
    pressed = made.solve({hub: rs.Move((0, -0.01))})
    for lifted in (pressed.then({hub: rs.Move((0, 0.5))}), made.solve({hub: rs.Move((0, 0.2))})):
        assert lifted.converged and not lifted.touching
        np.testing.assert_allclose(lifted.force(hub), 0.0, atol=1e-5)


def test_no_force_is_a_state_after_a_force_and_from_rest() -> None:
    """Boxes of quadrilaterals that do not match; their points did not settle, by rounding."""
    ends = (((0, -1), (4, 0)), ((0, 0), (4, 1)))
    made = rs.Model(*two_boxes("quadrilateral", ((4, 2), (5, 2)), ends), section="plane strain")
    made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, SOFT), rs.Clamp(21))
    made.add(rs.Contact(secondary=12, primary=11))
    hub = made.add(rs.Hub(22, free=(0, -1)))
    pressed = made.solve({hub: rs.Force(10.0)})
    for still in (made.solve({}), pressed.then({hub: rs.Force(0.0)})):
        assert still.converged and still.pressure.max() < 1e-9
        again = still.then({hub: rs.Force(10.0)})
        np.testing.assert_allclose(again.weights @ again.pressure, 10.0, rtol=1e-6)


@pytest.mark.parametrize("size", [1e-9, 1.0])
def test_a_uniform_pressure_on_solids_of_any_size(size: float) -> None:
    """Two cubes of hexahedra that do not match; below 3e-8 their points were paired wrongly."""
    ends = (((0, 0, -1), (1, 1, 0)), ((0, 0, 0), (1, 1, 1)))
    mesh, *tags = two_boxes("hexahedron", ((3, 3, 2), (4, 4, 2)), ends)
    mesh.geometry.x[:] *= size
    made = rs.Model(mesh, *tags, degree=1)
    made.add(rs.Body(LOWER, rs.Elastic(1e3, 0.0)), rs.Body(UPPER, rs.Elastic(1e3, 0.0)))
    made.add(rs.Clamp(21), rs.Contact(secondary=12, primary=11))
    found = made.solve({made.add(rs.Hub(22, free=(0, 0, -1))): rs.Force(size**2)})
    np.testing.assert_allclose(found.pressure, 1.0, rtol=1e-6)


def test_straight_facets_on_an_arc_are_warned_of_and_what_misses_is_told() -> None:
    def make(occ) -> list[int]:
        half = [(2, occ.addRectangle(-10, 0, 0, 20, 10))]
        disc = occ.intersect([(2, occ.addDisk(0, 10, 0, 10, 10))], half)[0][0][1]
        return [occ.addRectangle(-4, -8, 0, 8, 8), disc]

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        if body == 1:
            return 11 if box[1] > -1e-6 else 21 if box[3] < -7.9 else 31
        return 22 if box[1] > 9.9 else 12

    missed = []
    for order, pair in itertools.product((1, 2), ((11, 12), (12, 11))):
        made = rs.Model(*meshed(make, tag, "2", order), section="plane strain")
        made.add(rs.Body(1, SOFT), rs.Body(2, SOFT), rs.Clamp(21))
        made.add(rs.Contact(*pair))
        hub = made.add(rs.Hub(22, free=(0, -1)))
        with warnings.catch_warnings(record=True, action="always") as told:
            found = made.solve({hub: rs.Force(1.0)})
        assert any("are straight on a curved surface" in str(w.message) for w in told) == (
            order == 1
        )
        missed += found.missed
    assert max(missed[::2]) < 0.01 and all(0.2 < each < 0.9 for each in missed[1::2])


def test_a_roller_that_nothing_holds_along_its_plates_is_named() -> None:
    """Pushed aside between plates without friction; the linear solver stalled, and no more."""

    def make(occ) -> list[int]:
        low, high = (occ.addRectangle(-2, y, 0, 4, 1) for y in (-2, 1))
        return [low, occ.addDisk(0, 0, 0, 1, 1), high]

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        if body == 2 or box[3] - box[1] > 1e-3:
            return 12 * (body == 2)
        return 10 + body if abs(box[1]) < 1.5 else 20 + body

    made = rs.Model(*meshed(make, tag, "0.3"), section="plane strain", degree=1)
    made.add(*(rs.Body(k, SOFT, (0.1 * (k == 2), 0)) for k in (1, 2, 3)), rs.Clamp(21))
    made.add(*(rs.Contact(12, plate) for plate in (11, 13)))
    found = made.solve({made.add(rs.Hub(23, free=(0, -1))): rs.Force(4.0)})
    assert not found.converged and len(found.history) < 100
    told = re.fullmatch(r"nothing holds the body around (.*): it may move along (.*)", found.reason)
    place, along = (np.array([float(x) for x in told[k][1:-1].split(",")]) for k in (1, 2))
    np.testing.assert_allclose(place, 0, atol=0.05)
    np.testing.assert_allclose(along, [1, 0], atol=0.1)


def test_a_disc_that_rests_on_a_block_is_free_to_roll() -> None:
    """Its points of contact never settled: that was all that was said."""

    def make(occ) -> list[int]:
        return [occ.addRectangle(-2, -2, 0, 4, 2), occ.addDisk(0, 1, 0, 1, 1)]

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        return 12 if body == 2 else 11 if box[1] > -1e-6 else 21 * (box[3] < -1.9)

    made = rs.Model(*meshed(make, tag, "0.4"), section="plane strain")
    made.add(rs.Body(1, SOFT), rs.Body(2, SOFT, (0, -1)), rs.Clamp(21), rs.Contact(12, 11))
    found = made.solve()
    told = re.fullmatch(r"nothing holds the body around .*: it may move along (.*)", found.reason)
    along = np.array([float(x) for x in told[1][1:-1].split(",")])
    assert not found.converged and abs(along[0]) > 0.99


def test_nearly_incompressible_bodies_are_told_to_lock() -> None:
    for mean in (False, True):
        made = rs.Model(*boxes(), section="plane strain", mean_dilatation=mean)
        made.add(rs.Body(LOWER, SOFT), rs.Body(UPPER, rs.Elastic(1.0, 0.4999)), rs.Clamp(21))
        made.add(rs.Contact(12, 11))
        with warnings.catch_warnings(record=True, action="always") as told:
            made.solve()
        assert any("mean_dilatation=True" in str(w.message) for w in told) != mean


def test_tangents_are_orthonormal_whatever_the_normal() -> None:
    for normals in (np.eye(3), -np.eye(3), np.array([[0.6, 0.8, 0.0]])):
        frame = np.concatenate([normals[:, None], tangents_of(normals)], axis=1)
        products = frame @ np.swapaxes(frame, 1, 2)
        np.testing.assert_allclose(products, np.tile(np.eye(3), (len(normals), 1, 1)), atol=1e-12)
