"""From the axes of a file to those of the project; points that are refused before.

Files of instruments, two real ones among them, and tables as people and programs write them.
"""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from one_line import refusal
from profile_points import crown, wheel

from railhead.geometry import profiles
from railhead.geometry.measured import formats, ordering, orientation
from railhead.geometry.measured import measured_profile as measured


def head() -> np.ndarray:
    """Points of a 60E1 head, gauge corner worn, down to 25 mm."""
    profile = profiles.rail_head("60E1")
    y = np.linspace(*profile.domain, 400)
    z = profile.height(y) - 1.5 * np.exp(-(((y + 33) / 6) ** 2) / 2)
    depth = np.arange(z[-1] - 0.5, -25, -0.5)
    right = np.column_stack([y[-1] - (depth - z[-1]) / 20, depth])
    left = np.column_stack([y[0] + (depth - z[0]) / 20, depth])[::-1]
    return np.concatenate([left, np.column_stack([y, z]), right])


def table(points: np.ndarray, unit: str = "") -> formats.Table:
    lines = tuple(range(1, len(points) + 1))
    return formats.Table(points=points, unit=unit, body="", format="table", lines=lines)


def turned(points: np.ndarray, body: str = "rail", **given: str) -> tuple[np.ndarray, str]:
    """As profiles are read, from a table that states no unit."""
    orient = orientation.Orientation(**given)
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
    assert ("mirrored" in done) == (mirror < 0) and ("upside down" in done) == (flip < 0)
    assert f"in {unit} (by its width)" in done


def test_keys_stand_over_the_shape() -> None:
    """A head that is read upside down or from the wrong side on purpose stays so."""
    true = head()
    found, done = turned(true, mirror="on", flip="off", unit="mm", origin="file")
    np.testing.assert_allclose(found, true * [-1, 1])
    assert done == "in mm (as given)"
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
        lambda: orientation.in_mm(table(head() * scale, unit), "rail", "auto"), ordering.PointError
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
    assert "give its profile_flip" in refusal(lambda: turned(hollow, body), ordering.PointError)
    found, _ = turned(hollow, body, flip="off")
    np.testing.assert_allclose(found, hollow)
    np.testing.assert_allclose(turned(arc(radius, half), body)[0], arc(radius, half))


def open_sides(points: np.ndarray, body: str = "rail") -> tuple[str, float]:
    found = orientation.oriented(points, body, table(points), orientation.Orientation())
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
    assert (np.abs(found - points) <= atol).all() and ("mirrored" in done) == (turns[0] < 0)
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
    "drawn at the gauge side alone": (
        head()[head()[:, 0] < 22],
        "mirrored (only the gauge side reaches 14 mm below the top)", True,
    ),
    "neither": (crown(np.linspace(-30, 30, 200), "54E1"),
                f"{AS_IN_FILE}(no side is worn, the head does not lean)", False),
    "no standard rail": (outline(2.0, 26.0, 16.0, 16.0) * [1.1, 1],
                         f"{AS_IN_FILE}(no side is a standard rail's)", False),
}  # fmt: skip


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("points", "said", "if_mirrored"), SIDES.values(), ids=SIDES)
def test_depth_wear_and_lean_tell_the_gauge_side_unless_they_differ(
    points, said: str, if_mirrored: bool, sign: int
) -> None:
    _, done = turned(points * [sign, 1])
    assert (said in done) is (sign < 0 or not if_mirrored)


@pytest.mark.parametrize("left", [-57.0, -50.0])
def test_a_wheel_that_begins_in_its_flange_has_no_known_origin(left: float) -> None:
    points = wheel(np.linspace(left, 60.0, 400)) + [200.0, 0.0]
    with pytest.raises(ordering.PointError, match="begins in its flange") as caught:
        turned(points, "wheel")
    np.testing.assert_allclose(caught.value.place, points[0])
    turned(points, "wheel", origin="file")


def test_a_foreign_origin_is_moved_to_the_crown() -> None:
    true = head()
    found, said = turned(true + [100.0, 172.0])
    assert "moved" in said
    assert float(found[:, 0].mean()) == pytest.approx(float(true[:, 0].mean()), abs=0.5)
    assert float(found[:, 1].max()) == pytest.approx(0.0, abs=0.1)


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


