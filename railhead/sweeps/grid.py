"""Combinations of values of a scene's keys: lists, and ranges first:last:step."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import product
from typing import TYPE_CHECKING

from railhead.scene.scene import SceneError, assignment, checked, unit

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

MOST = 10_000  # combinations of a sweep
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_RANGE = re.compile(r"\s*:\s*".join([f"({_NUMBER.pattern})"] * 3) + r"\s*(.*)")


def written(texts: Sequence[str]) -> dict[str, list[object]]:
    """Values by key of texts key=value,value,... as `Scene.replace` takes them: each a value as in
    key=value, or a range with one unit at its end, 0:10:0.5mm. Raises SceneError."""
    lists: dict[str, list[object]] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not (key and equals and values):
            raise SceneError(
                "--over", f"{text!r} is not key=values; write e.g. load=25kN,50kN or 0:10:0.5mm"
            )
        if key in lists:
            raise SceneError(key, "is given twice with --over; give one list of values")
        items = [each for item in values.split(",") for each in _values(key, item.strip())]
        _same_units(key, items)
        lists[key] = [assignment(f"{key}={item}")[1] for item in items]
    return lists


def _values(key: str, item: str) -> Iterator[str]:
    if not item:
        raise SceneError(key, "a value between two commas is missing; give one")
    if item.count(":") < 2:
        yield item
        return
    found = _RANGE.fullmatch(item)
    if not found:
        raise SceneError(
            key, f"{item!r} is no range; write first:last:step, one unit at the end, 0:10:0.5mm"
        )
    first, last, step = (Decimal(number) for number in found.groups()[:3])
    if not step or (last != first and (last > first) != (step > 0)):
        raise SceneError(key, f"{item!r} never gets to its end; give a step towards it")
    try:
        count = (last - first) / step
    except ArithmeticError:  # too large for a number
        count = Decimal("inf")
    if count >= MOST:
        raise SceneError(key, f"{item!r} has too many values; give at most {MOST}")
    for number in range(int(count) + 1):
        yield f"{first + number * step}{found[4]}"


def _same_units(key: str, items: Sequence[str]) -> None:
    """Refuse 25,50kN, which is 25 N beside 50 kN."""
    numbers = [item for item in items if _NUMBER.match(item)]
    bare = [item for item in numbers if _NUMBER.fullmatch(item)]
    lone = next((item for item in bare if Decimal(item)), None)
    if unit(key) and lone and len(bare) < len(numbers):
        raise SceneError(key, f"{lone!r} has no unit and others have one; give each its unit")


def scenes(scene: Scene, lists: Mapping[str, Sequence[object]]) -> list[Scene]:
    """A scene for each combination of values by key, the last key changing fastest. Raises
    SceneError."""
    total = 1
    for values in lists.values():
        total *= len(values)
    if total > MOST:
        raise SceneError("--over", f"makes {total} combinations; give at most {MOST}")
    return [
        checked(scene).replace(**dict(zip(lists, chosen, strict=True)))
        for chosen in product(*lists.values())
    ]


def distinct(made: Sequence[Scene], keys: Sequence[str]) -> None:
    """Refuse values that are given twice."""
    seen: set[tuple[object, ...]] = set()
    for scene in made:
        values = tuple(scene.value(key) for key in keys)
        if values in seen:
            said = ", ".join(f"{key}={value}" for key, value in zip(keys, values, strict=True))
            raise SceneError("--over", f"gives {said} twice; give each value once")
        seen.add(values)
