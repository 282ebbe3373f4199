"""Positions of a wheel over a crossing that are close enough where its load goes over."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from scipy.optimize import brentq

from railhead.contact import closed_forms, crossing
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic import hertz

KEY = "rail.position"
MOST, DEEPEST = 0.1, 12  # of the share of the rail from a position to the next; times it is halved


def refined(scene: Scene, lists: Mapping[str, Sequence[object]]) -> dict[str, Any]:
    """Lists of values by key of a sweep, with positions between those of a rail of sections where
    the share of the load on a head changes by more than 0.1 (MOST) from one to the next. Unchanged
    where other keys are varied, too. Raises SceneError for a position that is none.
    """
    if not scene.rail.sections or scene.load is None or [*lists] != [KEY] or len(lists[KEY]) < 2:
        return dict(lists)
    given = sorted(scene.replace(**{KEY: each}).rail.position for each in lists[KEY])
    shares = {at: share(scene, at) for at in given}
    for _ in range(DEEPEST):
        ordered = sorted(shares)
        wide = [
            (here + after) / 2
            for here, after in zip(ordered, ordered[1:], strict=False)
            if abs(shares[here] - shares[after]) > MOST
        ]
        if not wide:
            break
        shares |= {at: share(scene, at) for at in wide}
    return {KEY: sorted(shares)}


def share(scene: Scene, at: float) -> float:
    """Share of the load that the rail carries at a position (mm), by exact Hertz at the first
    contact of each head, which displaces the other one as on one half-space; 0 where the wheel
    cannot stand there.
    """
    try:
        found = crossing.touch(scene.replace(**{KEY: at}))
    except SceneError:
        return 0.0
    if len(found.heads) < 2:
        return float("rail" in found.heads)
    modulus, load = closed_forms.contact_modulus(scene), float(scene.load or 0.0)
    touches = [found.placed(name)[0] for name in found.heads]
    if any(touch.at_edge or not touch.curvature_y > 0 for touch in touches):
        return float(touches[0].gap < touches[1].gap)
    first, second = (
        hertz.point_contact(touch.curvature_x, touch.curvature_y, modulus, load / touch.upright)
        for touch in touches
    )
    sinks = first.approach / touches[0].upright, second.approach / touches[1].upright
    apart = math.dist(*((touch.x, touch.y, touch.z - touch.gap) for touch in touches))
    other = load / (math.pi * modulus * apart)  # mm, by all of the load on the other head

    def deeper(share: float) -> float:
        """Sink over the rail less that over the wing at a share of the rail, mm."""
        own = sinks[0] * share ** (2 / 3) - sinks[1] * (1 - share) ** (2 / 3)
        return float(touches[0].gap - touches[1].gap + own + other * (1 - 2 * share))

    if deeper(0.0) < 0 < deeper(1.0):
        return float(brentq(deeper, 0.0, 1.0))
    return float(deeper(0.0) < 0)
