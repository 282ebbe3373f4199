"""Sweeps over the position on a crossing: close positions and one sentence where the load goes
over. Numbers are those of case 6 of the crossings' reference.
"""

import json
from pathlib import Path
from typing import Any

import drawn_sections as drawn
import numpy as np
import pytest

import railhead as rh
from railhead.contact import head_loads
from railhead.scene.scene import Scene
from railhead.sweeps import sweep_table

# Position of the axle, share of the nose (c = 1), largest pressure, MPa.
SHARES = {
    192.0: (0.0, 1140.1),
    193.0: (0.01743, 1133.4),
    193.75: (0.19616, 1105.3),
    194.5: (0.42838, 1434.0),
    195.25: (0.67284, 1666.9),
    196.0: (0.89794, 1835.3),
    300.0: (1.0, 1985.5),
}


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """Nose and wing of case 6."""
    folder = tmp_path_factory.mktemp("crossing")
    places = range(150, 360, 10)
    rail = drawn.write(folder / "nose", places, lambda x: drawn.moved(drawn.nose(x), -20.0))
    tables: dict[str, Any] = {
        "rail": {"sections": rail, "position": 194.0},
        "wing": {"sections": drawn.write(folder / "wing", places, drawn.wing)},
        "wheel": {"profile": "cone40", "rolling_radius": 460.0},
    }
    return Scene.from_mapping(
        {"load": 80000.0, "effects": {"finite_bodies": "off"}, "quantities": "patch", **tables}
    )


@pytest.mark.parametrize("position", [193.0, 194.5, 196.0, 300.0])
def test_springs_of_hertz_share_the_load_as_boundary_elements_do(
    scene: Scene, position: float
) -> None:
    """The reference has them in planes, with each body one half-space."""
    assert head_loads.share(scene, position) == pytest.approx(SHARES[position][0], abs=1e-3)


def test_positions_are_close_where_the_load_goes_over(scene: Scene) -> None:
    """From one to the next no share changes by more than 0.1; far away none is added."""
    found = head_loads.refined(scene, {"rail.position": [180.0, "200 mm", 220.0]})["rail.position"]
    assert np.abs(np.diff([head_loads.share(scene, at) for at in found])).max() <= 0.1
    assert {180.0, 200.0, 220.0} <= {*found} and 13 <= len(found) <= 25
    assert not [at for at in found if 200 < at < 220]
    plain = {"load": [1e4, 2e4]}
    assert head_loads.refined(scene, plain) == plain


def rows(upward: bool) -> list[dict[str, Any]]:
    """Rows of a sweep with the shares of the reference; not upward: nose and wing exchanged."""
    return [
        {
            "rail.position [mm]": at,
            "share rail": share if upward else 1 - share,
            "share wing": 1 - share if upward else share,
            "p_max [MPa]": pressure,
        }
        for at, (share, pressure) in SHARES.items()
    ]


@pytest.mark.parametrize("upward", [True, False])
def test_half_of_the_load_has_gone_over_within_a_short_travel(upward: bool) -> None:
    """Half from 194.720 mm; both heads carry more than 1 % from 192.57 mm on, linear to 300 mm."""
    found = sweep_table.transfer(rows(upward))
    assert found["half_mm"] == pytest.approx(194.720, abs=0.02)
    assert found["from_mm"] == pytest.approx(192.574, abs=1e-3) and 196.0 < found["to_mm"] < 300.0
    assert found["largest_MPa"] == 1985.5 and sweep_table.transfer(rows(upward)[:3]) == {}
    assert sweep_table.transfer([{"rail.position [mm]": 1.0, "share rail": 1.0}]) == {}


@pytest.mark.slow
def test_a_passage_tells_where_the_load_goes_over(scene: Scene, tmp_path: Path) -> None:
    """Rows of a sweep, its picture, and sweep.json; the same command goes on with the folder."""
    over = {"rail.position": [193.0, 194.5, 197.0]}
    found = rh.sweep(scene, over, out=tmp_path / "out", quiet=True)
    said = json.loads((tmp_path / "out" / "sweep.json").read_text())["transfer"]
    assert said["half_mm"] == pytest.approx(194.720, abs=0.02)
    table = {row["rail.position [mm]"]: row for row in found.rows()}
    assert table[194.5]["share rail"] == pytest.approx(0.42838, abs=3e-4)
    assert table[194.5]["p_max wing [MPa]"] == pytest.approx(946.2, rel=1e-3)
    assert np.abs(np.diff([row["share rail"] for row in found.rows()])).max() <= 0.11
    assert rh.sweep(scene, over, out=tmp_path / "out", quiet=True).rows() == found.rows()
