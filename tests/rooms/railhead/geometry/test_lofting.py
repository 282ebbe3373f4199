"""A rail through sections is the surface that they were cut from."""

from pathlib import Path

import drawn_sections as drawn
import numpy as np
import pytest

from railhead.geometry import sections
from railhead.geometry.lofting import Lofted, loft
from railhead.geometry.measured.formats import FormatError

Array = np.ndarray


def surface(table: str, x: float, **options: bool) -> Lofted:
    """Surface of the last head of a table around a place, mm."""
    return loft(sections.heads(Path(table), **options)[-1], x - 15, x + 15)


def grid(x: float, y: float) -> tuple[Array, Array]:
    """Places (n,) along and across around a place, mm."""
    along, across = np.meshgrid(x + np.linspace(-8, 8, 17), y + np.linspace(-3, 3, 13))
    return along.ravel(), across.ravel()


def height(points: object, x: Array, y: Array) -> Array:
    """Heights (n,) of the wing of case 6 at places (n,), mm."""
    return drawn.head(y, 300, 20, 0.0, 25 + x / 10) - 0.4 - 0.01 * x


def test_a_head_that_goes_aside_keeps_its_shape_between_sections(tmp_path: Path) -> None:
    """Joining at equal y would cut 0.0004 mm off the wing of case 6 (pitfall 2)."""
    table = drawn.write(tmp_path, np.arange(150, 231, 10), drawn.wing)
    x, y = grid(188.7, 36.4)
    z, along, across = surface(table, 188.7, split=False)(x, y)
    assert np.abs(z - height(None, x, y)).max() < 2e-7
    slope = -(y - 25 - x / 10) / np.sqrt(300**2 - (y - 25 - x / 10) ** 2)
    assert np.abs(across - slope).max() < 2e-6 and np.abs(along - (-0.01 - slope / 10)).max() < 2e-6


def test_a_hump_is_round_between_sections_and_no_polygon(tmp_path: Path) -> None:
    """Straight lines between sections 10 mm apart leave 0.0025 mm (pitfall 1)."""
    table = drawn.write(tmp_path, np.arange(-60, 61, 10), drawn.arcs)
    x, y = grid(3.0, 1.0)
    z, along, _ = surface(table, 3.0)(x, y)
    assert np.abs(z - (-drawn.top(y, 300.0) - drawn.top(x, 5000.0))).max() < 1e-7
    assert np.abs(along + x / np.sqrt(5000**2 - x**2)).max() < 1e-7


def test_a_ramp_that_ends_within_a_section_keeps_its_kink(tmp_path: Path) -> None:
    """No spline overshoots beside the end of a ramp of 1:25 (pitfall 1)."""

    def planed(x: float) -> Array:
        """Points of an arc on a ramp that ends at x = 40."""
        return drawn.arcs(0.0) + [0.0, 0.04 * min(x - 40, 0.0)]

    table = drawn.write(tmp_path, np.arange(0, 81, 10), planed)
    x = np.linspace(28.0, 52.0, 25)
    z, along, _ = surface(table, 40.0)(x, np.zeros_like(x))
    assert np.abs(z - 0.04 * np.minimum(x - 40, 0)).max() < 1e-7
    sides = x != 40.0
    assert np.abs(along - np.where(x < 40, 0.04, 0.0))[sides].max() < 1e-7


@pytest.mark.parametrize("digits", [8, 4])
def test_rounding_of_the_points_is_no_curvature(tmp_path: Path, digits: int) -> None:
    """A cubic spline through 4 decimals has curvatures from -0.0016 to 0.0079 where 1/300 is true
    (pitfall 5).
    """
    table = drawn.write(tmp_path, [-20, -10, 0, 10, 20], drawn.arcs, digits)
    lofted, y = surface(table, 0.0), np.linspace(-10.0, 10.0, 81)
    slopes = [lofted(np.zeros_like(y), y + step)[2] for step in (-0.5, 0.5)]
    curvature = -(slopes[1] - slopes[0])
    assert np.abs(300 * curvature - 1).max() < 0.03


def test_two_heads_in_one_line_are_parted_at_their_valley(tmp_path: Path) -> None:
    """The nose of case 6 is there from x = 0 on, with an end face, and the wing before it."""
    table = drawn.write(tmp_path, np.arange(-20, 101, 10), drawn.both)
    rail, wing = sections.heads(Path(table))
    assert (rail.x[0], wing.x[0]) == (0.0, -20.0)
    at = np.array([-5.0, 5.0])
    z = loft(rail, -15, 20)(at, np.full(2, -20.0))[0]
    assert np.isnan(z[0]) and z[1] == pytest.approx(drawn.ramp(5.0, 250, 350, 0.04, -2), abs=1e-6)
    z = loft(wing, -15, 20)(at, 25 + at / 10)[0]
    assert z == pytest.approx(-0.4 - 0.01 * at, abs=1e-6)


