"""Files of instruments, two real ones among them, and their axes."""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from railhead.meshing import instruments, measured, orientation, outlines, profiles, wear
from railhead.meshing.dialects import InstrumentError, Table
from railhead.meshing.orientation import Choices
from railhead.meshing.smoothing import PointError

DATA = Path(__file__).parent / "data"
BAN, PRW = DATA / "MBench_UIC60_v3.ban", DATA / "MBench_S1002_v3.prw"


def test_miniprof_rail_is_60e1_canted_1_in_40() -> None:
    """19 points that are commented out by quotation marks are left out; turned and mirrored."""
    found = measured.read(BAN, "rail")
    assert len(found.points) == 476
    said = " ".join(found.said)
    assert "MiniProf" in said and "upside down" in said and "mirrored" in said and "1:40" in said
    expected = profiles.rail_head("60E1", 1 / 40)
    y = np.linspace(-38, 25, 201)  # from the highest point, which the file has at the origin
    top = 300 / np.hypot(40, 1)
    truth = expected.height(y + top) - expected.height(top)
    np.testing.assert_allclose(found.profile.height(y), truth, atol=0.05)  # drawn a little leaner


def test_simpack_wheel_is_s1002() -> None:
    """A first point that is commented out is left out; the flange comes to y < 0."""
    found = measured.read(PRW, "wheel")
    assert len(found.points) == 399
    y = np.linspace(-60, 55, 301)
    truth = profiles.s1002()
    apart = (found.profile.height(y) - truth.height(y)) / np.hypot(1, truth.slope(y))
    assert np.abs(apart).max() < 3e-3


def test_a_wheel_is_no_rail(tmp_path) -> None:
    with pytest.raises(InstrumentError, match="is a wheel's"):
        measured.read(PRW, "rail")
    file = tmp_path / "wheel.prr"
    file.write_bytes(PRW.read_bytes())
    with pytest.raises(InstrumentError, match="header says wheel"):
        measured.read(file, "rail")


def simpack(keys: str, points: np.ndarray) -> str:
    rows = "\n".join(f"{y:.6f} {z:.6f} 1.0" for y, z in points)
    return f"header.begin\n type = 0 ! rail\nheader.end\nspline.begin\n{keys}\n" \
           f"point.begin\n{rows}\n point.end\nspline.end\n"  # fmt: skip


def test_simpack_headers_shift_rotate_and_mirror(tmp_path) -> None:
    """In the file's unit and in this order."""
    y = np.linspace(-0.03, 0.03, 61)
    points = np.column_stack([y, 0.1 * y + 0.01 * np.cos(30 * y)])
    file = tmp_path / "rail.prr"
    keys = "shift.y = 0.001\nshift.z = 0.002\nrotate = 0.1\nmirror.z = 1\nunits.len.f = 1"
    file.write_text(simpack(keys, points))
    found = instruments.read(file)
    c, s = np.cos(0.1), np.sin(0.1)
    moved = points + [0.001, 0.002]
    turned = np.column_stack([c * moved[:, 0] - s * moved[:, 1], s * moved[:, 0] + c * moved[:, 1]])
    np.testing.assert_allclose(found.points, turned * [1, -1], atol=1e-6)
    assert (found.unit, found.body) == ("m", "rail")


def test_simpack_bounds_and_inches(tmp_path) -> None:
    """Bounds are of the points as they are turned, before they are mirrored."""
    y = np.linspace(-1.2, 1.2, 25)
    points = np.column_stack([y, -0.2 * y**2])
    file = tmp_path / "rail.prr"
    keys = "units.len.f = 39\nbound.y.min = -0.65\nbound.y.max = 0.95\nmirror.y = 1"
    file.write_text(simpack(keys, points))
    found = instruments.read(file)
    assert found.unit == "inch"
    np.testing.assert_allclose(found.points[:, 0], -y[6:22], atol=1e-6)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("header.begin\n", 1, "without point.begin"),
        ("point.begin\n1 2\n", 2, "without point.end"),
        ("point.begin\n1 2\n3 x\npoint.end", 3, "no point"),
        ("mirror.y = yes\npoint.begin\n1 2\npoint.end", 1, "give a number"),
        ("point.begin\npoint.end", 2, "no points"),
    ],
)
def test_broken_simpack_files_are_refused(text, line, words, tmp_path) -> None:
    file = tmp_path / "rail.prr"
    file.write_text(text)
    with pytest.raises(InstrumentError, match=f"rail.prr, line {line}: .*{words}"):
        instruments.read(file)


