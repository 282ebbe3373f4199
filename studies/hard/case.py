"""A hard case: what is solved, against what, and when it counts as solved.

One rule for all: the run ends with status 0 and every judged quantity deviates from its reference
by no more than it promises. Or the case declares what fails, and then just that must happen.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

KRYLOV = 27  # iterations a step: a good preconditioner halves the residual, and 2^-27 < 1e-8


@dataclass(frozen=True)
class Deviation:
    """Relative deviation of a quantity from its reference, and the most that is allowed."""

    value: float
    allowed: float

    @property
    def share(self) -> float:
        """Of what is allowed; inf where the deviation is not a number."""
        if not math.isfinite(self.value):
            return math.inf
        return self.value / self.allowed if self.allowed else (math.inf if self.value else 0.0)


@dataclass(frozen=True)
class CaseErrors:
    """What solving a case gave.

    deviations: by quantity; failed: names of the checks that failed, or the one line of a refusal;
    newton, krylov: steps and iterations in all; noise: L2 distance of the raw pressure from its
    recovered field, relative; remark: what else is worth a line.
    """

    deviations: Mapping[str, Deviation] = field(default_factory=dict)
    failed: tuple[str, ...] = ()
    newton: int = 0
    krylov: int = 0
    noise: float | None = None
    remark: str = ""

    @property
    def worst(self) -> tuple[str, Deviation] | None:
        """The quantity nearest to, or furthest above, what is allowed."""
        return max(self.deviations.items(), key=lambda item: item[1].share, default=None)


@dataclass(frozen=True)
class HardCase:
    """One entry of the battery.

    reason: what is hard about it; reference: what the result is held against; newton: most steps
    allowed; krylov: most iterations a step, on average; seconds: time limit; quick: part of the
    tests; known: the check that fails, or the first words of the refusal; refusable: a result
    may be refused by any named check, as long as none that is wrong is signed.
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
        """Unique in the battery."""
        return f"{self.group}: {self.name}"

    def fault(self, found: CaseErrors) -> str:
        """Which part of the rule is broken; empty if none is."""
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
            return f"{name} off by {deviation.value:.2g}, {deviation.allowed:.2g} allowed"
        if found.newton > self.newton:
            return f"{found.newton} Newton steps, {self.newton} allowed"
        if found.krylov > self.krylov * found.newton:
            rate = found.krylov / found.newton
            return f"{rate:.0f} Krylov iterations a step, {self.krylov:g} allowed"
        return ""


@dataclass(frozen=True)
class CaseOutcome:
    """A case with what it gave (None if it ended without), why it fails, and its seconds."""

    case: HardCase
    measured: CaseErrors | None
    fault: str
    seconds: float

    @property
    def refused(self) -> bool:
        """Whether the case holds because its result is refused."""
        return not self.fault and self.measured is not None and bool(self.measured.failed)

    @property
    def result(self) -> str:
        """In words."""
        failed = ", ".join(self.measured.failed) if self.measured else ""
        return f"FAILS: {self.fault}" if self.fault else f"refused: {failed}" if failed else "right"
