"""What a scene says of the interface beside a coefficient of friction, as theory takes it."""

from __future__ import annotations

import numpy as np

from railhead.scene.scene import Scene
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.tribology.heat import Heat
from railhead.theory.tribology.laws import ByTemperature, Falling, Interface, Law

CELLS = 64  # along the patch, for temperatures before anything is solved: 0.1 %


def interface(scene: Scene) -> Interface:
    """Heat, law of friction and layer of a scene, without what its effects switch off."""
    friction, effects = scene.friction, scene.effects
    layer = 0.0
    if friction.layer_thickness and friction.layer_modulus and effects.layer != "off":
        layer = friction.layer_thickness / friction.layer_modulus
    if scene.rolling.speed is None:
        return Interface(layer=layer)
    heat = Heat(speed=scene.rolling.speed, **scene.heat.model_dump())
    found = None if effects.falling_friction == "off" else law(scene)
    return Interface(heat=heat, law=found, memory=friction.memory, layer=layer)


def coulomb(scene: Scene) -> bool:
    """Whether tractions have Coulomb's law alone: no law of the coefficient and no layer."""
    found = interface(scene)
    return found.law is None and not found.layer


def law(scene: Scene) -> Law | None:
    """Law of the coefficient of a scene; None of Coulomb's."""
    friction = scene.friction
    if friction.table:
        return ByTemperature(friction.table)
    if friction.kinetic is None or friction.slip_half is None:
        return None
    return Falling(friction.kinetic, friction.slip_half, friction.law == "linear")


def flash_rise(scene: Scene, hertz: Hertz, dissipated: float) -> float:
    """Largest rise of the hotter surface, K, by an energy that friction dissipates per rolled
    length, N, distributed as Hertz's pressure. It holds for one patch. The scene has a speed.
    """
    heat = interface(scene).heat
    assert heat is not None
    u = (2 * np.arange(CELLS) + 1) / CELLS - 1
    along = isinstance(hertz, LineContact) and hertz.across
    pressure = np.full_like(u, hertz.p0) if along else hertz.p0 * np.sqrt(1 - u**2)
    flux = heat.speed * dissipated / hertz.load * pressure[:, None]
    hot = heat.temperatures(hertz.half_lengths[0] * u, flux)
    return float((hot - heat.bulk.mean()).max())
