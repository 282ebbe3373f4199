"""A line contact that rolls and drives: Carter 1926, exactly, for like materials.

Rolling along +x; x = 0 in the middle of the strip, x = +w its leading edge (Johnson, Contact
Mechanics, 8.3). Creepage and force have one sign (see `theory.rolling.rolling`). The strip
has the half width w, load P and relative curvature 1/R.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhead.theory.elastic.hertz import Strip


@dataclass(frozen=True)
class Carter:
    """Carter's rolling strip: the part from the leading edge x = w to x = w - 2c sticks.

    strip: half width w, pressure and curvature.
    friction: coefficient mu.
    share: tangential force over mu times load, -1 to 1. ValueError: outside of that range.
    """

    strip: Strip
    friction: float
    share: float

    def __post_init__(self) -> None:
        """Raise ValueError where the share is outside -1..1."""
        if not abs(self.share) <= 1:
            raise ValueError(f"the force must be within mu P, got {self.share} of it")

    @property
    def creepage(self) -> float:
        """Creepage mu w/R (1 - c/w) with the force's sign, R relative radius, w half width, c half
        width that sticks. At full slip mu w/R, the smallest creepage of full slip.
        """
        full = self.friction * self.strip.b * self.strip.curvature
        return math.copysign(full * self.stick_centre / self.strip.b, self.share)

    @property
    def stick_half_width(self) -> float:
        """Half width c that sticks, w sqrt(1 - |share|), mm."""
        return self.strip.b * math.sqrt(1 - abs(self.share))

    @property
    def stick_centre(self) -> float:
        """x of the middle of the part that sticks, w - c, mm."""
        return self.strip.b - self.stick_half_width

    def traction(self, x: ArrayLike) -> NDArray[np.float64]:
        """Traction mu p0 (sqrt(1 - x^2/w^2) - c/w sqrt(1 - (x - w + c)^2/c^2)), MPa, at x (mm),
        with the force's sign; c is the half width that sticks.
        """
        beyond = self.stick_half_width**2 - (np.asarray(x) - self.stick_centre) ** 2
        stuck = self.strip.p0 / self.strip.b * np.sqrt(np.maximum(beyond, 0))
        sign = math.copysign(self.friction, self.share)
        return np.asarray(sign * (self.strip.pressure(x) - stuck))


def from_creepage(strip: Strip, friction: float, creepage: float) -> Carter:
    """The rolling strip of a given creepage xi: share = 1 - (1 - |xi| R/(mu w))^2 with the sign of
    xi, at most 1, with the relative radius R, the half width w and the friction coefficient mu.
    """
    part = min(abs(creepage) / (friction * strip.b * strip.curvature), 1.0)
    return Carter(strip, friction, math.copysign(part * (2 - part), creepage))
