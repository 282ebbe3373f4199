"""Files of instruments, two real ones among them."""

from pathlib import Path

import numpy as np
import pytest

from railhead.geometry import profiles
from railhead.geometry.measured import formats
from railhead.geometry.measured import profile as measured
from railhead.geometry.measured.formats import FormatError

DATA = Path(__file__).parents[1] / "data"
BAN, PRW = DATA / "MBench_UIC60_v3.ban", DATA / "MBench_S1002_v3.prw"


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
    with pytest.raises(FormatError, match="is a wheel's"):
        measured.read(PRW, "rail")
    file = tmp_path / "wheel.prr"
    file.write_bytes(PRW.read_bytes())
    with pytest.raises(FormatError, match="is a wheel's; give one of a rail"):
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
    found = formats.read(file)
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
    found = formats.read(file)
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
    with pytest.raises(FormatError, match=f"rail.prr, line {line}: .*{words}"):
        formats.read(file)


def test_broken_miniprof_files_are_refused(tmp_path) -> None:
    file = tmp_path / "rail.ban"
    file.write_text("1 2\n3 4\n")
    with pytest.raises(FormatError, match="rail.ban, line 1: .*key=value"):
        formats.read(file)
    file.write_text("XYPoints=2\n\n1 2\n3 four\n")
    with pytest.raises(FormatError, match="rail.ban, line 4: .*no point"):
        formats.read(file)


def test_miniprof_headers_order_the_columns(tmp_path) -> None:
    points = np.column_stack([np.linspace(-30.0, 30.0, 13), np.linspace(0.0, -5.0, 13)])
    rows = [f"{z:.4f} 7 {y:.4f}" for y, z in points]
    rows[3] = f'"{rows[3]}'
    file = tmp_path / "rail.ban"
    file.write_text("ColumnDef=Y,*,X\nXYPoints=12\n\n" + "\n".join(rows))
    found = formats.read(file)
    np.testing.assert_allclose(found.points, np.delete(points, 3, axis=0), atol=1e-3)
    assert found.remarks == ("1 line commented out",)


def test_lines_of_points_are_known() -> None:
    """Those that are commented out leave holes."""
    for file in (BAN, PRW):
        table, lines = formats.read(file), file.read_text().splitlines()
        assert len(table.lines) == len(table.points)
        for i in (0, len(table.lines) // 2, -1):
            assert [float(each) for each in lines[table.lines[i] - 1].split()[:2]]
    first = (BAN.read_text().splitlines()[formats.read(BAN).lines[0] - 1]).split()
    np.testing.assert_allclose(formats.read(BAN).points[0], [float(first[0]), float(first[1])])
