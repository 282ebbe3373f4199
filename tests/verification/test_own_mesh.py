"""Contact for a mesh of one's own (`rs.Model`) beside closed forms."""

import warnings

import dolfinx
import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes
from curved import meshed
from mpi4py import MPI

import railhead.solver as rs
from railhead.geometry.surfaces import Cosine

E, NU = 1000.0, 0.3
STRAIN = E / (1 - NU**2)
SOFT = rs.Elastic(E, NU)
BOTH = rs.Body(1, SOFT), rs.Body(2, SOFT)


def model_of(mesh, *parts, **options) -> rs.Model:
    """Model of a mesh with its tags, and these parts in it."""
    model = rs.Model(*mesh, **options)
    model.add(*parts)
    return model


def rectangle(width: float, depth: float, size: str):
    """Mesh of a rectangle below y = 0: 11 its upper side, 21 the lower, 30 the left, 31 the right
    one."""

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        _, low, right, high = box
        return 30 if right < 1e-6 else 11 if low > -1e-6 else 21 if high < 1e-5 - depth else 31

    return meshed(lambda occ: [occ.addRectangle(0, -depth, 0, width, depth)], tag, size)


def block(size: float, a: float, n: int):
    """Meridian section of a cylinder under z = 0, n elements over a at the axis."""
    return rectangle(size, size, f"{a / n}+0.15*Max(0,Sqrt(x*x+y*y)-{1.6 * a})")


def rings(radii, corner: tuple[float, float], extent: tuple[float, float], size: str):
    """Mesh of two rings of (inner, outer) radii around the origin, cut out by a rectangle: 11 and
    21 the outer and inner circle of the inner ring, 22 and 12 those of the outer one, 30 and 31
    the cuts along y and x."""

    def make(occ) -> list[int]:
        window, out = (2, occ.addRectangle(*corner, 0, *extent)), []
        for low, high in radii:
            ring = occ.cut(*([(2, occ.addDisk(0, 0, 0, r, r))] for r in (high, low)))[0]
            out.append(occ.intersect(ring, [window], removeTool=False)[0][0][1])
        occ.remove([window], recursive=True)
        return out

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        if box[2] < 1e-6 or (corner[1] == 0 and box[3] < 1e-6):
            return 30 if box[2] < 1e-6 else 31
        far = max(box[2], box[3], -box[1]) > radii[body - 1][0] + 1
        return (11 if far else 21) if body == 1 else (22 if far else 12)

    return meshed(make, tag, size)


def quarter(occ, radius: float, low: float) -> int:
    """Lower right quarter of a disc whose lowest point lies at y = low on the axis."""
    disc = [(2, occ.addDisk(0, low + radius, 0, radius, radius))]
    return occ.intersect(disc, [(2, occ.addRectangle(0, low, 0, radius, radius))])[0][0][1]


def ball_on_block(radius: float, a: float, n: int, gap: float):
    """Meridian section, or half, of half a ball over a block of 8 mm; 22: its flat face."""

    def make(occ) -> list[int]:
        return [occ.addRectangle(0, -8, 0, 8, 8), quarter(occ, radius, gap)]

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        _, low, right, high = box
        if right < 1e-6:
            return 30
        if body == 1:
            return 11 if low > -1e-6 else 21 if high < -7.9 else 31
        return 22 if low > radius + gap - 1e-5 else 12

    size = f"{a / n}+0.2*Max(0,Sqrt(x*x+y*y)-{1.5 * a + gap})"
    return meshed(make, tag, size)


BOXES = [("triangle", "plane strain"), ("quadrilateral", "plane strain")]
BOXES += [("triangle", "axisymmetric"), ("quadrilateral", "axisymmetric")]
BOXES += [("tetrahedron", None), ("hexahedron", None)]


