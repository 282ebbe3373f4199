"""Links, files, tests and rooms that pages name exist; lines are short; what README tells."""

import re
import subprocess
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from csv_rows import rows
from solved import solved

import railhead

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]


def prose(page: Path) -> str:
    """The text without its code."""
    return re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def anchors(page: Path) -> set[str]:
    """The names that its headings have in links."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", each.strip().lower()).replace(" ", "-") for each in headings}


def dead(page: Path):
    """Targets of its links that lead nowhere; those to other hosts are not followed."""
    for target in re.findall(r"\]\(([^()\s]+)\)|src=\"([^\"]+)\"", prose(page)):
        path, _, anchor = "".join(target).partition("#")
        file = page.parent / path if path else page
        if re.match(r"\w+:", path):
            continue
        if not file.is_file() or (anchor and anchor not in anchors(file)):
            yield "".join(target)


@pytest.mark.parametrize("page", [ROOT / "CHANGELOG.md", *PAGES], ids=lambda page: page.name)
def test_no_link_of_a_page_is_dead(page: Path) -> None:
    assert list(dead(page)) == []


def test_dead_links_are_found(tmp_path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# One, `two`\n[a](none.md) [b](#one-two) [c](#three) [d](page.md#one-two)\n")
    assert list(dead(page)) == ["none.md", "#three"]


def test_every_page_is_in_the_list_and_on_a_shelf() -> None:
    listed = set(re.findall(r"\]\(([\w-]+)\.md\)", (DOCS / "README.md").read_text("utf-8")))
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    shelved = {
        path.stem
        for entry in re.findall(r"^[\w*-]+$", index, re.MULTILINE)
        for path in DOCS.glob(f"{entry}.md")
    }
    assert listed == shelved == {page.stem for page in DOCS.glob("*.md")} - {"README", "index"}


FILE = re.compile(r"`((?:\w+/)+\w+\.py|(?:\w+/)*data/\w+\.\w+)`")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_that_a_page_names_exists(page: Path) -> None:
    """Its path begins at the checkout or at the package railhead."""
    named = set(FILE.findall(page.read_text(encoding="utf-8")))
    roots = ROOT, ROOT / "railhead"
    assert {each for each in named if not any((root / each).is_file() for root in roots)} == set()


def test_every_test_that_holds_a_claim_exists_and_runs_by_default() -> None:
    page = (ROOT / "docs" / "verification.md").read_text("utf-8")
    claims = [
        re.findall(r"\[(test_\w+)\]\(\.\./(tests/[\w/]+\.py)\)", row)
        for row in page.partition("\n## What `make test` leaves")[0].splitlines()
        if re.match(r"\| (?!Claim )", row)
    ]
    assert len(claims) == 39 and all(claims)
    for name, file in (each for row in claims for each in row):
        before, found, _ = (ROOT / file).read_text(encoding="utf-8").partition(f"def {name}(")
        assert found, (name, file)
        assert "\n@pytest.mark.slow" not in before[before.rindex("\n\n\n") :], name


def test_every_folder_of_modules_is_named_once_where_the_package_is_built() -> None:
    """An older environment still finds a folder whose name was lost; a new one does not."""
    setuptools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = [
        ".".join([name, *module.parent.relative_to(ROOT / place).parts])
        for name, place in setuptools["package-dir"].items()
        for module in (ROOT / place).rglob("__init__.py")
    ]
    assert sorted(setuptools["packages"]) == sorted(folders)


WIDEST = 200  # characters


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_line_of_prose_is_wider(page: Path) -> None:
    lines = page.read_text(encoding="utf-8").splitlines()
    wide = [line for line in lines if len(line) > WIDEST and not line.startswith("|")]
    assert not wide, wide[0]


README = (ROOT / "README.md").read_text(encoding="utf-8")


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
    assert len({row["code"] for row in others}) == 4
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
    assert metadata.version("railhead-contact") == railhead.__version__ == project["version"]


def test_the_package_depends_on_what_the_set_up_installs() -> None:
    script = (ROOT / "deb.sh").read_text(encoding="utf-8")
    (line,) = re.findall(r"^depends=\$\((.+)\)$", script, re.MULTILINE)
    done = subprocess.run(
        ["sh", "-c", line], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    assert {"python3-dolfinx", "python3-scipy"} <= set(done.split(", ")) and "venv" not in done
