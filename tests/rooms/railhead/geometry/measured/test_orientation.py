"""From the axes of a file to those of the project; points that are refused before."""

from contextlib import nullcontext

import numpy as np
import pytest
from one_line import refusal
from profile_points import crown, wheel

from railhead.geometry import profiles
from railhead.geometry.measured import ordering, orientation, standards
from railhead.geometry.measured.formats import Table
from railhead.geometry.measured.ordering import PointError
from railhead.geometry.measured.orientation import Orientation


def head() -> np.ndarray:
    """Points of a 60E1 head, gauge corner worn, down to 25 mm."""
    profile = profiles.rail_head("60E1")
    y = np.linspace(*profile.domain, 400)
    z = profile.height(y) - 1.5 * np.exp(-(((y + 33) / 6) ** 2) / 2)
    depth = np.arange(z[-1] - 0.5, -25, -0.5)
    right = np.column_stack([y[-1] - (depth - z[-1]) / 20, depth])
    left = np.column_stack([y[0] + (depth - z[0]) / 20, depth])[::-1]
    return np.concatenate([left, np.column_stack([y, z]), right])


def table(points: np.ndarray, unit: str = "") -> Table:
    lines = tuple(range(1, len(points) + 1))
    return Table(points=points, unit=unit, body="", format="table", remarks=(), lines=lines)


def turned(points: np.ndarray, body: str = "rail", **given: str) -> tuple[np.ndarray, str]:
    """As profiles are read, from a table that states no unit."""
    orient = Orientation(**given)
    file, unit = orientation.in_mm(table(points), body, orient.unit)
    way = ordering.in_order(file.points)
    ordering.refuse_outlier(way)
    found = orientation.oriented(way, body, file, orient)
    ordering.refuse_rounded(found.points)
    return found.of_file(file.points), ", ".join([unit, *found.done])


@pytest.mark.parametrize(
    ("unit", "mirror", "flip"), [("mm", 1, 1), ("m", -1, 1), ("inch", 1, -1), ("mm", -1, -1)]
)
def test_unit_sides_and_up_are_read_from_the_shape(unit: str, mirror: int, flip: int) -> None:
    true = head()
    found, done = turned(true * [mirror, flip] / orientation.MM_OF_UNIT[unit])
    np.testing.assert_allclose(found, true, atol=1e-9)
    assert ("mirrored" in done) == (mirror < 0)
    assert ("upside down" in done) == (flip < 0)
    assert f"in {unit} (by its width)" in done


def test_keys_stand_over_the_shape() -> None:
    """A head that is read upside down or from the wrong side on purpose stays so."""
    true = head()
    found, done = turned(true, mirror="on", flip="off", unit="mm", origin="file")
    np.testing.assert_allclose(found, true * [-1, 1])
    assert done == "in mm"
    found, done = turned(-true, mirror="off", flip="off", origin="file")
    np.testing.assert_allclose(found, -true)
    found, done = turned(true, origin="file", shift=(2.0, -1.5))
    np.testing.assert_allclose(found, true + [2.0, -1.5])
    assert "moved by 2, -1.5 mm as given" in done


@pytest.mark.parametrize(
    ("scale", "unit"),
    [(1.0, "m"), (1 / 100, ""), (0.5 / 72.0, "mm")],
    ids=["72 m", "0.7", "0.5 mm"],
)
def test_a_width_that_no_profile_has_asks_for_the_unit(scale: float, unit: str) -> None:
    said = refusal(
        lambda: orientation.in_mm(table(head() * scale, unit), "rail", "auto"), PointError
    )
    assert "no usual width of a rail" in said and "give its profile_unit" in said


def arc(radius: float, half: float, sign: float = 1.0) -> np.ndarray:
    y = np.linspace(-half, half, 161)
    return np.column_stack([y, sign * (np.sqrt(radius**2 - y**2) - radius)])


@pytest.mark.parametrize("body", ["rail", "wheel"])
@pytest.mark.parametrize(("radius", "half"), [(10.25, 8.0), (300.0, 15.0)])
def test_a_hollow_surface_without_axes_is_asked_about(radius, half, body) -> None:
    """A groove, or a ball whose z counts downwards: likeness cannot tell. Bulging ones are read."""
    hollow = arc(radius, half, -1.0)
    assert "give its profile_flip" in refusal(lambda: turned(hollow, body), PointError)
    found, _ = turned(hollow, body, flip="off")
    np.testing.assert_allclose(found, hollow)
    np.testing.assert_allclose(turned(arc(radius, half), body)[0], arc(radius, half))


def open_sides(points: np.ndarray, body: str = "rail") -> tuple[str, float]:
    found = orientation.oriented(points, body, table(points), Orientation())
    return found.sides, found.unlike


