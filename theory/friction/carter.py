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
    """A rolling strip of which the part from the leading edge to w - 2c sticks.

    share: force over mu P, from -1 to 1. ValueError: outside of that.
    """

    strip: Strip
    friction: float
    share: float

    def __post_init__(self) -> None:
        if not abs(self.share) <= 1:
            raise ValueError(f"the force must be within mu P, got {self.share} of it")

    @property
    def creepage(self) -> float:
        """mu w/R (1 - c/w), with the force's sign; at the limit mu w/R, the least of full slip."""
        full = self.friction * self.strip.b * self.strip.curvature
        return math.copysign(full * self.stick_centre / self.strip.b, self.share)

    @property
    def stick_half_width(self) -> float:
        """c = w sqrt(1 - |Q|/mu P), mm."""
        return self.strip.b * math.sqrt(1 - abs(self.share))

    @property
    def stick_centre(self) -> float:
        """x of the middle of what sticks, w - c, mm."""
        return self.strip.b - self.stick_half_width

    def traction(self, x: ArrayLike) -> NDArray[np.float64]:
        """mu p0 (sqrt(1 - x^2/w^2) - c/w sqrt(1 - (x - w + c)^2/c^2)) in MPa, x in mm."""
        beyond = self.stick_half_width**2 - (np.asarray(x) - self.stick_centre) ** 2
        stuck = self.strip.p0 / self.strip.b * np.sqrt(np.maximum(beyond, 0))
        sign = math.copysign(self.friction, self.share)
        return np.asarray(sign * (self.strip.pressure(x) - stuck))


def from_creepage(strip: Strip, friction: float, creepage: float) -> Carter:
    """Rolling strip whose creepage is given: Q/mu P = 1 - (1 - xi R/(mu w))^2, at most 1, with the
    relative radius R and half width w.
    """
    part = min(abs(creepage) / (friction * strip.b * strip.curvature), 1.0)
    return Carter(strip, friction, math.copysign(part * (2 - part), creepage))
