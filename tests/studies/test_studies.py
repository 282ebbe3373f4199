"""The studies as the command runs them, on a small part of their runs."""

import csv
import os
import sys
import tomllib

import command
import pytest

from railhead.cli import study
from railhead.scene.scene import SceneError
from studies.accuracy import accuracy_cost
from studies.mechanics import load_sweep

Rows = list[dict[str, float]]


def read(path) -> list[dict]:
    """The rows of a study's CSV; numbers as numbers, empty cells as None."""

    def value(text: str) -> object:
        if text in ("", "True", "False"):
            return {"": None, "True": True, "False": False}[text]
        try:
            return float(text)
        except ValueError:
            return text

    with path.open(newline="", encoding="utf-8") as file:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(file)]


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    done = command.process("study", "load-sweep", "--quick", cwd=folder)
    return done, folder / "results" / "load_sweep"


@pytest.fixture(scope="module")
def cost(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cost")
    done = command.process("study", "accuracy_cost", "--quick", "--out", "cost", cwd=folder)
    return done, folder / "cost"


@pytest.mark.slow
def test_load_sweep_writes_all_its_files_and_prints_its_page(sweep) -> None:
    done, folder = sweep
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(folder)) == [
        ".railhead",
        "load_sweep.csv",
        "load_sweep.png",
        "page.md",
    ]
    assert os.listdir(folder.parent) == ["load_sweep"]
    assert done.stdout.startswith((folder / "page.md").read_text())
    assert "hertz_ellipse: 1000 N" in done.stderr


@pytest.mark.slow
def test_one_mesh_follows_hertz_over_all_loads(sweep) -> None:
    rows = read(sweep[1] / "load_sweep.csv")
    assert [row["load_N"] for row in rows] == pytest.approx([1e3, 5313.3, 28231, 150e3], rel=1e-4)
    assert len({row["unknowns"] for row in rows}) == 1
    for row in rows:
        assert row["converged"]
        for quantity in ("a", "b", "p_max", "approach", "tau_max"):
            assert abs(row[f"difference_{quantity}"]) < 0.003


@pytest.mark.slow
def test_fitted_exponents_are_hertz_s(sweep) -> None:
    rows = read(sweep[1] / "load_sweep.csv")
    named = [
        {key.rsplit("_", 1)[0]: row[key] for key in row if key.endswith(("N", "mm", "MPa"))}
        for row in rows
    ]
    fitted = load_sweep.exponents(named)
    for key, exact in load_sweep.LAWS.items():
        assert fitted[key] == pytest.approx(exact, abs=2e-3)


@pytest.mark.slow
def test_a_further_load_needs_no_more_krylov_iterations(sweep) -> None:
    """The preconditioner follows the patch from 1 kN to 150 kN."""
    counts = [row["linear_iterations"] for row in read(sweep[1] / "load_sweep.csv")]
    assert max(counts) <= 1.5 * counts[0]


@pytest.mark.slow
def test_accuracy_cost_records_every_run(cost) -> None:
    done, folder = cost
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(folder)) == [
        ".railhead",
        "accuracy_cost.csv",
        "accuracy_cost.png",
        "page.md",
    ]
    rows = read(folder / "accuracy_cost.csv")
    given = [row for row in rows if row["asked"] is None]
    assert len(given) == 14  # two methods, three elements, two sizes; two cubic meshes
    for row in given:
        assert row["converged"] and row["failure"] is None
        assert row["seconds"] > 0.1
        assert row["error"] == max(row["error_a"], row["error_b"], row["error_p_max"])
        assert row["error"] <= row["error_all"] < 0.2
    for row in (row for row in rows if row["asked"] is not None):
        assert row["reached"] and row["error"] < row["asked"]


@pytest.mark.slow
def test_observed_orders_of_convergence(cost) -> None:
    rows = read(cost[1] / "accuracy_cost.csv")
    a, worst = accuracy_cost.orders(rows, "error_a"), accuracy_cost.orders(rows)
    assert a["hertz_ellipse", "nitsche", "tetrahedron 2"] > 1.5
    for method in ("nitsche", "penalty"):
        assert worst["hertz_ellipse", method, "tetrahedron 2"] > 1.5
        assert worst["hertz_ellipse", method, "tetrahedron 1"] > 0.8
        assert worst["hertz_ellipse", method, "hexahedron 1"] > 0.8


@pytest.mark.slow
def test_page_says_what_accuracy_costs(cost) -> None:
    done, folder = cost
    text = (folder / "page.md").read_text()
    assert "A factor ten in accuracy costs a factor" in text
    assert "Nothing: every run converged." in text
    assert done.stdout.startswith(text)


def test_without_a_name_the_studies_are_listed_and_cases_are_not(capsys) -> None:
    assert command.status("study") == 0
    told = capsys.readouterr().out.splitlines()
    assert {"accuracy_cost", "load_sweep"} <= {line.split()[0] for line in told}
    assert command.status("list") == 0
    listed = capsys.readouterr().out
    assert "load_sweep" not in listed and "accuracy_cost" not in listed


def test_without_a_checkout_the_command_says_in_one_line_that_it_needs_one(
    here, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(study, "ROOT", here)
    for arguments in (["study"], ["study", "load_sweep"]):
        assert "studies need a checkout" in command.refused(capsys, *arguments)
    assert os.listdir(here) == []


def test_studies_are_no_part_of_what_is_installed() -> None:
    with (study.ROOT / "pyproject.toml").open("rb") as file:
        setuptools = tomllib.load(file)["tool"]["setuptools"]
    named = [*setuptools["packages"], *setuptools["package-dir"], *setuptools["package-data"]]
    assert not [name for name in named if "studies" in name]


def test_a_folder_with_other_files_is_left_alone(tmp_path) -> None:
    (tmp_path / "page.md").write_text("mine")
    with pytest.raises(SceneError, match="--out"):
        study.run("load_sweep", tmp_path, quick=True)
    assert (tmp_path / "page.md").read_text() == "mine"


def test_an_earlier_study_is_replaced(tmp_path, monkeypatch) -> None:
    class Dummy:
        STUDY = "writes one line"
        text = "first"

        def main(self, out, *, quick: bool) -> None:
            (out / "dummy.csv").write_text("x\n1\n")
            (out / "page.md").write_text(self.text)

    monkeypatch.setattr(study, "modules", lambda: {"dummy": ("dummy", "")})
    monkeypatch.setitem(sys.modules, "dummy", Dummy())
    folder = tmp_path / "dummy"
    for text in ("first", "second"):
        Dummy.text = text
        assert study.run("dummy", folder, quick=False) == (folder, text)
    assert os.listdir(tmp_path) == ["dummy"]