@pytest.mark.parametrize("secondary", [LOWER, UPPER])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("cell, section", BOXES)
def test_contact_patch_test_at_every_point(
    cell: str, section: str | None, degree: int, secondary: int
) -> None:
    """Boxes of different, uneven meshes under a sliding plate: each contact point has the pressure
    of the load to 1 %, whichever box has the points, and the stress in the cells is uniaxial."""
    dim = 3 if section is None else 2
    counts = ((3,) * (dim - 1) + (2,), (4,) * (dim - 1) + (2,))
    ends = (((0,) * dim, (1,) * dim), ((0,) * (dim - 1) + (1,), (1,) * (dim - 1) + (2,)))
    mesh = two_boxes(cell, counts, ends, bend=0.1, interface=1.0)
    axes = np.eye(dim)
    sides = [rs.Slide(30 + 2 * axis, normal=axes[axis]) for axis in range(dim - 1)]
    pair = rs.Contact(secondary=10 + secondary, primary=13 - secondary)
    model = model_of(mesh, *BOTH, pair, *sides, section=section, degree=degree)
    base = model.add(rs.Slide(21, normal=axes[-1]))
    plate = model.add(rs.Hub(22, free=-axes[-1], slides=True))
    load = 100.0 * (np.pi if section == "axisymmetric" else 1.0)
    found = model.solve({plate: rs.Force(load)})
    assert found.converged and found.touching
    np.testing.assert_allclose(found.pressure, 100.0, rtol=0.01)
    assert found.force(plate) == pytest.approx(load, rel=1e-9)
    np.testing.assert_allclose(found.force(base), load * axes[-1], atol=1e-6 * load)
    stress = found.stress.x.array.reshape(-1, 3, 3)
    np.testing.assert_allclose(stress[:, dim - 1, dim - 1], -100.0, rtol=0.01)
    np.testing.assert_allclose(stress[:, 0, 0], 0.0, atol=0.5)
    modulus = STRAIN if section == "plane strain" else E
    assert found.motion(plate) == pytest.approx(100.0 * 2.0 / modulus, rel=1e-6)


PERSSON = {10: (82.2206, 3.6616), 30: (7.9435, 1.2603), 60: (1.0672, 0.7117)}
"""Half angle of contact in degrees -> (E dR/Q, p_max R/Q) of a pin in a hole, like bodies in plane
stress (A. Persson, On the stress distribution of cylindrical elastic bodies in contact, 1964)."""


def persson(half: float, angle: np.ndarray) -> np.ndarray:
    """p R/Q at angles from the middle of the contact, with its half angle, in radians."""
    b, y = np.tan(half / 2), np.tan(angle / 2)
    inner, outer = np.sqrt(np.maximum(b**2 - y**2, 0.0)), np.sqrt(b**2 + 1)
    logarithm = np.log((outer + inner) / (outer - inner)) / (2 * np.pi * b**2 * (1 + b**2))
    return 2 * inner / (np.pi * outer * (1 + y**2)) + logarithm


@pytest.mark.parametrize(
    "angle, secondary",
    [(30, 11), (30, 12)]
    + [pytest.param(each, tag, marks=pytest.mark.slow) for each in (10, 60) for tag in (11, 12)],
)
def test_pin_in_a_hole_has_perssons_pressure(angle: int, secondary: int) -> None:
    """Half a pin, concentric with its hole at the start, under a force at its middle: the largest
    pressure and the mean of the squared angle, which goes as force over clearance, to 1 %."""
    radius, clearance, half = 10.0, 0.01, np.radians(angle)
    over, largest = PERSSON[angle]
    load = E * clearance / over

    place = f"Sqrt(x*x+(y+{radius})*(y+{radius}))-{1.3 * half * radius}"
    size = f"{half * radius / 12}+0.2*Max(0,Min(Sqrt(x*x+y*y),{place}))"
    mesh = rings(((0.3, radius - clearance), (radius, 40 * radius)), (0, -700), (700, 1400), size)
    model = model_of(
        mesh, *BOTH, rs.Slide(30, normal=(1, 0)), rs.Clamp(22),
        rs.Contact(secondary=secondary, primary=23 - secondary), section="plane stress",
    )  # fmt: skip
    found = model.solve({model.add(rs.Hub(21, free=(0, -1))): rs.Force(load / 2)})
    assert found.converged
    assert found.pressure.max() == pytest.approx(largest * load / radius, rel=0.01)
    angles = np.arctan2(found.points[:, 0], -found.points[:, 1])
    spread = found.weights @ (found.pressure * angles**2) / (found.weights @ found.pressure)
    exact = np.linspace(0.0, half, 10_001)
    shape = persson(half, exact)
    assert shape[0] == pytest.approx(largest, rel=1e-4)
    assert spread == pytest.approx(shape @ exact**2 / shape.sum(), rel=0.01)


