"""Carter's strip that rolls (Johnson, Contact Mechanics, 8.3)."""

import math
from dataclasses import dataclass

from railhead.theory.elastic.hertz import Strip
from railhead.theory.friction.partial_slip import strip_stick_ratio


@dataclass(frozen=True)
class Carter:
    """Carter's rolling strip: the part from the leading edge x = w to x = w - 2c sticks.

    strip: half width w, pressure and curvature; its width runs along x, the rail.
    friction: coefficient mu.
    share: force of the wheel on the rail along x over mu times normal force, -1 to 1.
    """

    strip: Strip
    friction: float
    share: float

    @property
    def creepage(self) -> float:
        """Creepage mu w/R (1 - c/w) with the force's sign, R relative radius, w half width, c half
        width that sticks.
        """
        full = self.friction * self.strip.half_width * self.strip.curvature
        return math.copysign(full * self.stick_centre / self.strip.half_width, self.share)

    @property
    def stick_half_width(self) -> float:
        """Half width c that sticks, w sqrt(1 - |share|), mm."""
        return self.strip.half_width * strip_stick_ratio(abs(self.share))

    @property
    def stick_centre(self) -> float:
        """x of the middle of the part that sticks, w - c, mm."""
        return self.strip.half_width - self.stick_half_width
