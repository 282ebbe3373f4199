"""`railhead.sweep` beside the command."""

from pathlib import Path

import pytest
from sweep_command import rows

import railhead as rh
from railhead.meshing.mesh import MeshError
from railhead.results import pipeline


def test_the_public_sweep_gives_the_same(swept: Path) -> None:
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    table = rh.sweep(scene, {"load": ["50kN", "80kN", "110kN"]}, quiet=True)
    for row, result in zip(rows(swept)[::2], table, strict=True):
        assert row.keys() - {"wheel.rolling_radius [mm]"} == table.rows()[0].keys()
        assert float(row["p_max [MPa]"]) == pytest.approx(result.pressure.max, rel=1e-9)


def test_what_cannot_be_solved_is_a_row(monkeypatch) -> None:
    def failing(scene, *_):
        raise MeshError("gmsh: no")

    monkeypatch.setattr(pipeline, "run", failing)
    table = rh.sweep(rh.find("sphere_on_plane"), {"wheelset.yaw": [0]}, quiet=True)
    assert list(table) == []
    assert table.rows() == [{"wheelset.yaw [mrad]": 0.0, "checks": "NOT SOLVED: gmsh: no"}]
