"""Tables of creep forces: symmetries, limits, and rows beside solutions of their own.

Kalker's linear coefficients: reference numbers, published tables, limits.
"""

import json
import math
import shutil
from dataclasses import replace

import command
import numpy as np
import pytest
from friction_data import named

from railhead.scene.scene import SceneError
from railhead.sweeps import creep_tables
from railhead.theory.friction import creep_table
from railhead.theory.friction.creep_table import AXES
from railhead.theory.friction.kalker import coefficients
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction, grid_over
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Falling, Heat, Interface

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


@pytest.fixture
def known_axes(table, monkeypatch) -> None:
    """The axes of the table, which take most of the time of a table that is complete."""
    axes = {name: table.axes[name].tolist() for name in AXES}
    monkeypatch.setattr(creep_table, "axes", lambda **_: axes)


@pytest.mark.parametrize("values", ["{}", "[[0]]", '"high"', '{"values": [["x"]]}', "1e308", "NaN"])
def test_a_broken_record_is_said(known_axes, folder, tmp_path, values: str) -> None:
    shutil.copytree(folder, tmp_path / "t")
    path = tmp_path / "t" / "records" / "00001.json"
    if values in ("1e308", "NaN"):
        content = json.loads(path.read_text())
        content["values"][0][0][0][0] = float(values)
        values = json.dumps(content)
    path.write_text(values if values.startswith("{") else f'{{"values": {values}}}')
    with pytest.raises(SceneError, match="00001.json' is broken"):
        creep_tables.creep_table(
            tmp_path / "t", poisson=NU, accuracy=0.1, ratios=(1.0, 1.0), cells=12
        )


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
    assert along == pytest.approx(0.01, rel=0.02) and across == pytest.approx(0.01, rel=0.03)
    assert moment == pytest.approx(0.01 * linear.c33 / linear.c23, rel=0.05)


def test_far_creepages_slip_wholly_along_their_direction(table) -> None:
    """Beyond the table the direction is kept."""
    far, _ = table.scaled(1.0, np.array([300.0, 300.0, 0.0]))
    border, _ = table.scaled(1.0, np.array([10.0, 10.0, 0.0]))
    np.testing.assert_allclose(far, border)
    assert np.hypot(*far[:2]) == pytest.approx(1.0, abs=0.02)


ABOVE = ".* not allowed; give a finite one above 0"
SPIN = "is not allowed; give finite ones, S within -10 to 10"


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ((-6.0, -6.0, 82e3, 24e3), f"^a = -6.0 is{ABOVE}"),
        ((6.0, 0.0, 82e3, 24e3), f"^b = 0.0 is{ABOVE}"),
        ((6.0, 6.0, math.inf, 24e3), f"^shear_modulus = inf{ABOVE}"),
        ((6.0, 6.0, 82e3, -24e3), f"^limit = -{ABOVE}"),
        ((1.0, (0, 0, 30.0)), SPIN), ((1.0, (0, 10.0, -30.0)), SPIN),
        ((1.0, (math.nan, 0, 0)), SPIN),
        ((2.0, (0, 0, 0)), "a/b = 2 is outside of the table, 1 to 1"),
    ],
)  # fmt: skip
def test_what_is_no_place_of_the_table_is_refused(table, place, text) -> None:
    """No contact, and scaled places beyond: there forces go on falling with spin."""
    with pytest.raises(ValueError, match=text):
        table(*place, along=1e-3) if len(place) > 2 else table.scaled(place[0], np.array(place[1]))


def test_the_stated_error_holds_at_other_places(table) -> None:
    """Uniform in +-2 of the scaled creepages and in +-10, from another seed."""
    circle, random = creep_table.Ellipse(1.0, NU, 12), np.random.default_rng(77)
    for most in (2.0, 10.0):
        places = random.uniform(-most, most, (100, 3))
        off = [np.abs(circle(*each)[0] - table.scaled(1.0, each)[0]) for each in places]
        assert np.all(np.mean(off < table.interpolation, axis=0) > 0.93)


