"""Positions of a wheel over a crossing that are close enough where its load goes over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from railhead.contact import crossing, head_loads
from railhead.scene.scene import Scene, SceneError

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
    """Share of the load that the rail carries at a position (mm) by `head_loads`; 0 where the wheel
    cannot stand there.
    """
    try:
        return head_loads.divided(crossing.touch(scene.replace(**{KEY: at})))[0]
    except SceneError:
        return 0.0
