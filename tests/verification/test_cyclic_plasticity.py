"""Steel that remembers: closed forms of back stresses that are recalled, on one cell of a model."""

import numpy as np
import pytest
from boxes import LOWER, UPPER, two_boxes

import railhead.solver as rs
from railhead.solver.material import Hardening
from railhead.solver.plasticity.radial_return import History, radial_return

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


E, NU = 207e3, 0.3
MU, LAM = E / 2.6, E * NU / (1.3 * 0.4)
ELASTIC = 2 * MU * np.eye(4) + LAM * np.outer([1, 1, 1, 0], [1, 1, 1, 0])
AF1 = Hardening.linear(400.0).cyclic([(4e4, 100.0)])


def driven(law, path, given, state):
    """State and strain of n points after a path (steps, n, 4) of xx, yy, zz, sqrt(2) xz, whose
    components `given` are strains and the others stresses, by Newton's method with the consistent
    tangent."""
    count, free = path.shape[1], ~np.array(given)
    strain = np.zeros((count, 4)) if state is None else state[1].copy()
    history = History.virgin(count, 4) if state is None else state[0]
    for target in path:
        strain[:, ~free] = target[:, ~free]
        for _ in range(30):
            after, less = radial_return(strain, np.full(count, MU), history, law)
            wrong = (target - (strain @ ELASTIC - 2 * MU * after.plastic))[:, free]
            if np.abs(wrong).max() < 1e-6:
                break
            tangent = np.repeat(ELASTIC[None], count, axis=0)
            tangent[less.points] -= less.matrix
            block = tangent[:, free][:, :, free]
            strain[:, free] += np.linalg.solve(block, wrong[..., None])[..., 0]
        else:
            raise AssertionError("the driver does not converge")
        history = after
    return history, strain


def test_constant_tension_and_torsion_to_and_fro_is_the_closed_form():
    """de/dp = (s - X)/sy and dX/dp = C (s - X)/sy - g X, which have no step of their own: the
    axial strain over the accumulated strain after 4 cycles of shear +-0.02."""
    s, sy, c, g = 100.0, 400.0, 4e4, 100.0
    ends = np.concatenate([[0.0], np.tile([0.02, -0.02], 4)])
    shear = np.concatenate(
        [np.linspace(a, b, 61)[1:] for a, b in zip(ends, ends[1:], strict=False)]
    )
    path = np.zeros((len(shear) + 1, 1, 4))
    path[:, 0, 0], path[1:, 0, 3] = s, shear / np.sqrt(2)
    history, _ = driven(AF1, path, [False, False, False, True], None)
    p, rate = history.equivalent[0], (c + g * sy) / sy
    limit = c * s / (c + g * sy)
    exact = (s - limit) / sy * p + limit / sy * (1 - np.exp(-rate * p)) / rate
    assert history.plastic[0, 0] == pytest.approx(exact, rel=2e-3)


def elastic_line(x, depth, traction):
    """Stresses xx, zz, xz over the largest pressure below a line contact of half width 1 with
    tractions along x (Flamant's lines of force, by Gauss and Chebyshev's rule)."""
    angle = np.arange(1, 400) * np.pi / 400
    weight, apart = np.sin(angle) ** 2 / 200, x[..., None] - np.cos(angle)
    common = -weight / (apart**2 + depth**2) ** 2
    along, down = traction * apart + depth, depth
    return (
        (common * apart**2 * along).sum(-1),
        (common * down**2 * along).sum(-1),
        (common * down * apart * along).sum(-1),
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "traction", "second", "fifth"),
    [(5.5, 0.0, -0.3599e-3, -0.3355e-3), (4.5, 0.2, -4.8610e-3, -4.8175e-3)],
)
def test_material_below_a_rolling_line_shears_as_by_other_integrators(
    ratio, traction, second, fifth
):
    """Merwin and Johnson's problem at half a half width, AF1: growth of 2 exz in passes 2 and 5,
    extrapolated over the steps."""
    found = []
    for steps in (600, 1200):
        x = np.sinh(np.linspace(3.69, -3.69, steps))[:, None]
        x[0], x[-1] = 1e6, -1e6
        xx, zz, xz = ratio * 400 / 3**0.5 * np.array(elastic_line(x, 0.5, traction))
        path = np.zeros((steps, 1, 4))
        path[..., 0] = (xx - NU * (NU * (xx + zz) + zz)) / E
        path[..., 2], path[..., 3] = zz, np.sqrt(2) * xz
        state, shear = None, [0.0]
        for _ in range(5):
            state = driven(AF1, path, [True, True, False, False], state)
            shear.append(np.sqrt(2) * state[1][0, 3])
        found.append(np.diff(shear))
    assert (2 * found[1] - found[0])[[1, 4]] == pytest.approx([second, fifth], rel=0.01)
