"""The sweep of a script: side by side, as the command, and read again from its folder."""

import json
import os
import subprocess
import sys

import command
import matplotlib.image
import pytest
from matplotlib.figure import Figure
from sweep_command import rows

import railhead as rh
from railhead.meshing.mesh import MeshError
from railhead.results import pipeline

FAST = rh.find("hertz_ellipse").replace(["effects.finite_bodies=off"])


def test_the_public_sweep_gives_the_same(swept, in_this_process) -> None:
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    table = rh.sweep(scene, {"load": ["50kN", "80kN", "110kN"]}, quiet=True)
    for row, result in zip(rows(swept)[::2], table, strict=True):
        assert row.keys() - {"wheel.rolling_radius [mm]"} == table.rows()[0].keys()
        assert float(row["p_max [MPa]"]) == pytest.approx(result.pressure.max, rel=1e-9)


def test_what_cannot_be_solved_is_a_row(monkeypatch, in_this_process) -> None:
    def failing(plan, *_):
        raise MeshError("gmsh: no")

    monkeypatch.setattr(pipeline, "solve", failing)
    table = rh.sweep(rh.find("sphere_on_plane"), {"wheelset.yaw": [0]}, quiet=True)
    assert list(table) == []
    assert table.rows() == [{"wheelset.yaw [mrad]": 0.0, "checks": "NOT SOLVED: gmsh: no"}]


def test_a_folder_keeps_the_sweep(tmp_path, in_this_process, capsys) -> None:
    """The same call solves nothing again; what it had solved has arrays, what lay there numbers."""
    out = tmp_path / "out"
    given = {"load": [1e4, 2e4], "wheel.rolling_radius": [420, 460]}
    table = rh.sweep(FAST, given, out=out, quiet=True)
    assert {"sweep.csv", "sweep.png", "records"} <= set(os.listdir(out))
    assert table[0].findings is not None
    (out / "records" / "00001.json").unlink()
    again = rh.sweep(FAST, given, out=out, quiet=True)
    assert again[1].pressure == table[1].pressure and again[1].findings is not None
    with pytest.raises(ValueError, match="numbers only"):
        print(again[0].findings)
    read = rh.load(out)
    assert isinstance(read, rh.Sweep) and read.keys == list(given)
    assert read.rows() == again.rows() and read[3].pressure == table[3].pressure
    for row, line in zip(read.rows(), rows(out), strict=True):
        assert {key: "" if value is None else str(value) for key, value in row.items()} == line
    assert command.status("show", str(out), "--json") == 0
    assert json.loads(capsys.readouterr().out)["rows"] == read.rows()
    assert command.status("show", str(out)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80 and "4 combinations, all passed" in lines
    assert "4 combinations, all passed" in read._repr_html_() and "body {" not in read._repr_html_()
    with pytest.raises(rh.SceneError, match="holds another sweep"):
        rh.sweep(FAST, {"load": [1e4]}, out=out, quiet=True)


@pytest.mark.slow
def test_a_script_needs_no_guard(tmp_path) -> None:
    """Processes of a sweep do not run the script that started them."""
    script = tmp_path / "script.py"
    script.write_text(
        "import railhead as rh\n"
        "print('begins')\n"
        "scene = rh.find('hertz_ellipse').replace(['effects.finite_bodies=off'])\n"
        "print([each.load for each in rh.sweep(scene, load=[1e4, 2e4], quiet=True)])\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert done.stdout == "begins\n[10000.0, 20000.0]\n", done.stderr


def test_pictures_are_drawn_again_from_the_folder(swept, copied, capsys) -> None:
    """On axes, and as files, which are those of the command but for the title."""
    table = rh.load(swept)
    own = Figure()
    assert table.plot("sweep", ax=own.subplots(2, 2)) is own
    curve = own.axes[0].lines[0]
    assert max(curve.get_ydata()) in [row["p_max [MPa]"] for row in table.rows()]
    before = {name: (copied / name).read_bytes() for name in ("sweep.png", "sweep.csv")}
    for name in ("sweep.png", "patches.png"):
        (copied / name).unlink()
    assert command.status("show", str(copied), "--pictures") == 0
    assert "drawn: patches.png, sweep.png" in capsys.readouterr().out
    shape = matplotlib.image.imread(copied / "patches.png").shape
    assert shape[0] > 200 and shape == matplotlib.image.imread(swept / "patches.png").shape
    assert (copied / "sweep.csv").read_bytes() == before["sweep.csv"]
    assert b"railhead" in (copied / "sweep.png").read_bytes()[:200]