def test_sides_that_nothing_tells_are_open_and_say_whether_they_matter() -> None:
    """A tread worn to a cone, a head of no standard, a ball and a plane."""
    y = np.linspace(-30.0, 50.0, 161)
    assert open_sides(np.column_stack([y, -y / 40]), "wheel") == (
        "open",
        pytest.approx(1.42, abs=0.02),
    )
    sides, unlike = open_sides(outline(2.0, 26.0, 16.0, 16.0) * [1.1, 1])
    assert sides == "open" and unlike > 1
    for points in (arc(50.0, 20.0), arc(1e9, 40.0)):
        assert open_sides(points) == ("open", pytest.approx(0.0, abs=1e-3))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_side_that_is_drawn_down_to_the_gauge_is_the_gauge_side(sign: int) -> None:
    points = head()
    part = points[points[:, 0] < 22] * [sign, 1]
    found, done = turned(part)
    np.testing.assert_allclose(found, part * [sign, 1])
    assert "only the gauge side reaches 14 mm" in done


def with_rim(deep: float) -> np.ndarray:
    """A wheel with the faces of its rim, that deep."""
    true, down = wheel(), np.arange(0.5, deep, 0.5)
    back, rim = (np.column_stack([np.full(len(down), y), z - down]) for y, z in true[[0, -1]])
    return np.concatenate([back[::-1], true, rim])


def thin() -> np.ndarray:
    """A wheel of whose flange 3 mm of the front face are worn off."""
    points = wheel()
    front = (points[:, 0] > -54) & (points[:, 0] < -30)
    points[front, 1] -= 3.0 * np.sin(np.pi * (points[front, 0] + 54) / 24)
    return points


#: Dense at the flange, as chords of one tolerance make them: most points are not on the tread.
DENSE = wheel(np.concatenate([np.linspace(-70, -38, 500), np.linspace(-37, 60, 60)]))
#: Points, how they are turned and moved in a file, and how far off (y, z) they may be found.
WHEELS = {
    "mirrored": (wheel(), (-1, 1), (0.0, 0.0), 0.2),
    "upside down": (wheel(), (1, -1), (0.0, 0.0), 0.2),
    "both": (wheel(), (-1, -1), (0.0, 0.0), 0.2),
    "with faces of a rim, upside down": (with_rim(10.0), (-1, -1), (0.0, 0.0), 0.1),
    "with faces of a rim": (with_rim(60.0), (-1, 1), (0.0, 0.0), 0.1),
    "dense at the flange": (DENSE, (1, 1), (0.0, 0.0), 0.1),
    "dense at the flange, mirrored": (DENSE, (-1, 1), (0.0, 0.0), 0.1),
    "from the flange's back": (wheel(), (1, 1), (70.0, -30.0), 0.1),
    "far off, with its back": (wheel(), (1, 1), (200.0, 0.0), (0.5, np.inf)),
    "far off, thin": (thin(), (1, 1), (200.0, 0.0), (0.3, np.inf)),
}  # fmt: skip


@pytest.mark.parametrize(("points", "turns", "moved", "atol"), WHEELS.values(), ids=WHEELS)
def test_a_wheel_stands_by_its_flange_and_its_back(points, turns, moved, atol) -> None:
    found, done = turned((points + moved) * turns, "wheel")
    assert (np.abs(found - points) <= atol).all()
    assert ("mirrored" in done) == (turns[0] < 0)
    assert ("turned upside down" in done) == (turns[1] < 0)
    assert ("tape circle" in done) == any(moved)


def outline(
    worn: float, degrees: float, deepest: float, cut: float = 36.0, slope: float = 0.0
) -> np.ndarray:
    """A 60E1 head, symmetric, sides 1:20 down to 36 mm; its gauge face (y < 0) worn by a plane of
    that inclination, that much (mm) 14 mm below the top; cut off below a depth, mm, and leaning
    by a slope."""
    profile = profiles.rail_head("60E1")
    y = np.linspace(*profile.domain, 700)
    z = profile.height(y)
    down = np.arange(0.2, 36 + z[0], 0.2)
    right = np.column_stack([y[-1] + down / 20, z[-1] - down])
    points = np.concatenate([(right * [-1, 1])[::-1], np.column_stack([y, z]), right])
    plane = -36.0 + worn + np.tan(np.radians(degrees)) * (points[:, 1] + 14)
    gone = (points[:, 0] < plane) & (points[:, 1] > -deepest)
    points[gone, 0] = plane[gone]
    return points[points[:, 1] > -cut] @ np.array([[1.0, slope], [-slope, 1.0]])


