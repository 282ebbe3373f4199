"""Newton's method off the beaten track: stiff and soft laws, stalled solves, cycles."""

from types import SimpleNamespace

import numpy as np
import pytest

from railhead.solver.algebra import newton
from railhead.solver.algebra.mixing import Anderson
from railhead.solver.material import Material
from railhead.solver.space.contact_interface import ContactLaw, Interface
from studies.hard.block_pairs import contact_model, press


@pytest.fixture(scope="module")
def reference():
    """Solution with the usual settings."""
    return press(contact_model(), load=2000.0)


STEEL = (207000.0, Material(207000.0, 0.3).lame)


@pytest.mark.parametrize(
    "law, theta, factor",
    [
        (ContactLaw(), 1, 1.0),
        (ContactLaw(gamma_factor=0.1), -1, 0.1),
        (ContactLaw(theta=0, gamma_factor=0.1), 0, 0.1),
        (ContactLaw(theta=1, gamma_factor=0.1), 1, 0.1),
    ],
)
def test_theta_follows_the_factor_unless_it_is_given(law, theta, factor) -> None:
    suited = law.suited(*STEEL)
    assert (suited.theta, suited.gamma_factor) == (theta, factor)


def test_the_parameter_does_not_grow_with_lambda() -> None:
    scales = []
    for nu in (0.49, 0.4999, 0.499999):
        lam, mu = Material(1000.0, nu).lame
        law = ContactLaw().suited(1000.0, (lam, mu))
        assert law.theta == -1
        scales.append(law.scale * (lam + 2 * mu))
    np.testing.assert_allclose(scales, 3000.0)


class TwoRanks:
    """Seen from the first one."""

    def __init__(self, other: object) -> None:
        self.other = other

    def allgather(self, own: object) -> list[object]:
        return [own, self.other]

    def allreduce(self, own: float, op: object = None) -> float:
        return own


@pytest.mark.parametrize(("elsewhere", "count"), [(-1.0, 0), (99.0, 12)])
def test_the_nearest_points_are_those_of_all_ranks(elsewhere: float, count: int) -> None:
    interface = SimpleNamespace(
        contact=np.zeros(20, int),
        missed=[0.0],
        initial_gap=np.arange(20.0),
        points=np.ones((20, 3)),
        weights=np.ones(20),
        comm=TwoRanks(np.full(12, elsewhere)),
    )
    assert Interface.nearest(interface, np.zeros(20)).sum() == count


def test_it_ends_with_the_residual_that_was_asked_for() -> None:
    """No sooner, and no later."""
    *before, last = press(contact_model(tolerance=1e-7), load=2000.0).newton.history
    assert last.residual <= 1e-7 < min(step.residual for step in before)


def test_stages_lead_up_to_a_stiff_law() -> None:
    assert [law.scale for law in ContactLaw(theta=1).stages] == [1.0]
    stiff = ContactLaw(theta=1, gamma_factor=2e4).stages
    np.testing.assert_allclose([law.scale for law in stiff], [2.0, 20.0, 200.0, 2e3, 2e4])
    assert stiff[-1] == ContactLaw(theta=1, gamma_factor=2e4)


@pytest.mark.parametrize("factor", [1e-3, 1e2, 1e6])
def test_nitsche_converges_at_any_factor(reference, factor: float) -> None:
    solution = press(contact_model(law=ContactLaw(gamma_factor=factor)), load=2000.0)
    assert solution.newton.converged
    assert solution.approach == pytest.approx(reference.approach, rel=0.01)


@pytest.mark.parametrize("start", ["none", "random"])
def test_wrong_starts_end_in_the_same_state(reference, start: str) -> None:
    contact = contact_model()
    count = len(contact.interface.points)
    rng = np.random.default_rng(1)
    active = rng.random(count) < 0.5 if start == "random" else np.zeros(count, bool)
    solution = contact.solve(load=2000.0, active=active)
    assert solution.newton.converged and len(solution.newton.history) <= 15
    assert solution.approach == pytest.approx(reference.approach, rel=1e-7)
    np.testing.assert_allclose(
        solution.pressure, reference.pressure, atol=1e-6 * reference.pressure.max()
    )


def test_a_step_that_fails_is_halved_until_the_rest_succeeds() -> None:
    """No step of more than 0.3 succeeds."""
    reached, tried = [0.0], []

    def step(share: float) -> bool:
        tried.append(share)
        if share - reached[-1] > 0.3:
            return False
        reached.append(share)
        return True

    assert newton.in_steps([0.25, 1.0], 0.0, step) and reached == [0.0, 0.25, 0.4375, 0.71875, 1.0]
    assert tried == [0.25, 1.0, 0.625, 0.4375, 1.0, 0.71875, 1.0]


def test_what_never_succeeds_ends_at_the_smallest_step() -> None:
    tried: list[float] = []
    assert not newton.in_steps([1.0, 2.0], 0.0, lambda share: bool(tried.append(share)))
    assert tried == [2.0**-k for k in range(7)]


def test_a_linear_fixed_point_is_met_where_plain_iterations_diverge():
    rng = np.random.default_rng(3)
    matrix = rng.normal(0.0, 1.0, (5, 5))
    shift = rng.normal(0.0, 1.0, 5)
    fixed = np.linalg.solve(np.eye(5) - matrix, shift)
    assert np.abs(np.linalg.eigvals(matrix)).max() > 1  # x <- g(x) diverges
    mixing, x = Anderson(depth=10), np.zeros(5)
    for _ in range(12):
        x = mixing.next(x, matrix @ x + shift)
    assert np.abs(x - fixed).max() < 1e-4 * np.abs(fixed).max()
