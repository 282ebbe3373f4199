"""The scene: everything a person may say about a wheel on a rail, checked once, then frozen.

A `Scene` is built in Python, from a mapping, or from a TOML file (`railhead.scene.catalogue`).
Lengths are in mm, forces in N, stresses in MPa; wherever a number is expected, a string with a unit
is read as well. Every way of building one raises `SceneError`, whose text is one line.
"""

import math
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from itertools import product
from operator import getitem
from pathlib import Path
from typing import Annotated, Any, Self, get_args

from pydantic import BeforeValidator, model_validator

from railhead.scene import units
from railhead.scene.bodies import Rail, Wheel, Wheelset
from railhead.scene.keys import (
    HALF_SPACE,
    OTHER_NAMES,
    UNUSED_KEYS,
    assigned,
    dotted,
    file_entries,
    refuse_unused,
    without_keys,
)
from railhead.scene.quantities import GROUPS
from railhead.scene.sections import (
    Effects,
    Friction,
    Heat,
    Mesh,
    Rolling,
    SceneError,
    Section,
    Solver,
    Wear,
    refuse_first,
)
from railhead.scene.units import Range, show

__all__ = [
    "Effects",
    "Friction",
    "Heat",
    "Mesh",
    "Rail",
    "Rolling",
    "Scene",
    "SceneError",
    "Solver",
    "Wear",
    "Wheel",
    "Wheelset",
]

#: Transverse radius in mm of what touches: the crowns of EN 13674-1, straight wheel treads.
NOMINAL_RADIUS = {"54E1": 300.0, "60E1": 300.0} | dict.fromkeys(
    ("cylinder", "cone20", "cone40"), math.inf
)
#: Longest name of a scene: folders are named after it, and their names have at most 255 bytes.
MAX_NAME_BYTES = 100
#: Setting the key on the left drops the one on the right, but for some values.
_DROPS = {
    "load": ("approach", (None, "none")),
    "approach": ("load", (None, "none")),
    "rail.profile": ("rail.crown_radius", ("arc",)),
    "wheel.profile": ("wheel.transverse_radius", ("arc",)),
    "solver.method": ("solver.theta", ("nitsche", "none")),
}
USUAL = {
    "rail.young_modulus": (190e3, 220e3),
    "wheel.young_modulus": (190e3, 220e3),
    "rail.yield_stress": (200.0, 1500.0),
    "wheel.yield_stress": (200.0, 1500.0),
    "wheel.rolling_radius": (250.0, 650.0),
    "wheel.transverse_radius": (50.0, 1000.0),
    "rail.crown_radius": (50.0, 1000.0),
    "load": (5e3, 250e3),
    "heat.conductivity": (15.0, 60.0),
    "heat.density": (7000.0, 8500.0),
    "heat.specific_heat": (400.0, 700.0),
}
"""Usual range of values for steel wheels on rails, in base units, by dotted key."""
FACTORS = (1e-3, 1e3, 1e6)  # GPa for MPa, m for mm, kN for N; kPa and Pa for MPa


def _name(value: object) -> str:
    """A valid name of a scene: letters, digits, _, - and ., 1 to 100 bytes (MAX_NAME_BYTES), not
    only dots. Raises ValueError (one line) for anything else.
    """
    if (
        isinstance(value, str)
        and re.fullmatch(r"(?!\.+$)[\w.-]+", value)
        and len(value.encode()) <= MAX_NAME_BYTES
    ):
        return value
    allowed = f"give 1 to {MAX_NAME_BYTES} letters, digits, _, - or ."
    raise ValueError(f"{show(value)} is not allowed; {allowed} (of others than a to z fewer)")


def _quantities(value: object) -> tuple[str, ...]:
    """Names of `GROUPS`, each once, from a list or a text with commas. Raises ValueError (one
    line) for anything else.
    """
    names = value.split(",") if isinstance(value, str) else value
    try:
        found = tuple(dict.fromkeys(str(name).strip() for name in names))  # type: ignore[attr-defined]
    except TypeError:
        found = ()
    if not found or not GROUPS.keys() >= {*found}:
        allowed = f"give one or more of {', '.join(GROUPS)}"
        raise ValueError(f"{show(value)} is not allowed; {allowed}")
    return found


