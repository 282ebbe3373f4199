"""A hard case: what is solved, against what, and when it counts as solved.

One rule for all: the run ends with status 0 and every judged quantity deviates from its reference
by no more than it promises. Or the case declares what fails, and then just that must happen.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Deviation:
    """Relative deviation of a quantity from its reference.

    value: the deviation; NaN where there is no number.
    allowed: largest deviation that is allowed.
    """

    value: float
    allowed: float

    @property
    def share(self) -> float:
        """Deviation over the allowed one; infinite where the deviation is not finite, or not 0 and
        nothing is allowed."""
        if not math.isfinite(self.value):
            return math.inf
        return self.value / self.allowed if self.allowed else (math.inf if self.value else 0.0)


@dataclass(frozen=True)
class CaseErrors:
    """Deviations, failed checks and cost of one solved case.

    deviations: deviation by name of the quantity.
    failed: names of the checks that failed, or the one line of a refusal.
    newton: steps of Newton's method, of all solutions together.
    krylov: iterations of the linear solver, of all solutions together.
    noise: L2 distance of the raw pressure from its recovered field, relative; None: not read.
    remark: further words for the row of the case.
    """

    deviations: Mapping[str, Deviation] = field(default_factory=dict)
    failed: tuple[str, ...] = ()
    newton: int = 0
    krylov: int = 0
    noise: float | None = None
    remark: str = ""

    @property
    def worst(self) -> tuple[str, Deviation] | None:
        """Name and deviation of the quantity with the largest share of what is allowed; None where
        no quantity was compared.
        """
        return max(self.deviations.items(), key=lambda item: item[1].share, default=None)


@dataclass(frozen=True)
class HardCase:
    """A case of the battery: what is solved, and when it counts as right.

    group: group of cases that share a table.
    name: name within the group.
    reason: what is hard about the case.
    reference: what the result is compared with.
    solve: function that solves the case.
    newton: most steps of Newton's method allowed.
    krylov: most iterations of the linear solver a step allowed, on average.
    seconds: time limit, s.
    quick: whether the tests run the case.
    known: check that must fail, or the first words of a refusal; empty: nothing may fail.
    refusable: whether any named check may fail, as the result is then not signed.
    """

    group: str
    name: str
    reason: str
    reference: str
    solve: Callable[[], CaseErrors]
    newton: int = 10
    krylov: float = math.inf
    seconds: float = 120.0
    quick: bool = False
    known: str = ""
    refusable: bool = False

    @property
    def key(self) -> str:
        """Group and name of the case, unique in the battery."""
        return f"{self.group}: {self.name}"

    def fault(self, found: CaseErrors) -> str:
        """The part of the rule that these errors of the case break, in words; empty if none."""
        if self.known:
            if any(each.startswith(self.known) for each in found.failed):
                return ""
            happened = f"failed: {', '.join(found.failed)}" if found.failed else "status 0"
            return f"{self.known} should fail; {happened}"
        if found.failed:
            return "" if self.refusable else f"failed: {', '.join(found.failed)}"
        if (worst := found.worst) is None:
            return "held against nothing"
        name, deviation = worst
        if not deviation.share <= 1:
            return f"{name} off by {deviation.value:.3g}, {deviation.allowed:.3g} allowed"
        if found.newton > self.newton:
            return f"{found.newton} Newton steps, {self.newton} allowed"
        if found.krylov > self.krylov * found.newton:
            rate = found.krylov / found.newton
            return f"{rate:.0f} Krylov iterations a step, {self.krylov:g} allowed"
        return ""
