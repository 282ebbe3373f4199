"""Combinations of values of a scene's keys, given as lists and as ranges first:last:step."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path

from railhead.geometry.tables import lines_of
from railhead.scene.keys import assignment
from railhead.scene.scene import Scene, SceneError, checked, unit
from railhead.scene.sections import ArgumentError, refuse_first
from railhead.sweeps.sampling import NUMBER, Law, check_units, draw, law

MAX_COMBINATIONS = 10_000
_RANGE = re.compile(r"\s*:\s*".join([f"({NUMBER.pattern})"] * 3) + r"\s*(.*)")


@dataclass(frozen=True, kw_only=True)
class ParameterGrid:
    """Scenes that differ in the values of some keys.

    base: the scene before any of the values is set.
    keys: dotted keys that are set, in order, also where all scenes have the same value.
    scenes: one for each combination of values; the last key changes fastest.
    listed: whether the scenes come from rows of a table, which need not be all combinations of the
        values of each key.
    laws: texts of the laws by key of which the rows are samples; None where they are none.
    sobol: whether the samples come in groups as of `sampling.draw`.
    refused: values by dotted key, and the reason, of those samples that make no scene, by number;
        in `scenes` the base is in their place.
    """

    base: Scene
    keys: list[str]
    scenes: list[Scene]
    listed: bool = False
    laws: Mapping[str, str] | None = None
    sobol: bool = False
    refused: Mapping[int, tuple[Mapping[str, object], SceneError]] = field(default_factory=dict)

    @classmethod
    def combine(
        cls,
        scene: Scene,
        lists: Mapping[str, Sequence[object]],
        rows: Sequence[Mapping[str, object]] = (),
        laws: Mapping[str, str] | None = None,
        *,
        sobol: bool = False,
    ) -> ParameterGrid:
        """Grid of all combinations of lists of values by dotted key; rows change slowest.

        rows: values by dotted key, each combined with all of the lists. laws, sobol: as of the
            grid; samples may be alike, and some of them may make no scene.
        Raises SceneError for a wrong key or value, a key in both or without values, more than
        10 000 combinations and two scenes with the same values.
        """
        first = rows[0] if rows else {}
        total = max(len(rows), 1) * prod(map(len, lists.values()))
        both = "is given with --over and in --over-file; give one of them"
        refuse_first(
            *((key in lists, key, both) for key in first),
            *(
                (key.startswith("wear."), key, "changes no scene; only railhead wear reads it")
                for key in (*first, *lists)
            ),
            *(
                (not values, key, "has no values; give one or more")
                for key, values in lists.items()
            ),
        )
        many = f"makes {total} combinations; give at most {MAX_COMBINATIONS}"
        refuse_first((total > MAX_COMBINATIONS, "over", many), kind=ArgumentError)
        scenes, refused = [], {}
        for row, values in product(rows or ({},), product(*lists.values())):
            asked = {**row, **dict(zip(lists, values, strict=True))}
            try:
                scenes.append(checked(scene).replace(**asked))
            except SceneError as error:
                if laws is None:
                    raise
                refused[len(scenes)] = asked, error
                scenes.append(scene)
        if refused and len(refused) == len(scenes):
            raise refused[0][1]
        keys, listed = [*first, *lists], bool(rows)
        grid = cls(
            base=scene,
            keys=keys,
            scenes=scenes,
            listed=listed,
            laws=laws,
            sobol=sobol,
            refused=refused,
        )
        every = Counter(tuple(grid.values(number).items()) for number in range(total))
        values, count = every.most_common(1)[0]
        if count > 1 and laws is None:
            text = ", ".join(f"{key}={value}" for key, value in values)
            raise ArgumentError("over", f"gives {text} twice; give each value once")
        return grid

    @classmethod
    def sampled(
        cls,
        scene: Scene,
        lists: Mapping[str, Sequence[object] | Law],
        rows: Sequence[Mapping[str, object]],
        count: int | None,
        *,
        sobol: bool,
    ) -> ParameterGrid:
        """Grid of samples: `count` of the laws, or the rows with one sample of the laws for each.
        sobol: as of `sampling.draw`. Raises SceneError as `combine`, for lists of values, where
        number or laws are missing or too many, and where no sample makes a scene.
        """
        laws = {key: each for key, each in lists.items() if isinstance(each, Law)}
        refuse_first(
            *((key not in laws, key, "has values beside samples; give a law") for key in lists),
            *((key in laws, key, "is in the file of samples, too") for key in (rows or [{}])[0]),
        )
        refuse_first(
            (not (laws or rows), "sample", "has no laws; give KEY=LAW"),
            (count is None and not rows, "sample", "is missing; give the number of samples"),
            (
                bool(rows) and (count is not None or sobol),
                "samples-file",
                "has all samples, which may depend on each other; leave --sample and --sobol out",
            ),
            kind=ArgumentError,
        )
        size = count or len(rows)
        drawn = draw(laws, size, sobol=sobol) if laws else [{}] * size
        both = zip(rows or [{}] * len(drawn), drawn, strict=True)
        texts = {key: each.text for key, each in laws.items()}
        return cls.combine(scene, {}, [{**row, **own} for row, own in both], texts, sobol=sobol)

    def values(self, number: int) -> dict[str, object]:
        """Values of the changing keys in scene `number` by dotted key, in base units; of a refused
        sample as they were given.
        """
        if number in self.refused:
            return dict(self.refused[number][0])
        return {key: self.scenes[number].value(key) for key in self.keys}

    @cached_property
    def names(self) -> list[dict[str, str]]:
        """Names of the files among the values of each scene by dotted key: the last parts of their
        paths, as many as tell all values of the key apart.
        """
        found: list[dict[str, str]] = [{} for _ in self.scenes]
        files = {file for scene in self.scenes for file in scene.files}
        for key in self.keys:
            paths = [Path(str(self.values(number)[key])) for number in range(len(found))]
            if files.isdisjoint(paths):
                continue
            last = 1
            while len({path.parts[-last:] for path in paths}) < len({*paths}):
                last += 1
            for names, path in zip(found, paths, strict=True):
                names[key] = str(Path(*path.parts[-last:]))
        return found

    def label(self, number: int) -> str:
        """Keys, units and values of scene `number` as text, e.g. "load [N] = 25000.0"."""
        pairs = (f"{column(key)} = {shown(key, v)}" for key, v in self.values(number).items())
        return ", ".join(pairs) or "the scene"


def column(key: str) -> str:
    """Header of a table column with the values of a dotted key: key and unit, "load [N]"; angles
    are in mrad.
    """
    shown = {"rad": "mrad"}.get(unit(key), unit(key))
    return f"{key} [{shown}]" if shown else key


def shown(key: str, value: object) -> object:
    """A value (base unit, as in JSON) of a dotted key in the unit of its column: angles in mrad,
    the words "inf" and "-inf" as numbers, lists as text, others unchanged.
    """
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    if value in ("inf", "-inf"):
        return float(str(value))
    if unit(key) == "rad" and isinstance(value, float):
        return float(f"{1e3 * value:.12g}")
    return value


def parse_values(texts: Sequence[str]) -> dict[str, list[object] | Law]:
    """Lists of values, or laws, by dotted key from texts "key=value,value,..." or "key=law".

    Each value is a scalar with or without unit, or a range first:last:step with one unit at its
    end, "0:10:0.5mm". Values are int, float, bool or text: a value with a unit stays text ("25kN"),
    as do all values of keys that take words. Raises SceneError for any other text, a key given
    twice, and a number without a unit, other than 0, beside numbers with units.
    """
    lists: dict[str, list[object] | Law] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        shape = f"{text!r} is not key=values; write e.g. load=25kN,50kN or 0:10:0.5mm"
        refuse_first(
            (not (key and equals and values), "--over", shape),
            (key in lists, key, "is given twice with --over; give one list of values"),
        )
        if (found := law(key, values)) is not None:
            lists[key] = found
            continue
        items = [each for item in values.split(",") for each in _expand(key, item.strip())]
        check_units(key, items)
        lists[key] = [assignment(f"{key}={item}")[1] for item in items]
    return lists


def read_rows(path: Path, option: str = "--over-file") -> list[dict[str, object]]:
    """Rows of values by dotted key from a table of comma-separated values (or semicolons).

    The first line names the keys, each with a unit in brackets where the numbers below have none,
    "wheelset.shift [mm]". option: for messages. Raises SceneError for a file that is no such table.
    """
    try:
        lines = lines_of(path)
        split = ";" if ";" in "".join(lines[:1]) else ","
        reader = csv.reader(io.StringIO("\n".join(lines)), delimiter=split, strict=True)
        table = [(reader.line_num, [cell.strip() for cell in line]) for line in reader if line]
    except (csv.Error, OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        advice = "give a .csv file in UTF-8, with a closing quote for each"
        text = f"{str(path)!r} is no table: {reason}; {advice}"
        raise SceneError(option, text) from None
    pairs = [head.rstrip("]").partition("[") for head in (table[0][1] if table else ())]
    heads = [(key.strip(), of) for key, _, of in pairs]
    if len(table) < 2 or len({key for key, _ in heads}) < len(heads):
        text = f"{str(path)!r} is no table; give a line of different keys and lines of values"
        raise SceneError(option, text)
    rows = []
    for number, line in table[1:]:
        if len(line) != len(heads) or not all(line):
            text = f"line {number} of {str(path)!r} has no {len(heads)} values; give one a key"
            raise SceneError(option, text)
        texts = (f"{key}={cell}{of}" for (key, of), cell in zip(heads, line, strict=True))
        rows.append(dict(map(assignment, texts)))
    return rows


def _expand(key: str, item: str) -> Iterator[str]:
    """The values of the range "first:last:step" with a unit at its end, as texts; any other text
    unchanged. Raises SceneError for an empty or wrong range and for too many values.
    """
    if not item:
        raise SceneError(key, "a value between two commas is missing; give one")
    if item.count(":") < 2:
        yield item
        return
    match = _RANGE.fullmatch(item)
    if not match:
        raise SceneError(
            key, f"{item!r} is no range; write first:last:step, one unit at the end, 0:10:0.5mm"
        )
    first, last, step = (Decimal(number) for number in match.groups()[:3])
    if not step or (last != first and (last > first) != (step > 0)):
        raise SceneError(key, f"{item!r} never gets to its end; give a step towards it")
    try:
        count = (last - first) / step
    except ArithmeticError:  # too large for a number
        count = Decimal("inf")
    if count >= MAX_COMBINATIONS:
        raise SceneError(key, f"{item!r} has too many values; give at most {MAX_COMBINATIONS}")
    for number in range(int(count) + 1):
        yield f"{first + number * step}{match[4]}"
