"""Numbers with units: read from what a person writes, checked against a range, in base units.

Each type of number in a scene (`Force`, `BodyLength`, ...) is an annotated float or int. Pydantic
calls its validator, which converts the value to the base unit (N, mm, MPa, s, rad). What is no such
quantity or out of range is refused in one line.
"""

import math
import re
import reprlib
import sys
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from decimal import Decimal
from functools import lru_cache
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

if TYPE_CHECKING:
    import pint

_NUMBER = r"[+-]?(?:inf|(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
_TEXT = re.compile(rf"({_NUMBER})\s*(.*)", re.DOTALL)
_RUN = re.compile(rf"[:/]\s*({_NUMBER})")  # the part :20 or /20 of a slope 1:20
_POWER = r"[A-Za-z\u00b5\u03bc]+(?:(?:\*\*|\^)-?[1-9]|[²³23])?"  # either micro sign; mm2
_BARE_POWER = re.compile(r"(?<=[A-Za-z])([23])\b")
_PER_BOTH = re.compile(r"/\s*\(\s*([^\s()*]+)[\s*]+([^\s()*]+)\s*\)")  # ug/(m mm2)
_UNIT = re.compile(rf"(?:1\s*/\s*)?{_POWER}(?:\s*[*/]\s*{_POWER})*")  # 1/m as well


_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = 100  # characters


def show(value: object) -> str:
    """A short `repr` of any value, on one line."""
    try:
        return " ".join(_REPR.repr(value).split())
    except ValueError:  # Python refuses to print an integer of more than 4300 digits
        return "a huge int"


@lru_cache(maxsize=1)
def _registry() -> "pint.UnitRegistry[Decimal]":
    """The unit registry of pint with decimal numbers, made once. Pint is imported here because its
    import is slow and only rare units need it.
    """
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


@dataclass(frozen=True, kw_only=True, eq=False)
class QuantityKind:
    """A kind of physical quantity and the texts by which values are given.

    noun: name with an article, for messages.
    hint: how to write a value, for messages.
    unit: base unit; empty for plain numbers.
    factors: usual units, and the number of base units in one of each; decimal, but for angles.
    pint: whether other units of the same dimension are read with the package pint.
    """

    noun: str
    hint: str
    unit: str = ""
    factors: Mapping[str, Decimal | float] = field(default_factory=dict)
    pint: bool = False

    def convert(self, number: str, unit: str) -> float:
        """The value, in the base unit, of a decimal number (text) with a unit (text).

        Decimal arithmetic makes "0.42 m" the same float as 420 mm. Raises ValueError, TypeError or
        ArithmeticError where the unit is none of this kind.
        """
        factor = self.factors.get(unit)
        if isinstance(factor, float):  # of an angle: no decimal has it
            return float(number) * factor
        if factor is not None:
            return float(Decimal(number) * factor)
        unit = _PER_BOTH.sub(r"/\1/\2", f"1{unit}" if unit.startswith("/") else unit)
        if not self.pint or not _UNIT.fullmatch(unit):
            raise ValueError(unit)
        try:
            given = _registry().Quantity(Decimal(number), _BARE_POWER.sub(r"**\1", unit))
            return float(given.to(_BARE_POWER.sub(r"**\1", self.unit)).magnitude)
        except AttributeError as unknown:  # pint's UndefinedUnitError is one
            raise ValueError(unit) from unknown


class SlopeKind(QuantityKind):
    """A slope (tangent): given as a number, as 1:20 or 1/20, per cent, or as an angle below 90
    degrees, of which the tangent is taken.
    """

    def convert(self, number: str, unit: str) -> float:
        """The slope (tangent) of a number (text) with a unit (text): an angle's unit, ":20", "/20"
        or "%". Raises ValueError, TypeError or ArithmeticError for another unit.
        """
        if unit in ANGLE.factors and abs(angle := ANGLE.convert(number, unit)) < math.pi / 2:
            return math.tan(angle)
        if run := _RUN.fullmatch(unit):
            return float(number) / float(run[1])
        return super().convert(number, unit)


