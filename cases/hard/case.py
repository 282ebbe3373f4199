"""A hard case: what is solved, against what, and when it counts as solved."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from railhead.checks import BALANCE as FORCE_BALANCE


@dataclass(frozen=True)
class Measured:
    """What solving a case gave.

    deviation: worst relative deviation from the reference; balance: relative force imbalance;
    newton, krylov: steps and iterations in all; noise: L2 distance of the raw pressure from its
    recovered field, relative; remark: what else is worth a line.
    """

    deviation: float
    balance: float = 0.0
    converged: bool = True
    newton: int = 0
    krylov: int = 0
    noise: float | None = None
    remark: str = ""


@dataclass(frozen=True)
class Case:
    """One entry of the battery.

    reason: what is hard about it; reference: what the result is held against; limit: largest
    deviation that passes (inf: a point of a map without a rule of its own); newton: most steps
    allowed; seconds: time limit; quick: part of the tests; known: why it may miss the rule.
    """

    group: str
    name: str
    reason: str
    reference: str
    limit: float
    solve: Callable[[], Measured]
    newton: int = 10
    seconds: float = 60.0
    quick: bool = False
    known: str = ""

    @property
    def key(self) -> str:
        """Unique in the battery."""
        return f"{self.group}: {self.name}"

    @property
    def ruled(self) -> bool:
        """Whether it counts as passed or failed."""
        return math.isfinite(self.limit)

    def fault(self, found: Measured) -> str:
        """Which part of the rule is broken; empty if none is."""
        if not found.converged:
            return found.remark or "not converged"
        if not found.balance < FORCE_BALANCE:
            return f"force balance {found.balance:.1e}"
        if not found.deviation <= self.limit:
            return f"deviation {found.deviation:.2g} above {self.limit:g}"
        if found.newton > self.newton:
            return f"{found.newton} Newton steps"
        return ""
