"""The tables of a scene: frozen, without unknown keys, and one line of text when wrong.

Lengths are in mm, stresses in MPa, and wherever a number is expected a string with its unit is read
as well. A key that may be None leaves the choice to the plan.
"""

from difflib import get_close_matches
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, model_validator

from railhead.scene import files, units
from railhead.scene.units import Range, show

if TYPE_CHECKING:
    from railhead.theory.array_types import Array


class SceneError(ValueError):
    """Error of a scene or of a command's input, as one line "key: text".

    key: dotted key or option that is wrong.
    text: what the value was and what is allowed there.
    """

    def __init__(self, key: str, text: str) -> None:
        """key: dotted key or option that is wrong; text: what the value was and what is allowed."""
        super().__init__(key, text)
        self.key, self.text = key, text

    def __str__(self) -> str:
        """The line "key: text"; a key with unprintable characters is shown as its `repr`."""
        key = self.key if self.key and self.key.isprintable() else show(self.key)
        return f"{key}: {self.text}"


class ArgumentError(SceneError):
    """Error of an argument of a function, which is an option of a command. key: its name."""


def refuse_first(*rules: tuple[object, str, str], kind: type[SceneError] = SceneError) -> None:
    """Raise an error of a kind for the first rule (broken, key, text) that is broken."""
    for broken, key, text in rules:
        if broken:
            raise kind(key, text)