def test_errors_at_a_place_hold_and_are_not_far_wider(table) -> None:
    """Beside the forces of 32 cells at places of another seed: smooth places have small errors."""
    circle, random = creep_table.Ellipse(1.0, NU, 32), np.random.default_rng(78)
    over = []
    for most in (2.0, 10.0):
        for each in random.uniform((0, 0, -most), most, (20, 3)):
            forces, errors = table.scaled(1.0, each)
            over.append(errors / np.abs(circle(*each)[0] - forces))
    assert np.mean(np.array(over) > 1) >= 0.95 and np.median(over) < 8


def test_between_axis_ratios_are_the_forces_of_that_ratio() -> None:
    """Beside ellipses on another grid; those of a circle at the same place are farther off."""
    ratios, along, spin = [0.3, 1.0, 3.0], [0.0, 0.5, 1.5, 10.0], [-10.0, -1.5, 0.0, 1.5, 10.0]
    values = [
        [creep_table.solve(NU, 12, ratio, x, (along, spin)) for x in along] for ratio in ratios
    ]
    linear, four = (
        [coefficients(ratio, NU) for ratio in ratios],
        map(np.array, (ratios, along, along, spin)),
    )
    of = creep_table.CreepTable(
        poisson=NU, cells=12, axes=dict(zip(AXES, four, strict=True)),
        kalker=np.array([[each.c11, each.c22, each.c23] for each in linear]).T,
        values=np.moveaxis(np.array(values), (0, 1), (2, 3)), interpolation=np.zeros(3),
    )  # fmt: skip
    shear, limit, c = 82e3, 24e3, 6.0
    unit = limit * np.array([1, 1, c])
    for ratio in (0.5, 1.4):
        a, b = c * math.sqrt(ratio), c / math.sqrt(ratio)
        own = coefficients(ratio, NU)
        scales = limit / (shear * c**2 * np.array([own.c11, own.c22, own.c23])) / [1, 1, c]
        place = np.array([0.5, 0.5, 1.5])
        creepage = Creepage(*(scales * place))
        motion = {"along": creepage.along, "across": creepage.across, "spin": creepage.spin}
        right = exact(a, b, shear, limit, creepage) / unit
        np.testing.assert_allclose(of(a, b, shear, limit, **motion)[0] / unit, right, atol=0.02)
        assert np.abs(of.scaled(1.0, place)[0] - right).max() > 0.04


def test_the_command_writes_a_table_and_says_its_errors(
    known_axes, folder, tmp_path, capsys
) -> None:
    out = tmp_path / "t"
    shutil.copytree(folder, out)
    (out / "table.npz").unlink()
    asked = "--poisson", "0.28", "--ratios", "1", "--accuracy", "10%", "--cells", "12"
    assert command.status("table", *asked, "--out", str(out)) == 0
    text = capsys.readouterr().out
    read = creep_table.CreepTable.load(out / "table.npz")
    assert np.all(read.interpolation > 0) and read.cells == 12
    assert f"{read.values[0, 0].size} cases; between them 95 % of places are within" in text
    assert f"force_along  {read.interpolation[0]:.2%}, grid at most" in text


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"poisson": 0.6}, "poisson: 0.6 is not allowed; give 0 to 0.5"),
        ({"accuracy": 0.5}, "accuracy: 0.5 is not allowed"),
        ({"ratios": (2.0, 1.0)}, "ratios: 2:1 is not allowed; give LOW:HIGH"),
        ({"ratios": "wide"}, "ratios: 'wide' is not allowed; give LOW:HIGH"),
        ({"cells": 13}, "cells: 13 is not allowed; give 12 to 96, even"),
        ({"law": (1.5, 1.0, 1.0)}, "law: .* give KINETIC above 0 to 1"),
        ({"law": (0.1, 1e-3, 1e-4), "cells": 12}, "law: .* the law falls too steeply"),
    ],
)
def test_a_wrong_request_is_one_line_and_writes_nothing(keys, text, tmp_path) -> None:
    with pytest.raises(SceneError, match=f"^{text}"):
        creep_tables.creep_table(tmp_path / "none", **keys)
    assert not (tmp_path / "none").exists()


LAW = (0.4, 5.0, 0.2)


