"""Half-spaces cut to blocks whose outer faces follow the exact displacement."""

from __future__ import annotations

from railhead.planning.context import Context, Effect


def decide(context: Context) -> Effect:
    """Half-spaces continued beyond their blocks are simulated where rail.extent is half-space; real
    bodies end where they end and cannot have this effect.
    """
    if context.contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {context.scene.rail.extent}"})
