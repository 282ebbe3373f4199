"""Quantities as people write them: a number in N, mm, MPa, or a string with its unit.

Each quantity of a scene is an annotated number (`Force`, `BodyLength`, ...): pydantic reads its
value through `to_base`, checks the range, and stores the number in the base unit.
"""

import math
import re
import reprlib
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache, partial
from numbers import Real
from typing import TYPE_CHECKING, Annotated, get_args

from pydantic import BeforeValidator

if TYPE_CHECKING:
    import pint

_NUMBER = r"[+-]?(?:inf|(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
_TEXT = re.compile(rf"({_NUMBER})\s*(.*)", re.DOTALL)
_RUN = re.compile(rf"[:/]\s*({_NUMBER})")  # what follows the 1 in 1:20
_POWER = r"[A-Za-z\u00b5\u03bc]+(?:(?:\*\*|\^)-?[1-9]|[²³])?"  # either micro sign
_UNIT = re.compile(rf"(?:1\s*/\s*)?{_POWER}(?:\s*[*/]\s*{_POWER})*")  # 1/m as well
# The usual ones, by base unit: pint has all of them, but to import it takes a tenth of a short run.
_USUAL = {
    "N": {"N": 1, "kN": 1000},
    "mm": {"mm": 1, "m": 1000},
    "MPa": {"MPa": 1, "GPa": 1000},
    "s": {"s": 1, "min": 60},
}
_ANGLES = {"deg": math.pi / 180, "°": math.pi / 180, "mrad": 1e-3, "rad": 1.0}


