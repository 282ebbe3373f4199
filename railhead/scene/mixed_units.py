"""Values of a scene whose unit was probably mixed up."""

from __future__ import annotations

from collections.abc import Iterator

from railhead.scene.scene import Scene, unit

USUAL = {
    "rail.young_modulus": (190e3, 220e3),
    "wheel.young_modulus": (190e3, 220e3),
    "rail.yield_stress": (200.0, 1500.0),
    "wheel.yield_stress": (200.0, 1500.0),
    "wheel.rolling_radius": (250.0, 650.0),
    "load": (5e3, 250e3),
}
"""Range in base units of steel wheels on rails, by dotted key."""
FACTORS = (1e-3, 1e3, 1e6)  # GPa for MPa, m for mm, kN for N; kPa and Pa for MPa


def questions(scene: Scene) -> Iterator[str]:
    """A line for each value that is a thousandth, a thousand or a million times what a steel wheel
    on a rail has: "load = 25 N, 0.001 times what is usual: 25000 N meant?".

    A load is only judged on the profile of a rail.
    """
    for key, (low, high) in USUAL.items():
        value = scene.value(key)
        if not isinstance(value, float) or (key == "load" and scene.rail.profile == "arc"):
            continue
        for factor in FACTORS:
            if low <= value / factor <= high:
                meant = f"{value / factor:g} {unit(key)} meant?"
                yield f"{key} = {value:g} {unit(key)}, {factor:g} times what is usual: {meant}"
