"""Questions about units that were probably mixed up."""

import command
import pytest

import railhead as rh
from railhead.scene import catalogue
from railhead.scene.scene import unit_questions


@pytest.mark.parametrize(
    "key, value, meant",
    [
        ("rail.young_modulus", "207", "207000 MPa"),
        ("rail.young_modulus", "207e9", "207000 MPa"),
        ("wheel.young_modulus", "207e6", "207000 MPa"),
        ("wheel.rolling_radius", "0.42", "420 mm"),
        ("load", "25", "25000 N"),
        ("rail.yield_stress", "0.472", "472 MPa"),
    ],
)
def test_a_thousand_times_off_is_asked_about(key: str, value: str, meant: str) -> None:
    (line,) = unit_questions(rh.find("uic54_thesis").replace([f"{key}={value}"]))
    assert line.startswith(f"{key} = ") and line.endswith(f"{meant} meant?")


def test_usual_and_small_models_are_not_asked_about() -> None:
    for case in catalogue.shipped():
        assert not list(unit_questions(rh.find(case))), case
    soft = ["rail.young_modulus=20", "load=30"]
    assert not list(unit_questions(rh.find("sphere_on_plane").replace(soft)))


def test_the_command_asks_in_one_line_and_goes_on(capsys) -> None:
    assert command.status("plan", "sphere_on_plane", "--set", "wheel.young_modulus=207") == 0
    out, err = capsys.readouterr()
    assert "predicted" in out
    assert err.splitlines() == [
        "railhead: wheel.young_modulus = 207 MPa, 0.001 times what is usual: 207000 MPa meant?"
    ]
