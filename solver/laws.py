"""Contact laws: penalty and Nitsche's method as one family.

    p    = < -(sigma s + tau g) >+             pressure; sigma = 1 for Nitsche, 0 for penalty
    R(u) = K u - f - (theta sigma S + tau N)^T (W/tau) p - (theta sigma/tau) S^T W s

Chouly and Hild 2013 (Nitsche, theta = 1 symmetric, 0, -1); penalty is sigma = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

PENALTY_FACTOR = 10.0  # penalty over the Nitsche parameter: bias against conditioning


@dataclass(frozen=True)
class Law:
    """method 'nitsche' or 'penalty'; theta 1, 0, -1 (Nitsche); factor on the safe parameter."""

    method: str = "nitsche"
    theta: int = 1
    gamma_factor: float = 1.0

    @property
    def sigma(self) -> int:
        """1 where the bulk stress enters the law."""
        return int(self.method == "nitsche")

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric."""
        return self.method == "penalty" or self.theta == 1

    @property
    def scale(self) -> float:
        """tau over C (lambda + 2 mu)."""
        return self.gamma_factor * (1.0 if self.sigma else PENALTY_FACTOR)
