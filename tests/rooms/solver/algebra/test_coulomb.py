"""Newton's method of the tractions on a made-up contact."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

from railhead.solver.algebra.coulomb import ContactCompliance, CoulombContact

N, M, MU = 12, 8, 0.3  # points, unknown tractions


def contact(rng: np.random.Generator) -> ContactCompliance:
    """Points with two tangents whose slip and pressure answer to tractions at random."""
    none = np.zeros((N, 2))
    along = np.broadcast_to(np.eye(3)[:2], (N, 2, 3))
    return ContactCompliance(
        points=np.zeros((N, 3)),
        area=np.full(N, 0.5),
        tangents=along,
        tau=np.full(N, 40.0),
        step=1.0,
        shape_functions=sp.csr_matrix(rng.random((2 * N, M))),
        trial_compliance=rng.normal(size=(2 * N, M)),
        displacement_compliance=rng.random((2 * N, M)),
        pressure_compliance=rng.normal(size=(N, M)),
        active=np.arange(N) % 4 > 0,
        trial_traction=rng.normal(size=(N, 2)) * 50,
        displacement=none,
        pressure=rng.random(N) * 100 + 50,
    )


@pytest.mark.parametrize("free, tries", [(0, 1), (2, 2)])
def test_motions_are_held_where_there_are_any(free: int, tries: int, monkeypatch) -> None:
    """What does not converge is tried with held motions, but where none is free nothing is."""
    asked = []

    def lost(problem: CoulombContact, begin: object, held: float) -> SimpleNamespace:
        asked.append(held)
        return SimpleNamespace(converged=False)

    monkeypatch.setattr(CoulombContact, "newton", lost)
    made, modes = contact(np.random.default_rng(1)), np.ones((free, N, 2))
    CoulombContact(made, MU, np.zeros((N, 2)), modes, np.ones((free, 4))).solve()
    assert len(asked) == tries and asked[0] == 0.0 and all(held > 0 for held in asked[1:])


def pushed_apart(push: float) -> ContactCompliance:
    """Twelve points in a row with one tangent, driven apart so that all may slip; the right half is
    pressed harder."""
    x = np.linspace(-1.0, 1.0, 12)
    n = len(x)
    none = np.zeros((n, 1))
    along = np.broadcast_to(np.eye(3)[0], (n, 1, 3))
    return ContactCompliance(
        points=np.stack([x, 0 * x, 0 * x], axis=1),
        area=np.full(n, 0.1),
        tangents=along,
        tau=np.full(n, 40.0),
        step=1.0,
        shape_functions=sp.identity(n, format="csr"),
        trial_compliance=-0.1 * np.eye(n),
        displacement_compliance=none,
        pressure_compliance=np.zeros((n, n)),
        active=np.ones(n, dtype=bool),
        trial_traction=push * x[:, None],
        displacement=none,
        pressure=100 + 7 * x,
    )


def test_where_all_would_slip_the_force_decides_the_motion() -> None:
    """Points driven apart carry no force along only if one of them hardly slips; rounding does not
    choose how far they move."""
    axis, modes = np.array([[1.0, 0.0, 0.0, 0.0]]), np.ones((1, 12, 1))
    found = [
        CoulombContact(pushed_apart(push), MU, np.zeros((12, 1)), modes, axis).solve()
        for push in (500.0, 500.0 * (1 + 1e-9))
    ]
    for each in found:
        assert each.converged and each.traction.sum() == pytest.approx(0.0, abs=1e-6 * MU * 100)
        assert each.sticks.sum() == 1
    assert found[1].motion == pytest.approx(found[0].motion, rel=1e-6)


def test_a_force_beyond_friction_is_not_converged() -> None:
    """All slips, and the tractions no longer change, but the force is not reached."""
    contact = pushed_apart(0.0)
    limit = MU * float(contact.area @ contact.pressure)
    for share, reached in ((0.99, True), (1.01, False)):
        axis = np.array([[1.0, 0.0, 0.0, share * limit]])
        sliding = CoulombContact(contact, MU, np.zeros((12, 1)), np.ones((1, 12, 1)), axis)
        assert sliding.solve().converged == reached


def test_the_tangent_is_the_derivative_of_the_residual() -> None:
    """Of points that stick, slip and do not touch, with a motion that follows from a force."""
    rng = np.random.default_rng(1)
    pressed, force = contact(rng), np.array([[0.6, 0.8, 0.0, 3.0]])
    problem = CoulombContact(pressed, MU, np.zeros((N, 2)), rng.normal(size=(1, N, 2)), force)
    x, way = rng.normal(size=M + 1), rng.normal(size=M + 1)
    slips = pressed.active & (rng.random(N) < 0.5)
    assert 0 < slips.sum() < pressed.active.sum()
    residual, tangent = problem.linearised(x, slips)
    ends = [problem.linearised(x + step * way, slips)[0] for step in (1e-5, -1e-5)]
    change = (ends[0] - ends[1]) / 2e-5
    assert np.linalg.norm(residual) > 0
    assert tangent @ way == pytest.approx(change, rel=1e-6, abs=1e-6 * np.abs(change).max())