DATA = Path(__file__).parents[1] / "data"
BAN, PRW = DATA / "MBench_UIC60_v3.ban", DATA / "MBench_S1002_v3.prw"


def read(folder: Path, text: str, name: str = "rail.csv") -> formats.Table:
    """What a file of that text holds."""
    (folder / name).write_bytes(text.encode())
    return formats.read(folder / name)


def test_miniprof_rail_is_60e1_canted_1_in_40() -> None:
    """19 points that are commented out by quotation marks are left out; turned and mirrored."""
    found = measured.read(BAN, "rail")
    assert len(found.points) == 476
    said = " ".join(found.remarks)
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
    assert "is a wheel's" in refusal(lambda: measured.read(PRW, "rail"), formats.FormatError)
    file = tmp_path / "wheel.prr"
    file.write_bytes(PRW.read_bytes())
    assert "is a wheel's; give one of a rail" in refusal(
        lambda: measured.read(file, "rail"), formats.FormatError
    )


def simpack(keys: str, points: np.ndarray) -> str:
    rows = "\n".join(f"{y:.6f} {z:.6f} 1.0" for y, z in points)
    return f"header.begin\n type = 0 ! rail\nheader.end\nspline.begin\n{keys}\n" \
           f"point.begin\n{rows}\n point.end\nspline.end\n"  # fmt: skip


def test_simpack_headers_shift_rotate_and_mirror(tmp_path) -> None:
    """In the file's unit and in this order."""
    y = np.linspace(-0.03, 0.03, 61)
    points = np.column_stack([y, 0.1 * y + 0.01 * np.cos(30 * y)])
    keys = "shift.y = 0.001\nshift.z = 0.002\nrotate = 0.1\nmirror.z = 1\nunits.len.f = 1"
    found = read(tmp_path, simpack(keys, points), "rail.prr")
    c, s = np.cos(0.1), np.sin(0.1)
    moved = points + [0.001, 0.002]
    turned = np.column_stack([c * moved[:, 0] - s * moved[:, 1], s * moved[:, 0] + c * moved[:, 1]])
    np.testing.assert_allclose(found.points, turned * [1, -1], atol=1e-6)
    assert (found.unit, found.body) == ("m", "rail")


def test_simpack_bounds_and_inches(tmp_path) -> None:
    """Bounds are of the points as they are turned, before they are mirrored."""
    y = np.linspace(-1.2, 1.2, 25)
    points = np.column_stack([y, -0.2 * y**2])
    keys = "units.len.f = 39\nbound.y.min = -0.65\nbound.y.max = 0.95\nmirror.y = 1"
    found = read(tmp_path, simpack(keys, points), "rail.prr")
    assert found.unit == "inch"
    np.testing.assert_allclose(found.points[:, 0], -y[6:22], atol=1e-6)


ROWS = "1 2\n3 4\n5 6\n"


@pytest.mark.parametrize(
    ("text", "name", "line", "words"),
    [
        ("header.begin\n", "rail.prr", 1, "without point.begin"),
        ("point.begin\n1 2\n", "rail.prr", 2, "without point.end"),
        ("point.begin\n1 2\n3 x\npoint.end", "rail.prr", 3, "no point"),
        ("mirror.y = yes\npoint.begin\n1 2\npoint.end", "rail.prr", 1, "give a number"),
        ("units.ang.f = 0\npoint.begin\n1 2\npoint.end", "rail.prr", 1, "give a number"),
        ("units.len.f = 1e999\npoint.begin\n1 2\npoint.end", "rail.prr", 1, "give a number"),
        ("point.begin\npoint.end", "rail.prr", 2, "no points"),
        ("1 2\n3 4\n", "rail.mpt", 2, "ends after 2 points"),
        (f"XYPoints=2\n\n{ROWS}3 four\n", "rail.mpt", 6, "no point"),
        (f"[Profile1Data]\n{ROWS}[Profile2Data]\n{ROWS}", "rail.mpt", 6, "begins another profile"),
    ],
)
def test_broken_files_of_instruments_are_refused(text, name, line, words, tmp_path) -> None:
    with pytest.raises(formats.FormatError, match=f"{name}, line {line}: .*{words}"):
        read(tmp_path, text, name)


