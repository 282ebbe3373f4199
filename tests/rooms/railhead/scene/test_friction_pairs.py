"""Pairs of an angle and a coefficient of friction."""

import math

import numpy as np
import pytest
import tomli_w
from one_line import refusal

from railhead.scene import catalogue
from railhead.scene.scene import Scene

PAIRS = ((-10.0, 0.5), (20.0, 0.4), (60.0, 0.1))


def scene(coefficient: object) -> Scene:
    return Scene(load="80 kN", friction={"coefficient": coefficient})


def test_pairs_are_the_same_in_toml_in_set_and_in_python(tmp_path) -> None:
    given = scene([["-10 deg", 0.5], (20, "40%"), [60, 0.1]])
    assert given.friction.coefficient == PAIRS
    text = "friction.coefficient=[[-10, 0.5], [20, 0.4], [60, 0.1]]"
    assert scene(0.3).replace([text]) == given
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(catalogue.portable(given)))
    assert catalogue.read_scene(tmp_path / "scene.toml") == given


def test_between_angles_it_is_linear_and_beyond_them_constant() -> None:
    angles = np.radians([-90.0, -10.0, 5.0, 20.0, 50.0, 60.0, 80.0])
    found = scene(PAIRS).friction.at(angles, 0.0)
    assert found == pytest.approx([0.5, 0.5, 0.45, 0.4, 0.175, 0.1, 0.1])
    assert scene(0.3).friction.at(angles, 0.0).tolist() == 7 * [0.3]
    assert scene("30%").friction.at(math.pi / 4, 0.0) == 0.3


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], "rising angles"),
        ([[0, 0.3], [0, 0.4]], "rising angles"),
        ([[20, 0.3], [10, 0.4]], "rising angles"),
        ([0.3, 0.4], "give pairs"),
        ([[0, 0.3, 0.1]], "give pairs"),
        ([[0, 0.0], [60, 0.1]], "0.0 is not allowed; give a number from 0 to 2, but not 0"),
        ([[0, 3.0], [60, 0.1]], "3.0 is not allowed"),
        ([["x", 0.3], [60, 0.1]], "'x' is not an angle; give degrees"),
        ([[0, 0.3], [91, 0.1]], "91 is not allowed; give an angle from -90 to 90 deg"),
        (3.0, "give a number from 0 to 2 or pairs of an angle and a coefficient"),
        ("high", "'high' is not a number"),
        ("[[0, 0.3], [60, 0.1", "is not a number"),
    ],
)
def test_what_is_neither_a_number_nor_pairs_is_refused_in_one_line(given, words: str) -> None:
    said = refusal(lambda: scene(given))
    assert said.startswith("friction.coefficient: ") and words in said
