"""report.html of a sweep."""

import re
from html import unescape

from sweep_command import rows

import railhead as rh
from railhead.postprocess.findings import Units
from railhead.sweeps import sweep_report


def test_the_report_of_a_sweep_has_all_of_it(swept) -> None:
    """Pictures, a row for each combination in both tables, what differs and what does not."""
    text = (swept / "report.html").read_text(encoding="utf-8")
    assert "<title>sweep of long_roller over load and wheel.rolling_radius</title>" in text
    assert "6 combinations, all passed" in text and text.count("data:image/png;base64,") == 2
    short, full = (_cells(text, name) for name in ("answers", "all"))
    table = rows(swept)
    assert len(short) == len(full) == 7 and full[0] == list(table[0])
    for line, row in zip(short[1:], table, strict=True):
        found = dict(zip(short[0], line, strict=True))
        bound = f"{float(row['p_max estimate']):.2%}"
        assert found["p_max [MPa]"] == f"{float(row['p_max [MPa]']):.5g}\u00a0\u00b1\u00a0{bound}"
        assert found["checks"] == "passed"
    assert _cells(text, "asked")[0] == ["load [N]", "50000, 80000, 110000"]
    same = {name for name, _ in _cells(text, "scene")}
    assert "mesh: patch size" in same and not {"load", "wheel: rolling radius"} & same


def test_what_failed_is_red(tmp_path) -> None:
    table = [{"load [N]": 1.0, "checks": "NOT SOLVED: gmsh <no>"}]
    scenes = [rh.find("sphere_on_plane")]
    sweep_report.write("a sweep", scenes, ["load [N]"], table, tmp_path, ["none.png"], Units())
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'class="verdict bad"' in text and '<td class="bad">NOT SOLVED: gmsh &lt;no&gt;' in text


def _cells(text: str, name: str) -> list[list[str]]:
    """Texts of the cells of the table of this id, by line."""
    (table,) = re.findall(rf'<table id="{name}">(.*?)</table>', text, re.DOTALL)
    lines = re.findall("<tr>(.*?)</tr>", table, re.DOTALL)
    return [
        [unescape(each) for each in re.findall("<t[dh].*?>(.*?)</t[dh]>", line)] for line in lines
    ]
