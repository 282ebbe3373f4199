"""`railhead.sweep` beside the command."""

from pathlib import Path

import pytest
from sweep_command import rows

import railhead as rh


def test_the_public_sweep_gives_the_same(swept: Path) -> None:
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    table = rh.sweep(scene, {"load": ["50kN", "80kN", "110kN"]}, quiet=True)
    for row, result in zip(rows(swept)[::2], table, strict=True):
        assert float(row["p_max [MPa]"]) == pytest.approx(result.pressure.max, rel=1e-9)
