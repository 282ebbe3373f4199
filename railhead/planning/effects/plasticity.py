"""Yielding below the surface: recognised, not simulated."""

from __future__ import annotations

from railhead.planning.effects.base import NOT_SIMULATED, After, Context, Effect
from railhead.postprocess.findings import Findings
from railhead.scene.scene import Scene
from railhead.theory import contacts


def decide(context: Context) -> Effect:
    """Called for where the largest von Mises stress of exact Hertz passes a yield stress."""
    stresses = {
        name: contacts.axis_extrema(context.hertz, poisson).von_mises_max
        for name, (_, poisson) in _yielding(context.scene).items()
    }
    yields, why = _compare(context.scene, stresses)
    return Effect(yields, False, why, {"on": NOT_SIMULATED})


def check(context: Context, effect: Effect, found: Findings) -> After | None:
    """The same with the largest stresses that were found in each body."""
    scene = context.scene
    stresses = {
        name: found.largest[name].von_mises.value
        for name in _yielding(scene)
        if name in found.largest
    }
    if not stresses:
        return None
    yields, why = _compare(scene, stresses)
    return After(yields, f"{why}: the elastic answer overstates the pressure" if yields else why)


def _yielding(scene: Scene) -> dict[str, tuple[float, float]]:
    """Yield stress (MPa) and Poisson's ratio of the bodies that have one."""
    return {
        name: (part.yield_stress, part.poisson_ratio)
        for name, part in (("rail", scene.rail), ("wheel", scene.wheel))
        if part.yield_stress is not None
    }


def _compare(scene: Scene, stresses: dict[str, float]) -> tuple[bool, str]:
    limits = _yielding(scene)
    if not stresses:
        return False, "no yield stress is given"
    worst = max(stresses, key=lambda name: stresses[name] / limits[name][0])
    limit = limits[worst][0]
    yields = bool(stresses[worst] > limit)
    verb = "passes" if yields else "stays below"
    return (
        yields,
        f"von Mises {stresses[worst]:.4g} MPa {verb} the yield {limit:.4g} MPa of the {worst}",
    )
