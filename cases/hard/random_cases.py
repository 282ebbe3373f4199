"""Cases made of random scenes."""

from __future__ import annotations

from collections.abc import Iterator

from cases.hard.case import Case, Measured
from cases.hard.random_scenes import Seeded, plans, runnable, scene
from cases.hard.scenes import measure
from railhead import run as running

PLANS, RUNS, SEED = 500, 60, 54


def plan_cases() -> Iterator[Case]:
    """Every valid scene has a plan with finite numbers or a refusal in one line."""

    def solve() -> Measured:
        refused = sum(plans(scene(Seeded(seed))) is None for seed in range(PLANS))
        return Measured(0.0, remark=f"{refused} of {PLANS} refused in one line")

    yield Case(
        "random", f"{PLANS} plans", "any valid scene", "finite numbers", 0.0, solve, seconds=120
    )


def run_cases() -> Iterator[Case]:
    """Random scenes that the plan accepts are solved and balance to 1e-6."""
    for index in range(RUNS):

        def solve(index: int = index) -> Measured:
            # Scene `index` of the list, found by its own seed: no case depends on another.
            given = runnable(1, SEED + 1000 * index)[0]
            found = measure(running.run(given), 0.0)
            return found

        yield Case(
            "random", f"scene {index + 1}", "any runnable scene", "force balance", 1e-6, solve,
            newton=30, seconds=60,
        )  # fmt: skip