class Scene(Section):
    """A wheel on a rail, pressed by a load or by an approach: exactly one of both is given.

    ``Scene(load="25 kN", rail=Rail(profile="60E1"))`` builds a scene; a wrong key or value raises
    SceneError. A later assignment raises pydantic's ValidationError, as scenes are frozen.

    name: name of the scene and of its folder in results/.
    load: N, vertical load on the wheel; at an inclined contact the normal force is larger. None:
        approach is given.
    approach: mm, by which the supports of the bodies come closer, vertically; None: load is given.
    accuracy: largest relative error of the estimated quantities (`Result.estimate`), 0.0005 to 0.2:
        meshes are refined until the estimates meet it; None: not given.
    budget: s of computing time for the best possible accuracy; None: not given. With neither one
        mesh is solved.
    unload: whether bodies that yield are unloaded after the load; no effect where nothing yields.
    quantities: what is computed, some of `GROUPS`, as a list or a text "patch,forces". Without
        "forces" the contact is frictionless.
    rail: the rail, a `Rail`.
    wing: a second head beside the rail, with sections and a steel of its own, a `Rail`; None: none
        is given.
    wheel: the wheel, a `Wheel`.
    wheelset: position of the wheelset, a `Wheelset`.
    friction: coefficient of friction, also of rolling (0: none), and tangential forces that shift
        the wheel from rest, a `Friction`.
    rolling: steady rolling, a `Rolling`.
    heat: warmth of the bodies, a `Heat`.
    wear: wear over a route, a `Wear`.
    solver: contact method and linear solver, a `Solver`.
    mesh: the elements, a `Mesh`.
    effects: physical effects and simplifications, each "auto", "on" or "off", an `Effects`.
    """

    name: Annotated[str, BeforeValidator(_name)] = "scene"
    load: Annotated[float, Range(units.FORCE, 1e-40, 1e15)] | None = None
    approach: Annotated[float, Range(units.LENGTH, 1e-21, 1e6)] | None = None
    accuracy: units.Accuracy | None = None
    budget: units.Duration | None = None
    unload: bool = True
    quantities: Annotated[tuple[str, ...], BeforeValidator(_quantities)] = tuple(GROUPS)
    rail: Rail = Rail()
    wing: Rail | None = None
    wheel: Wheel = Wheel()
    wheelset: Wheelset = Wheelset()
    friction: Friction = Friction()
    rolling: Rolling = Rolling()
    heat: Heat = Heat()
    wear: Wear = Wear()
    solver: Solver = Solver()
    mesh: Mesh = Mesh()
    effects: Effects = Effects()

    @model_validator(mode="after")
    def _keys_of_several_tables(self) -> Self:
        """Raise SceneError for the first rule that is broken: exactly one of load and approach; no
        patch size beside accuracy or budget; no force of [friction] beside rolling; a load and
        friction for an axle without torque; a speed for a law of friction, its temperatures for one
        that depends on them; no such law and no layer beside passes; at least one body that
        deforms.
        """
        friction, rolling = self.friction, self.rolling
        free = rolling.axle == "torque_free"
        shifted = friction.force_along or friction.force_across
        neither = self.load is None and self.approach is None
        both = self.load is not None and self.approach is not None
        values = f"({self.load or 0:.12g}, {self.approach or 0:.12g})"
        other = "accuracy" if self.accuracy else "budget"
        sized = self.mesh.patch_size is not None and (self.accuracy or self.budget)
        refuse_first(
            (neither, "load, approach", "neither is given; give exactly one of them"),
            (both, "load, approach", f"both are given {values}; give exactly one of them"),
            (
                sized,
                f"mesh.patch_size, {other}",
                f"both are given; {other} chooses the patch size, give one of them",
            ),
            (
                rolling.prescribed and shifted,
                "rolling",
                "is not allowed beside a force of [friction]; give one",
            ),
            *(
                (
                    part.surface and (rolling.prescribed or rolling.passes is not None),
                    "rolling",
                    f"is not allowed beside {body}.surface, over which nothing rolls steadily",
                )
                for body, part in self.bodies.items()
            ),
            (
                self.wing is not None and not (self.rail.sections and self.wing.sections),
                "rail.sections" if self.wing and self.wing.sections else "wing.sections",
                "not given; a wing needs sections of both heads",
            ),
            (
                self.rail.varies and math.isinf(self.wheel.rolling_radius),
                "wheel.rolling_radius",
                "inf is not allowed beside sections or a roller; give that of a wheel",
            ),
            (
                self.rail.friction_coefficient is not None,
                "rail.friction_coefficient",
                "is not allowed; give friction.coefficient, and here that of a wing",
            ),
            (
                self.wing is not None
                and self.wing.friction_coefficient is not None
                and (friction.law != "coulomb" or not friction.acts),
                "wing.friction_coefficient",
                "needs a friction.coefficient, and friction.law coulomb",
            ),
            (
                self.wing is not None and self.wing.position != 0,
                "wing.position",
                "is not allowed; rail.position says where the axle stands",
            ),
            (
                free and self.load is None,
                "rolling.axle",
                "torque_free is not allowed with an approach: give the load of each wheel",
            ),
            (
                free and not self.asks("forces"),
                "quantities",
                "rolling.axle torque_free needs the forces; add forces to quantities or --only",
            ),
            (
                free and not self.rubs,
                "rolling.axle",
                "torque_free is not allowed without friction, which makes the torque",
            ),
            (
                friction.law != "coulomb" and rolling.speed is None,
                "rolling.speed",
                f"is missing; friction.law {friction.law} needs it",
            ),
            (
                friction.law == "temperature" and self.effects.heat == "off",
                "effects.heat",
                "off is not allowed beside friction.law temperature",
            ),
            (
                rolling.passes is not None and friction.law != "coulomb",
                "friction.law",
                f"{friction.law} is not allowed beside rolling.passes; give coulomb",
            ),
            (
                rolling.passes is not None and friction.layer_thickness is not None,
                "friction.layer_thickness",
                "is not allowed beside rolling.passes; leave it out",
            ),
            (
                all(math.isinf(body.young_modulus) for body in self.bodies.values()),
                "rail.young_modulus, wheel.young_modulus",
                "both are inf (rigid); make at least one of them finite",
            ),
        )
        return self

    @property
    def bodies(self) -> dict[str, Rail | Wheel]:
        """The sections of both bodies by "rail" and "wheel"."""
        return {"rail": self.rail, "wheel": self.wheel}

    @property
    def smooth(self) -> Self:
        """The scene with nothing added to the surfaces of its bodies."""
        return self.model_copy(
            update={
                body: part.model_copy(update={"surface": None})
                for body, part in self.bodies.items()
            }
        )

    @property
    def opposite(self) -> Self:
        """The same wheelset on its track with its other wheel as the one that is solved."""
        here, rail, wheel = self.wheelset, self.rail, self.wheel
        there = here.model_copy(
            update={
                "side": "left" if here.side == "right" else "right",
                "other_rail": here.other_rail and rail.profile,
                "other_wheel": here.other_wheel and wheel.profile,
                "other_radius": here.other_radius and wheel.rolling_radius,
            }
        )
        rail = rail.model_copy(update={"profile": here.other_rail or rail.profile})
        update = {
            "profile": here.other_wheel or wheel.profile,
            "rolling_radius": here.other_radius or wheel.rolling_radius,
        }
        wheel = wheel.model_copy(update=update)
        return self.model_copy(update={"wheelset": there, "rail": rail, "wheel": wheel})

    @property
    def one_mesh(self) -> bool:
        """Whether the scene is solved on one mesh: neither an accuracy nor a budget is set."""
        return self.accuracy is None and self.budget is None

    def asks(self, name: str) -> bool:
        """Whether a group of `GROUPS` is computed: it is asked for, or needed by one that
        is.
        """
        return name == "patch" or any(name in (each, *GROUPS[each]) for each in self.quantities)

    @property
    def rubs(self) -> bool:
        """Whether friction may act: there is a coefficient, and neither the effect is off nor are
        forces left out.
        """
        return self.friction.acts and self.effects.friction != "off" and self.asks("forces")

    @property
    def tangential_forces(self) -> tuple[str, float, float]:
        """The table that sets the tangential forces of the wheel on the rail ("rolling" or
        "friction"), and the forces along and across the rail, N. A force that is not given is 0.
        """
        if self.rolling.prescribed:
            return "rolling", self.rolling.force_along or 0.0, self.rolling.force_across or 0.0
        return "friction", self.friction.force_along, self.friction.force_across

    @property
    def asymmetric_friction(self) -> tuple[bool, bool]:
        """Two booleans: whether friction breaks the mirror symmetry about x = 0, and about y = 0.
        Both are False without friction.
        """
        friction, rolling = self.friction, self.rolling
        if not self.rubs:
            return False, False
        if rolling.prescribed:
            sideways = rolling.creepage_across or rolling.force_across or rolling.spin
            return True, bool(sideways or rolling.from_wheelset)
        return bool(friction.force_along), bool(friction.force_across)

    @model_validator(mode="after")
    def _half_space_is_a_point_or_line_contact(self) -> Self:
        """Raise SceneError for half-spaces whose relative curvatures make neither a point nor a
        line contact, and for keys that half-spaces cannot use.
        """
        if self.rail.extent == "half-space":
            along, across = self.relative_curvatures()
            if across < 0 or not along + across > 0:
                raise SceneError(
                    "rail.crown_radius, wheel.transverse_radius",
                    f"a relative curvature of {across:.6g} 1/mm is neither a point nor a line "
                    "contact; a half-space needs 1/crown_radius + 1/transverse_radius > 0, or 0 "
                    "with a finite wheel.rolling_radius",
                )
            refuse_unused(self, self._half_space)
        return self

    @property
    def files(self) -> list[Path]:
        """Absolute paths of the files that the scene names."""
        paths = (Path(table[key]) for table, key in file_entries(self.model_dump()))
        return [path for path in paths if path.suffix]

    @property
    def _half_space(self) -> str:
        """Key of `UNUSED_KEYS` for the kind of contact of two half-spaces: point contact,
        line contact curved along the rail, or line contact curved across the rail.
        """
        along, across = self.relative_curvatures()
        if along and across:
            return "half_space"
        return "half_space_along" if along else "half_space_across"

    def relative_curvatures(self) -> tuple[float, float]:
        """Relative curvatures (along, across the rail) of two half-spaces with the radii of the
        scene, 1/mm; negative across where the concave body is the more curved one.

        That along is 1/rolling_radius, as the rail is straight; that across is 1/crown_radius +
        1/transverse_radius (K. L. Johnson, Contact Mechanics, 1985, section 4.1). Standard rails
        have the radius of their crown; cylinders and cones are straight across.
        Raises SceneError for a profile without a single radius (S1002, a file).
        """
        across = 0.0
        for key, profile, radius in (
            ("rail", self.rail.profile, self.rail.crown_radius),
            ("wheel", self.wheel.profile, self.wheel.transverse_radius),
        ):
            radius = radius or NOMINAL_RADIUS.get(profile)
            if radius is None:
                text = f"{show(profile)} has no single radius; a half-space needs one, e.g. arc"
                raise SceneError(f"{key}.profile", text)
            across += 1 / radius
        return 1 / self.wheel.rolling_radius, across

    @classmethod
    def from_mapping(cls, data: Mapping[str, object]) -> Self:
        """The scene of nested tables {key: value or {key: value}}; keys that are left out have
        their defaults. Raises SceneError for the first wrong key or value.
        """
        if not isinstance(data, Mapping):
            raise SceneError(
                "scene", f"{show(data)} is not a table; give one, e.g. {{'load': 25000}}"
            )
        tables: dict[str, Any] = {str(key): value for key, value in data.items()}
        for key, value in tables.items():
            if isinstance(value, Mapping):
                tables[key] = {str(inner): deeper for inner, deeper in value.items()}
        return cls(**tables)

    def replace(self, assignments: Iterable[str] = (), /, **values: object) -> Self:
        """A new scene with some keys changed; this one stays as it is.

        assignments: texts "key=value" with dotted keys; a value that is a TOML scalar or array is
            read as such, anything else as a plain string.
        values: values by key, or tables of them: ``replace(load="110 kN", rail={"profile":
            "60E1"})``.
        Setting the load drops the approach and the reverse; a profile other than ``arc`` drops its
        radius, and the penalty method drops theta. Setting rail.extent to half-space drops the keys
        that half-spaces cannot use, but for those set in the same call. Raises SceneError for a
        wrong key or value, and for a scene that breaks a rule.
        """
        given = assigned(assignments) | dict(dotted(values))
        given = {OTHER_NAMES.get(key, key): value for key, value in given.items()}
        drops = [
            _DROPS[key][0]
            for key, value in given.items()
            if key in _DROPS and not (isinstance(value, str | None) and value in _DROPS[key][1])
        ]
        data: dict[str, Any] = self.model_dump()
        for key, value in (dict.fromkeys(drops) | given).items():
            *above, leaf = key.split(".")
            table = data
            for name in above:
                inner = table.get(name)
                table[name] = dict(inner) if isinstance(inner, dict) else {}
                table = table[name]
            if not above and isinstance(data.get(leaf), dict):
                keys = ", ".join(data[leaf])
                raise SceneError(key, f"{show(value)} is not allowed; set one of its keys: {keys}")
            table[leaf] = value
        if given.get("rail.extent") == "half-space":
            bare = self.from_mapping(without_keys(data, HALF_SPACE - given.keys()))
            data = without_keys(data, UNUSED_KEYS[bare._half_space][1] - given.keys())
        return self.from_mapping(data)

    def value(self, key: str) -> object:
        """The value of a dotted key, in its base unit (`unit`); None where it is not given, for a
        table a dictionary. Raises KeyError for an unknown key.
        """
        return reduce(getitem, OTHER_NAMES.get(key, key).split("."), self.model_dump())