def test_broken_miniprof_files_are_refused(tmp_path) -> None:
    file = tmp_path / "rail.ban"
    file.write_text("1 2\n3 4\n")
    with pytest.raises(InstrumentError, match="rail.ban, line 1: .*key=value"):
        instruments.read(file)
    file.write_text("XYPoints=2\n\n1 2\n3 four\n")
    with pytest.raises(InstrumentError, match="rail.ban, line 4: .*no point"):
        instruments.read(file)


def test_miniprof_headers_order_the_columns_and_count_the_points(tmp_path) -> None:
    """Of 3 points said, one is commented out; 4 would be too many."""
    points = np.column_stack([np.linspace(-30.0, 30.0, 13), np.linspace(0.0, -5.0, 13)])
    rows = [f"{z:.4f} 7 {y:.4f}" for y, z in points]
    rows[3] = f'"{rows[3]}'
    file = tmp_path / "rail.ban"
    for count, said in ((12, False), (13, False), (14, True)):
        header = f"ColumnDef=Y,*,X\nXYPoints={count}\n\n"
        file.write_text(header + "\n".join(rows))
        found = instruments.read(file)
        np.testing.assert_allclose(found.points, np.delete(points, 3, axis=0), atol=1e-3)
        assert "1 line commented out" in found.remarks
        assert (f"the header says {count} points" in found.remarks) is said


def head() -> np.ndarray:
    """Points of a 60E1 head, gauge corner worn, down to 25 mm."""
    profile = profiles.rail_head("60E1")
    y = np.linspace(*profile.domain, 400)
    z = profile.height(y) - 1.5 * np.exp(-(((y + 33) / 6) ** 2) / 2)
    depth = np.arange(z[-1] - 0.5, -25, -0.5)
    right = np.column_stack([y[-1] - (depth - z[-1]) / 20, depth])
    left = np.column_stack([y[0] + (depth - z[0]) / 20, depth])[::-1]
    return np.concatenate([left, np.column_stack([y, z]), right])


def wheel(y: np.ndarray | None = None) -> np.ndarray:
    """Points of S1002, which reaches from -70 to 60 mm."""
    y = np.linspace(-70.0, 60.0, 300) if y is None else y
    return np.column_stack([y, profiles.s1002().height(y)])


def turned(points: np.ndarray, **choices: str) -> tuple[np.ndarray, str]:
    found, said = orientation.turned(Table(points, "", "", "table"), "rail", Choices(**choices))
    return found, ", ".join(said)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1 / 25.4], ids=["mm", "m", "inch"])
@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize("flip", [1, -1])
def test_unit_sides_and_up_are_found_and_said(unit: float, mirror: int, flip: int) -> None:
    true = head()
    found, said = turned(unit * true * [mirror, flip])
    np.testing.assert_allclose(found, true, atol=1e-9)
    assert ("mirrored" in said) == (mirror < 0)
    assert ("upside down" in said) == (flip < 0)
    assert {1.0: "in mm", 1e-3: "in m ", 1 / 25.4: "in inch"}[unit] in said


def test_what_is_found_is_overridden_by_what_is_chosen() -> None:
    true = head()
    found, said = turned(true / 2, mirror="on", flip="on", unit="mm", origin="file")
    np.testing.assert_allclose(found, true / 2 * [-1, -1])
    assert said == "in mm, turned upside down, mirrored"
    found, said = turned(-true, mirror="off", flip="off", origin="file")
    np.testing.assert_allclose(found, -true)
    with pytest.raises(ValueError, match="mm wide in m; give its profile_unit"):
        turned(true, unit="m")
    with pytest.raises(ValueError, match="0.25 high, no rail of 25 to 100 mm in mm, inch, m"):
        turned(true / 100)
    with pytest.raises(ValueError, match="7.2 mm wide in mm; give its profile_unit"):
        turned(true * 7.2 / np.ptp(true[:, 0]), unit="mm")


@pytest.mark.parametrize("unit", [10.0, 100.0, 304.8], ids=["cm", "dm", "ft"])
def test_units_that_nobody_says_are_not_taken_for_others(unit: float) -> None:
    """A head in cm is as wide as one of 7 inches would be, a wheel in cm as a strip of 13 mm."""
    for points, body in ((head(), "rail"), (wheel(), "wheel")):
        with pytest.raises(ValueError, match="give its profile_unit, or name it in a header"):
            orientation.in_mm(Table(points / unit, "", "", "table"), body, "auto")