_PER_CENT = {"%": Decimal("0.01")}
FORCE = QuantityKind(
    noun="a force",
    hint='newtons or a force with its unit, e.g. 25000 or "25 kN"',
    unit="N",
    factors={"N": Decimal(1), "kN": Decimal(1000)},
    pint=True,
)
LENGTH = QuantityKind(
    noun="a length",
    hint='millimetres or a length with its unit, e.g. 420 or "0.42 m"',
    unit="mm",
    factors={"mm": Decimal(1), "m": Decimal(1000)},
    pint=True,
)
WAVELENGTH = replace(LENGTH, hint='auto or a wavelength from 1 to 100 mm, e.g. 10 or "10 mm"')
STRESS = QuantityKind(
    noun="a stress",
    hint='megapascals or a stress with its unit, e.g. 207000 or "207 GPa"',
    unit="MPa",
    factors={"MPa": Decimal(1), "GPa": Decimal(1000)},
    pint=True,
)
WEAR_RATE = QuantityKind(
    noun="a rate of wear", hint="micrograms per m and mm2", unit="ug/m/mm2", pint=True
)
DURATION = QuantityKind(
    noun="a duration",
    hint='seconds or a time with its unit, e.g. 30 or "2 min"',
    unit="s",
    factors={"s": Decimal(1), "min": Decimal(60)},
    pint=True,
)
SPIN = QuantityKind(
    noun="a spin",
    hint='a number in 1/mm or with its unit, e.g. 0.0002 or "0.2 1/m"',
    unit="1/mm",
    pint=True,
)
SPEED = QuantityKind(
    noun="a speed", hint='m/s or a speed with its unit, e.g. 20 or "72 km/h"', unit="m/s", pint=True
)
SLIP_SPEED = QuantityKind(
    noun="a slip velocity",
    hint='mm/s or a velocity with its unit, e.g. 1250 or "1.25 m/s"',
    unit="mm/s",
    pint=True,
)
_CELSIUS = dict.fromkeys(("degC", "°C", "C"), Decimal(1))
TEMPERATURE = QuantityKind(
    noun="a temperature",
    hint='degrees Celsius, e.g. 20 or "20 degC"',
    unit="degC",
    factors=_CELSIUS,
)
ANGLE = QuantityKind(
    noun="an angle",
    hint='radians or an angle with its unit, e.g. 0.002 or "2 mrad"',
    unit="rad",
    factors={
        "rad": Decimal(1),
        "mrad": Decimal("0.001"),
        "deg": math.pi / 180,
        "°": math.pi / 180,
    },
)
DEGREES = QuantityKind(
    noun="an angle",
    hint='degrees, e.g. 30 or "30 deg"',
    unit="deg",
    factors={
        "deg": Decimal(1),
        "°": Decimal(1),
        "rad": 180 / math.pi,
        "mrad": 0.18 / math.pi,
    },
)
NUMBER = QuantityKind(noun="a number", hint="a plain number, e.g. 1", factors=_PER_CENT)
FRACTION = QuantityKind(
    noun="a fraction", hint='a number or per cent, e.g. 0.01 or "1%"', factors=_PER_CENT
)
CREEPAGE = replace(FRACTION, noun="a creepage")
SLOPE = SlopeKind(
    noun="a slope",
    hint='a slope or an angle, e.g. 0.05, "1:20" or "2.86 deg"',
    factors=_PER_CENT,
)


def to_base(value: object, kind: QuantityKind) -> float:
    """A number or a text with a unit as a float in the base unit of its kind.

    Raises ValueError (one line) for NaN, a boolean, anything that is not a number or a text, an
    unreadable text and a unit of another kind.
    """
    number = math.nan
    try:
        if isinstance(value, str) and (parts := _TEXT.fullmatch(value.strip())):
            number = kind.convert(parts[1], parts[2]) if parts[2] else float(parts[1])
        elif isinstance(value, Real) and not isinstance(value, bool):
            number = float(value)
    except (ValueError, TypeError, ArithmeticError):
        pass  # still NaN, which is refused below
    if math.isnan(number):
        raise ValueError(f"{show(value)} is not {kind.noun}; give {kind.hint}")
    return number


