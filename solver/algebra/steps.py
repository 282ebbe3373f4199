"""Steps of a load, halved where they fail."""

from __future__ import annotations

from collections.abc import Callable, Iterable

SMALLEST_STEP = 1 / 64  # of a step, below which it is cut no further


def in_steps(goals: Iterable[float], done: float, step: Callable[[float], bool]) -> bool:
    """Go to shares of a load, one after the other. A step that fails is halved, down to 1/64
    (SMALLEST_STEP) of it; then all of the rest is tried again. Returns whether the last goal was
    reached.

    done: share where the first step starts.
    step: goes to a share from the last one that was reached, and says whether it succeeded.
    """
    for goal in goals:
        least = abs(goal - done) * SMALLEST_STEP
        while done != goal:
            target = goal
            while not step(target):
                if abs(target - done) <= least:
                    return False
                target = (target + done) / 2
            done = target
    return True
