"""Half-spaces cut to blocks whose outer faces follow the exact displacement."""

from __future__ import annotations

from railhead.planning.context import Context, Effect


def decide(context: Context) -> Effect:
    """Half-spaces that continue beyond their meshed blocks are simulated where rail.extent is half-
    space; for real bodies the effect is refused.
    """
    if context.contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {context.scene.rail.extent}"})
