"""What measured profiles leave open: how much the answer changes with the length of smoothing.

Half-spaces are solved on profiles smoothed with one, with two and with half a smoothing length:
the longer one takes away what may be shape, the shorter one lets in what may be noise. The largest
change of pressure or area, times SAFETY, holds the error in nine of ten seeds of the study
`profiles`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from railhead.contact import solid
from railhead.planning.context import Context
from railhead.planning.references import boundary_elements, closed_forms
from railhead.scene.scene import Scene
from railhead.theory.bem.boundary_element import Solution

STRETCHES = (2.0, 0.5)  # factors on the smoothing lengths
SAFETY = 2.0  # factor on the change, chosen on six seeds of each pair of the study


@dataclass(frozen=True)
class Uncertainty:
    """Relative error of sizes and values of the answer that measured profiles may hide.
    relative: relative error, infinite where boundary elements find no patch.
    reason: why the error is infinite, else empty.
    """

    relative: float
    reason: str = ""


def of_profiles(context: Context) -> Uncertainty | None:
    """Relative error that the measured profiles of a scene may hide; None where no profile is
    measured, for half-spaces, and in sections, whose contacts no half-space has.
    """
    scene, contact = context.scene, context.contact
    if contact.half_space or contact.plane or not solid.measured_bodies(scene):
        return None
    try:
        return around(scene, context.boundary_elements)
    except ValueError as error:
        return Uncertainty(math.inf, str(error))


def around(scene: Scene, solution: Solution) -> Uncertainty:
    """Twice (SAFETY) the largest relative change of pressure or area when the smoothing length of
    the measured profiles is doubled or halved.
    solution: boundary elements with the usual smoothing.
    Raises ValueError (SceneError is one) where one length leaves no contact.
    """
    changes = []
    for stretch in STRETCHES:
        contact = solid.locate(scene, solid.pair(scene, stretch))
        other = boundary_elements.solve(contact, closed_forms.ellipse(scene, contact), scene.load)
        changes.append(abs(other.max_pressure / solution.max_pressure - 1))
        changes.append(abs(other.area / solution.area - 1))
    return Uncertainty(SAFETY * max(changes))
