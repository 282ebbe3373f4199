"""The terminal report fits 80 columns where there is no terminal."""

import command
import numpy as np
import pytest

from railhead.cli import geometry

NAME = "a_long_name_of_a_file_of_points_on_a_rail_head.csv"
COMMANDS = {
    "list": ["list"],
    "plan": ["plan", "uic54_22t5_axle"],
    "locate": ["locate", "s1002_60e1", "--shift", "3mm", "--no-pictures"],
    "run": ["run", "long_roller", "--set", "mesh.patch_size=1", "--no-pictures"],
    "profile": ["profile", NAME, "--no-pictures"],
}


@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_lines_fit_eighty_columns(arguments: list[str], capsys, here, monkeypatch) -> None:
    points = [f"{0.5 * y},{-((0.5 * y) ** 2) / 600}" for y in range(-60, 61)]
    (here / NAME).write_text("y (mm),z (mm)\n" + "\n".join(points))
    monkeypatch.setattr(geometry, "SHIFTS", np.linspace(-3.0, 3.0, 3))
    assert command.status(*arguments) in (0, 1)
    printed = capsys.readouterr().out
    lines = printed.splitlines()
    assert len(lines) > 5 and max(map(len, lines)) <= 80 and "…" not in printed
    if NAME in arguments:
        assert any(line.startswith(11 * " ") for line in lines)  # words go on below their column


def test_effects_that_have_no_part_in_a_scene_are_one_line(capsys) -> None:
    """Their reasons stay in the JSON; one that a person chose is told."""
    command.status("plan", "hertz_ellipse")
    out = capsys.readouterr().out
    assert "no part    plane_strain, axisymmetry, surface_shape, true_profile," in out
    assert "Poisson's ratio" not in out and "│ symmetry_x " in out
    command.status("plan", "hertz_ellipse", "--without", "mean_dilatation")
    assert "│ mean_dilatation " in capsys.readouterr().out
    command.status("plan", "hertz_ellipse", "--json")
    assert "Poisson's ratio 0.3" in capsys.readouterr().out


def test_what_a_person_switched_off_is_no_failing(capsys) -> None:
    """Yield is called for, and half-spaces cannot have it; whoever switched it off knows."""
    plan = "plan", "uic54_22t5_axle", "--without", "finite_bodies"
    command.status(*plan)
    assert "though" in capsys.readouterr().out
    command.status(*plan, "--without", "plasticity")
    out = capsys.readouterr().out
    assert "│ plasticity " in out and "though" not in out
