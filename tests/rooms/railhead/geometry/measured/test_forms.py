"""Files as instruments write them, of profiles that are drawn here from arcs and lines.

A heavy-haul rail and wheel: no standard is like them, and the wheel's tape circle is 77.8 mm from
its flange back. The truth is the drawing; the reading knows nothing of it.
"""

import command
import numpy as np
import pytest

import railhead as rh
from railhead.geometry.measured import measured_profile as measured

TAPE = 77.8
RAIL_RADII, FACE = (254.0, 31.75, 14.3), np.radians(88.57)


def drawn(start: np.ndarray, angle: float, pieces: list[tuple[float, float]]) -> np.ndarray:
    """Points 0.25 mm apart from a start on: of each piece its radius (positive bends to the right)
    and the angle (rad) to which it turns, or inf and the length of a straight one."""
    points = [start]
    for radius, value in pieces:
        if np.isinf(radius):
            s = np.linspace(0, value, max(2, round(value / 0.25) + 1))[1:]
            step = np.outer(s, [np.cos(angle), np.sin(angle)])
            points += list(points[-1] + step)
            continue
        count = max(2, round(abs((value - angle) * radius) / 0.25) + 1)
        turned = np.linspace(angle, value, count)[1:]
        centre = points[-1] + radius * np.array([np.sin(angle), -np.cos(angle)])
        points += list(centre + radius * np.column_stack([-np.sin(turned), np.cos(turned)]))
        angle = value
    return np.array(points)


def rail() -> np.ndarray:
    """y to the field side, z up from the crown; its gauge side (y < 0) worn by 1.2 mm."""
    half = drawn(np.zeros(2), 0.0, [
        (RAIL_RADII[0], -np.arcsin(11.923 / 254.0)), (RAIL_RADII[1], -np.pi / 4),
        (RAIL_RADII[2], -FACE), (np.inf, 15.0),
    ])  # fmt: skip
    whole = np.concatenate([(half * [-1, 1])[:0:-1], half])
    return whole - np.outer(1.2 * np.exp(-(((whole[:, 0] + 21) / 7) ** 2)), [0.0, 1.0])


def wheel() -> np.ndarray:
    """y from the flange back, z outwards, 0 at the tape circle: tread 1:20, fillets R 38 and R 15,
    face of 75 deg, tip of R 11."""
    cone = np.arctan(1 / 20)
    points = drawn(np.zeros(2), cone, [
        (np.inf, 100.0), (-38.0, np.radians(25)), (-15.0, np.radians(75)), (np.inf, 8.0),
        (11.0, -np.pi / 2), (np.inf, 12.0),
    ])[::-1] * [-1, 1]  # fmt: skip
    points = points - [points[:, 0].min(), 0.0]
    return points - [0.0, np.interp(TAPE, *points[points[:, 0] > 70.0].T)]


def text(points: np.ndarray, separator: str = " ") -> str:
    return "".join(separator.join(f"{each:.5f}" for each in row) + "\n" for row in points)


def simpack(points: np.ndarray, kind: int, factor: float = 1000.0, keys: str = "") -> str:
    return (
        f"header.begin\n type = {kind}\nheader.end\nspline.begin\n{keys} units.len.f = {factor}\n"
        f" point.begin\n{text(points)} point.end\nspline.end\n"
    )


