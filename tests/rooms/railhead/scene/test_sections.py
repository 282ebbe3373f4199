"""How a body yields is said in one way, and a wrong one is one line."""

import numpy as np
import pytest

from railhead import Rail, Scene, find
from railhead.planning import simulation_plan as planning
from railhead.run.model_setup import hardening
from railhead.scene.flow_curves import by_name
from railhead.scene.sections import SceneError

ROLLING = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


def test_every_steel_has_a_source_and_no_hardening_that_nobody_measured() -> None:
    """Radii of yield surfaces after torsion had been taken for a flow curve: 560 MPa at 10 %, where
    EN 13674-1 wants a tensile strength of 880."""
    for name, steel in by_name().items():
        assert steel.kind.endswith("without hardening") and steel.source, name
        curve = hardening(Rail(steel=name))
        assert 300 < curve.initial_yield_stress == steel.yield_stress < 1000
        stress, slope = curve.stress_and_slope(np.array([0.0, 0.1, 5.0]))
        assert np.all(stress == steel.yield_stress) and not slope.any()


@pytest.mark.parametrize(
    "keys, key, said",
    [
        ({"steel": "R350HT"}, "steel", "no yield of R350HT is known here; give R260, ER7, ER8 or"),
        ({"steel": "S235"}, "steel", "'S235' is not allowed; give R260, ER7, ER8"),
        ({"steel": 260}, "steel", "260 is not allowed; give R260"),
        ({"steel": "R260", "yield_stress": 500}, "yield_stress", "is not allowed beside steel"),
        ({"steel": "R260", "hardening_modulus": 1e3}, "hardening_modulus", "without yield_stress"),
        ({"kinematic_fraction": 0.5}, "kinematic_fraction", "without steel, yield_stress or"),
        ({"yield_stress": 500, "kinematic_fraction": 1.5}, "kinematic_fraction", "1.5"),
        ({"yield_stress": 500, "hardening_modulus": -1}, "hardening_modulus", "-1"),
        ({"stress_strain": "none.csv"}, "stress_strain", "not a readable .csv file"),
    ],
)
def test_wrong_ways_to_yield_are_one_line(keys: dict, key: str, said: str) -> None:
    with pytest.raises(SceneError) as error:
        Rail(**keys)
    assert error.value.key == key and said in error.value.text


def test_a_modulus_goes_on_and_a_file_ends(tmp_path) -> None:
    straight = hardening(Rail(yield_stress=500, hardening_modulus=1e3, kinematic_fraction=0.7))
    assert straight.kinematic == 0.7
    assert straight.stress_and_slope([0.0, 5.0])[0] == pytest.approx([500, 5500])
    file = tmp_path / "curve.csv"
    file.write_text("\ufeffstrain,stress\n0,480\n0.001,580\n\n", encoding="utf-8")
    curve = hardening(Rail(stress_strain=str(file)))
    assert curve.stress_and_slope([0.0005, 0.01])[0] == pytest.approx([530, 580])


@pytest.mark.parametrize(
    "rows, said",
    [
        ("0,500\n0.1,450", "line 2: stress 450 falls"),
        ("0.01,500\n0.1,600", "line 1: the first plastic strain is 0.01; give 0"),
        ("strain,stress\n0,500\n0,600", "line 3: plastic strain 0 does not grow"),
        ("0,500", "has 1 points; give at least two"),
        ("0,1e-300\n0.1,1e300", "line 1: stress 1e-300 is not allowed"),
        ("0,500\nx,600", "line 2: 'x,600' is not a plastic strain and a stress"),
        ("\udcff\udcfe\x00\x01,5", "curve.csv is no text"),
    ],
)
def test_a_wrong_curve_names_its_line(tmp_path, rows: str, said: str) -> None:
    file = tmp_path / "curve.csv"
    file.write_bytes(rows.encode(errors="surrogateescape"))
    with pytest.raises(SceneError, match=said):
        Rail(stress_strain=str(file))


def test_linear_tetrahedra_are_no_matter_where_yield_is_switched_off() -> None:
    scene = Scene(load=2e5, rail=Rail(yield_stress=300), mesh={"order": 1})
    planning.make(scene.replace(effects={"plasticity": "off"}))


def test_half_spaces_have_no_cells_that_lock() -> None:
    plan = planning.make(
        find("hertz_ellipse").replace([*ROLLING, "mesh.order=1", "effects.finite_bodies=off"])
    )
    assert plan.effects["friction"].on
