"""report.html: one file, complete, with the numbers of summary.json, that a browser can draw."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from one_line import refusal

from railhead import api
from railhead.planning.effects import in_words
from railhead.postprocess.findings import Units
from railhead.postprocess.pictures import gallery
from railhead.results import quantity_rows, result_folder
from railhead.results.report import html, output_units, terminal
from railhead.results.subject import subject
from railhead.scene import quantities

UNITS = output_units.parse("um,kN,GPa")


def tables_of(text: str) -> list[str]:
    """Ids of tables."""
    return re.findall(r'<table id="(\w+)"', text)


def addresses_of(text: str) -> list[str]:
    """What it loads or leads to."""
    return re.findall(r'\s(?:src|href|data)="([^"]*)"', text)


@pytest.fixture(scope="module")
def result():
    scene = api.find("long_roller").replace(
        ["friction.coefficient=0.3", "rolling.creepage_along=0.1%", "mesh.patch_size=0.6"]
    )
    return api.solve(scene, quiet=True)


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "out"
    result.save(out, units=UNITS)
    return out


def test_one_file_without_a_network(folder: Path) -> None:
    text = (folder / html.NAME).read_text(encoding="utf-8")
    assert len(text) < 6e6
    addresses = addresses_of(text)
    assert len(addresses) == len(list(folder.glob("*.png")))
    assert all(address.startswith("data:image/png;base64,") for address in addresses)
    assert not re.search(r"@import|url\(\s*['\"]?https?:|<link|<script[^>]+src", text)
    assert {"answer", "friction", "checks", "scene", "plan", "left_out"} <= set(tables_of(text))
    assert "of the checks is in mm, N and MPa, whatever" in text
    assert not result_folder.foreign(folder)


def test_numbers_are_those_of_the_summary(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text())
    text = (folder / html.NAME).read_text(encoding="utf-8")
    cells = dict(re.findall(r'data-key="([^"]+)">([^<]*)<', text))  # of the finite elements
    assert len(cells) == len(quantities.rows("contact"))
    factor = {"mm": 1e3, "mm2": 1e6, "MPa": 1e-3}
    compared = 0
    for each, row in zip(
        quantities.rows("contact"), quantity_rows.rows(summary, "contact"), strict=True
    ):
        value = row["FE"]
        if isinstance(value, float):
            assert float(cells[".".join(each.path)]) == pytest.approx(
                value * factor[each.unit], rel=1e-4
            )
            compared += 1
    assert compared == 10


def brief_of(result, folder: Path) -> str:
    found = replace(result.findings, subject=subject(result.plan, result.load))
    return html.render(result.mesh_solution, result.summary, UNITS, folder, found, brief=True)


def test_a_brief_report_is_the_answer_and_what_was_asked(result, folder: Path) -> None:
    text = brief_of(result, folder)
    assert tables_of(text) == ["answer", "friction"]
    assert len(addresses_of(text)) == 2 and "checks hold" in text
    assert result.summary["date"] in text
    failed = result.summary["checks"] | {"failed": ["converged"], "passed": False}
    worse = replace(result, summary=result.summary | {"checks": failed})
    assert "FAILS" in brief_of(worse, folder) and "holds</td>" not in brief_of(worse, folder)


def with_passes(result):
    columns = ("strain_increment_max", "forward_mm", "groove_mm", "lean_mm")
    columns += ("pressure_max_MPa", "residual_along_MPa", "residual_across_MPa")
    rows = [dict.fromkeys(columns, 1e-3 * number) for number in range(30)]
    more = result.summary["result"] | {"passes": rows, "passes_words": "it shakes down"}
    more["passes_after"] = {"estimate": {}}
    return replace(result, summary=result.summary | {"result": more})


def test_passes_are_a_table(result, folder: Path) -> None:
    text = brief_of(with_passes(result), folder)
    table = re.search(r'<table id="passes">.*?</table>', text, re.S)
    numbers = [int(each) for each in re.findall(r'<tr><td class="n">([0-9]+)</td>', table[0])]
    assert numbers == [1, 2, 3, 30]
    rows = terminal.passes_table(with_passes(result).summary["result"]["passes"], UNITS)
    assert [row[0] for row in rows[1:]] == [str(each) for each in (*range(1, 11), 30)]
    assert "groove, um" in table[0] and ">29<" in table[0] and "-0<" not in table[0]


def test_report_and_pictures_are_left_out_when_asked(
    result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gallery, "drawings", lambda *_: {"pressure.png": Path.touch})
    result.save(tmp_path / "without", report=False)
    result.save(tmp_path / "bare", pictures=False)
    for name in ("without", "bare"):
        assert not (tmp_path / name / html.NAME).exists()
    assert (tmp_path / "without" / "pressure.png").exists()
    assert not (tmp_path / "bare" / "pressure.png").exists()


def test_a_failed_check_comes_first(result) -> None:
    checks = result.summary["checks"]
    name = next(iter(checks["limits"]))
    rows = html._checks({**checks, "failed": [name], "advice": {name: "do better"}})
    assert [row[3] for row in rows] == [False, *[True] * (len(rows) - 1)]
    assert rows[0][5] == "do better"


def test_the_verdict_is_of_what_holds(result, folder: Path) -> None:
    """One patch or two; that a patch is no ellipse only where the mesh can tell."""
    summary = result.summary
    no_ellipse = {**summary["checks"], "hertzian": False, "passed": True}
    two = {**summary["result"], "patches": [{"load_share": 0.5}] * 2}

    def said(**changed) -> str:
        shown = {**summary, **changed}
        return html.render(result.mesh_solution, shown, Units(), folder, result.findings)

    after = {"plasticity": {"needed": True, "why": "it yields <b>here</b>"}}
    told = f"What was left out matters: {in_words('plasticity')}.</b> it yields &lt;b&gt;here"
    assert told in said(effects_after=after)
    assert "matters" not in said()

    assert "The patch is no ellipse" in said(checks=no_ellipse)
    assert "The patch is no ellipse" not in said(checks={**no_ellipse, "passed": False})
    assert re.search(r"The contact patch\s+is", said())
    assert "touch in 2 patches; the most loaded one" in said(result=two)


def test_estimates_are_give_or_take(result) -> None:
    summary = {**result.summary, "accuracy": {"bound": {"max_MPa": 0.0123}}}
    table = html.answer_rows(summary, Units(), result.findings)
    column = table["columns"].index("within")
    cells = {key: cells[column] for _, _, key, cells in table["rows"]}
    assert cells["pressure.max_MPa"] == "\u00b1 1.23%"
    others = {text for key, text in cells.items() if key != "pressure.max_MPa"}
    assert others == {"", "no law"}


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [(645.16, "mm2", "1 in2"), (25.4, "N mm", "1 N in"), (6.894757293, "MPa", "1 ksi"),
     (1.0, "1/mm", "25.4 1/in"), (1.0, "N/mm2", "645.2 N/in2")],
)  # fmt: skip
def test_units_are_the_readers(value: float, unit: str, shown: str) -> None:
    assert output_units.parse("in, ksi").text(value, unit) == shown
    assert Units().value(value, unit) == value


@pytest.mark.parametrize("wrong", ["mm,furlong", "", "kN,N", "kg"])
def test_unknown_units_are_refused(wrong: str) -> None:
    assert "--units" in refusal(lambda: output_units.parse(wrong))