@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize("flip", [1, -1])
def test_a_wheel_is_turned_by_its_flange(mirror: int, flip: int) -> None:
    true = wheel()
    table = Table(true * [mirror, flip], "mm", "", "table")
    found, said = orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(found, true, atol=0.2)
    assert ("mirrored (by its flange)" in said) == (mirror < 0)
    assert ("turned upside down (by its flange)" in said) == (flip < 0)


@pytest.mark.parametrize(("above", "side"), [(14.0, 0.0), (16.0, 1.0)])
def test_a_flange_stands_out_half_as_much_again_as_what_lies_below(
    above: float, side: float
) -> None:
    """12 mm above the tread and 10 below it, say, is a tread that is tilted."""
    y = np.linspace(-60.0, 60.0, 241)
    z = np.interp(y, [-60, -50, -40, 40, 55], [above, above, 0.0, 0.0, -10.0])
    found = orientation.flange(np.column_stack([y, z]))
    assert (found[1] if found else 0.0) == side


def outline(worn: float, degrees: float, deepest: float) -> np.ndarray:
    """A 60E1 head, symmetric, sides 1:20 down to 36 mm; its gauge face (y < 0) worn by a plane of
    that inclination, that much (mm) 14 mm below the top."""
    profile = profiles.rail_head("60E1")
    y = np.linspace(*profile.domain, 700)
    z = profile.height(y)
    down = np.arange(0.2, 36 + z[0], 0.2)
    right = np.column_stack([y[-1] + down / 20, z[-1] - down])
    points = np.concatenate([(right * [-1, 1])[::-1], np.column_stack([y, z]), right])
    plane = -36.0 + worn + np.tan(np.radians(degrees)) * (points[:, 1] + 14)
    cut = (points[:, 0] < plane) & (points[:, 1] > -deepest)
    points[cut, 0] = plane[cut]
    return points


@pytest.mark.parametrize("worn", [2.0, 3.0, 6.0, 10.0])
@pytest.mark.parametrize("degrees", [5.0, 15.0, 26.0])
@pytest.mark.parametrize("deepest", [14.0, 20.0, 30.0])
def test_a_worn_face_is_no_lean(worn: float, degrees: float, deepest: float) -> None:
    """The gauge side is the worn one, or nobody says."""
    points = outline(worn, degrees, deepest)
    for sign in (1, -1):
        found, said = turned(points * [sign, 1])
        if "shows no gauge side" in said:
            assert deepest == 30.0 and degrees < 26
        else:
            assert ("mirrored" in said) is (sign < 0)
            np.testing.assert_allclose(np.abs(found[:, 0] - points[:, 0]).max(), 0.0, atol=0.1)


@pytest.mark.parametrize("lean", [1 / 20, 1 / 40])
def test_a_leaning_head_tells_its_side_though_it_is_worn(lean: float) -> None:
    """Lean to the gauge side, y < 0."""
    points = outline(2.0, 26.0, 20.0) @ np.array([[1.0, lean], [-lean, 1.0]])
    for sign in (1, -1):
        _, said = turned(points * [sign, 1])
        assert ("mirrored (its head leans" in said) is (sign < 0)


@pytest.mark.parametrize(("off", "is_refused"), [(0.6, False), (1.0, True), (-3.0, True)])
def test_a_wild_point_is_refused(off: float, is_refused: bool) -> None:
    """The curve would turn back at it, and the profile end there. Points are 0.25 mm apart."""
    profile = profiles.rail_head("60E1")
    y = np.arange(-30.0, 30.0, 0.25)
    points = np.column_stack([y, profile.height(y)])
    points[90, 1] += off
    if is_refused:
        with pytest.raises(ValueError, match="stands off its neighbours by .* mm; delete it"):
            turned(points / 25.4, unit="inch")
    else:
        turned(points / 25.4, unit="inch")


@pytest.mark.parametrize("place", [0, 1, -2, -1])
@pytest.mark.parametrize("off", [[0, 3], [0, -3], [0, 1], [3, 0], [-3, 0]])
def test_a_wild_point_at_an_end_is_refused(place: int, off: list[float]) -> None:
    """The curve through it may run off for kilometres; one that is farther along it is none."""
    points = outline(0.0, 0.0, 0.0)
    points = points[points[:, 1] > -16]
    points[place] += off
    along = off == [0, -3] and place in (0, -1)  # down the face
    with nullcontext() if along else pytest.raises(ValueError, match="stands off"):
        turned(points)


