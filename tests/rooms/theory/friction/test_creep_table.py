"""Tables of creep forces: symmetries, limits, and rows beside solutions of their own."""

import math

import numpy as np
import pytest

from railhead.scene.scene import SceneError
from railhead.sweeps import creep_tables
from railhead.theory.friction import creep_table
from railhead.theory.friction.creep_table import AXES
from railhead.theory.friction.kalker import coefficients
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction
from railhead.theory.friction.tangential import MaterialPair

NU = 0.28


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("table") / "t"


@pytest.fixture(scope="module")
def table(folder):
    """A coarse table of circles."""
    return creep_tables.creep_table(folder, poisson=NU, accuracy=0.1, ratios=(1.0, 1.0), cells=12)


def test_a_table_goes_on_and_is_read_again(table, folder) -> None:
    records = sorted((folder / "records").glob("*.json"))
    times = [path.stat().st_mtime_ns for path in records]
    records[1].unlink()
    same = creep_tables.creep_table(folder, poisson=NU, accuracy=0.1, ratios=(1.0, 1.0), cells=12)
    np.testing.assert_allclose(same.values, table.values, atol=1e-7)
    kept = [path.stat().st_mtime_ns for path in records]
    assert kept[0] == times[0] and kept[1] > times[1]
    read = creep_table.CreepTable.load(folder / "table.npz")
    np.testing.assert_array_equal(read.values, same.values)
    rows = (folder / "table.csv").read_text().splitlines()
    head = [row for row in rows if row.startswith("#")]
    assert "Poisson's ratio 0.28" in head[0]
    assert len(rows) == len(head) + 1 + table.values[0, 0].size
    with pytest.raises(SceneError, match="holds another sweep, with table.poisson 0.28"):
        creep_tables.creep_table(folder, poisson=0.3, accuracy=0.1, ratios=(1.0, 1.0), cells=12)


def exact(
    a: float, b: float, shear: float, limit: float, creepage: Creepage, cells=40
) -> np.ndarray:
    """Forces of an ellipse on a grid of its own, with pressures sampled in the cells' middles."""
    x, y = (half * ((2 * np.arange(cells) + 1) / cells - 1) for half in (a, b))
    pressure = np.sqrt(np.clip(1 - (x[:, None] / a) ** 2 - (y / b) ** 2, 0, None))
    mu = 0.3
    pressure *= limit / mu / (pressure.sum() * (x[1] - x[0]) * (y[1] - y[0]))
    body = HalfSpaceFriction(x, y, pressure, mu, MaterialPair(shear, NU), rolling=True)
    return np.array(body.solve(creepage).forces)


@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, -1, -1)])
def test_a_contact_has_the_forces_of_its_own_solution(table, signs) -> None:
    """Within the table's own error, in N and N mm, with creepages of either sign."""
    a, b, shear, limit = 5.5, 5.5, 82e3, 3000.0
    node = np.array([1, 2, len(table.axes["spin"]) // 2 + 1])
    place = np.array([table.axes[name][at] for name, at in zip(AXES[1:], node, strict=True)])
    linear = [np.interp(np.log(a / b), np.log(table.axes["axis_ratio"]), c) for c in table.kalker]
    unit = limit / (shear * a * b * np.array(linear)) / [1, 1, math.sqrt(a * b)]
    creepage = Creepage(*(np.array(signs) * place * unit))
    along, across, spin = creepage.along, creepage.across, creepage.spin
    found, errors = table(a, b, shear, limit, along=along, across=across, spin=spin)
    assert np.all(np.abs(found - exact(a, b, shear, limit, creepage)) < errors)
    assert np.all(errors < 0.25 * limit * np.array([1, 1, math.sqrt(a * b)]))


def test_small_creepages_give_kalkers_linear_theory(table) -> None:
    ellipse = creep_table.Ellipse(1.0, NU, 48)
    linear = coefficients(1.0, NU)
    (along, across, moment), _ = ellipse(0.01, 0.0, 0.01)
    assert along == pytest.approx(0.01, rel=0.02)
    assert across == pytest.approx(0.01, rel=0.03)
    assert moment == pytest.approx(0.01 * linear.c33 / linear.c23, rel=0.05)


def test_far_creepages_slip_wholly_along_their_direction(table) -> None:
    """Beyond the table the direction is kept."""
    far, _ = table.scaled(1.0, np.array([300.0, 300.0, 0.0]))
    border, _ = table.scaled(1.0, np.array([10.0, 10.0, 0.0]))
    np.testing.assert_allclose(far, border)
    assert np.hypot(*far[:2]) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"poisson": 0.6}, "--poisson: 0.6 is not allowed; give 0 to 0.5"),
        ({"accuracy": 0.5}, "--accuracy: 0.5 is not allowed"),
        ({"ratios": (2.0, 1.0)}, "--ratios: 2:1 is not allowed; give LOW:HIGH"),
        ({"cells": 13}, "--cells: 13 is not allowed; give 12 to 96, even"),
    ],
)
def test_a_wrong_request_is_one_line_and_writes_nothing(keys, text, tmp_path) -> None:
    with pytest.raises(SceneError, match=f"^{text}"):
        creep_tables.creep_table(tmp_path / "none", **keys)
    assert not (tmp_path / "none").exists()


def test_an_axis_ratio_outside_is_refused(table) -> None:
    with pytest.raises(ValueError, match="a/b = 2 is outside of the table, 1 to 1"):
        table.scaled(2.0, np.zeros(3))
