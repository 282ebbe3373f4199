"""The terminal report fits 80 columns where there is no terminal."""

import command
import pytest

COMMANDS = {
    "list": ["list"],
    "plan": ["plan", "uic54_22t5_axle"],
    "locate": ["locate", "s1002_60e1", "--shift", "3mm", "--no-pictures"],
}


@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_lines_fit_eighty_columns(arguments: list[str], capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    command.status(*arguments)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 5 and max(map(len, lines)) <= 80


def test_a_profile_is_told_in_eighty_columns(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "a_long_name_of_a_file_of_points_on_a_rail_head.csv"
    points = [f"{0.5 * y},{-((0.5 * y) ** 2) / 600}" for y in range(-60, 61)]
    file.write_text("y (mm),z (mm)\n" + "\n".join(points))
    assert command.status("profile", str(file), "--no-pictures") == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert any(line.startswith(11 * " ") for line in lines)