class _Brief(reprlib.Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = 100

    def repr_int(self, x: int, level: int) -> str:
        """Python refuses to print integers of more than 4300 digits."""
        try:
            str(x)
        except ValueError:
            return "a huge int"
        return super().repr_int(x, level)


def show(value: object) -> str:
    """Return a short ``repr`` of any value, on one line."""
    return " ".join(_Brief().repr(value).split())


@lru_cache(maxsize=1)
def _registry() -> "pint.UnitRegistry[Decimal]":
    """Return the unit registry; only a string with a rare unit needs it."""
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


def _physical(number: str, unit: str, *, base: str) -> float:
    """Convert exactly, in decimals, so that "0.42 m" is the same float as 420."""
    if factor := _USUAL.get(base, {}).get(unit):
        return float(Decimal(number) * factor)
    if unit.startswith("/"):
        unit = f"1{unit}"
    if not _UNIT.fullmatch(unit):
        raise ValueError(unit)
    registry = _registry()
    try:
        return float(registry.Quantity(Decimal(number), unit).to(base).magnitude)
    except AttributeError as unknown:  # pint's UndefinedUnitError is one
        raise ValueError(unit) from unknown


def to_reader(base: str, unit: str) -> float:
    """How many of a unit make one of the base unit."""
    return float(_registry().Quantity(1, base).to(unit).magnitude)


def _per_cent(number: str, unit: str) -> float:
    """Convert per cent."""
    if unit != "%":
        raise ValueError(unit)
    return float(number) / 100


def _slope(number: str, unit: str) -> float:
    """Convert an angle below 90 degrees (to its tangent), 1:20, 1/20, or per cent."""
    if unit in _ANGLES:
        angle = float(number) * _ANGLES[unit]
        if abs(angle) < math.pi / 2:
            return math.tan(angle)
    if run := _RUN.fullmatch(unit):
        return float(number) / float(run[1])
    return _per_cent(number, unit)


def _angle(number: str, unit: str) -> float:
    """Convert an angle to radians."""
    if unit in _ANGLES:
        return float(number) * _ANGLES[unit]
    raise ValueError(unit)


def _speed(number: str, unit: str) -> float:
    """Convert to m/s; per hour as railways write it."""
    return _physical(number, unit.replace("km/h", "kilometer/hour"), base="m/s")


@dataclass(frozen=True)
class Dimension:
    """What a kind of quantity is called, how to write it, how to convert (number, unit), and to
    which unit."""

    noun: str
    hint: str
    convert: Callable[[str, str], float]
    unit: str = ""


FORCE = Dimension(
    "a force",
    'newtons or a force with its unit, e.g. 25000 or "25 kN"',
    partial(_physical, base="N"),
    "N",
)
LENGTH = Dimension(
    "a length",
    'millimetres or a length with its unit, e.g. 420 or "0.42 m"',
    partial(_physical, base="mm"),
    "mm",
)
STRESS = Dimension(
    "a stress",
    'megapascals or a stress with its unit, e.g. 207000 or "207 GPa"',
    partial(_physical, base="MPa"),
    "MPa",
)
DURATION = Dimension(
    "a duration",
    'seconds or a time with its unit, e.g. 30 or "2 min"',
    partial(_physical, base="s"),
    "s",
)
NUMBER = Dimension("a number", "a plain number, e.g. 1", _per_cent)
FRACTION = Dimension("a fraction", 'a number or per cent, e.g. 0.01 or "1%"', _per_cent)
CURVATURE = Dimension(
    "a curvature",
    'a number in 1/mm or with its unit, e.g. 0.0002 or "0.2 1/m"',
    partial(_physical, base="1/mm"),
    "1/mm",
)
SPEED = Dimension("a speed", 'm/s or a speed with its unit, e.g. 20 or "72 km/h"', _speed, "m/s")
ANGLE = Dimension(
    "an angle", 'radians or an angle with its unit, e.g. 0.002 or "2 mrad"', _angle, "rad"
)
SLOPE = Dimension("a slope", 'a slope or an angle, e.g. 0.05, "1:20" or "2.86 deg"', _slope)


def to_base(value: object, dimension: Dimension) -> float:
    """Return a number, or a string with a unit, as a float in N, mm, MPa or without unit.

    Raises ValueError (one line) for NaN, a boolean, anything that is not a number or a string,
    an unreadable string and a unit of another dimension.
    """
    number = math.nan
    try:
        if isinstance(value, str) and (parts := _TEXT.fullmatch(value.strip())):
            number = dimension.convert(parts[1], parts[2]) if parts[2] else float(parts[1])
        elif isinstance(value, Real) and not isinstance(value, bool):
            number = float(value)
    except (ValueError, TypeError, ArithmeticError):
        pass  # still NaN, which is refused below
    if math.isnan(number):
        raise ValueError(f"{show(value)} is not {dimension.noun}; give {dimension.hint}")
    return number


@dataclass(frozen=True)
class Quantity:
    """Converts a value to the base unit and refuses what `allowed` refuses; `words` completes the
    message "<value> is not allowed; give <words>"."""

    dimension: Dimension
    allowed: Callable[[float], bool]
    words: str

    def __call__(self, value: object) -> float:
        number = to_base(value, self.dimension)
        if not self.allowed(number):
            raise ValueError(f"{show(value)} is not allowed; give {self.words}")
        return number


def quantity(dimension: Dimension, allowed: Callable[[float], bool], words: str) -> BeforeValidator:
    """Return a validator: see `Quantity`."""
    return BeforeValidator(Quantity(dimension, allowed, words))


def unit(annotation: object) -> str:
    """Return the base unit of what a key's annotation reads; empty where it has none."""
    if isinstance(annotation, Dimension):
        return annotation.unit
    if isinstance(annotation, BeforeValidator):
        return annotation.func.dimension.unit if isinstance(annotation.func, Quantity) else ""
    return next(filter(None, map(unit, get_args(annotation))), "")


def _positive(value: float) -> bool:
    return 0 < value < math.inf


def _between(low: float, high: float, also: float = math.nan) -> Callable[[float], bool]:
    return lambda value: low <= value <= high or value == also


# Beyond these ranges no scene of allowed radii and moduli makes a patch of a nanometre or more, or
# numbers overflow.
Force = Annotated[
    float, quantity(FORCE, _between(1e-40, 1e15), "a positive force from 1e-40 to 1e15 N")
]
Approach = Annotated[
    float, quantity(LENGTH, _between(1e-21, 1e6), "a positive length from 1e-21 to 1e6 mm")
]
Radius = Annotated[
    float,
    quantity(LENGTH, _between(1e-6, 1e9, math.inf), "a length from 1e-6 to 1e9 mm; inf is flat"),
]
SignedRadius = Annotated[
    float,
    quantity(
        LENGTH,
        lambda v: _between(1e-6, 1e9, math.inf)(abs(v)),
        "a length of 1e-6 to 1e9 mm; negative is concave, inf is flat",
    ),
]
Modulus = Annotated[
    float,
    quantity(
        STRESS, _between(1e-12, 1e15, math.inf), "a stress from 1e-12 to 1e15 MPa; inf is rigid"
    ),
]
BodyLength = Annotated[
    float, quantity(LENGTH, _between(1e-3, 1e6), "a length from 0.001 to 1e6 mm")
]
ElementSize = Annotated[
    float, quantity(LENGTH, _between(1e-9, 1e6), "a length from 1e-9 to 1e6 mm")
]
Duration = Annotated[float, quantity(DURATION, _positive, "a positive, finite time")]
Stress = Annotated[float, quantity(STRESS, _between(1e-6, 1e9), "a stress from 1e-6 to 1e9 MPa")]
Hardening = Annotated[
    float, quantity(STRESS, lambda v: 0 <= v < math.inf, "a finite stress that is not negative")
]
Share = Annotated[float, quantity(FRACTION, lambda v: 0 <= v <= 1, "a fraction from 0 to 1")]
Factor = Annotated[float, quantity(NUMBER, _positive, "a positive, finite number")]
Slope = Annotated[
    float, quantity(SLOPE, lambda v: abs(v) <= 0.2, 'a slope from -0.2 to 0.2, e.g. "1:20"')
]
PoissonRatio = Annotated[
    float,
    quantity(NUMBER, lambda v: 0 <= v < 0.5, "a number from 0 up to, but not including, 0.5"),
]
Accuracy = Annotated[
    float,
    quantity(FRACTION, lambda v: 0.0005 <= v <= 0.2, 'a fraction from 0.0005 to 0.2, e.g. "1%"'),
]
SignedForce = Annotated[float, quantity(FORCE, math.isfinite, "a finite force")]
Creepage = Annotated[
    float,
    quantity(FRACTION, lambda v: abs(v) <= 1, 'a creepage from -1 to 1, e.g. 0.001 or "0.1%"'),
]
Spin = Annotated[float, quantity(CURVATURE, lambda v: abs(v) <= 1, "a spin from -1 to 1 1/mm")]
Speed = Annotated[
    float, quantity(SPEED, lambda v: 0 < v <= 1000, 'a speed up to 1000 m/s, e.g. "80 km/h"')
]
FrictionCoefficient = Annotated[
    float, quantity(NUMBER, lambda v: 0 <= v <= 2, "a number from 0 to 2")
]
Shift = Annotated[float, quantity(LENGTH, lambda v: abs(v) <= 30, "a length from -30 to 30 mm")]
Yaw = Annotated[
    float, quantity(ANGLE, lambda v: abs(v) <= 0.1, 'an angle from -0.1 to 0.1 rad, e.g. "2 mrad"')
]
Gauge = Annotated[
    float, quantity(LENGTH, lambda v: 500 <= v <= 2000, "a length from 500 to 2000 mm, e.g. 1435")
]
Theta = Annotated[int, quantity(NUMBER, lambda v: v in (1, 0, -1), "1, 0 or -1")]
Cycles = Annotated[
    int,
    quantity(NUMBER, lambda v: 1 <= v <= 100 and v.is_integer(), "a whole number from 1 to 100"),
]
Order = Annotated[int, quantity(NUMBER, lambda v: v in (1, 2), "1 or 2")]
Iterations = Annotated[
    int,
    quantity(NUMBER, lambda v: 1 <= v <= 200 and v.is_integer(), "a whole number from 1 to 200"),
]