def test_miniprof_headers_order_the_columns(tmp_path) -> None:
    points = np.column_stack([np.linspace(-30.0, 30.0, 13), np.linspace(0.0, -5.0, 13)])
    rows = [f"{z:.4f} 7 {y:.4f}" for y, z in points]
    rows[3] = f'"{rows[3]}'
    found = read(tmp_path, "ColumnDef=Y,*,X\nXYPoints=12\n\n" + "\n".join(rows), "rail.ban")
    np.testing.assert_allclose(found.points, np.delete(points, 3, axis=0), atol=1e-3)


def test_a_file_that_was_cut_off_is_refused(tmp_path) -> None:
    """By the number of points in its header."""
    cut = tmp_path / "cut.ban"
    cut.write_text("\n".join(BAN.read_text().splitlines()[:-150]))
    assert "of the 495 points of its header" in refusal(
        lambda: measured.read(cut, "rail"), formats.FormatError
    )


@pytest.mark.parametrize("file", [BAN, PRW], ids=lambda file: file.name)
def test_lines_of_points_are_known(file: Path) -> None:
    """Those that are commented out leave holes."""
    table, lines = formats.read(file), file.read_text().splitlines()
    listed = [[float(each) for each in lines[line - 1].split()[:2]] for line in table.lines]
    np.testing.assert_allclose(np.abs(table.points), np.abs(listed))


# Tables of points as people and programs write them.

Y = np.linspace(-35, 35, 15)
Z = -(Y**2) / 600
POINTS = np.column_stack([Y, np.round(Z, 5)])


def written(separator: str, comma: bool = False, form: str = "%.5f") -> str:
    rows = "\n".join(separator.join(form % value for value in row) for row in POINTS)
    return rows.replace(".", ",") if comma else rows


def numbered(separator: str) -> str:
    return "\n".join(
        separator.join([str(i), f"{y:.5f}", f"{z:.5f}"]) for i, (y, z) in enumerate(POINTS)
    )


GOOD = {
    "commas": written(","),
    "commas and blanks": written(", "),
    "semicolons": written(";"),
    "tabs": written("\t"),
    "blanks": written("   "),
    "aligned": written(" ", form="%12.5f"),
    "decimal commas, semicolons": written(";", True),
    "decimal commas, tabs": written("\t", True),
    "decimal commas, blanks": written(" ", True),
    "decimal commas, commas and blanks": "\n".join(
        f"{y:.5f}".replace(".", ",") + ", " + f"{z:.5f}".replace(".", ",") for y, z in POINTS
    ),
    "exponents": written(",", form="%.7e"),
    "byte order mark": "\ufeffy,z\n" + written(","),
    "windows": written(";").replace("\n", "\r\n"),
    "quoted": "\n".join(f'"{y:.5f}";"{z:.5f}"' for y, z in POINTS).join(["x;y\n", ""]),
    "separators at the end": written(";").replace("\n", ";\n") + ";",
    "# comments": "# rail 12\n# km 3,4\n" + written(","),
    "% comments": "% rail\n" + written(" ") + "\n% end\n",
    "! comments": "! rail\n!\n" + written(" "),
    "// comments": "// rail 1 2\n" + written("\t"),
    "; comments": "; rail\n" + written(","),
    "* comments": "* rail\n" + written(","),
    "names and units": "y [mm];z [mm]\n" + written(";"),
    "names, then units": "y;z\n[mm];[mm]\n" + written(";"),
    "words": "measured by hand\nleft rail\n\ny z\n" + written(" "),
    "named columns": "no,y,z\n" + numbered(","),
    "names and units, blanks": "y [mm] z [mm]\n" + written(" "),
    "columns the other way": "z;y\n" + "\n".join(f"{z:.5f};{y:.5f}" for y, z in POINTS),
    "comments beside points": written(" ").replace("\n", "  # fine\n"),
}


@pytest.mark.parametrize("text", GOOD.values(), ids=GOOD)
def test_usual_dialects_give_the_same_points(text: str, tmp_path) -> None:
    np.testing.assert_allclose(read(tmp_path, text).points, POINTS, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("x;y;z", (1, 2)), ("y;sigma;elevation", (0, 2)), ("No;y;depth", (1, 2)),
        ("t [s];lat [mm];vert [mm]", (1, 2)), ("X;Y;Angle", (0, 1)), ("x;q;z", (0, 2)),
        ("Wheel diameter;920;1\nz;no;y", (2, 0)),
    ],
)  # fmt: skip
def test_names_tell_y_and_z(header: str, columns: tuple, tmp_path) -> None:
    numbers = np.random.default_rng(3).uniform(-9, 9, (15, 3)).round(3)
    rows = "\n".join(";".join(map(str, row)) for row in numbers)
    found = read(tmp_path, f"{header}\n{rows}")
    np.testing.assert_allclose(found.points, numbers[:, list(columns)])


