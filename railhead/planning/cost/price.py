"""What a resolution costs on this machine, before it is bought."""

from __future__ import annotations

from typing import NamedTuple

from railhead.planning.accuracy import error_envelopes
from railhead.planning.cost import machine
from railhead.planning.plan import Plan
from railhead.scene.scene import SceneError

BUDGET_SHARE = 0.85  # of the budget that the prediction may fill
MEMORY_SHARE = 0.8  # of the free memory that a run may take


class NoMemoryError(SceneError):
    """A mesh does not fit into the memory that is free now."""


def fits(plan: Plan, free: int) -> bool:
    """Whether the mesh of a plan may take what it needs of the free memory (bytes)."""
    return plan.memory <= MEMORY_SHARE * free


def check_memory(plan: Plan, free: int) -> None:
    """Refuse the only mesh of a scene that does not fit into the free memory (bytes):
    NoMemoryError. Where there are several, the first is coarse, and a finer one is left out."""
    if plan.scene.one_mesh and not fits(plan, free):
        raise NoMemoryError(
            "mesh.patch_size",
            f"{plan.patch_size:.3g} mm makes about {plan.unknowns:.2g} unknowns, which need "
            f"{plan.memory / 1e9:.3g} GB of {free / 1e9:.3g} GB free; give a larger one",
        )


class Price(NamedTuple):
    """Predicted unknowns and peak memory (bytes) of the fine mesh, seconds of the whole process."""

    unknowns: int
    seconds: float
    memory: int


def price(plan: Plan, n: float) -> Price:
    """Of two meshes, the finer one at resolution n."""
    fine, coarse = plan.at_resolution(n), plan.at_resolution(n / error_envelopes.STEP)
    return Price(fine.unknowns, machine.START + fine.solving + coarse.solving, fine.memory)


def affordable(plan: Plan, wanted: float) -> float:
    """The finest resolution, coarse mesh included, that the budget is predicted to allow."""
    budget = BUDGET_SHARE * float(plan.scene.budget or 0.0)
    best = n = error_envelopes.RANGE[0] * error_envelopes.STEP
    limit = wanted
    if plan.scene.accuracy is None:
        known = plan.family
        limit = error_envelopes.STEP * known.resolution[1] if known else error_envelopes.RANGE[1]
    while n <= limit and price(plan, n).seconds <= budget:
        best, n = n, 1.05 * n
    return best
