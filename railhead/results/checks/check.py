"""One check of a result, and the tolerances that checks share."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from railhead.run.estimates import Estimate

DEFAULT_TOLERANCE = 0.05  # relative: of a number without an estimate
ESTIMATE_FACTOR = 1.5  # times an estimate: what a number with one may be off by
FINER = "give a smaller mesh.patch_size, or an accuracy"


@dataclass(frozen=True, kw_only=True)
class Check:
    """A value that must not exceed a limit; a value that is not a number fails.

    name: key in "checks" of summary.json.
    value: the number.
    limit: largest allowed value; with at_least the smallest.
    source: reason of the limit.
    advice: what to change where the check fails.
    at_least: whether the limit is a lower bound.
    """

    name: str
    value: float
    limit: float
    source: str
    advice: str
    at_least: bool = False

    @property
    def passed(self) -> bool:
        """Whether the value is within the limit."""
        return self.value >= self.limit if self.at_least else self.value <= self.limit


def allowed(estimates: Mapping[str, Estimate], key: str) -> float:
    """Relative error allowed for a quantity: a multiple of its estimate, or the default."""
    return ESTIMATE_FACTOR * estimates[key].total if key in estimates else DEFAULT_TOLERANCE


def deviation(value: float, target: float) -> float:
    """Relative deviation of a value from a target; infinite for a target of 0."""
    return abs(value / target - 1) if target else math.inf