OLD = "MINIPROF 101 148 1994 3 24\nwheel.prd\nWheel ID....: 3\n 32.0 28.0 10.0  (Sd/Sh/qR)\n\n"
NEW = '#MINIWHEELPROF\nMINIPROF 2020\nCar Number..: 1\n" 32.00 28.00 10.00\n(Sd/Sh/qR)\n'
CAD = "ProgramName=AutoCAD\nColumnDef=X,Y,A\nXYPoints=3\n\n"
WINDOWS = "[FileInfo]\nDate=18/09/2022\n\n[Profile1Info]\nColumnDef=X,Y\n\n[Profile1Data]\n"
DOWN, MIRRORED = np.array([1.0, -1.0]), np.array([-1.0, 1.0])
WHEELS = {
    "1994.whl": OLD + text(wheel()),
    "2020.whl": NEW + text(wheel(), "\t"),
    "backwards.whl": CAD + text(wheel()[::-1]),
    "plain.prw": simpack(wheel(), 1),
    "mirrored.prw": simpack(wheel() * MIRRORED, 1, keys=" mirror.y = 1\n"),
    "upright.csv": text(wheel() * DOWN * MIRRORED + [300.0, 0.0], ","),
}
RAILS = {
    "cad.ban": (CAD + text(rail()), "open"),
    "downwards.ban": (CAD + text(rail() * DOWN), "open"),
    "windows.mpt": (WINDOWS + text(rail(), "\t"), "open"),
    "plain.prr": (simpack(rail() * DOWN, 0), "as in the file"),
    "metres.prr": (simpack(rail() * DOWN / 1000 * 1.0, 0, 1.0), "as in the file"),
    "metres.txt": ("".join(f"{y / 1e3:.18e},{z / 1e3:.18e}\n" for y, z in rail()), "open"),
    "part.csv": ("y [mm],z [mm]\n" + text(rail()[rail()[:, 0] < 22], ","), "as in the file"),
}


@pytest.mark.parametrize("name", WHEELS)
def test_a_wheel_stands_on_the_tape_circle_of_its_file(name: str, tmp_path) -> None:
    """77.8 mm from the flange back, where the file has z = 0."""
    (tmp_path / name).write_text(WHEELS[name])
    found = measured.read(tmp_path / name, "wheel")
    assert found.oriented.tape_circle == pytest.approx(TAPE, abs=0.02)
    y = np.linspace(-30, 40, 71)
    tread = wheel()
    np.testing.assert_allclose(
        found.profile.height(y), np.interp(y + TAPE, *tread[tread[:, 0] > 35].T), atol=0.01
    )
    shift = 300.0 if name == "upright.csv" else 0.0
    sign = -1.0 if shift else 1.0
    assert (found.origin["flange_back_mm"], found.origin["tape_circle_mm"]) == pytest.approx(
        (shift, shift + sign * TAPE), abs=0.02
    )


def test_wear_moves_no_tape_circle_and_a_wheel_is_no_rail(tmp_path) -> None:
    """A tread that is worn by 2 mm where z was 0; an origin on the tape circle, with the flange
    back beside it; the same points as those of a rail."""
    points, usual = wheel(), wheel() - [0.0, np.interp(70.0, *wheel()[wheel()[:, 0] > 50].T)]
    worn = usual - np.outer(2.0 * np.exp(-(((usual[:, 0] - 78) / 20) ** 2)), [0, 1])
    files = {"worn.whl": (OLD + text(worn), 70.0), "origin.csv": (text(points - [TAPE, 0]), TAPE)}
    for name, (written, tape) in files.items():
        (tmp_path / name).write_text(written)
        found = measured.read(tmp_path / name, "wheel")
        assert found.oriented.tape_circle == pytest.approx(tape, abs=0.02)
    with pytest.raises(ValueError, match="line 1: has the flange of a wheel"):
        measured.read(tmp_path / "origin.csv", "rail")


@pytest.mark.parametrize("name", RAILS)
def test_a_rail_of_no_standard_is_read_in_its_axes(name: str, tmp_path) -> None:
    text, sides = RAILS[name]
    (tmp_path / name).write_text(text)
    found = measured.read(tmp_path / name, "rail")
    assert found.oriented.sides == sides
    assert found.origin["crown_mm"] == pytest.approx([0.0, 0.0], abs=0.02)
    y = np.array([-30.0, -21.0, -5.0, 0.0, 5.0, 20.0])
    true = rail()[np.abs(rail()[:, 0]) < 36]
    np.testing.assert_allclose(found.profile.height(y), np.interp(y, *true.T), atol=0.01)
    assert (1 / found.profile.curvature(5.0), 1 / found.profile.curvature(17.0)) == pytest.approx(
        (254.0, 31.75), rel=0.03
    )


