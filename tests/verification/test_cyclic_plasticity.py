"""Steel that remembers: closed forms of back stresses that are recalled, on one cell of a model."""

import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes

import railhead.solver as rs

ENDS = (((0, 0, -1), (1, 1, 0)), ((0, 0, 1), (1, 1, 2)))


def pulled(steel: rs.Plastic) -> tuple[rs.Model, rs.Hub, rs.Hub]:
    """A cell of steel on three guides, and the hub that pulls it; beside it, as a model needs a
    contact, another cell and the hub that presses it against a plane.
    """
    made = rs.Model(*two_boxes("hexahedron", ((1, 1, 1), (1, 1, 1)), ENDS), degree=1)
    made.add(rs.Body(LOWER, rs.Elastic(207e3, 0.3)), rs.Body(UPPER, steel))
    made.add(rs.Slide(30, normal=(1, 0, 0)), rs.Slide(32, normal=(0, 1, 0)))
    made.add(rs.Slide(12, normal=(0, 0, 1)), rs.Contact(11, rs.Plane((0, 0, 0), (0, 0, -1))))
    hubs = (rs.Hub(tag, free=(0, 0, 1), slides=True) for tag in (22, 21))
    pulls, presses = (made.add(hub) for hub in hubs)
    return made, pulls, presses


@pytest.mark.parametrize("most, exact", [(600.0, 0.002231436), (700.0, 0.007621401)])
def test_ratchetting_under_a_mean_stress_is_the_closed_form(most: float, exact: float) -> None:
    """(1/g) ln[(A^2 - (smin + sy)^2)/(A^2 - (smax - sy)^2)] a cycle, A = C/g; the least stress is
    -500 MPa. Steps follow the back stress exactly, so that few do.
    """
    young, modulus, recall = 207e3, 4e4, 100.0
    made, hub, other = pulled(rs.Plastic(young, 0.3, 400.0, backstress=[(modulus, recall)]))
    found, plastic = made.solve({hub: rs.Force(most), other: rs.Force(10.0)}, steps=8), []
    for _ in range(2):
        plastic.append(found.motion(hub) - most / young)
        found = found.then({hub: rs.Force(-500.0)}, steps=10)
        found = found.then({hub: rs.Force(most)}, steps=10)
    assert found.converged
    first = -np.log(1 - (most - 400) * recall / modulus) / recall
    assert plastic[0] == pytest.approx(first, rel=1e-5)
    assert plastic[1] - plastic[0] == pytest.approx(exact, rel=1e-4)