@pytest.mark.parametrize("unit", [10.0, 304.8], ids=["cm", "ft"])
@pytest.mark.parametrize("half", [13.0, 15.0, 18.0])
def test_a_narrow_crown_is_no_head_in_inches(unit: float, half: float) -> None:
    y = np.arange(-half, half, 0.25)
    points = np.column_stack([y, profiles.rail_head("60E1").height(y)])
    turned(points)
    with pytest.raises(ValueError, match="give its profile_unit"):
        turned(points / unit)


@pytest.mark.parametrize("slope", [0.0, 1 / 40, 1 / 20])
@pytest.mark.parametrize(("worn", "degrees"), [(1.0, 3.0), (2.0, 0.0), (4.0, 8.0), (4.0, 15.0)])
@pytest.mark.parametrize("depth", [16.0, 20.0, 32.0])
def test_a_worn_side_is_the_gauge_side(
    slope: float, worn: float, degrees: float, depth: float
) -> None:
    """In shallow scans too; a face worn parallel to itself was taken for that of a worn corner on
    the other side."""
    points = outline(worn, degrees, 30.0)
    points = points[points[:, 1] > -depth] @ np.array([[1.0, slope], [-slope, 1.0]])
    for sign in (1, -1):
        _, said = turned(points * [sign, 1])
        assert "shows no gauge side" not in said
        assert ("mirrored" in said) is (sign < 0)


@pytest.mark.parametrize("wide", [0.9, 1.1])
def test_a_rail_that_is_no_standard_one_tells_no_side_by_its_wear(wide: float) -> None:
    points = outline(2.0, 26.0, 16.0)
    points = points[points[:, 1] > -16] * [wide, 1]
    for sign in (1, -1):
        assert "shows no gauge side" in turned(points * [sign, 1])[1]


@pytest.mark.parametrize("flip", [1, -1])
@pytest.mark.parametrize("name", profiles.STANDARD_RAILS)
def test_a_head_with_its_underside_stands_upright(name: str, flip: int) -> None:
    """Few points on the crown, as chords of one tolerance make them: it was turned upside down."""
    outline = wear._outline(name)
    crown = outline[:, 1] > -3
    every = np.arange(len(outline)) % np.where(crown, 200, 10) == 0
    points = outline[every]
    _, said = turned(points * [1, flip], unit="mm")
    assert ("turned upside down" in said) is (flip < 0)


@pytest.mark.parametrize("flip", [1, -1])
@pytest.mark.parametrize("begin", [0.0, 0.3, 0.5, 0.8])
def test_a_closed_section_stands_upright_wherever_it_begins(begin: float, flip: int) -> None:
    curves = outlines.rail_section("60E1", "section", half=False)
    points = np.concatenate([wear._sampled(curve) for curve in curves])
    s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    even = np.arange(0, s[-1], 1.0)
    points = np.column_stack([np.interp(even, s, column) for column in points.T])
    points = np.roll(points, int(begin * len(points)), axis=0)
    _, said = turned(points * [1, flip], unit="mm")
    assert ("turned upside down" in said) is (flip < 0)


def test_a_tread_with_a_foreign_origin_is_warned_of() -> None:
    points = wheel(np.linspace(-30.0, 50.0, 300))
    for origin, is_said in ((0.0, False), (200.0, True)):
        table = Table(points + [origin, 0.0], "mm", "", "table")
        _, said = orientation.turned(table, "wheel", Choices())
        assert ("WARNING: moved by -210.00, " in " ".join(said)) is is_said


@pytest.mark.parametrize("left", [-54.0, -50.0, -45.0])
def test_a_wheel_that_begins_in_its_flange_has_no_known_origin(left: float) -> None:
    points = wheel(np.linspace(left, 60.0, 400)) + [200.0, 0.0]
    table = Table(points[::-1], "mm", "", "table", (), tuple(range(400)))
    with pytest.raises(PointError, match="begins in its flange") as caught:
        orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(caught.value.place, points[0])
    orientation.turned(table, "wheel", Choices(origin="file"))