def test_an_origin_beside_the_crown_is_asked_about_where_no_gauge_places_the_wheel(
    tmp_path,
) -> None:
    """A table 8 mm aside, whose top is 8 mm from its origin; one 1.5 mm too high says so."""
    for name, moved in (("aside", [8.0, 0.0]), ("high", [0.0, 1.5]), ("plain", [0.0, 0.0])):
        (tmp_path / f"{name}.csv").write_text("y [mm],z [mm]\n" + text(rail() + moved, ","))

    def wheel_y(name: str, *keys: str) -> float:
        """y of the first contact on the right wheel, mm."""
        keys = f"rail.profile={tmp_path / name}", "rail.profile_mirror=off", *keys
        found = rh.locate(rh.find("cone20_uninclined_uic54").replace(keys))
        return found.placed.right.touches[0].wheel_y

    with pytest.raises(ValueError, match=r"rail\.profile_origin: .* top is 8\.\d mm beside it"):
        wheel_y("aside.csv")
    aside = wheel_y("aside.csv", "rail.profile_origin=file")
    moved = wheel_y("aside.csv", "rail.profile_shift=[-8, 0]")
    wheel_y("aside.csv", "rail.gauge=1435")
    assert aside == pytest.approx(moved + 8.0, abs=0.01)  # the rail stands 8 mm aside
    assert moved == pytest.approx(wheel_y("plain.csv"), abs=1e-3)
    high = measured.read(tmp_path / "high.csv", "rail")
    assert any("its top is at y = " in each and "z = 1.5" in each for each in high.remarks)


@pytest.mark.parametrize("given", [920.0, 2.75, -70.0])
def test_a_tape_circle_of_a_header_is_a_length_of_wheels(given: float, tmp_path) -> None:
    path = tmp_path / "w.whl"
    path.write_text(f"{CAD}WheelDiameterTaperline={given}\n{text(wheel())}")
    with pytest.raises(ValueError, match=f"tape circle {given:g} mm .* 30 to 120 are allowed"):
        measured.read(path, "wheel")


def test_columns_of_a_wheel_the_other_way_are_refused(tmp_path) -> None:
    (tmp_path / "w.csv").write_text(text(wheel()[:, ::-1], ","))
    with pytest.raises(ValueError, match="higher than it is wide; give y before z"):
        measured.read(tmp_path / "w.csv", "wheel")


@pytest.mark.parametrize(
    ("header", "keys", "tape"),
    [("", ["wheel.tape_circle=70"], 70.0), ("", ["wheel.tape_circle=80"], 80.0),
     ("WheelDiameterTaperline=66.5\n", [], 66.5)],
)  # fmt: skip
def test_a_tape_circle_that_is_given_is_measured_from_the_flange_back(
    header: str, keys: list[str], tape: float, tmp_path
) -> None:
    """By a key, or by the header."""
    (tmp_path / "w.whl").write_text(CAD + header + text(wheel()))
    found = rh.profile(tmp_path / "w.whl", "wheel", keys).measured
    assert (found.origin["tape_circle_mm"], found.origin["flange_back_mm"]) == pytest.approx(
        (tape, 0.0)
    )


def test_heavy_haul_files_run_and_say_where_they_were_placed(tmp_path, monkeypatch, capsys) -> None:
    """The distance of flange back and rail is that of the drawing: gauge, and backs as given."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rail.prr").write_text(RAILS["plain.prr"][0])
    (tmp_path / "wheel.whl").write_text(WHEELS["1994.whl"])
    (tmp_path / "haul.toml").write_text(
        'load = "127.5 kN"\n[rail]\nprofile = "rail.prr"\ngauge = 1435.1\n'
        '[wheel]\nprofile = "wheel.whl"\nrolling_radius = 457\n[wheelset]\nback_to_back = 1347.4\n'
    )
    right = command.told(capsys, "locate", "haul.toml", "--no-pictures")["right"][0]
    face = rail()[(rail()[:, 0] < -30) & (rail()[:, 1] < -5)]
    crown = 1435.1 / 2 - np.interp(-14.0, face[::-1, 1][::-1], face[:, 0])
    assert right["rail_y_mm"] + crown == pytest.approx(
        1347.4 / 2 + TAPE + right["wheel_y_mm"], abs=0.05
    )
    assert command.status("run", "haul.toml", "--fast", "--no-pictures", "--quiet") in (0, 1)
    assert (tmp_path / "results" / "haul" / "summary.json").is_file()
