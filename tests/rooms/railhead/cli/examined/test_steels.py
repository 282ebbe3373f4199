"""`railhead steel`: bars of a steel by closed forms, constants of a test, and what is refused."""

from dataclasses import replace
from pathlib import Path

import command
import numpy as np
import pytest
from one_line import refusal

from railhead.cli.examined.steels import steel_tests
from railhead.results.report import terminal
from railhead.solver.material import Hardening, Material
from railhead.solver.plasticity.specimen import Bar, fitted, stresses

E, Y, C, G = 207e3, 400.0, 40e3, 100.0
LAW = Hardening.linear(Y).cyclic([(C, G)])
EXAMPLES = Path(__file__).parents[5] / "examples"


@pytest.mark.parametrize(("most", "exact"), [(600.0, 0.002231436), (700.0, 0.007621401)])
def test_a_bar_ratchets_as_the_closed_form_says(most: float, exact: float) -> None:
    """(1/g) ln[(A^2 - (smin + sy)^2)/(A^2 - (smax - sy)^2)] a cycle, A = C/g, in two steps."""
    bar = Bar(Material(E, 0.3, LAW))
    first = bar.to_stress(most)
    assert first - most / E == pytest.approx(-np.log(1 - (most - Y) * G / C) / G, rel=1e-7)
    bar.to_stress(-500.0)
    assert bar.to_stress(most) - first == pytest.approx(exact, rel=1e-6)
    assert "does not carry 810 MPa" in refusal(lambda: bar.to_stress(810.0), ValueError)


@pytest.mark.parametrize(("exponent", "proof"), [(0, 445.0), (5, 479.0)])
def test_1070_in_tension_depends_on_the_rule(exponent: int, proof: float) -> None:
    law = steel_tests("1070", [], 1, 0.0).steel.hardening
    assert law is not None
    pairs = [(each.modulus, each.recall) for each in law.backstresses]
    steel = Material(206800.0, 0.3, Hardening.linear(225.17).cyclic(pairs, exponent))
    strain = np.linspace(0.0, 0.006, 100)
    stress = stresses(steel, strain)
    assert np.interp(0.002, strain - stress / 206800, stress) == pytest.approx(proof, rel=5e-3)


def exact_test() -> np.ndarray:
    """Strain and stress (n, 2) of three legs of plastic strain by the closed form of a back stress
    (Armstrong and Frederick) and of Voce's part, with elastic points between.
    """
    back, travelled, plastic = 0.0, 0.0, 0.0
    rows = [(s / E, s) for s in np.linspace(0.0, Y, 6)]
    for way, end in ((1, 0.01), (-1, -0.01), (1, 0.01)):
        while way * (end - plastic) > 1e-9:
            plastic, travelled = plastic + way * 5e-4, travelled + 5e-4
            back = way * C / G - (way * C / G - back) * np.exp(-G * 5e-4)
            stress = way * (Y + 60.0 * -np.expm1(-20.0 * travelled)) + back
            rows.append((stress / E + plastic, stress))
        turned = back - way * (Y + 60.0 * -np.expm1(-20.0 * travelled))
        rows += [(s / E + plastic, s) for s in np.linspace(rows[-1][1], turned, 6)[1:-1]]
    return np.array(rows[:-4])


def test_constants_of_a_test_come_back() -> None:
    strain, stress = exact_test().T
    found, errors = fitted(strain, stress, 1)
    law = found.hardening
    assert errors.max() < 1e-3
    assert law is not None and found.young_modulus == pytest.approx(E, rel=1e-6)
    (back,) = law.backstresses
    assert (law.initial_yield_stress, back.modulus, back.recall) == pytest.approx(
        (Y, C, G), rel=1e-3
    )
    assert law.isotropic == pytest.approx((60.0, 20.0), rel=1e-2)


@pytest.mark.slow
def test_noise_moves_constants_by_their_standard_errors() -> None:
    """Four tests with independent noise of 5 MPa: constants scatter as the errors of a test say."""
    strain, stress = exact_test().T
    found = []
    for seed in range(4):
        noise = np.random.default_rng(seed).normal(0.0, 5.0, len(stress)) * (strain > 0.002)
        steel, errors = fitted(strain, stress + noise, 1)
        law = steel.hardening
        assert law is not None
        (back,) = law.backstresses
        values = law.initial_yield_stress / Y, back.modulus / C, back.recall / G
        found.append((np.array(values) - 1) / errors[:3])
    assert 0.5 < np.sqrt(np.mean(np.square(found))) < 1.7