@pytest.mark.parametrize("deep", [10.0, 40.0, 60.0])
@pytest.mark.parametrize("flip", [1, -1])
def test_faces_of_a_rim_are_no_flange(deep: float, flip: int) -> None:
    true, down = wheel(), np.arange(0.5, deep, 0.5)
    back, rim = (np.column_stack([np.full(len(down), y), z - down]) for y, z in true[[0, -1]])
    points = np.concatenate([back[::-1], true, rim])
    table = Table(points * [-1, flip], "mm", "", "table")
    found, said = orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(found, points, atol=0.1)
    assert "mirrored (by its flange)" in said


@pytest.mark.parametrize("mirror", [1, -1])
def test_points_may_be_dense_at_the_flange(mirror: int) -> None:
    """As chords of one tolerance make them: most points are not on the tread."""
    points = wheel(np.concatenate([np.linspace(-70, -38, 500), np.linspace(-37, 60, 60)]))
    table = Table(points * [mirror, 1], "mm", "", "table")
    found, said = orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(found, points, atol=0.1)
    assert ("mirrored (by its flange)" in said) is (mirror < 0)


@pytest.mark.parametrize(
    ("digits", "unit", "is_refused"),
    [(1, "mm", True), (2, "mm", False), (2, "cm", True), (3, "inch", True), (4, "inch", False)],
)
def test_heights_in_stairs_are_refused(digits: int, unit: str, is_refused: bool) -> None:
    profile = profiles.rail_head("60E1")
    y = np.arange(-30.0, 30.0, 0.25)
    points = np.column_stack([y, profile.height(y)]) / orientation.UNITS[unit]
    points[:, 1] = np.round(points[:, 1], digits)
    if is_refused:
        with pytest.raises(ValueError, match="heights rounded to .* mm; give more digits"):
            turned(points, unit=unit)
    else:
        turned(points, unit=unit)


@pytest.mark.parametrize("left", [-70.0, -66.0, -64.0, -60.0])
def test_a_foreign_origin_is_found_wherever_a_wheel_begins(left: float) -> None:
    """By the back of the flange where it is there, else by the tip."""
    points = wheel(np.linspace(left, 60.0, 400))
    table = Table(points + [200.0, 0.0], "mm", "", "table")
    found, _ = orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(found[:, 0], points[:, 0], atol=0.5)


def test_an_upright_unworn_head_shows_no_side() -> None:
    profile = profiles.rail_head("54E1")
    y = np.linspace(-30, 30, 200)
    _, said = turned(np.column_stack([y, profile.height(y)]))
    assert "shows no gauge side" in said


def test_a_foreign_origin_is_moved_to_the_crown_or_the_tape_circle() -> None:
    true = head()
    found, said = turned(true + [100.0, 172.0])
    assert "moved" in said
    assert float(found[:, 0].mean()) == pytest.approx(float(true[:, 0].mean()), abs=0.5)
    assert float(found[:, 1].max()) == pytest.approx(0.0, abs=0.1)
    kept, _ = turned(true + [100.0, 172.0], origin="file")
    np.testing.assert_allclose(kept, true + [100.0, 172.0])
    points = wheel()
    back = points + [70.0, -30.0]  # from the flange back
    found, said = orientation.turned(Table(back, "mm", "", "table"), "wheel", Choices())
    np.testing.assert_allclose(found, points, atol=0.1)
    assert any("tape circle" in each for each in said)


def test_a_wheel_cut_short_of_the_flange_back_is_placed_by_its_tip() -> None:
    points = wheel(np.linspace(orientation.TIP - 6, 60.0, 300))
    table = Table(points + [200.0, 0.0], "mm", "", "table")
    found, _ = orientation.turned(table, "wheel", Choices())
    np.testing.assert_allclose(found[:, 0], points[:, 0], atol=1.0)  # 9 mm off by the flange back


def test_lines_of_points_are_known() -> None:
    """Those that are commented out leave holes."""
    for file in (BAN, PRW):
        table, lines = instruments.read(file), file.read_text().splitlines()
        assert len(table.lines) == len(table.points)
        for i in (0, len(table.lines) // 2, -1):
            assert [float(each) for each in lines[table.lines[i] - 1].split()[:2]]
    first = (BAN.read_text().splitlines()[instruments.read(BAN).lines[0] - 1]).split()
    np.testing.assert_allclose(instruments.read(BAN).points[0], [float(first[0]), float(first[1])])