class Section(BaseModel):
    """Base class of the tables of a scene: a frozen pydantic model without unknown keys.

    Keys are given by name. A wrong key or value raises SceneError. A key with the value "none" has
    its default.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    def __init__(self, /, **data: Any) -> None:
        """Check the given keys. Raises SceneError for the first wrong key or value."""
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise self._first_problem(error) from None

    @model_validator(mode="before")
    @classmethod
    def _unset(cls, data: Any) -> Any:
        """Remove keys of the table whose value is the text "none", so that they get their defaults;
        unknown keys stay, to be refused.
        """
        if not isinstance(data, dict):
            return data
        return {
            key: value
            for key, value in data.items()
            if not (key in cls.model_fields and isinstance(value, str) and value == "none")
        }

    @classmethod
    def _first_problem(cls, error: ValidationError) -> SceneError:
        """The first error of pydantic's ValidationError as a SceneError of one line, which is
        returned, not raised.
        """
        first = error.errors(include_url=False)[0]
        key = str(first["loc"][0]) if first["loc"] else ""  # then the branches of a union
        value = show(first["input"])
        match first["type"]:
            case "value_error":
                cause = first["ctx"]["error"]
                if isinstance(cause, SceneError):  # from within a section, or from a cross check
                    return SceneError(f"{key}.{cause.key}" if key else cause.key, cause.text)
                return SceneError(key, str(cause))
            case "extra_forbidden":
                close = get_close_matches(key, cls.model_fields, n=1)
                hint = f"did you mean {close[0]}? " if close else ""
                allowed = ", ".join(cls.model_fields)
                return SceneError(key, f"unknown key; {hint}allowed here: {allowed}")
            case "literal_error":
                choices = first["ctx"]["expected"].replace("'", "")
                return SceneError(key, f"{value} is not allowed; give {choices}")
            case "bool_parsing" | "bool_type":
                return SceneError(key, f"{value} is not allowed; give true or false")
            case "model_type":
                return SceneError(key, f"{value} is not a table; give [{key}] and its keys")
            case "missing":
                choices = ", ".join(map(str, get_args(cls.model_fields[key].annotation)))
                return SceneError(key, f"is missing; give {choices}")
            case _:  # string_unicode: half of a surrogate pair, in a key or in a value
                return SceneError(key, f"{value} is not Unicode text; give whole characters")


def _pairs(value: object, first: Range, least: int, allowed: str) -> tuple[files.Pair, ...]:
    """Pairs of a number, rising, and a coefficient of friction above 0, `least` of them at least.
    first: range of the rising numbers; allowed: words of messages. Raises ValueError (one line) for
    anything else.
    """
    wrong = f"{show(value)} is not allowed; {allowed}"
    try:
        pairs = tuple((first(at), units.PAIRED_COEFFICIENT(mu)) for at, mu in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError) as error:
        raise ValueError(f"{wrong} ({error})") from None
    if len(pairs) < least or any(after[0] <= before[0] for before, after in pairwise(pairs)):
        raise ValueError(wrong)
    return pairs


def _coefficient(value: object) -> object:
    """A coefficient of friction from 0 to 2, or pairs (angle in degrees, coefficient above 0) with
    rising angles. Raises ValueError (one line) for anything else.
    """
    if isinstance(value, list | tuple):
        return _pairs(value, units.SURFACE_ANGLE, 1, PAIRS)
    return units.COEFFICIENT(value)


def _table(value: object) -> object:
    """Pairs (temperature in deg C, coefficient above 0) with rising temperatures. Raises ValueError
    (one line) for anything else.
    """
    return _pairs(value, units.TEMPERATURE_RANGE, 2, TABLE)


TABLE = "give pairs of a temperature, rising, and a coefficient, e.g. [[0, 0.3], [400, 0.12]]"
PAIRS = "give pairs with rising angles, e.g. [[0, 0.4], [60, 0.1]]"
_SWITCHED = {"True": "on", "true": "on", "False": "off", "false": "off"}
Switch = Annotated[
    Literal["auto", "on", "off"],
    BeforeValidator(
        lambda value: _SWITCHED.get(str(value), value) if isinstance(value, bool | str) else value
    ),
]


class Solver(Section):
    """Contact method and linear solver. No effect where half-spaces answer (effects.finite_bodies
    off).

    method: "nitsche" (Nitsche's method) or "penalty".
    theta: symmetry parameter of Nitsche's method: 1 (symmetric), 0 or -1 (skew). None: 1 for
        gamma_factor of at least 1, else -1; with yield and friction 0. Not allowed with method
        penalty.
    gamma_factor: factor on the default stabilisation of Nitsche's method or on the default penalty.
    linear: solver of linear systems: "direct", "multigrid", or "auto", which chooses by the cells
        and the number of unknowns.
    tolerance: of Newton's method, residual over the contact force, 1e-10 to 1e-3. None: a share of
        the expected error of the mesh.
    max_newton: largest number of steps of Newton's method in each solve of the pressure, 1 to 200;
        tractions have a limit of their own.
    """

    method: Literal["nitsche", "penalty"] = "nitsche"
    theta: Annotated[int, Range(units.NUMBER, -1, 1, whole=True, words="1, 0 or -1")] | None = None
    gamma_factor: Annotated[
        float,
        Range(units.NUMBER, 0, units.LARGEST, excluded=(0,), words="a positive, finite number"),
    ] = 1.0
    linear: Literal["auto", "direct", "multigrid"] = "auto"
    tolerance: Annotated[float, Range(units.NUMBER, 1e-10, 1e-3, note=", e.g. 1e-8")] | None = None
    max_newton: Annotated[int, Range(units.NUMBER, 1, 200, whole=True)] = 30

    @model_validator(mode="after")
    def _theta_of_nitsche(self) -> Self:
        """Raise SceneError where theta is given with the penalty method."""
        if self.method == "penalty" and self.theta is not None:
            raise SceneError("theta", f"{self.theta} is not allowed; only method nitsche takes it")
        return self


class Mesh(Section):
    """Elements of the bodies. No effect where half-spaces answer (effects.finite_bodies off).

    cell: "tetrahedron" or "hexahedron"; in a section these stand for triangles and quadrilaterals.
    order: polynomial order of the elements, 1 or 2; None: 2 for tetrahedra, 1 for hexahedra.
    patch_size: mm, size of the elements in the contact patch, not allowed beside accuracy or
        budget; None: the plan chooses.
    """

    cell: Literal["tetrahedron", "hexahedron"] = "tetrahedron"
    order: Annotated[int, Range(units.NUMBER, 1, 2, whole=True, words="1 or 2")] | None = None
    patch_size: Annotated[float, Range(units.LENGTH, 1e-9, 1e6)] | None = None

    @property
    def linear(self) -> bool:
        """Whether the cells are tetrahedra (in a section triangles) of order 1, which lock; False
        of hexahedra.
        """
        return self.cell == "tetrahedron" and self.order == 1


class Friction(Section):
    """Friction, what lies between the surfaces, and forces that shift the wheel from rest.

    coefficient: friction coefficient, 0 to 2; 0: no friction. Or pairs (angle, coefficient) with
        rising angles of the rail's surface across the track, degrees, positive where it rises to
        the field side; linear between them, constant beyond.
        It is the static coefficient of every law but temperature, which has that of `table` at the
        bulk temperature.
    law: "coulomb": the coefficient is the same at every slip and temperature. "exponential",
        "linear": it falls with the slip velocity from `coefficient` to `kinetic`. "temperature": it
        is that of `table`. All but coulomb need rolling.speed.
    kinetic: coefficient at large slip velocities, above 0 to 2; of exponential and linear.
    slip_half: mm/s, slip velocity at which half of the difference is gone; of both as well.
    memory: mm, length along which the coefficient follows its law; None: the length of a cell where
        it falls with slip, else 0.
    table: pairs (temperature in deg C, coefficient), linear between, constant beyond; of
        temperature. `coefficient` may be left out beside it.
    layer_thickness: mm, of an elastic layer between the surfaces; None: no layer.
    layer_modulus: MPa, its shear modulus.
    force_along: N, tangential force of the wheel on the rail along x, along the rail, reached from
        rest. The key tangential_load is another name of this one.
    force_across: N, tangential force of the wheel on the rail across it, along the common tangent
        to the field side.
    """

    coefficient: Annotated[
        float | tuple[tuple[float, float], ...], BeforeValidator(_coefficient)
    ] = 0.0
    law: Literal["coulomb", "exponential", "linear", "temperature"] = "coulomb"
    kinetic: Annotated[float, units.PAIRED_COEFFICIENT] | None = None
    slip_half: Annotated[float, Range(units.SLIP_SPEED, 1e-6, 1e9)] | None = None
    memory: Annotated[float, Range(units.LENGTH, 0, 1e6)] | None = None
    table: Annotated[tuple[tuple[float, float], ...], BeforeValidator(_table)] | None = None
    layer_thickness: Annotated[float, Range(units.LENGTH, 1e-9, 10)] | None = None
    layer_modulus: units.Stress | None = None
    force_along: units.SignedForce = 0.0
    force_across: units.SignedForce = 0.0

    @model_validator(mode="before")
    @classmethod
    def _other_name(cls, data: Any) -> Any:
        """Replace the key tangential_load by force_along. Raises SceneError where both are set."""
        if not isinstance(data, dict) or "tangential_load" not in data:
            return data
        both = data.get("force_along")
        refuse_first((both, "tangential_load", "is not allowed beside force_along; give one"))
        rest = {key: value for key, value in data.items() if key != "tangential_load"}
        return rest | {"force_along": data["tangential_load"]}

    @model_validator(mode="after")
    def _keys_of_the_law(self) -> Self:
        """Raise SceneError for the first key that the law lacks or has no use for, for another
        coefficient than that of the table, and for half of a layer.
        """
        falls, table = self.law in ("exponential", "linear"), self.table
        missing, useless = f"is missing; law {self.law} needs it", f"has no use in law {self.law}"
        first = table[0][1] if table else 0.0
        layer = (self.layer_thickness, "layer_thickness"), (self.layer_modulus, "layer_modulus")
        refuse_first(
            *(
                rule
                for key in ("kinetic", "slip_half")
                for given in [getattr(self, key) is not None]
                for rule in ((falls and not given, key, missing), (given > falls, key, useless))
            ),
            (self.law == "temperature" and table is None, "table", missing),
            (self.law != "temperature" and table is not None, "table", useless),
            (self.law == "coulomb" and self.memory is not None, "memory", useless),
            (
                self.law == "temperature" and self.coefficient not in (0.0, first),
                "coefficient",
                f"{show(self.coefficient)} is not the first of the table, {first:g}; leave it out",
            ),
            *(
                (value is None and other is not None, key, f"is missing beside {beside}")
                for (value, key), (other, beside) in (layer, layer[::-1])
            ),
        )
        return self

    @property
    def acts(self) -> bool:
        """Whether there is a coefficient above 0."""
        return self.largest > 0

    @property
    def largest(self) -> float:
        """Largest coefficient of all angles, slips and temperatures."""
        return max(self.given)

    @property
    def given(self) -> list[float]:
        """Coefficients of all keys: of every angle, slip and temperature one between them."""
        kinetic = [] if self.kinetic is None else [self.kinetic]
        return [mu for _, mu in self.table or self.pairs] + kinetic

    @property
    def uneven(self) -> bool:
        """Whether the coefficient depends on the angle of the rail's surface."""
        return len({coefficient for _, coefficient in self.pairs}) > 1

    @property
    def pairs(self) -> tuple[tuple[float, float], ...]:
        """Pairs of an angle, degrees, and `coefficient` there; a single one of a number."""
        given = self.coefficient
        return ((0.0, given),) if isinstance(given, float) else given

    def at(self, angle: "Array | float", bulk: float) -> "Array":
        """Static coefficient of friction (n,) where the rail's surface has the angle (n,) to the
        horizontal across the track, rad; of a table its value at the temperature `bulk`, deg C.
        """
        import numpy as np  # not before `process.prepare`

        if self.table:
            return np.interp(np.full(np.shape(angle), bulk), *np.transpose(self.table))
        angles, values = np.transpose(self.pairs)
        return np.interp(np.degrees(angle), angles, values)


class Rolling(Section):
    """Steady rolling of the wheel towards positive x. Without friction.coefficient only passes have
    an effect.

    Along and across, either a creepage or a force may be given, not both. Beside from_wheelset no
    creepage, spin or force_across is allowed. Creepages are the velocity of the wheel's surface
    relative to the rail's over the rolling speed. A creepage of 0 prescribes rolling, too. Where
    one direction is not given and another makes the wheel roll, its creepage is 0.

    from_wheelset: whether creepages and spin follow from the position of the wheelset.
    axle: beside from_wheelset, the radius by which the axle turns: the mean of both wheels' rolling
        radii ("free"), wheel.rolling_radius ("nominal"), or that at which the moments of both
        wheels' creep forces about the axle cancel ("torque_free").
    creepage_along: creepage along the rail, -1 to 1; None: not given.
    creepage_across: creepage across the rail, -1 to 1; None: not given.
    force_along: N, tangential force of the wheel on the rail to be met along the rail (+x); the
        creepage follows. None: not given.
    force_across: N, tangential force of the wheel on the rail to be met across it, along the common
        tangent to the field side; the creepage follows. None: not given.
    spin: 1/mm, angular velocity about the normal out of the rail over the rolling speed.
    speed: m/s, for the friction power, temperatures and laws of friction; None: there are none.
    passes: how often the wheel rolls over a rail that yields, 1 to 1000; None: not simulated.
    pressure: beside passes, "contact": the pressure follows from the rail as the passes leave it;
        "hertz": the elastic pressure is kept.
    wheels: number of wheels to which passes that ratchet steadily are extrapolated; None: not.
    """

    from_wheelset: bool = False
    axle: Literal["free", "nominal", "torque_free"] = "free"
    creepage_along: units.Creepage | None = None
    creepage_across: units.Creepage | None = None
    force_along: units.SignedForce | None = None
    force_across: units.SignedForce | None = None
    spin: Annotated[float, Range(units.SPIN, -1, 1)] = 0.0
    speed: units.Speed | None = None
    passes: Annotated[int, Range(units.NUMBER, 1, 1000, whole=True)] | None = None
    pressure: Literal["contact", "hertz"] = "contact"
    wheels: Annotated[int, Range(units.NUMBER, 2, 10_000_000, whole=True)] | None = None

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        """Raise SceneError for a creepage and a force in one direction, for a key that
        from_wheelset gives, for an axle without from_wheelset, for a force along on an axle without
        torque, for a speed without rolling, for a pressure without passes, and for wheels that are
        not more than the passes.
        """
        along = None not in (self.creepage_along, self.force_along)
        across = None not in (self.creepage_across, self.force_across)
        given = self.model_dump(exclude_defaults=True) if self.from_wheelset else {}
        refuse_first(
            (along, "force_along", "is not allowed beside creepage_along; give one"),
            (across, "force_across", "is not allowed beside creepage_across; give one"),
            *(
                (key in given, key, "is not allowed beside from_wheelset, which gives it")
                for key in ("creepage_along", "creepage_across", "force_across", "spin")
            ),
            (
                self.axle != "free" and not self.from_wheelset,
                "axle",
                f"{self.axle} is not allowed without from_wheelset",
            ),
            (
                self.axle == "torque_free" and self.force_along is not None,
                "force_along",
                "is not allowed beside an axle that is torque_free; give free or nominal",
            ),
            (
                self.speed is not None and not self.prescribed,
                "speed",
                "is not allowed without a creepage, spin or force; give one",
            ),
            (
                self.pressure != "contact" and self.passes is None,
                "pressure",
                f"{self.pressure} is not allowed without passes",
            ),
            (
                self.wheels is not None and self.wheels <= (self.passes or self.wheels),
                "wheels",
                f"{self.wheels} is not allowed; give passes, and more wheels than passes",
            ),
        )
        return self

    @property
    def prescribed(self) -> bool:
        """Whether a creepage, a force, a spin or the wheelset prescribes steady rolling: a creepage
        or force of 0 does, a spin of 0 does not.
        """
        chosen = (self.creepage_along, self.creepage_across, self.force_along, self.force_across)
        return self.from_wheelset or any(value is not None for value in chosen) or self.spin != 0


class Heat(Section):
    """Warmth of the bodies and constants of their material, for temperatures of their surfaces.
    Constants of steel: Ertz and Knothe, Wear 253 (2002) 498.

    bulk_rail, bulk_wheel: deg C, temperatures far from the patch.
    conductivity: W/(m K).
    density: kg/m3.
    specific_heat: J/(kg K).
    share: of the heat of friction that the rail takes, 0 to 1.
    """

    bulk_rail: units.Temperature = 0.0
    bulk_wheel: units.Temperature = 0.0
    conductivity: units.ThermalConstant = 50.0
    density: units.ThermalConstant = 7850.0
    specific_heat: units.ThermalConstant = 450.0
    share: units.Share = 0.5

    @property
    def bulk(self) -> float:
        """Temperature that both surfaces have where they touch without slip, deg C."""
        return (self.bulk_rail + self.bulk_wheel) / 2

    @property
    def known(self) -> bool:
        """Whether a constant of the material is given that is not that of steel."""
        given = self.model_dump(exclude_defaults=True)
        return bool(given.keys() & {"conductivity", "density", "specific_heat"})


def _law(value: object) -> str:
    """A law of wear: 'energy', 'usfd' or the absolute path of a .csv file of pairs. Raises
    ValueError (one line) for another value and a file that holds no pairs.
    """
    if value in ("energy", "usfd"):
        return str(value)
    if not str(value).lower().endswith(".csv"):
        raise ValueError(f"{show(value)} is not allowed; give energy, usfd or a .csv file of pairs")
    path = files.existing(value, (".csv",))
    files.wear_pairs(path)
    return path


class Wear(Section):
    """Wear of rail and wheel over a route; only `railhead wear` reads it.

    law: "energy": one `rate`; "usfd": rates of twin discs by T-gamma over the area; or the path of
        a .csv file of pairs: T-gamma over the area, N/mm2, and ug worn per m rolled and mm2.
    rate: of law energy, worn volume over dissipated energy, mm3/(N mm), the same of both bodies.
    on: what is worn: "rail", "wheel" or "both".
    axles: number of wheels that pass the rail. Needed where the rail is worn.
    distance: mm that the wheel rolls. Needed where the wheel is worn.
    positions: path of a .csv file of the route: a row a position, its first line keys of a scene,
        and "share" of the passages, of which the sum counts as 1; without it all are alike. None:
        the scene alone.
    step: number of equal steps, each solved whole and in two halves; "auto": as many as the
        accuracy needs.
    accuracy: largest relative error of largest depth and worn area, by steps and grids.
    depth_limit: mm; None: none. The result says when each limit is reached.
    flange_limit: mm, least thickness of the flange; None: none.
    conicity_limit: largest equivalent conicity at 3 mm; None: none.
    """

    law: Annotated[str, BeforeValidator(_law)] = "energy"
    rate: Annotated[float, Range(units.NUMBER, 1e-12, 1.0, note=" mm3/(N mm)")] = 6.75e-7
    on: Literal["rail", "wheel", "both"] = "rail"
    axles: Annotated[float, Range(units.NUMBER, 1, 1e12)] | None = None
    distance: Annotated[float, Range(units.LENGTH, 1e3, 1e15, note=', e.g. "1000 km"')] | None = (
        None
    )
    positions: (
        Annotated[str, BeforeValidator(partial(files.existing, suffixes=(".csv",)))] | None
    ) = None
    step: (
        Annotated[int, Range(units.NUMBER, 1, 1000, whole=True, words="auto or 1 to 1000")]
        | Literal["auto"]
    ) = "auto"
    accuracy: units.Accuracy = 0.01
    depth_limit: Annotated[float, Range(units.LENGTH, 1e-6, 50)] | None = None
    flange_limit: Annotated[float, Range(units.LENGTH, 1, 100)] | None = None
    conicity_limit: Annotated[float, Range(units.NUMBER, 1e-3, 2)] | None = None

    @model_validator(mode="after")
    def _rate_of_energy(self) -> Self:
        """Raise SceneError for a rate beside another law than energy."""
        if self.law != "energy" and self.rate != type(self).model_fields["rate"].default:
            raise SceneError("rate", f"{self.rate:g} is not allowed; only law energy takes it")
        return self


class Effects(Section):
    """Physical effects and simplifications: each is "on", "off", or "auto", which leaves the choice
    to the plan. A value that is not allowed raises SceneError when the scene is planned. Where
    half-spaces answer (finite_bodies off), effects of meshed bodies cannot be on.

    symmetry: value of symmetry_x and symmetry_y where these are "auto".
    plane_strain: on: a line contact is solved in a plane section. off: as a solid; not allowed
        without curvature along or across the rail. on is not allowed where the contact is no line.
    axisymmetry: on: bodies of revolution about the contact's normal are solved in a meridian
        section. off: as a solid. on is not allowed for other bodies, nor with a tangential force,
        creepage or spin.
    symmetry_x: on: only x >= 0 is solved. off: both halves. on is not allowed where x = 0 is no
        plane of symmetry.
    symmetry_y: on: only y >= 0 is solved. off: both halves. on is not allowed where y = 0 is no
        plane of symmetry.
    deformable_rail: on: the rail deforms. off: it is rigid, and only its exact surface takes part.
        on is not allowed for an infinite modulus, off not for both bodies.
    deformable_wheel: the same of the wheel.
    rail_section: on: a standard rail is meshed with web and foot and held at its foot. off: its
        head alone, held at the cut. on is not allowed for other rails and for half-spaces.
    far_field: on: the outer faces of the blocks of half-spaces follow the displacement of the
        half-spaces. off: they are held. on is not allowed for bodies that end.
    finite_bodies: on: finite elements on meshed bodies. off: half-spaces answer without a mesh, by
        exact Hertz or boundary elements; not allowed in sections of bodies that end, beside an
        approach of such bodies, and beside a budget.
    surface_shape: on: the gap is that of the surfaces with rail.surface and wheel.surface. off:
        that of the smooth ones. on is not allowed where nothing is added to them.
    mean_dilatation: on: the volume change is constant in each cell, so that nearly incompressible
        cells do not lock. off: it is not. on needs quadratic tetrahedra or triangles.
    plasticity: on: bodies with a yield stress yield, where stresses reach it. off: they stay
        elastic. on is not allowed without a yield stress, without finite_bodies, and with friction
        where bodies roll or differ in material.
    friction: on: Coulomb friction. off: frictionless contact. on is not allowed for a coefficient
        of 0, and where half-spaces cannot answer it.
    passes: on: the wheel rolls rolling.passes times over a rail that yields. off: it does not. on
        is not allowed without rolling.passes.
    plasticity_wheel: on: the wheel yields in passes, too. off: it stays elastic there. on is not
        allowed without passes, and for a wheel without a yield stress.
    heat: on: surface temperatures are simulated. off: they are not; not allowed beside a
        coefficient that depends on them. on is not allowed without friction and rolling.speed, and
        for bodies whose tractions are condensed.
    falling_friction: on: the coefficient follows friction.law. off: it is the static one
        everywhere.
    layer: on: the layer of [friction] shears. off: it does not.
    """

    symmetry: Switch = "auto"
    plane_strain: Switch = "auto"
    axisymmetry: Switch = "auto"
    symmetry_x: Switch = "auto"
    symmetry_y: Switch = "auto"
    deformable_rail: Switch = "auto"
    deformable_wheel: Switch = "auto"
    rail_section: Switch = "auto"
    far_field: Switch = "auto"
    finite_bodies: Switch = "auto"
    surface_shape: Switch = "auto"
    mean_dilatation: Switch = "auto"
    plasticity: Switch = "auto"
    friction: Switch = "auto"
    passes: Switch = "auto"
    plasticity_wheel: Switch = "auto"
    heat: Switch = "auto"
    falling_friction: Switch = "auto"
    layer: Switch = "auto"

    def state(self, name: str) -> Switch:
        """The value ("auto", "on" or "off") of the key `name`, as it was given, whether or not it
        is allowed; for symmetry_x and symmetry_y that are "auto", the value of `symmetry`.
        """
        choice: Switch = getattr(self, name)
        return self.symmetry if choice == "auto" and name.startswith("symmetry") else choice
