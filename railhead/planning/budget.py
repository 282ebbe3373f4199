"""Whether meshes fit into the free memory, and the finest one that a budget of time allows."""

from __future__ import annotations

from railhead.planning import error_envelopes
from railhead.planning.simulation_plan import Plan
from railhead.scene.scene import SceneError

BUDGET_SHARE = 0.85  # largest predicted time over the budget
MEMORY_SHARE = 0.8  # largest predicted memory over the free memory


class NoMemoryError(SceneError):
    """The mesh of a scene that is solved once does not fit into the memory that is free now."""


def fits(plan: Plan, free: int) -> bool:
    """Whether the memory that a plan needs (bytes) is at most 0.8 (MEMORY_SHARE) of the free memory
    (bytes).
    """
    return plan.memory <= MEMORY_SHARE * free


def check_memory(plan: Plan, free: int) -> None:
    """Refuse a scene that is solved on one mesh where this mesh does not fit into the free memory
    (bytes): NoMemoryError.
    Nothing is refused where the scene has several meshes: the first is coarse, and a finer one that
    does not fit is left out.
    """
    if plan.scene.one_mesh and not fits(plan, free):
        raise NoMemoryError(
            "mesh.patch_size",
            f"{plan.patch_size:.3g} mm makes about {plan.unknowns:.2g} unknowns, which need "
            f"{plan.memory / 1e9:.3g} GB of {free / 1e9:.3g} GB free; give a larger one",
        )


def affordable(plan: Plan, wanted: float) -> float:
    """Finest resolution (elements per smaller semi-axis) at which the predicted seconds of a coarse
    and a fine mesh are within 0.85 (BUDGET_SHARE) of the budget of the scene; the least one, 4.8,
    where none is.

    wanted: largest resolution that is returned where the scene has an accuracy, unless it is below
        4.8. Without an accuracy the largest one is the finest that the error laws cover, or 60
        without laws.
    """
    budget = BUDGET_SHARE * float(plan.scene.budget or 0.0)
    best = n = error_envelopes.RANGE[0] * error_envelopes.STEP
    limit = wanted
    if plan.scene.accuracy is None:
        known = plan.family
        limit = error_envelopes.STEP * known.resolution[1] if known else error_envelopes.RANGE[1]
    while n <= limit and plan.at_resolution(n).seconds_of_two <= budget:
        best, n = n, 1.05 * n
    return best
