"""Steps of a load that fail are halved, and no further than to 1/64."""

from railhead.solver.algebra.steps import in_steps


def test_a_step_that_fails_is_halved_until_the_rest_succeeds() -> None:
    """No step of more than 0.3 succeeds."""
    reached, tried = [0.0], []

    def step(share: float) -> bool:
        tried.append(share)
        if share - reached[-1] > 0.3:
            return False
        reached.append(share)
        return True

    assert in_steps([0.25, 1.0], 0.0, step)
    assert reached == [0.0, 0.25, 0.4375, 0.71875, 1.0]
    assert tried == [0.25, 1.0, 0.625, 0.4375, 1.0, 0.71875, 1.0]


def test_what_never_succeeds_ends_at_the_smallest_step() -> None:
    tried: list[float] = []
    assert not in_steps([1.0, 2.0], 0.0, lambda share: bool(tried.append(share)))
    assert tried == [2.0**-k for k in range(7)]
