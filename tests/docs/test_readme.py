"""What the README tells a newcomer: targets of make, the table and versions. Its commands
are tested in test_page_commands."""

import re
import shutil
import subprocess
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from csv_rows import rows
from solved import solved

import railhead as rh

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("target", ["run", "test", "deb"])
def test_make_targets_exist(target: str) -> None:
    make = shutil.which("make")
    assert f"    make {target} " in README
    done = subprocess.run(
        [make, "-n", target], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "./setup.sh" in done.stdout


@pytest.mark.slow
def test_setup_installs_nothing_the_second_time() -> None:
    done = subprocess.run(
        ["./setup.sh"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.returncode, done.stdout) == (0, "")


def peers() -> list[dict[str, str]]:
    """The runs of docs/peers.csv that came to an end."""
    return [row for row in rows(ROOT / "docs" / "peers.csv") if not row["failure"]]


def pressure_and_area(row: dict[str, str]) -> float:
    """The larger error of both, in per cent."""
    return 100 * max(abs(float(row[key])) for key in ("error_p_max", "error_area"))


def test_the_figure_beside_other_programs_is_that_of_the_peers() -> None:
    others = [row for row in peers() if row["method"] == "finite elements"]
    others = [row for row in others if row["code"] != "railhead"]
    best = min(others, key=pressure_and_area)
    own = [row for row in peers() if row["code"] == "railhead" and row["setting"] == "default"]
    time = sorted(float(row["cpu_seconds"]) for row in own)[len(own) // 2]
    text = " ".join(README.split())
    own_error = max(map(pressure_and_area, own))
    assert f"within {own_error:.2f} % after {time:.1f} s of processor time" in text
    told = f"is within {pressure_and_area(best):.2f} % after {float(best['cpu_seconds']):.1f} s"
    assert told in text and own_error < pressure_and_area(best)
    assert len({row["code"] for row in others}) == 5
    quick = [row for row in peers() if row["setting"] == "64 x 64 cells"]
    assert (
        f"has {pressure_and_area(quick[0]):.2f} % after {float(quick[0]['cpu_seconds']):.1f} s"
        in text
    )


TABLE = re.findall(r"^\| (.+?) \|(.+)\|$", README, re.MULTILINE)[1:]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(6))
def test_rows_of_the_table_come_out(number: int) -> None:
    label, cells = TABLE[number]
    _, unknowns, *errors, _ = (cell.strip() for cell in cells.split("|"))
    case = re.findall(r"`(\w+)[ `]", " ".join(row for row, _ in TABLE[: number + 1]))[-1]
    accuracy = re.search(r"--accuracy (\S+?)`", label)
    keys = [f"accuracy={accuracy[1]}"] if accuracy else []
    found = solved(case, *keys, *(["effects.plasticity=off"] if "--without" in label else []))
    assert found.passed, found.failed
    hertz, patch = found.hertz, found.patch
    pairs = [
        (patch.a, hertz.patch.a), (patch.b, hertz.patch.b),
        (found.pressure.max, hertz.pressure.max), (found.stress.tau_max, hertz.stress.tau_max),
    ]  # fmt: skip
    for said, (value, exact) in zip(errors, pairs, strict=True):
        if said:
            digits = len(said.rstrip(" %").partition(".")[2])
            assert float(said.rstrip(" %")) == pytest.approx(
                100 * (value / exact - 1), abs=1.01 * 10.0**-digits
            ), said
    told = 1e3 * float(unknowns.removesuffix("k"))
    assert told == pytest.approx(found.mesh_solution.unknowns, rel=0.05)
    if estimate := re.search(r"estimate (\S+) %", label):
        largest = found.as_dict()["checks"]["accuracy"]
        assert float(estimate[1]) == pytest.approx(100 * largest, abs=0.015)


@pytest.mark.slow
def test_yield_changes_the_last_row_by_what_it_says() -> None:
    found = solved("uic54_22t5_axle")
    elastic = found.as_dict()["elastic"]
    numbers = [
        found.pressure.max, found.patch.area,
        elastic["pressure"]["max_MPa"], elastic["patch"]["area_mm2"],
    ]  # fmt: skip
    said = re.search(r"(\d+) MPa on (\d+) mm2 instead of (\d+) on (\d+)", README)
    assert [float(number) for number in said.groups()] == pytest.approx(numbers, rel=0.004)


def test_package_project_and_citation_have_one_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"\nversion: {project['version']}\n" in (ROOT / "CITATION.cff").read_text()
    assert metadata.version("railhead-contact") == rh.__version__ == project["version"]


def test_the_package_depends_on_what_the_set_up_installs() -> None:
    script = (ROOT / "deb.sh").read_text(encoding="utf-8")
    (line,) = re.findall(r"^depends=\$\((.+)\)$", script, re.MULTILINE)
    done = subprocess.run(
        ["sh", "-c", line], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    assert {"python3-dolfinx", "python3-scipy"} <= set(done.split(", ")) and "venv" not in done