def test_rigid_punch_of_fourth_power() -> None:
    """z = C r^4 (Steuermann, Galin): force (64/15) E* C a^5, largest pressure sqrt 2 times the
    central one at a/sqrt 2, under the approach (8/3) C a^4."""
    a, c = 1.0, 0.004
    load, centre = 64 / 15 * STRAIN * c * a**5, 32 / (9 * np.pi) * STRAIN * c * a**3

    def gap(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return c * x[:, 0] ** 4, np.tile([0.0, 1.0], (len(x), 1))

    punch = rs.Contact(secondary=11, primary=None, gap=gap)
    model = model_of(block(400.0, a, 12), BOTH[0], punch, section="axisymmetric")
    base = model.add(rs.Hub(21, free=(0, 1)))
    found = model.solve({base: rs.Force(load)})
    assert found.converged
    r = found.points[:, 0]
    assert found.pressure.max() == pytest.approx(np.sqrt(2) * centre, rel=0.01)
    assert r[found.pressure.argmax()] == pytest.approx(a / np.sqrt(2), rel=0.1)
    near = (r > 0.1) & (r < 0.9)
    exact = centre * np.sqrt(1 - r[near] ** 2) * (1 + 2 * r[near] ** 2)
    np.testing.assert_allclose(found.pressure[near], exact, rtol=0.02)
    moved = model.solve({base: rs.Move((0, 8 / 3 * c * a**4))})
    assert moved.force(base) == pytest.approx(load, rel=0.005)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_westergaards_waves_under_a_plane(share: float) -> None:
    """Half a wave between planes of symmetry, pressed on a rigid plane. Mean pressure
    pi E* amplitude/length sin2(psi_a), and p = 2 p_mean cos(psi) sqrt(sin2(psi_a) -
    sin2(psi))/sin2(psi_a), psi = pi x/length (H. M. Westergaard, J. Appl. Mech. 6, 1939; Johnson,
    Contact Mechanics, 13.2)."""
    waves = Cosine(length=20.0, amplitude=1e-3)
    sine = np.sin(np.pi * share / 2) ** 2
    mean = np.pi * STRAIN * waves.amplitude / waves.length * sine

    def gap(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return waves.amplitude - waves(x[:, 0], x[:, 1])[0], np.tile([0.0, 1.0], (len(x), 1))

    half = waves.length / 2
    size = f"{min(half / 40, share * half / 16)}+0.2*Max(0,-y-1)"
    model = model_of(
        rectangle(half, 4 * half, size), BOTH[0], rs.Contact(secondary=11, primary=None, gap=gap),
        rs.Slide(30, normal=(1, 0)), rs.Slide(31, normal=(1, 0)), section="plane strain",
    )  # fmt: skip
    found = model.solve({model.add(rs.Hub(21, free=(0, 1))): rs.Force(mean * half)})
    assert found.converged
    psi = np.pi * found.points[:, 0] / waves.length
    inside = np.sin(psi) ** 2 < 0.9 * sine
    exact = 2 * mean * np.cos(psi) * np.sqrt(np.maximum(sine - np.sin(psi) ** 2, 0)) / sine
    near = exact[inside].max()
    np.testing.assert_allclose(found.pressure[inside], exact[inside], atol=0.01 * near)
    # where p^2/cos^2, a line over sin^2, is zero
    slope, start = np.polyfit(
        np.sin(psi[inside]) ** 2, (found.pressure / np.cos(psi))[inside] ** 2, 1
    )
    assert 2 / np.pi * np.arcsin(np.sqrt(-start / slope)) == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize("gap, secondary", [(0.0, 12), (1.0, 12), (1.0, 11)])
def test_ball_on_a_block_under_a_load_from_afar(gap: float, secondary: int) -> None:
    """Hertz's largest pressure to 1 %, also where the ball starts a tenth of its radius away."""
    radius, a = 10.0, 0.3
    load = 4 * (STRAIN / 2) * a**3 / (3 * radius)
    pair = rs.Contact(secondary=secondary, primary=23 - secondary)
    mesh = ball_on_block(radius, a, 8, gap)
    model = model_of(mesh, *BOTH, rs.Clamp(21), pair, section="axisymmetric")
    ball = model.add(rs.Hub(22, free=(0, -1)))
    found = model.solve({ball: rs.Force(load)})
    assert found.converged and len(found.history) <= 15  # 21 and 26 from the twelve nearest points
    assert found.pressure.max() == pytest.approx(3 * load / (2 * np.pi * a**2), rel=0.01)
    assert found.force(ball) == pytest.approx(load, rel=1e-8)
    assert found.weights @ found.pressure == pytest.approx(load, rel=1e-3)


def disc(n: int, degree: int, young: float = E, secondary: int = 12) -> tuple[float, float, str]:
    """Largest pressure over Hertz's of half a disc on a block with n elements on the half width,
    force on the pair over the load, and what is warned of."""
    radius, a = 10.0, 0.5
    load = np.pi * a**2 / (4 * radius) / (1 / STRAIN + (1 - NU**2) / young)
    pair = rs.Contact(secondary=secondary, primary=23 - secondary)
    model = model_of(
        ball_on_block(radius, a, n, 0.0), BOTH[0], rs.Body(2, rs.Elastic(young, NU)), rs.Clamp(21),
        rs.Slide(30, normal=(1, 0)), pair, section="plane strain", degree=degree,
    )  # fmt: skip
    top = model.add(rs.Hub(22, free=(0, -1)))
    with warnings.catch_warnings(record=True, action="always") as told:
        found = model.solve({top: rs.Force(load / 2)})
    largest = found.pressure.max() / (2 * load / (np.pi * a))
    return largest, found.force(pair)[1] / (load / 2), "\n".join(str(w.message) for w in told)


@pytest.mark.parametrize("secondary, degree", [(11, 2), (12, 2), (12, 1)])
def test_the_stiffer_body_may_be_secondary(secondary: int, degree: int) -> None:
    """A disc 30 times as stiff as the block: with its points the largest pressure was 85 % off
    (degree 1). The roles are exchanged then, which is told; forces are those of the given pair."""
    largest, force, told = disc(12, degree, 30 * E, secondary)
    assert told.count("stiffer body") == len(told.splitlines()) == (secondary == 12)
    assert largest == pytest.approx(1, rel=0.02 * (3 - degree))
    assert force == pytest.approx(1 if secondary == 12 else -1, rel=1e-3)


@pytest.mark.parametrize("n, degree", [(3, 1), (12, 1), (3, 2)])
def test_a_mesh_that_is_too_coarse_is_told(n: int, degree: int) -> None:
    """Warned where the largest pressure is a tenth off, not where it is right."""
    largest, _, told = disc(n, degree)
    assert (abs(largest - 1) > 0.1) == ("facets from its" in told) == (n == 3 and degree == 1)


def test_a_solid_that_is_too_coarse_is_told() -> None:
    """A rigid ball on tetrahedra of degree 2, two on the half width: 2.8 % off, and said."""
    radius, a = 50.0, 1.0
    near = 1.6 * np.arange(4) / 3
    line = np.append(near, 1.6 + 6.4 * np.expm1(np.arange(1, 6) / 2.5) / np.expm1(2.0))
    made = dolfinx.mesh.create_box(MPI.COMM_WORLD, [[0] * 3, [8] * 3], [8] * 3)
    at = np.rint(made.geometry.x).astype(int)
    made.geometry.x[:] = line[at] * [1, 1, -1]
    faces = {21: (2, -8.0), 31: (0, 0.0), 32: (1, 0.0), 11: (2, 0.0)}
    found = {
        int(facet): tag
        for tag, (axis, place) in faces.items()
        for facet in dolfinx.mesh.locate_entities_boundary(
            made, 2, lambda x, axis=axis, place=place: np.isclose(x[axis], place)
        )
    }
    facets = np.array(sorted(found), dtype=np.int32)
    tags = np.array([found[each] for each in facets.tolist()], dtype=np.int32)
    cells = np.arange(made.topology.index_map(3).size_local, dtype=np.int32)
    model = rs.Model(
        made,
        dolfinx.mesh.meshtags(made, 3, cells, np.ones_like(cells)),
        dolfinx.mesh.meshtags(made, 2, facets, tags),
    )
    model.add(BOTH[0], rs.Contact(11, rs.Sphere((0, 0, radius), radius)))
    base = model.add(rs.Hub(21, free=(0, 0, 1)))
    model.add(rs.Slide(31, (1, 0, 0)), rs.Slide(32, (0, 1, 0)))
    load = 4 * STRAIN * a**3 / (3 * radius)
    with pytest.warns(UserWarning, match="with less than 4.0 its pressure may be off by 3 %"):
        pressed = model.solve({base: rs.Force(load / 4)})
    assert 0.02 < abs(pressed.pressure.max() / (3 * load / (2 * np.pi * a**2)) - 1) < 0.03


@pytest.mark.parametrize("secondary", [11, pytest.param(12, marks=pytest.mark.slow)])
def test_press_fit_of_two_free_rings_has_lames_pressure(secondary: int) -> None:
    """Interference 5 um, held by symmetry alone: the mean to 0.5 %, every point within 2 %."""
    inner, radius, outer, over = 10.0, 20.0, 30.0, 0.005

    away = f"Sqrt(x*x+y*y)-{radius}"
    size = f"0.5*(1+0.3*Max(0,Min(1,1e6*({away}))))+0.3*Max(0,({away})*({away})/10)"
    steel = rs.Elastic(210e3, 0.3)
    mesh = rings(((inner, radius + over / 2), (radius - over / 2, outer)), (0, 0), (40, 40), size)
    found = model_of(
        mesh, rs.Body(1, steel), rs.Body(2, steel),
        rs.Slide(30, normal=(1, 0)), rs.Slide(31, normal=(0, 1)),
        rs.Contact(secondary=secondary, primary=23 - secondary), section="plane stress",
    ).solve()  # fmt: skip
    b, c, a = radius**2, outer**2, inner**2
    exact = over * 210e3 / radius / ((c + b) / (c - b) + (b + a) / (b - a))
    assert found.converged
    assert np.average(found.pressure, weights=found.weights) == pytest.approx(exact, rel=0.005)
    np.testing.assert_allclose(found.pressure, exact, rtol=0.02)


def test_a_block_slides_over_ten_elements_and_back() -> None:
    """Ten facets of 0.4 mm are passed: the force stays mu N within 1 %, and turns when the motion
    does; before it slides it is less, and nothing slides."""
    mesh = two_boxes("quadrilateral", ((20, 2), (7, 2)), (((0, -1), (8, 0)), ((0.5, 0), (2.5, 1))))
    pair = rs.Contact(secondary=12, primary=11, friction=0.3)
    model = model_of(mesh, *BOTH, pair, section="plane strain")
    floor, top = model.add(rs.Clamp(21)), model.add(rs.Hub(22, free=(0, -1)))
    found = model.solve({top: rs.Force(10.0)}, steps=2)
    still = found.then({top: rs.Force(10.0, move=(1e-4, 0))}, steps=1)
    assert still.converged and abs(still.force(floor)[0]) < 0.1 * 3.0
    shares = [0.05, *np.linspace(0.4, 4.0, 10), 3.9]
    for x in shares:
        found = found.then({top: rs.Force(10.0, move=(x, 0))}, steps=1)
        assert found.converged and len(found.history) <= 12, found.reason
        side = -1.0 if x != 3.9 else 1.0
        np.testing.assert_allclose(found.force(floor), [side * 3.0, 10.0], rtol=0.01)
    along = found.traction - (found.traction * found.normals).sum(axis=1)[:, None] * found.normals
    limit = 0.3 * found.pressure
    np.testing.assert_allclose(np.linalg.norm(along, axis=1), limit, atol=1e-6 * limit.max())


def disc_on_block(radius: float, b: float, n: int):
    """Half a disc on a block of 40 x 20 mm with 2 n elements over the contact: 12 its arc, 22 its
    flat face, 11 and 21 the upper and lower face of the block."""

    def make(occ) -> list[int]:
        box = [(2, occ.addRectangle(-radius, 0, 0, 2 * radius, radius))]
        disc = occ.intersect([(2, occ.addDisk(0, radius, 0, radius, radius))], box)[0][0][1]
        return [occ.addRectangle(-20, -20, 0, 40, 20), disc]

    def tag(body: int, box: tuple[float, float, float, float]) -> int:
        _, low, _, high = box
        if body == 2:
            return 22 if low > radius - 1e-6 else 12
        return 11 if low > -1e-6 else 21 if high < -19.9 else 0

    return meshed(make, tag, f"{b / n}+0.3*Max(0,Sqrt(x*x+y*y)-{1.4 * b})")


def test_friction_of_like_bodies_is_cattaneos_for_either_role() -> None:
    """Pressing like bodies makes next to no tangential traction: with the normals of one surface
    alone it was 0.16 of mu p0. Shifted until T = 0.469 mu N, sqrt(1 - T/(mu N)) of the contact
    sticks (C. Cattaneo 1938)."""
    radius, young, mu, load = 8.0, 200.0, 0.2, 10.0
    b = np.sqrt(4 * load * radius / (np.pi * (young / (2 * (1 - NU**2)))))
    soft, shares = rs.Elastic(young, NU), []
    mesh = disc_on_block(radius, b, 8)
    for tag in (12, 11):
        pair = rs.Contact(secondary=tag, primary=23 - tag, friction=mu)
        model = model_of(mesh, rs.Body(1, soft), rs.Body(2, soft), pair, section="plane strain")
        floor, top = model.add(rs.Clamp(21), rs.Hub(22, free=(0, -1)))
        pressed = model.solve({top: rs.Force(load)}, steps=1)
        across = pressed.traction + pressed.pressure[:, None] * pressed.normals
        near = np.abs(pressed.points[:, 0]) < 0.6 * b
        assert np.abs(across[near]).max() < 0.03 * mu * pressed.pressure.max()
        found = pressed.then({top: rs.Force(load, move=(0.0292, 0))}, steps=3)
        exact = np.sqrt(1 + found.force(floor)[0] / (mu * load))
        touches = found.weights[found.pressure > 0].sum()
        shares.append(found.weights[found.sticking].sum() / touches)
        assert exact == pytest.approx(0.729, abs=0.005)
        assert shares[-1] == pytest.approx(exact, abs=0.02)
    assert shares[0] == pytest.approx(shares[1], abs=0.01)


JACKSON_GREEN = {2.83: (2.0, 2.02), 10.13: (5.0, 5.77), 25.89: (10.0, 12.78), 64.2: (20.0, 28.31)}
"""Load of a rigid sphere on a perfectly plastic half-space over the critical load -> approach and
area over the critical ones (R. L. Jackson and I. Green, Journal of Tribology 127, 2005; from
memory)."""


@pytest.mark.parametrize(
    "over",
    [2.83, *(pytest.param(each, marks=pytest.mark.slow) for each in (10.13, 25.89, 64.2))],
)
def test_rigid_sphere_into_perfectly_plastic_steel(over: float) -> None:
    """Approach within 4 % and area within 7 %; unloaded, an imprint is left."""
    young, poisson, yields, radius = 210e3, 0.3, 600.0, 10.0
    modulus, c = young / (1 - poisson**2), 1.295 * np.exp(0.736 * poisson)
    approach = (np.pi * c * yields / (2 * modulus)) ** 2 * radius
    load = 4 / 3 * (radius / modulus) ** 2 * (c / 2 * np.pi * yields) ** 3
    area = np.pi**3 * (c * yields * radius / (2 * modulus)) ** 2
    sunk, wide = JACKSON_GREEN[over]
    a = np.sqrt(area * wide / np.pi)
    fast = over < 5
    mesh, steel = block(40 * a, a, 7 if fast else 10), rs.Plastic(young, poisson, yields)
    sphere = rs.Contact(secondary=11, primary=rs.Sphere((0, radius), radius))
    model = model_of(mesh, rs.Body(1, steel), sphere, section="axisymmetric")
    base = model.add(rs.Hub(21, free=(0, 1)))
    found = model.solve({base: rs.Force(over * load)}, steps=4 if fast else 10)
    assert found.converged and found.motion(base) / approach == pytest.approx(sunk, rel=0.04)
    assert found.weights[found.pressure > 0].sum() / area == pytest.approx(wide, rel=0.07)
    back = found.then({base: rs.Force(0.0)}, steps=2)
    assert back.converged and 0.02 * sunk < back.motion(base) / approach < 0.8 * sunk


def test_hexahedra_with_two_pairs_share_a_load() -> None:
    """One box between two others, the lower ends on a plane: all three faces carry the load."""
    counts = ((2, 2, 2), (3, 3, 2))
    ends = (((0, 0, 0), (1, 1, 1)), ((0, 0, 1), (1, 1, 2)))
    model = model_of(
        two_boxes("hexahedron", counts, ends, interface=1.0), *BOTH,
        rs.Contact(secondary=12, primary=11),
        rs.Contact(secondary=21, primary=rs.Plane((0, 0, 0), (0, 0, 1))),
        rs.Slide(30, normal=(1, 0, 0)), rs.Slide(32, normal=(0, 1, 0)), degree=1,
    )  # fmt: skip
    found = model.solve({model.add(rs.Hub(22, free=(0, 0, -1), slides=True)): rs.Force(5.0)})
    assert found.converged
    np.testing.assert_allclose(found.pressure, 5.0, rtol=0.01)
    assert set(found.contact) == {0, 1}
    for number in (0, 1):
        own = found.contact == number
        assert found.weights[own] @ found.pressure[own] == pytest.approx(5.0, rel=1e-6)
