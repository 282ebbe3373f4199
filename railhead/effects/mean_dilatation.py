"""Volume change taken constant in each cell, for nearly incompressible bodies."""

from __future__ import annotations

from railhead import dimension
from railhead.effects.base import Effect, Hertz
from railhead.geometry import Contact
from railhead.scene import Scene

LARGEST_RATIO = 0.45  # Poisson's ratio above which ordinary cells begin to lock
LARGEST_REVOLVED = 0.499  # the same in a meridian section, where it is itself 1 % off


def decide(scene: Scene, contact: Contact, ellipse: Hertz) -> Effect:
    """Called for above nu = 0.45 (0.499); linear and hexahedral cells cannot have it."""
    name, ratio = max(
        (("rail", scene.rail.poisson_ratio), ("wheel", scene.wheel.poisson_ratio)),
        key=lambda each: each[1],
    )
    revolved = dimension.choose(scene).kind == "axisymmetric"
    limit = LARGEST_REVOLVED if revolved else LARGEST_RATIO
    above = ratio > limit
    why = f"Poisson's ratio {ratio:g} of the {name}, {'above' if above else 'below'} {limit}"
    if scene.mesh.cell != "tetrahedron" or scene.mesh.order == 1:
        locks = "; these cells lock, take quadratic tetrahedra" if above else ""
        return Effect(above, False, why + locks, {"on": "it needs quadratic tetrahedra"})
    return Effect(above, above, why)