def test_a_law_in_scaled_numbers_is_that_of_the_contact() -> None:
    """A circle of 6 mm under 80 kN at 20 m/s, in mm and N: the force over that of Coulomb's law."""
    a, modulus, speed, mu, normal = 6.0, 82e3, 20.0, 0.3, 8e4
    half = LAW[1] * 1e3 * speed * mu * normal / (modulus * a**2)
    surfaces = Interface(heat=Heat(speed=speed), law=Falling(LAW[0] * mu, half), memory=LAW[2] * a)

    def force(interface: Interface | None, creepage: Creepage) -> float:
        """Extrapolated from two grids, N."""
        found = []
        for cells in (12, 24):
            grid = grid_over((0.0, 0.0), (a, a), cells)
            p = np.sqrt(np.maximum(1 - (grid.x[:, None] / a) ** 2 - (grid.s / a) ** 2, 0))
            p *= normal / (p.sum() * grid.cell)
            pair = MaterialPair(modulus, NU)
            body = HalfSpaceFriction(grid.x, grid.s, p, mu, pair, rolling=True, interface=interface)
            found.append(body.solve(creepage).forces[0])
        return 2 * found[1] - found[0]

    circles = [creep_table.Ellipse(1.0, NU, 24, law) for law in (LAW, None)]
    scales = mu * normal / (modulus * a**2) * circles[0].scales / creep_table.NORMAL
    shares = []
    for x in (0.8, 2.0, 10.0):
        creepage = Creepage(*(scales * (x, 0.3, 0.0)))
        (falling, _), (plain, _) = (circle(x, 0.3, 0.0) for circle in circles)
        shares.append(falling[0] / plain[0])
        exact = force(surfaces, creepage) / force(None, creepage)
        assert shares[-1] == pytest.approx(exact, abs=5e-4)
    assert 1 > shares[0] > shares[1] > shares[2] + 0.05


def test_a_table_with_a_law_is_kept_and_ends_at_its_border(table, tmp_path) -> None:
    replace(table, law=LAW).save(tmp_path / "t.npz")
    read = creep_table.CreepTable.load(tmp_path / "t.npz")
    assert read.law == LAW and read.scaled(1.0, np.array([10.0, 0, 0]))[0][0] > 0.9
    with pytest.raises(ValueError, match="2 times the largest of a table with a law"):
        read.scaled(1.0, np.array([20.0, 0, 0]))
    table.save(tmp_path / "u.npz")
    assert creep_table.CreepTable.load(tmp_path / "u.npz").law is None


def test_nodes_have_the_law_of_the_table() -> None:
    """Forces at 10 are below those at 2."""
    near, far = (
        creep_table.solve(NU, 12, 1.0, x, ([0.0], [0.0]), LAW)[0, 0, 0, 0] for x in (2.0, 10.0)
    )
    assert near > far + 0.05


SLOW = pytest.mark.slow
QUICK = {"kalker_ab0.1_nu0", "kalker_ab0.1_nu0.3", "kalker_ab0.5_nu0.3", "kalker_ab1.251_nu0.3",
         "kalker_ab2_nu0", "kalker_ab5_nu0.3", "kalker_ab10_nu0", "kalker_ab10_nu0.3"}  # fmt: skip


def every_axis_ratio():
    entries = named("kalker")
    return [p if p.id in QUICK else pytest.param(*p.values, id=p.id, marks=SLOW) for p in entries]


@pytest.mark.parametrize("entry", every_axis_ratio())
def test_coefficients_are_kalker_s(entry) -> None:
    """Within the entry's own error; of the printed table within 1 % and half its last digit."""
    found = coefficients(entry["a_over_b"], entry["nu"])
    assert (found.c11, found.c22) == pytest.approx((entry["C11"], entry["C22"]), rel=5e-3)
    assert (found.c23, -found.c23, found.c33) == pytest.approx(
        (entry["C23"], entry["C32"], entry["C33"]), rel=1e-2
    )
    for key in ("C11", "C22", "C23"):
        if (printed := entry.get(f"published_{key}")) is not None:
            half_digit = 10.0 ** (math.floor(math.log10(printed)) - 2) / 2
            assert abs(getattr(found, key.lower()) - printed) <= 0.01 * printed + half_digit


def test_ratios_without_coefficients_are_refused() -> None:
    for ratio, poisson in ((0.01, 0.3), (1.0, 0.6), (math.nan, 0.3)):
        with pytest.raises(ValueError):
            coefficients(ratio, poisson)
