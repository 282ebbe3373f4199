"""What a resolution costs on this machine, before it is bought."""

from __future__ import annotations

from railhead.planning import laws, machine
from railhead.planning.plan import Plan

BUDGET_SHARE = 0.85  # of the budget that the prediction may fill


def price(plan: Plan, n: float) -> tuple[int, float]:
    """Predicted unknowns of the fine mesh and seconds of the whole process at resolution n."""
    fine, coarse = plan.at_resolution(n), plan.at_resolution(n / laws.STEP)
    return fine.unknowns, machine.START + fine.solving + coarse.solving


def affordable(plan: Plan, wanted: float) -> float:
    """The finest resolution, coarse mesh included, that the budget is predicted to allow."""
    budget = BUDGET_SHARE * float(plan.scene.budget or 0.0)
    best = n = laws.RANGE[0] * laws.STEP
    limit = wanted
    if plan.scene.accuracy is None:
        known = plan.family
        limit = laws.STEP * known.resolution[1] if known else laws.RANGE[1]
    while n <= limit and price(plan, n)[1] <= budget:
        best, n = n, 1.05 * n
    return best