WORN, AS_IN_FILE = "mirrored (by its worn side)", "sides as in the file "
#: Points with the gauge side at y < 0, what is said, and whether of the mirrored ones alone.
SIDES = {
    "worn by 1 mm": (outline(1.0, 3.0, 30.0, 16.0), WORN, True),
    "worn by 6 mm": (outline(6.0, 15.0, 30.0, 20.0), WORN, True),
    "worn and leaning": (outline(4.0, 8.0, 30.0, 16.0, 1 / 20), WORN, True),
    "leaning": (outline(0.0, 0.0, 0.0, slope=1 / 40),
                "mirrored (its head leans 1:40 to the gauge side)", True),
    "worn, leaning the other way": (outline(3.0, 26.0, 20.0, slope=-1 / 20),
                                    f"{AS_IN_FILE}(worn at one side, leaning to the other)", False),
    "neither": (crown(np.linspace(-30, 30, 200), "54E1"),
                f"{AS_IN_FILE}(no side is worn, the head does not lean)", False),
    "no standard rail": (outline(2.0, 26.0, 16.0, 16.0) * [1.1, 1],
                         f"{AS_IN_FILE}(no side is a standard rail's)", False),
}  # fmt: skip


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("points", "said", "if_mirrored"), SIDES.values(), ids=SIDES)
def test_wear_and_lean_tell_the_gauge_side_unless_they_differ(
    points, said: str, if_mirrored: bool, sign: int
) -> None:
    _, done = turned(points * [sign, 1])
    assert (said in done) is (sign < 0 or not if_mirrored)


@pytest.mark.parametrize("name, flip", zip(profiles.STANDARD_RAILS, (1, -1), strict=True))
def test_a_head_with_its_underside_stands_upright(name: str, flip: int) -> None:
    """Few points on the crown, as chords of one tolerance make them: it was turned upside down."""
    outline = standards._outline(name)[0]
    crown = outline[:, 1] > -3
    every = np.arange(len(outline)) % np.where(crown, 200, 10) == 0
    _, said = turned(outline[every] * [1, flip], unit="mm")
    assert ("turned upside down" in said) is (flip < 0)


@pytest.mark.parametrize("left", [-57.0, -50.0])
def test_a_wheel_that_begins_in_its_flange_has_no_known_origin(left: float) -> None:
    points = wheel(np.linspace(left, 60.0, 400)) + [200.0, 0.0]
    with pytest.raises(PointError, match="begins in its flange") as caught:
        turned(points, "wheel")
    np.testing.assert_allclose(caught.value.place, points[0])
    turned(points, "wheel", origin="file")


def test_a_foreign_origin_is_moved_to_the_crown() -> None:
    true = head()
    found, said = turned(true + [100.0, 172.0])
    assert "moved" in said
    assert float(found[:, 0].mean()) == pytest.approx(float(true[:, 0].mean()), abs=0.5)
    assert float(found[:, 1].max()) == pytest.approx(0.0, abs=0.1)
    kept, _ = turned(true + [100.0, 172.0], origin="file")
    np.testing.assert_allclose(kept, true + [100.0, 172.0])


#: Place among points, by how much (mm) it is off, and whether it stands off.
WILD = [(90, [0, off], off != 0.4) for off in (0.4, 1.0, -3.0)]
WILD += [(place, off, True) for place in (0, -2) for off in ([0, 3], [0, 1], [3, 0], [-3, 0])]
WILD += [(0, [0, -3], False), (-2, [0, -3], True)]  # down the face is farther along it


@pytest.mark.parametrize(("place", "off", "is_refused"), WILD)
def test_a_wild_point_is_refused(place: int, off: list[float], is_refused: bool) -> None:
    """The curve would turn back at it, and the profile end there; at an end it may run off for
    kilometres."""
    points = outline(0.0, 0.0, 0.0, 16.0)
    points[place] += off
    said = pytest.raises(ValueError, match="stands off its neighbours by .* mm; delete it")
    with said if is_refused else nullcontext():
        turned(points)


@pytest.mark.parametrize(
    ("digits", "unit", "is_refused"),
    [(1, "mm", True), (2, "mm", False), (3, "inch", True), (4, "inch", False)],
)
def test_heights_in_stairs_are_refused(digits: int, unit: str, is_refused: bool) -> None:
    points = crown(np.arange(-30.0, 30.0, 0.25)) / orientation.MM_OF_UNIT[unit]
    points[:, 1] = np.round(points[:, 1], digits)
    said = pytest.raises(ValueError, match="heights rounded to .* mm; give more digits")
    with said if is_refused else nullcontext():
        turned(points, unit=unit)
