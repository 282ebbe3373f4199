"""Samples of a scene's keys: their laws, what is drawn of them, and what the answers say together.

Points are those of a scrambled Sobol' sequence with a fixed seed, so more samples keep the first
ones. Shares of variance are by Saltelli's design with Jansen's estimators (Saltelli et al., Comput.
Phys. Commun. 181, 2010). Errors of sampling are half widths of intervals that hold in 95 % of
samples.
"""

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from scipy.special import ndtri
from scipy.stats import binom, qmc

from railhead.scene import units
from railhead.scene.scene import SceneError, unit
from railhead.scene.sections import refuse_first
from railhead.theory.array_types import Array

_LAW = re.compile(r"(normal|lognormal|uniform|choice)\s*\((.*)\)", re.DOTALL)
NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
KINDS = {
    kind.unit: kind
    for kind in (
        *(units.FORCE, units.LENGTH, units.STRESS, units.SPIN, units.SPEED, units.TEMPERATURE),
        *(units.ANGLE, units.NUMBER),
    )
}
SEED = 1
SHARES = 0.05, 0.5, 0.95, 0.99
DRAWS = 200  # of the bootstrap
FEW = 8  # groups of samples below which shares of variance have no error
SURE = 0.95  # share of samples in which the error of sampling holds
LEAST = 1e-12  # share of a law, and distance from 1


@dataclass(frozen=True)
class Law:
    """How a key's values are distributed.

    text: as it was given, "normal(0, 2mm)".
    name: "normal", "lognormal", "uniform" or "choice".
    values: mean and standard deviation, median and standard deviation of the logarithm, or both
        ends, in the key's base unit; of a choice its texts.
    weights: of a choice.
    """

    text: str
    name: str
    values: tuple[Any, ...]
    weights: tuple[float, ...] = ()

    @property
    def median(self) -> object:
        """Value below which half of the law lies."""
        return self.at(np.array([0.5]))[0]

    def at(self, shares: Array) -> list[object]:
        """Values (n,) below which these shares (n,) of the law lie; of a choice in its order."""
        first, second = self.values[:2] if self.name != "choice" else (0, 0)
        if self.name == "choice":
            ends = np.cumsum(self.weights) / sum(self.weights)
            return [self.values[n] for n in np.searchsorted(ends[:-1], shares, side="right")]
        score = ndtri(shares)
        drawn = {
            "uniform": lambda: first + (second - first) * shares,
            "normal": lambda: first + second * score,
            "lognormal": lambda: first * np.exp(second * score),
        }
        return list(drawn[self.name]().tolist())


def law(key: str, text: str) -> Law | None:
    """The law of a text "normal(mean, sd)", "lognormal(median, sigma)", "uniform(a, b)" or
    "choice(a, b*weight, ...)" for a dotted key; None for any other text. Raises SceneError for
    wrong numbers, and for one without a unit beside one with a unit.
    """
    if not (match := _LAW.fullmatch(text.strip())):
        return None
    name, items = match[1], [item.strip() for item in match[2].split(",")]
    try:
        if name == "choice":
            pairs = [item.partition("*") for item in items]
            weights = [float(weight or "1") for _, _, weight in pairs]
            found = Law(text, name, tuple(value.strip() for value, _, _ in pairs), tuple(weights))
            wrong = not (all(0 < each < np.inf for each in weights) and all(found.values))
            bare = [str(value) for value in found.values]
        else:
            first, second = items
            kinds = KINDS[unit(key)], units.NUMBER if name == "lognormal" else KINDS[unit(key)]
            low, high = map(units.to_base, (first, second), kinds)
            found = Law(text, name, (low, high))
            wrong = high <= (low if name == "uniform" else 0) or (name == "lognormal" and low <= 0)
            wrong |= not np.isfinite([low, high]).all()
            bare = items[: 1 if name == "lognormal" else 2]
    except (KeyError, ValueError):
        wrong, bare = True, []
    laws = "normal(mean, sd), lognormal(median, sigma), uniform(a, b) or choice(a, b*weight, c)"
    refuse_first((wrong, key, f"{text!r} is no law; give {laws}, e.g. normal(25kN, 2kN)"))
    check_units(key, bare)
    return found


def check_units(key: str, items: Sequence[str]) -> None:
    """Raise SceneError where some numbers of a list have a unit and others, not zero, have none,
    e.g. "25,50kN", which would be 25 N and 50 kN.
    """
    numbers = [item for item in items if NUMBER.match(item)]
    bare = [item for item in numbers if NUMBER.fullmatch(item)]
    without_unit = next((item for item in bare if Decimal(item)), None)
    if unit(key) and without_unit and len(bare) < len(numbers):
        text = f"{without_unit!r} has no unit and others have one; give each its unit"
        raise SceneError(key, text)