def _units(section: type[Section], above: str = "") -> Iterator[tuple[str, str]]:
    """Dotted keys of a table and of those in it, and the base unit of their values, empty for none.
    above: prefix of the keys with its dot, 'mesh.'.
    """
    for key, field in section.model_fields.items():
        kinds = (field.annotation, *get_args(field.annotation))
        tables = [each for each in kinds if isinstance(each, type) and issubclass(each, Section)]
        for table in tables:
            yield from _units(table, f"{above}{key}.")
        if not tables:
            yield above + key, units.unit(field.annotation, *field.metadata)


def unit(key: str) -> str:
    """Base unit (N, mm, MPa, s, rad, 1/mm, m/s) of the values of a dotted key; empty for keys
    without unit and for unknown keys.
    """
    return dict(_units(Scene)).get(OTHER_NAMES.get(key, key), "")


def unit_questions(*scenes: Scene) -> Iterable[str]:
    """A line for each key with a value that is a thousandth, a thousand or a million times what a
    steel wheel on a rail has: "load = 25 N, 0.001 times what is usual: 25000 N meant?".

    A load is not judged where rail.profile is arc. Of several values of a key the first one is
    named.
    """
    lines: dict[str, str] = {}
    for scene, (key, (low, high)) in product(scenes, USUAL.items()):
        value = scene.value(key)
        if not isinstance(value, float) or (key == "load" and scene.rail.profile == "arc"):
            continue
        for factor in FACTORS:
            if low <= abs(value) / factor <= high:
                said = f"{key} = {value:g} {unit(key)}, {factor:g} times what is usual"
                lines.setdefault(key, f"{said}: {value / factor:g} {unit(key)} meant?")
    return lines.values()


def warn_of_units(*scenes: Scene) -> None:
    """The questions about units in scenes of a script, as warnings of the line that called the
    caller.
    """
    for question in unit_questions(*scenes):
        warnings.warn(question, stacklevel=3)


def checked(scene: object) -> Scene:
    """The argument, if it is a Scene. Raises SceneError for any other object."""
    if not isinstance(scene, Scene):
        raise SceneError("scene", f"{show(scene)} is no Scene; give one, e.g. railhead.find(name)")
    return scene
