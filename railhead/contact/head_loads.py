"""How two heads share the load of a wheel, by exact Hertz, and where its axle goes between them.

`refined` has positions that are close where the load goes over.

Both heads have one sink. At the first contact of each its own approach counts, and the other load
displaces it as on one half-space. With the rises t of both contacts and the compliances a = du/dF
of both approaches, less c of the mutual displacement, the axle moves along

    dz/dx = (t_1 (a_2 - c) + t_2 (a_1 - c)) / (a_1 + a_2 - 2 c)
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

from railhead.contact import closed_forms, crossing
from railhead.contact.crossing import Crossing
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic import hertz

KEY = "rail.position"
MOST, DEEPEST = 0.1, 12  # of the share of the rail from a position to the next; times it is halved


def divided(found: Crossing) -> tuple[float, float]:
    """Share of the load that the rail carries, 0 to 1, and the slope at which the axle moves along
    the rail. Beside an edge or a line contact the head that is touched first carries all.
    """
    touches = [found.placed(name)[0] for name in found.heads]
    if len(touches) < 2:
        return float("rail" in found.heads), touches[0].rise
    modulus, load = closed_forms.contact_modulus(found.scene), float(found.scene.load or 0.0)
    gaps, rises = np.array([[each.gap, each.rise] for each in touches]).T
    if any(touch.at_edge or not touch.curvature_y > 0 for touch in touches):
        return float(gaps[0] < gaps[1]), float(rises[gaps.argmin()])
    whole = np.array(
        [
            hertz.point_contact(
                touch.curvature_x, touch.curvature_y, modulus, load / touch.upright
            ).approach
            / touch.upright
            for touch in touches
        ]
    )  # sinks under all of the load
    apart = math.dist(*((touch.x, touch.y, touch.z - touch.gap) for touch in touches))
    other = load / (math.pi * modulus * apart)  # mm, by all of the load on the other head

    def deeper(share: float) -> float:
        """Sink over the rail less that over the wing at a share of the rail, mm."""
        own = whole[0] * share ** (2 / 3) - whole[1] * (1 - share) ** (2 / 3)
        return float(gaps[0] - gaps[1] + own + other * (1 - 2 * share))

    if not deeper(0.0) < 0 < deeper(1.0):
        first = deeper(0.0) < 0
        return float(first), float(rises[0 if first else 1])
    share = float(brentq(deeper, 0.0, 1.0))
    softer = 2 / 3 * whole / np.cbrt([share, 1 - share]) - other
    return share, float(rises @ softer[::-1] / softer.sum())


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
    """Share of the load that the rail carries at a position (mm) by `divided`; 0 where the wheel
    cannot stand there.
    """
    try:
        return divided(crossing.touch(scene.replace(**{KEY: at})))[0]
    except SceneError:
        return 0.0