def draw(laws: Mapping[str, Law], count: int, *, sobol: bool) -> list[dict[str, object]]:
    """Values by key of `count` samples of independent laws. sobol: of each sample of these, A, with
    another one, B, and A with one key's value of B after the other: d + 2 rows for d keys.
    """
    d = len(laws)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the number is no power of 2
        points = qmc.Sobol(2 * d if sobol else d, seed=SEED).random(count).clip(LEAST, 1 - LEAST)
    if sobol:
        a, b = points[:, :d], points[:, d:]
        mixed = np.where(np.eye(d, dtype=bool)[:, None], b, a)
        points = np.stack([a, b, *mixed], axis=1).reshape(-1, d)
    columns = [each.at(shares) for each, shares in zip(laws.values(), points.T, strict=True)]
    return [dict(zip(laws, values, strict=True)) for values in zip(*columns, strict=True)]


def summary(
    answers: Mapping[str, tuple[Array, Array]], failed: Mapping[int, str], keys: Sequence[str]
) -> dict[str, Any]:
    """What samples say, as in sample.json: "samples", "failed" (number and names of those that did
    not pass), "quantiles" and, with keys, "sobol".

    answers: values (n,), NaN where a sample has none, and their own errors (n,), by quantity; n is
        the same for all. failed: reason by number of the sample. keys: those of shares of variance,
        of which samples come in groups as of `draw`; empty without.
    """
    size = len(keys) + 2 if keys else 1
    out: dict[str, Any] = {
        "samples": max((len(values) for values, _ in answers.values()), default=len(failed)),
        "failed": {"count": len(failed), "names": {str(n): why for n, why in failed.items()}},
        "quantiles": {},
    }
    for name, both in answers.items():
        values, errors = (each.reshape(-1, size)[:, :2].ravel() for each in both)
        known = np.isfinite(values)
        if known.any():
            out["quantiles"][name] = _quantiles(values[known], errors[known])
    if keys:
        groups = {name: values.reshape(-1, size) for name, (values, _) in answers.items()}
        out["sobol"] = {name: _shares(each, keys) for name, each in groups.items()}
    return out


def _quantiles(values: Array, errors: Array) -> dict[str, dict[str, float | None]]:
    """Quantiles of values (n,) by share: "value"; "error", by the order of so many samples, None
    where they are too few; "estimate", by the values' own errors (n,), None where one has none.
    """
    ordered, count, found = np.sort(values), len(values), {}
    for share in SHARES:
        low, high = binom.ppf([(1 - SURE) / 2, (1 + SURE) / 2], count, share).astype(int)
        value = float(np.quantile(values, share))
        ends = (ordered[low - 1], ordered[high]) if low and high < count else (np.nan, np.nan)
        own = [abs(np.quantile(values + sign * errors, share) - value) for sign in (1, -1)]
        numbers = max(value - ends[0], ends[1] - value), max(own)
        error, estimate = (float(each) if np.isfinite(each) else None for each in numbers)
        found[str(share)] = {"value": value, "error": error, "estimate": estimate}
    return found


def _shares(groups: Array, keys: Sequence[str]) -> dict[str, dict[str, float | None]]:
    """Shares of variance by key, of groups (n, d + 2) of values as of `draw`: "first" of the key
    alone, "total" with all others together, and "error", the larger one of both by bootstrap, None
    of fewer than 8 (FEW) groups, and where draws have no variance. Empty where nothing varies.
    """
    known = groups[np.isfinite(groups).all(axis=1)]
    if len(known) < 2 or not known[:, :2].var():
        return {}

    def both(of: Array) -> Array:
        """First and total shares (2, d)."""
        variance, (a, b) = of[:, :2].var(), of[:, :2].T[:, :, None]
        total, rest = (((each - of[:, 2:]) ** 2).mean(axis=0) / 2 / variance for each in (a, b))
        return np.stack([1 - rest, total])

    chance = np.random.default_rng(SEED)
    drawn = [known[chance.integers(len(known), size=len(known))] for _ in range(DRAWS)]
    error: list[float | None] = [None] * len(keys)
    if len(known) >= FEW and all(of[:, :2].var() > 0 for of in drawn):
        spread = np.std([both(of) for of in drawn], axis=0).max(axis=0)
        error = (ndtri((1 + SURE) / 2) * spread).tolist()
    columns = zip(keys, *both(known).tolist(), error, strict=True)
    return {key: {"first": one, "total": all_, "error": wide} for key, one, all_, wide in columns}
