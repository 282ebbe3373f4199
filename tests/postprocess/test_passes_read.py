"""Passes as people read them: the section below the middle, the table, and the verdict in words."""

import numpy as np
import pytest

from railhead.postprocess.passes import Passes, RailState, words
from railhead.solver.material.elasticity import Material
from railhead.solver.material.hardening import Hardening
from railhead.solver.passes.block import Block
from railhead.solver.passes.rolling import RollingBlock


def test_below_the_middle_are_means_of_the_nearest_lines_from_the_surface_down():
    places = np.array([[0.3, -2.0], [-0.1, -3.0], [0.1, -1.0], [0.1, -3.0], [-0.1, -1.0]])
    stress = np.arange(20.0).reshape(5, 4)
    state = RailState(
        places=places, stress=stress, strain=np.arange(5.0), y=np.zeros(1), up=np.zeros(1)
    )
    depth, found, strain = state.below()
    assert depth.tolist() == [1.0, 3.0]
    assert found.tolist() == [
        stress[[2, 4]].mean(axis=0).tolist(),
        stress[[1, 3]].mean(axis=0).tolist(),
    ]
    assert strain.tolist() == [3.0, 2.0]


def test_the_table_has_the_place_in_two_columns():
    row = {"strain_increment_max": 0.01, "place_mm": [0.5, -3.0]}
    found = Passes(rows=[row, row], verdict="ratchets").table()
    assert [each["pass"] for each in found] == [1, 2]
    assert (found[1]["place_across_mm"], found[1]["place_depth_mm"]) == (0.5, 3.0)
    assert "place_mm" not in found[0]


@pytest.mark.parametrize(
    ("hardening", "text"),
    [
        (Hardening.linear(480.0), "perfect plasticity knows no hardening"),
        (Hardening.linear(480.0, 6e3, 1.0), "kinematic hardening never ratchets for ever"),
        (Hardening.linear(480.0, 6e3), "isotropic hardening always shakes down"),
    ],
)
def test_the_words_say_what_the_hardening_law_makes_of_it(hardening, text):
    axis = np.linspace(-1, 0, 2)
    rolling = RollingBlock(Block((axis, axis), Material(207e3, 0.3, hardening)))
    rows = [{"strain_increment_max": 0.004, "forward_mm": -0.0012}]
    said = words("ratchets", rows, rolling)
    assert said.startswith("ratchets: the surface moves by -0.0012 mm a pass") and text in said
    assert words("elastic", rows, rolling) == "elastic: nothing yields"
