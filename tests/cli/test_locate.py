"""`railhead locate`: both wheels of a wheelset on their rails."""

import json

import command
import numpy as np
import pytest

from railhead.cases.s1002_60e1 import SCENE
from railhead.cli import locate
from railhead.scene.scene import SceneError


def located(*assignments: str) -> dict:
    return locate.locate(SCENE.replace(assignments)).summary()


def test_manchester_case_touches_left_and_right_alike() -> None:
    summary = located()
    right, left = summary["right"][0], summary["left"][0]
    assert right == left
    assert right["top_y_mm"] == pytest.approx(-7.28, abs=0.05)
    assert right["angle_rad"] == pytest.approx(0.0244, abs=1e-3)
    assert len(summary["right"]) == 2  # the second one hangs 8 um above the rail


def test_command_prints_json_and_writes_pictures(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.setattr(locate, "SHIFTS", np.linspace(-10.0, 10.0, 9))
    folder = tmp_path / "located"
    given = f"s1002_60e1 --shift 3mm --yaw 2mrad --json --out {folder}"
    assert command.status("locate", *given.split()) == 0
    printed = json.loads(capsys.readouterr().out)
    written = json.loads((folder / "summary.json").read_text())
    assert printed == {key: written[key] for key in printed}
    assert printed["scene"]["wheelset"]["yaw"] == pytest.approx(2e-3)
    assert printed["rolling_radius_difference_mm"] == pytest.approx(0.958, abs=0.01)
    pictures = {path.name for path in folder.glob("*.png")}
    assert pictures == {"profiles.png", "positions.png", "rolling_radius.png"}


def test_measured_profiles_come_with_their_curvature(tmp_path, capsys) -> None:
    rows = "\n".join(f"{y},{-(y**2) / 600}" for y in range(-26, 27, 2))
    (tmp_path / "rail.csv").write_text(rows)
    command.status(
        "locate", "uic54_thesis", "--no-pictures", "--set", f"rail.profile={tmp_path / 'rail.csv'}"
    )
    assert "rail profile, smoothed: radius" in capsys.readouterr().out
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize(
    "assignment, key",
    [
        ("rail.extent=half-space", "rail.extent|rail.profile|wheel.profile"),
        ("wheelset.yaw=1", "wheelset.yaw"),
        ("rail.gauge=1 mm", "rail.gauge"),
        ("wheelset.back_to_back=600", "wheelset.shift"),
    ],
)
def test_what_cannot_be_located_is_refused_by_its_key(assignment: str, key: str) -> None:
    with pytest.raises(SceneError, match=key):
        located(assignment)


def test_angles_are_printed_in_degrees(capsys) -> None:
    command.status("locate", "s1002_60e1", "--no-pictures")
    row = next(line for line in capsys.readouterr().out.splitlines() if "contact angle" in line)
    assert row.split()[3:6] == ["│", "deg", "│"] and "1.3955" in row  # 0.0243564 rad