def test_a_file_of_contact_is_the_same_rail_upside_down(tmp_path: Path) -> None:
    """Offset and scale act on the places, and z points down (pitfall 11)."""
    table = Path(drawn.write(tmp_path, np.arange(0, 61, 10), drawn.wing, slcs=True))
    text = table.read_text().replace("0.0 1.0", "20.0 1000.0")
    for x in range(60, -1, -10):
        text = text.replace(f"\n{x} '", f"\n{x / 1000 - 20:g} '")
    table.write_text(text)
    x, y = grid(30.0, 28.0)
    z = surface(str(table), 30.0, split=False)(x, y)[0]
    assert np.abs(z - height(None, x, y)).max() < 2e-7
    table = table.with_name("turned.slcs")
    table.write_text(text.replace("1000.0", "-1000.0"))
    assert np.abs(surface(str(table), -30.0, split=False)(-x, y)[0] - z).max() < 1e-9


def test_a_nose_below_its_wing_is_the_right_way_up_and_heads_are_followed(tmp_path: Path) -> None:
    """Sections of a measured crossing, z down: a single head that goes aside from y = 0 to 60, then
    low nose, deep valley and wing, then the nose alone.
    """
    wing = np.array([[-34, -30], [-30, 0], [30, 0], [34, -1.0]])

    def section(x: float) -> Array:
        """Points at a place: nose and wing from x = 40 to 60, before it the wing alone."""
        nose = np.array([[-42, -42], [-30, -6], [-18, -6], [-10, -50], [20, -55.0]])
        line = wing + [10.0 if x > 60 else 1.5 * min(x, 40), 0.0]
        line = np.vstack([nose, line]) if 40 <= x <= 60 else line
        at = np.linspace(0, len(line) - 1, 64)
        return np.column_stack([np.interp(at, np.arange(len(line)), axis) for axis in line.T])

    table = drawn.write(tmp_path, np.arange(0, 101, 10), section, slcs=True)
    rail, other = sections.heads(Path(table))
    assert rail.x.tolist() == [40, 50, 60, 70, 80, 90, 100]
    assert other.x.tolist() == [0, 10, 20, 30, 40, 50, 60]
    assert [other.load(at).points[:, 1].max() for at in (0, 6)] == [0.0, 0.0]


def test_between_two_sections_a_rail_is_straight(tmp_path: Path) -> None:
    """A bar that rises 1:20 in two sections has its slope, and so has one interval at a kink."""
    table = drawn.write(tmp_path, [-20, 40], lambda x: drawn.arcs(0.0) + [0.0, 0.05 * x])
    x, y = grid(0.0, 0.0)
    z, along, _ = surface(table, 0.0)(x, y)
    assert np.abs(z - 0.05 * x + drawn.top(y, 300.0)).max() < 1e-7
    assert np.abs(along - 0.05).max() < 1e-7


def test_lengths_of_features_join_what_belongs_together(tmp_path: Path) -> None:
    """A point that is marked stays on one line along the rail; -1 says that it is absent."""
    table = Path(drawn.write(tmp_path, np.arange(0, 61, 10), drawn.wing, slcs=True))
    lengths = [f"{x} 24.7386 -1 64.7683" for x in range(0, 61, 10)]
    table.write_text(table.read_text().replace("0 0 0", "3 0 0") + "\n" + "\n".join(lengths))
    (rail,) = sections.heads(table, split=False)
    section = rail.load(3)
    assert section(section.anchors[[0, 2]]) == pytest.approx(section.points[[24, 184]], abs=1e-3)
    assert np.isnan(section.anchors[1])
    x, y = grid(30.0, 28.0)
    assert np.abs(loft(rail, 15, 45)(x, y)[0] - height(None, x, y)).max() < 2e-7


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x_mm,name\n0,a.txt", "has no columns x_mm and file"),
        ("x_mm,file\n0,0.txt\nten,10.txt", "line 3: 'ten' is no number"),
        ("x_mm,file\n0,0.txt\n0,10.txt", "does not follow that at 0; give rising places"),
        ("x_mm,file\n0,0.txt\n10,nothing.txt", "names nothing.txt, which is no file"),
        ("x_mm,file\n0,0.txt", "has 1 sections; give 2 or more"),
    ],
)
def test_a_table_that_is_none_is_refused_in_a_line(tmp_path: Path, text: str, said: str) -> None:
    """The message names the file, the line, and what is allowed."""
    table = Path(drawn.write(tmp_path, [0, 10], drawn.wing))
    table.write_text(text)
    with pytest.raises(FormatError, match=said):
        sections.heads(table)