@pytest.mark.parametrize("coding", ["utf-16", "latin-1"])
def test_other_codings_are_read(coding: str, tmp_path) -> None:
    file = tmp_path / "rail.txt"
    file.write_bytes(("# Höhe über SO\n" + written(" ")).encode(coding))
    np.testing.assert_allclose(formats.read(file).points, POINTS, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("y [mm], z [mm]", "mm"), ("y (m), z (m)", "m"), ("y/inch, z/inch", "inch"),
        ("y_mm,z_mm", "mm"), ("# unit: inches", "inch"), ("y (cm), z (cm)", "cm"),
        ("Y [µm],Z [µm]", "um"), ("y (in),z (in)", "inch"), ("y,z\ncm,cm", "cm"),
        ("y,z (um)", "um"), ("x [m]\ny [mm], z [mm]", "mm"), ("# 60 kg/m", ""),
        ("# 0.1 mm/m, 5 kN/mm", ""), ("y,z", ""), ("y_left,z_left", ""),
        ("Chainage (m),Line\ny,z", ""), ("# station [m]: 1200", ""),
    ],
)  # fmt: skip
def test_units_are_taken_from_headers(header: str, unit: str, tmp_path) -> None:
    assert read(tmp_path, header + "\n" + written(",")).unit == unit


BAD = {
    "empty": ("", 1, "two numbers"),
    "words": ("rail\nof steel\n", 2, "no points follow; give two numbers"),
    "broken": (written(",").replace("-15.00000", "oops", 1), 5, "no point"),
    "one number": (written(",") + "\n7\n", 16, "no point"),
    "not a number": (written(",").replace("-15.00000", "nan", 1), 5, "no point"),
    **{f"three columns below {header!r}": (f"{header}{numbered(';')}", line, "names y and z")
       for header, line in [("", 1), ("# rail 12\n", 2), ("Position;Hoehe;Extra\n", 2),
                            ("a;b;c\n", 2)]},
    "ambiguous": ("\n".join(f"{y},{y},-{y},5" for y in range(20)), 1, "4 columns"),
    "more columns than names": ("y,z\n" + "\n".join(f"{y},5,-{y},5" for y in range(20)), 1,
                                "fewer than the 4 of the points"),
    "short": (written(",").split("\n-15")[0], 4, "at least 12"),
    "a column too few": ("z,no,y\n" + "\n".join(f"1,{i},2" for i in range(20)) + "\n1,2", 22,
                         "column 3"),
    "binary": ("\0\1\2" * 50, 1, "no text"),
    "points in thousands": (written(";", comma=True).replace("35,", "1.035,"), 15, "no point"),
    "beyond numbers": (written(",").replace("-15.00000", "1e999", 1), 5, "no point"),
    "two heights": ("rail\ny;z_left;z_worn\n" + "1;2;3\n" * 15, 2, "several columns"),
    "decimal commas, y in whole mm": (
        "\n".join(f"{y:.0f},{z:.4f}".replace(".", ",") for y, z in POINTS), 1, "3 columns"
    ),
    "two units": ("rail\ny/mm,z/um\n" + written(","), 2, "in mm and um; give both in one of mm, m"),
    "two units, blanks": ("y [mm] z [m]\n" + written(" "), 1, "in mm and m; give"),
    "degrees": ("y [°];z [mm]\n" + written(";"), 1, "in ° and mm; give both"),
    "unknown unit": ("y (yd),z (yd)\n" + written(","), 1, "in yd; give both in one of mm, m, inch"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "line", "words"), BAD.values(), ids=BAD)
def test_wrong_files_name_file_line_and_what_is_allowed(text, line, words, tmp_path) -> None:
    message = refusal(lambda: read(tmp_path, text), formats.FormatError)
    assert message.startswith(f"rail.csv, line {line}: ") and "give" in message and words in message
