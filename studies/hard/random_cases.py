"""Cases made of random scenes."""

from __future__ import annotations

from collections.abc import Iterator

from railhead.scene.scene import Scene
from studies.hard.case import Case, Deviation, Measured
from studies.hard.random_scenes import Seeded, plans, runnable, scene
from studies.hard.scenes import Solve, against_half_space, against_hertz

PLANS, RUNS, SEED = 500, 60, 54


def plan_cases() -> Iterator[Case]:
    """Every valid scene has a plan with finite numbers or a refusal in one line."""

    def solve() -> Measured:
        refused = broken = 0
        for seed in range(PLANS):
            try:
                refused += plans(scene(Seeded(seed))) is None
            except ValueError:
                broken += 1
        return Measured(
            {"broken plans": Deviation(broken / PLANS, 0.0)},
            remark=f"{refused} of {PLANS} refused in one line",
        )

    yield Case("random", f"{PLANS} plans", "any valid scene", "finite numbers", solve, seconds=240)


def run_cases() -> Iterator[Case]:
    """Random scenes that the plan accepts: half-spaces against Hertz, profiles against boundary
    elements."""

    def against(index: int, *, half_space: bool) -> Solve:
        def solve() -> Measured:
            # Scene `index` of the list, found by its own seed: no case depends on another.
            given = runnable(SEED + 1000 * index, lambda each: _half_space(each) == half_space)
            return (against_hertz if half_space else against_half_space)(given, n=None)()

        return solve

    for index in range(RUNS):
        half_space = index % 2 == 0
        yield Case(
            "random", f"scene {index + 1}", "any half-spaces" if half_space else "any profiles",
            "exact Hertz" if half_space else "boundary elements",
            against(index, half_space=half_space), newton=30, seconds=240, quick=index < 4,
        )  # fmt: skip


def _half_space(given: Scene) -> bool:
    return given.rail.extent == "half-space"
