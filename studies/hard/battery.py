"""The hard cases of cases.toml; the study runs all of them, the tests those marked quick."""

import itertools
import tomllib
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from railhead.scene import catalogue
from railhead.scene.scene import Scene
from studies.hard import blocks, references
from studies.hard.case import Case, Measured

STEEL = 207e3  # MPa, what a stiffness ratio refers to
REFERENCES = {
    "half_space": "boundary elements",
    "positioned": "boundary elements",
    "hertz": "exact Hertz",
    "finer": "own finer mesh",
    "finer_plastic": "own finer mesh",
    "random_plans": "finite numbers",
}
"""Name of the reference of a function, where a row gives none; of others it is an invariance."""


def base(fields: Mapping[str, Any]) -> Scene:
    """A scene of the table [scenes]: a shipped case with changes, or all of its fields."""
    changes = {key: value for key, value in fields.items() if key != "case"}
    if "case" in fields:
        return catalogue.find(fields["case"]).replace(**changes)
    return Scene.from_mapping(changes)


def expand(row: Mapping[str, Any], scenes: Mapping[str, Scene]) -> Iterator[Case]:
    """The cases of a row, see the head of cases.toml."""
    for entry in row.get("cases", [{}]):
        fields = {**row, **entry}
        over = fields.get("over", {})
        for chosen in itertools.product(*over.values()):
            values = dict(zip(over, chosen, strict=True))
            values["modulus"] = STEEL * values.get("ratio", 1.0)
            yield one(fields, values, scenes)


def one(fields: Mapping[str, Any], values: Mapping[str, Any], scenes: Mapping[str, Scene]) -> Case:
    """The case of a row with values in the places of its templates."""
    name, against = fields["name"].format(**values), fields["against"]
    options = {
        key: values[value[1:-1]] if isinstance(value, str) and value[:1] == "{" else value
        for key, value in fields.get("with", {}).items()
    }
    if "scene" in fields:
        keys = [key.format(**values) for key in fields.get("keys", [])]
        options["scene"] = scenes[fields["scene"]].replace(keys)
    quick = fields.get("quick", False)
    given = ("newton", "krylov", "seconds", "known")
    return Case(
        group=fields["group"],
        name=name,
        reason=fields["reason"],
        reference=fields.get("reference", REFERENCES.get(against, "invariance")),
        solve=partial(references.METHODS.get(against) or getattr(blocks, against), **options),
        quick=name in quick if isinstance(quick, list) else quick,
        refusable=fields.get("refusable", bool(options.get("noise"))),
        **{key: fields[key] for key in given if key in fields},
    )


def read() -> Iterator[Case]:
    """All cases of cases.toml."""
    with Path(__file__).with_name("cases.toml").open("rb") as file:
        table = tomllib.load(file)
    scenes = {name: base(fields) for name, fields in table["scenes"].items()}
    for row in table["rows"]:
        yield from expand(row, scenes)


CASES: dict[str, Case] = {case.key: case for case in read()}
QUICK = [case for case in CASES.values() if case.quick]


def solve(key: str) -> Measured:
    """Solve the case of a key."""
    return CASES[key].solve()
