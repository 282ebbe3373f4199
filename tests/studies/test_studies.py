"""The studies as the command runs them, on a small part of their runs."""

import os

import command
import matplotlib.image
import pytest

from railhead.cli import study
from railhead.scene import catalogue

#: Files beside the page, and what it says.
QUICK = {
    "accuracy-cost": (
        {"accuracy_cost.csv", "accuracy_cost.png", "accuracy_asked.csv", "accuracy_asked.png"},
        "Nothing: every run converged.",
    ),
    "effects": (
        {"effects.csv", "effects_off.csv"}, "Unknowns and compiled forms are the same"
    ),
    "creep": (
        {"creep.csv", "creep_costs.csv", "creep_left_out.csv", "creep_sliding.csv",
         "creep_speed.csv", "creep.png", "friction_axes.png"},
        "Full sliding",
    ),
    "friction-bounds": ({"friction_bounds.csv"}, "3 random ellipses of half-spaces"),
    "passes": (
        {"passes_axle.csv", "passes_map.csv", "passes_study.png"},
        "on the right side of the limit at all 2 places",
    ),
    "pass-bounds": ({"pass_bounds.csv"}, "1 random lines that roll 5 times"),
    "profiles": ({"profiles.csv"}, "54E1 crown 1 mm"),
    "speed": ({"speed.csv", "speed_commands.csv"}, "a creep force on 24 x 24 cells"),
    "thesis": (
        {"thesis.csv", "thesis_lines.png", "thesis_patch.png"},
        "Not run: closed forms only.",
    ),
    "wear-bounds": ({"wear_bounds.csv"}, "hold in 2 of 2 routes"),
    "peers": ({"peers.csv", "peers.png"}, "| railhead | coarse "),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_a_quick_study_writes_its_files_and_prints_its_page(name: str, here, capsys) -> None:
    files, words = QUICK[name]
    assert command.status("study", name, "--quick", "--out", "out") == 0
    page = (here / "out" / "page.md").read_text()
    assert set(os.listdir("out")) == {".railhead", "page.md", *files}
    assert words in " ".join(page.split()) and capsys.readouterr().out.startswith(page)
    for picture in (here / "out").glob("*.png"):
        assert matplotlib.image.imread(picture).std() > 0.02


def test_without_a_name_the_studies_are_listed_and_cases_are_not(capsys) -> None:
    assert command.status("study") == 0
    told = capsys.readouterr().out.splitlines()
    assert {"accuracy_cost", "hard_cases"} <= {line.split()[0] for line in told}
    assert command.status("list") == 0
    listed = capsys.readouterr().out
    assert "hard_cases" not in listed and "accuracy_cost" not in listed
    assert all(name in listed for name in catalogue.shipped())


def test_without_a_checkout_the_command_says_in_one_line_that_it_needs_one(
    here, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(study, "ROOT", here)
    for arguments in (["study"], ["study", "hard_cases"]):
        assert "studies need a checkout" in command.refused(capsys, *arguments)
    assert os.listdir(here) == []