@dataclass(frozen=True, eq=False)
class Range:
    """Quantities of a kind within a range, as metadata of an annotated float or int: pydantic calls
    it with a value and gets the value in the base unit of the kind.

    kind: the kind of quantity, with its base unit.
    low: smallest allowed value, in the base unit.
    high: largest allowed value, in the base unit.
    note: added to the description of the range in messages.
    words: replaces that description.
    excluded: single values between low and high that are not allowed.
    infinite: whether inf is allowed, too.
    either_sign: whether all of these hold for the absolute value, so that negative numbers are
        allowed.
    whole: whether only whole numbers are allowed.
    """

    kind: QuantityKind
    low: float
    high: float
    _: KW_ONLY
    note: str = ""
    words: str = ""
    excluded: tuple[float, ...] = ()
    infinite: bool = False
    either_sign: bool = False
    whole: bool = False

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Pydantic's schema of the annotated number: this range first, then the number's own."""
        return core_schema.no_info_before_validator_function(self, handler(source))

    @property
    def allowed(self) -> str:
        """What is allowed, for the message "<value> is not allowed; give <allowed>"."""
        noun = "a whole number" if self.whole else self.kind.noun
        ends = f"from {_short(self.low)} to {_short(self.high)} {self.kind.unit}".rstrip()
        return self.words or f"{noun} {ends}{self.note}"

    def __call__(self, value: object) -> float:
        """The value (a number, or a text with its unit) in the base unit. Raises ValueError (one
        line) for what is no such quantity or out of range.
        """
        number = to_base(value, self.kind)
        size = abs(number) if self.either_sign else number
        inside = self.low <= size <= self.high and size not in self.excluded
        if not (inside or (self.infinite and size == math.inf)) or (
            self.whole and not number.is_integer()
        ):
            raise ValueError(f"{show(value)} is not allowed; give {self.allowed}")
        return number


def _short(number: float) -> str:
    """Text of a number with a short exponent: 1e-6, 0.001, 1e15."""
    return re.sub(r"e([+-])0*", lambda sign: "e" + sign[1].strip("+"), f"{number:g}")


def angle(value: object) -> float | None:
    """Angle in rad of a text that is a number with a unit of an angle; None for anything else."""
    parts = _TEXT.fullmatch(value.strip()) if isinstance(value, str) else None
    return ANGLE.convert(parts[1], parts[2]) if parts and parts[2] in ANGLE.factors else None


def unit(*annotations: object) -> str:
    """Base unit of the quantity that the first type annotation with one reads; empty where none
    has.
    """
    for each in annotations:
        found = each.kind.unit if isinstance(each, Range) else unit(*get_args(each))
        if found:
            return found
    return ""


LARGEST = sys.float_info.max  # all finite numbers
# Beyond these ranges no scene of allowed radii and moduli makes a patch of a nanometre or more, or
# numbers overflow.
Radius = Annotated[float, Range(LENGTH, 1e-6, 1e9, note="; inf is flat", infinite=True)]
SignedRadius = Annotated[
    float,
    Range(
        LENGTH,
        1e-6,
        1e9,
        note="; negative is concave, inf is flat",
        infinite=True,
        either_sign=True,
    ),
]
BodyLength = Annotated[float, Range(LENGTH, 1e-3, 1e6)]
Duration = Annotated[
    float, Range(DURATION, 0, LARGEST, excluded=(0,), words="a positive, finite time")
]
Stress = Annotated[float, Range(STRESS, 1e-6, 1e9)]
Hardening = Annotated[
    float,
    Range(STRESS, 0, LARGEST, words="a finite stress that is not negative"),
]
Recall = Annotated[float, Range(NUMBER, 0, 1e9)]
Share = Annotated[float, Range(FRACTION, 0, 1)]
Accuracy = Annotated[float, Range(FRACTION, 0.0005, 0.2, note=', e.g. "1%"')]
SignedForce = Annotated[
    float,
    Range(FORCE, 0, LARGEST, either_sign=True, words="a finite force"),
]
Creepage = Annotated[float, Range(CREEPAGE, -1, 1, note=', e.g. 0.001 or "0.1%"')]
Speed = Annotated[float, Range(SPEED, 0, 1000, note=', but not 0, e.g. "80 km/h"', excluded=(0,))]
COEFFICIENT = Range(NUMBER, 0, 2, note=" or pairs of an angle and a coefficient")
PAIRED_COEFFICIENT = Range(NUMBER, 0, 2, note=", but not 0", excluded=(0,))
TEMPERATURE_RANGE = Range(TEMPERATURE, -273.15, 5000)
Temperature = Annotated[float, TEMPERATURE_RANGE]
ThermalConstant = Annotated[float, Range(NUMBER, 1e-6, 1e6)]
SURFACE_ANGLE = Range(DEGREES, -90, 90)
Position = Annotated[
    float,
    Range(
        LENGTH, 0, 1e6, either_sign=True, words="a length of at most 1e6 mm, or an angle of a wheel"
    ),
]
Displacement = Annotated[float, Range(LENGTH, 0, 1000, either_sign=True)]
AxleAngle = Annotated[float, Range(ANGLE, -0.1, 0.1, note=', e.g. "2 mrad"')]
Gauge = Annotated[float, Range(LENGTH, 500, 2000, note=", e.g. 1435")]