@pytest.mark.slow
def test_the_table_of_the_examples_gives_its_rule_back(here, capsys) -> None:
    """Its five back stresses by three, within 0.3 % of the largest stress, but not by another
    rule."""
    path = str(EXAMPLES / "steel_loops.csv")
    for exponent, least, most in (("5", 0.0, 1.8), ("0", 15.0, 40.0)):
        keys = ("--backstresses", "3", "--recall-exponent", exponent, "--no-pictures")
        found = command.told(capsys, "steel", path, *keys, "--out", f"of_{exponent}")
        assert least < found["misfit_MPa"] < most


def test_what_is_no_steel_is_refused_in_one_line(here) -> None:
    for name, text, said in (
        ("empty.csv", "", "empty.csv, line 1"),
        ("late.csv", "strain,stress\n0.01,400\n0.02,500\n", "starts at 400 MPa"),
        ("short.csv", "strain,stress\n0,0\n0.01,400\n0.02,500\n", "3 rows; give 6 or more"),
    ):
        Path(name).write_text(text)
        assert said in refusal(lambda name=name: steel_tests(name, [], 1, 0.0)), name
    rows = exact_test()
    for scales in ((100.0, 1.0), (1.0, 1e-3), (1.0, 0.0)):  # per cent, GPa, no slope
        file = Path("units.csv")
        np.savetxt(file, rows * scales, delimiter=",", header="strain,stress", comments="")
        text = refusal(lambda: steel_tests("units.csv", [], 1, 0.0))
        assert "Young's modulus of" in text and "strain [%]" in text
    for option, value in (("--amplitude", "0"), ("--recall-exponent", "nan")):
        assert command.status("steel", "1070", option, value) == 2
    assert "give a steel (R260" in refusal(lambda: steel_tests("R999", [], 1, 0.0))
    assert "cannot be read" in refusal(lambda: steel_tests("none.csv", [], 1, 0.0))
    assert "rail.steel: is not given" in refusal(
        lambda: steel_tests("sphere_on_plane", [], 1, 0.0).summary()
    )
    assert "does not carry" in refusal(lambda: steel_tests("R260", [], 1, 0.0, mean=400.0).rates)


def test_the_command_writes_keys_tables_and_a_picture(here, capsys) -> None:
    found = command.told(capsys, "steel", "1070", "--mean", "50 MPa", "--cycles", "3")
    assert found["rule"] == "Jiang and Sehitoglu's rule, exponent 5"
    rates = found["ratchetting"]["strain_per_cycle"]
    assert len(rates) == 3 and rates[0] > rates[1] > rates[2] > 0
    assert found["ratchetting"]["mean_MPa"] == 50.0
    names = {path.name for path in Path("results/1070_steel").iterdir()}
    assert {"steel.png", "curve.csv", "loops.csv", "cycles.csv", "scene.toml"} < names


def test_a_test_that_softens_is_no_fit(here, capsys) -> None:
    rows = [(i * 5e-4, i * 100.0) for i in range(6)] + [
        (i * 0.01, 700.0 - 40 * i) for i in range(1, 12)
    ]
    np.savetxt("soft.csv", rows, delimiter=",", header="strain,stress", comments="")
    fit = "steel", "soft.csv", "--backstresses", "1", "--no-pictures"
    assert command.status(*fit, "--cycles", "1", "--amplitude", "100MPa") == 1
    assert "DO NOT DESCRIBE THE TEST" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("end", "known"), [(0.02, [0.002, 0.01]), (0.005, [0.002]), (0.001, [])])
def test_proof_stresses_end_with_the_test_and_with_the_curve(
    end: float, known: list[float], tmp_path
) -> None:
    """Beyond it, they were those of the last point."""
    (tmp_path / "curve.csv").write_text(f"0,400\n{end},500\n")
    curve = [f"rail.stress_strain={tmp_path / 'curve.csv'}"]
    found = steel_tests("long_roller", curve, 1, 0.0)
    assert list(found.proof) == [f"{each:g}" for each in known]
    printed = terminal.recorded(found.show).export_text()
    assert ("no proof stress" in printed) == (not known)
    bar = steel_tests("long_roller", ["rail.yield_stress=400"], 1, 0.0)
    pulled = np.array([[0.0, 0.0], [end + 400.0 / 207000.0, 400.0]])
    assert list(replace(bar, measured=pulled).proof) == list(found.proof)
