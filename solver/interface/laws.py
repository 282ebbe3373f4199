"""Contact laws: penalty and Nitsche's method as one family.

    p    = < -(sigma s + tau g) >+             pressure; sigma = 1 for Nitsche, 0 for penalty
    R(u) = K u - f - (theta sigma S + tau N)^T (W/tau) p - (theta sigma/tau) S^T W s

Chouly and Hild 2013 (Nitsche, theta = 1 symmetric, 0, -1); penalty is sigma = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

METHODS = ("nitsche", "penalty")
PENALTY_FACTOR = 10.0  # penalty over the Nitsche parameter: bias against conditioning
LARGEST_PARAMETER = 3.0  # over E times the trace constant; of nearly incompressible bodies
STAGE_GROWTH = 10.0  # of the parameter from one stage of a stiff law to the next


@dataclass(frozen=True)
class ContactLaw:
    """Contact law: method and parameters.

    method: 'nitsche' or 'penalty'.
    theta: variant of Nitsche's method: 1 (symmetric), 0 or -1; None: `suited` chooses.
    gamma_factor: parameter over the smallest stable one or, for a penalty, over `PENALTY_FACTOR`
        times the trace bound; positive.
    Raises ValueError for other values.
    """

    method: str = "nitsche"
    theta: int | None = None
    gamma_factor: float = 1.0

    def __post_init__(self) -> None:
        """Check method, theta and gamma_factor; raises ValueError for a value that is not
        allowed.
        """
        if self.method not in METHODS:
            raise ValueError(f"method {self.method!r} is unknown; give one of {METHODS}")
        if self.theta not in (None, 1, 0, -1):
            raise ValueError(f"theta {self.theta!r} is not allowed; give 1, 0, -1 or None")
        if not 0 < self.gamma_factor < math.inf:
            raise ValueError(f"gamma_factor {self.gamma_factor!r} is not allowed; give more than 0")

    @property
    def sigma(self) -> int:
        """Factor of the bulk stress in the contact law: 1 for Nitsche's method, 0 for a penalty."""
        return int(self.method == "nitsche")

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric: for a penalty, and for Nitsche's method with theta
        = 1.
        """
        return self.method == "penalty" or self.theta == 1

    @property
    def scale(self) -> float:
        """Parameter tau of the law over the stiffness bound of a facet
        (`Interface.stiffness_bound`).
        """
        return self.gamma_factor * (1.0 if self.sigma else PENALTY_FACTOR)

    def suited(self, young_modulus: float, lame: tuple[float, float]) -> ContactLaw:
        """The law with theta and factor chosen for the material of the slave.

        young_modulus: MPa.
        lame: Lame's constants (lambda, mu), MPa.

        theta = 1 is coercive down to factor 1, theta = -1 at any factor. So theta = -1 is chosen
        for factors below 1 where theta is None. Towards incompressibility the safe parameter grows
        with lambda, although the contact gets no stiffer. The parameter is then limited to
        LARGEST_PARAMETER times E, unless theta = 1 is given.
        """
        lam, mu = lame
        factor = self.gamma_factor
        if self.theta != 1:
            factor *= min(1.0, LARGEST_PARAMETER * young_modulus / (lam + 2 * mu))
        theta = self.theta if self.theta is not None else (1 if factor >= 1 else -1)
        return replace(self, theta=theta, gamma_factor=factor)

    @property
    def stages(self) -> list[ContactLaw]:
        """Laws to solve with one after the other, from a parameter near the default up to this law,
        which is the last; from one to the next the parameter grows by `STAGE_GROWTH`.
        """
        count = max(0, math.ceil(math.log(self.scale / STAGE_GROWTH, STAGE_GROWTH)))
        return [
            replace(self, gamma_factor=self.gamma_factor / STAGE_GROWTH**k)
            for k in range(count, -1, -1)
        ]
