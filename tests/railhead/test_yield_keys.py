"""How a body yields is said in one way, and a wrong one is one line."""

import pytest

from railhead import Rail
from railhead.planning.effects.plasticity import hardening
from railhead.scene.sections import SceneError
from railhead.scene.steels import known


def test_every_steel_has_a_source_and_a_curve_that_does_not_soften() -> None:
    for name, steel in known().items():
        assert steel.kind in ("measured", "specified minimum") and steel.source, name
        strain, stress = zip(*steel.curve, strict=True)
        assert strain[0] == 0 and list(strain) == sorted(set(strain))
        assert list(stress) == sorted(stress) and 300 < stress[0] < 1000
        assert hardening(Rail(steel=name)).first == stress[0]


def test_r260_hardens_as_was_measured_after_predeformation() -> None:
    """106 MPa more after 13 % of strain, nothing more behind the last point."""
    curve = hardening(Rail(steel="R260"))
    stress, slope = curve.at([0.0, 0.1347 / 2, 5.0])
    assert stress == pytest.approx([472, (472 + 590.5) / 2, 706.2])
    assert slope == pytest.approx([118.5 / 0.1347, 118.5 / 0.1347, 0])


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


@pytest.mark.parametrize(
    "rows, said",
    [
        ("0,500\n0.1,450", "line 2: stress 450 falls"),
        ("0.01,500\n0.1,600", "line 1: the first plastic strain is 0.01; give 0"),
        ("strain,stress\n0,500\n0,600", "line 3: plastic strain 0 does not grow"),
        ("0,500", "has 1 points; give at least two"),
        ("0,500\nx,600", "line 2: 'x,600' is not a plastic strain and a stress"),
    ],
)
def test_a_wrong_curve_names_its_line(tmp_path, rows: str, said: str) -> None:
    file = tmp_path / "curve.csv"
    file.write_text(rows)
    with pytest.raises(SceneError, match=said):
        Rail(stress_strain=str(file))
