"""The tables of a scene that describe bodies: [rail] and [wheel], their surfaces, [wheelset].

Steels yield as data/steels.json says, with sources. EN 13674-1 fixes strength and hardness of rail
steels, not their yield: R260's was measured. EN 13262 fixes the least yield strength of wheels. Of
these no flow curve with a source was at hand; 1070 has constants of measured cycles.
"""

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, model_validator

from railhead.geometry.measured import BODY_BY_EXTENSION, EXTENSIONS
from railhead.scene import files, units
from railhead.scene.sections import SceneError, Section, Switch, refuse_first
from railhead.scene.units import Range, show

ALIASES = {"UIC54": "54E1", "UIC60": "60E1"}
GAUGE_HEIGHT = 14.0  # mm, of EN 13848-1
RAILS, WHEELS = ("54E1", "60E1"), ("cylinder", "cone20", "cone40", "S1002")
"""Names of the profiles that have no key of their own."""
_FILE_KEYS = (
    "profile_unit",
    "profile_mirror",
    "profile_flip",
    "profile_origin",
    "profile_shift",
    "smoothing",
)
_PLAIN_KEYS = ("profile", "profile_origin", "inclination", "gauge", "extent", "depth", "width")
_STRAIGHT = {"sections", "gauge", "extent"}


def _profile(body: str, *names: str) -> BeforeValidator:
    """A pydantic validator of the key `profile` of a body ("rail" or "wheel").

    names: names of the allowed standard profiles, in capitals or not. The validator returns one of
        them (UIC54 and UIC60 become 54E1 and 60E1) or the absolute path of a readable profile file.
        It raises ValueError (one line) for anything else.
    """
    suffixes = [suffix for suffix in EXTENSIONS if BODY_BY_EXTENSION.get(suffix, body) == body]
    kinds = f"a {', '.join(suffixes[:-1])} or {suffixes[-1]} file"
    known = {name.casefold(): ALIASES.get(name, name) for name in (*ALIASES, *names)}

    def validate(value: object) -> str:
        """The name of a standard profile or the absolute path of a file. Raises ValueError."""
        text = str(value)
        if (name := known.get(text.casefold())) in names:
            return name
        if not text.lower().endswith(tuple(suffixes)):
            quoted = "a text in quotes: " if isinstance(value, int | float) else ""
            allowed = quoted + ", ".join(names)
            raise ValueError(f"{show(value)} is not allowed; give {allowed} or {kinds}")
        path = os.path.abspath(text)
        if not files.readable(path):
            raise ValueError(f"{show(value)} is not a readable file; give {kinds} that exists")
        return path

    return BeforeValidator(validate)


def is_profile_file(profile: str) -> bool:
    """Whether a checked profile is the path of a file, not the name of a standard profile."""
    return os.path.isabs(profile)


def _curve(value: object) -> str:
    """The absolute path of a .csv file with a stress-strain curve. Raises ValueError (one line) for
    a file that cannot be read or that holds no valid curve (`files.read_curve`).
    """
    path = files.existing(value, (".csv",))
    files.read_curve(path)
    return path


def _two(value: object) -> object:
    """A list of two numbers, or its text "[1, 2]", as a tuple. Raises ValueError (one line) for
    anything else.
    """
    if isinstance(value, str):
        value = value.strip().removeprefix("[").removesuffix("]").split(",")
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise ValueError(f"{show(value)} is not allowed; give two of them, e.g. [0, -1.5]")
    return tuple(value)


STEEL_MODULI = (180e3, 230e3)  # MPa, least and largest Young's modulus of a steel


def _pairs(value: Any) -> object:
    """A list of pairs, or its text "[[1, 2], [3, 4]]", as tuples. Raises ValueError (one line) for
    anything else.
    """
    with suppress(ValueError):
        value = json.loads(value) if isinstance(value, str) else value
    lists = isinstance(value, (list, tuple)) and value
    if not lists or not all(isinstance(each, (list, tuple)) and len(each) == 2 for each in value):
        text = "give pairs of C (MPa) and g, e.g. [[40000, 100], [10000, 10]]"
        raise ValueError(f"{show(value)} is not allowed; {text}")
    return tuple(tuple(each) for each in value)


Fatigue = Annotated[
    tuple[Annotated[float, Range(units.NUMBER, 0, 10)], units.Stress], BeforeValidator(_two)
]
"""Weight of a normal stress beside the shear stress, and limit of their sum, MPa."""

Law = tuple[Sequence[tuple[float, float]], float, tuple[float, float]]
"""Pairs (C in MPa, g) of back stresses, their recall exponent, and Voce's (Q in MPa, b)."""


@dataclass(frozen=True)
class Steel:
    """A steel; without back stresses it does not harden.

    yield_stress: of uniaxial tension, MPa.
    kind: where the value comes from, in a few words.
    source: the publication.
    backstress: pairs (C in MPa, g); recall_exponent: of all of them.
    """

    yield_stress: float
    kind: str
    source: str
    backstress: tuple[tuple[float, float], ...] = ()
    recall_exponent: float = 0.0


@cache
def steels() -> dict[str, Steel]:
    """The steels of data/steels.json by name, read once."""
    text = (Path(__file__).parent / "data" / "steels.json").read_text(encoding="utf-8")
    return {name: Steel(**entry) for name, entry in json.loads(text).items()}


def is_steel(modulus: float) -> bool:
    """Whether a Young's modulus (MPa) lies in the range of steels, 180 to 230 GPa."""
    return STEEL_MODULI[0] <= modulus <= STEEL_MODULI[1]


def _steel_name(value: object) -> str:
    """The argument, if it is the name of a steel in data/steels.json. Raises ValueError (one line)
    for anything else.
    """
    if str(value) in steels():
        return str(value)
    allowed = f"give {', '.join(steels())}, or a yield_stress instead"
    raise ValueError(f"{show(value)} is not allowed; {allowed}")


class Surface(Section):
    """A height that is added to the surface of a body, outwards, and varies along it.

    kind: "flat", a hollow; "cosine", waves; "map", heights from a file.
    length: mm, of a flat along the surface, or of a wave.
    depth: mm, of a flat that is rounded, -depth/2 (1 + cos(2 pi x / length)); None: a wheel is cut
        off in a plane, which makes its depth.
    amplitude: mm, of waves amplitude cos(2 pi x / length); negative has a trough at 0.
    file: of a map: a .csv file with x, y and height, a row for each place of a grid, in the order
        and units of its header, else in mm; or a .npz file with arrays x (n,), y (m,) and height
        (n, m) in mm.
    position: mm, place x of the flat, the waves or the map at which the smooth bodies touch, or an
        angle of the wheel, which becomes an arc of its rolling radius. x grows to where it rolls.
    """

    kind: Literal["flat", "cosine", "map"]
    length: units.BodyLength | None = None
    depth: Annotated[float, Range(units.LENGTH, 0, 100)] | None = None
    amplitude: units.Displacement | None = None
    file: (
        Annotated[str, BeforeValidator(partial(files.existing, suffixes=(".csv", ".npz")))] | None
    ) = None
    position: units.Position = 0.0

    @model_validator(mode="after")
    def _keys_of_the_kind(self) -> Self:
        """Raise SceneError for a key that the kind needs and that is missing, and for one that it
        has no use for.
        """
        needs = {"flat": {"length"}, "cosine": {"length", "amplitude"}, "map": {"file"}}[self.kind]
        for key in ("length", "depth", "amplitude", "file"):
            given = getattr(self, key) is not None
            if not given and key in needs:
                raise SceneError(key, f"not given; kind {self.kind} needs it")
            if given and key not in needs and (self.kind, key) != ("flat", "depth"):
                raise SceneError(key, f"is not allowed beside kind {self.kind}; leave it out")
        return self


class BodySection(Section):
    """Material of a rail or a wheel, and how the file of its profile is read.

    At most one of steel, yield_stress and stress_strain may be given; with none of them the body is
    elastic. Keys of the file are only allowed where the profile is a file; "auto" derives them from
    the points.

    young_modulus: MPa; inf is a rigid body, which is not meshed; not for both bodies.
    poisson_ratio: 0 to below 0.5.
    steel: name of a steel with a known yield stress; None: no steel.
    yield_stress: MPa; None: no yield stress.
    hardening_modulus: MPa, derivative of stress by plastic (not total) strain beyond yield_stress;
        None: no hardening. Only beside yield_stress.
    kinematic_fraction: share of the hardening that moves the yield surface, 0 to 1; the rest widens
        the surface. None: not given. Only in a body that yields.
    backstress: pairs (C in MPa, g) of back stresses that are recalled; g = 0: Prager's. None: none.
        Only beside yield_stress.
    recall_exponent: of all back stresses; 0: Armstrong and Frederick, 1 to 30: Jiang and Sehitoglu.
        None: 0. Only beside backstress.
    isotropic: Voce's (Q in MPa, b), by which the yield stress grows. None: it does not. Only beside
        yield_stress.
    dang_van: weight of the hydrostatic stress in Dang Van's stress, and its limit, MPa, both of a
        test of the steel. None: the weight is 0.33, and nothing is compared with a limit.
    findley: weight of the normal stress in Findley's stress, and its limit, MPa. None: the weight
        is 0.3, and nothing is compared with a limit.
    stress_strain: path of a .csv file, a row of plastic strain and true stress (MPa) a line, whose
        header may name another order and units; None: no curve.
    profile_unit: unit of the file's numbers: "auto", "mm", "m" or "inch".
    profile_mirror: "on": left and right of the file are exchanged, "off": they are not, or "auto".
    profile_flip: "on": up and down of the file are exchanged, "off": they are not, or "auto".
    profile_shift: mm, (y, z) by which the profile is moved at last, in the axes of profiles.
    smoothing: mm, wavelength of waves that keep half of their height; "auto" chooses by the noise.
    surface: table of a height that varies along the surface, a `Surface`; None: it is smooth.
    """

    _ARC_KEYS: ClassVar[tuple[str, ...]]  # only beside profile arc
    young_modulus: Annotated[
        float, Range(units.STRESS, 1e-12, 1e15, note="; inf is rigid", infinite=True)
    ] = 207000.0
    poisson_ratio: Annotated[
        float, Range(units.NUMBER, 0, 0.5, note=", but not 0.5 itself", excluded=(0.5,))
    ] = 0.3
    steel: Annotated[str, BeforeValidator(_steel_name)] | None = None
    yield_stress: units.Stress | None = None
    hardening_modulus: units.Hardening | None = None
    kinematic_fraction: units.Share | None = None
    backstress: (
        Annotated[
            tuple[tuple[units.Stress, units.Recall], ...],
            BeforeValidator(_pairs),
        ]
        | None
    ) = None
    recall_exponent: Annotated[float, Range(units.NUMBER, 0, 30)] | None = None
    isotropic: Annotated[tuple[units.Hardening, units.Recall], BeforeValidator(_two)] | None = None
    dang_van: Fatigue | None = None
    findley: Fatigue | None = None
    stress_strain: Annotated[str, BeforeValidator(_curve)] | None = None
    profile_unit: Literal["auto", "mm", "m", "inch"] = "auto"
    profile_mirror: Switch = "auto"
    profile_flip: Switch = "auto"
    profile_shift: Annotated[
        tuple[units.Displacement, units.Displacement], BeforeValidator(_two)
    ] = (0.0, 0.0)
    smoothing: (
        Annotated[float, Range(units.WAVELENGTH, 1, 100, words=units.WAVELENGTH.hint)]
        | Literal["auto"]
    ) = "auto"
    surface: Surface | None = None

    @model_validator(mode="after")
    def _one_way_to_yield(self) -> Self:
        """Raise SceneError for two of steel, stress_strain and yield_stress, and for a
        hardening_modulus or a kinematic_fraction without what they need.
        """
        given = [key for key in ("steel", "stress_strain", "yield_stress") if getattr(self, key)]
        kinematic = self.kinematic_fraction
        cyclic = ("hardening_modulus", "backstress", "isotropic")
        refuse_first(
            *(
                (True, key, f"is not allowed beside {given[0]}; give one of them")
                for key in given[1:]
            ),
            *(
                (True, key, "is not allowed without yield_stress")
                for key in cyclic
                if getattr(self, key) is not None and given != ["yield_stress"]
            ),
            (
                self.recall_exponent is not None and self.backstress is None,
                "recall_exponent",
                "is not allowed without backstress",
            ),
            (
                0 < (self.recall_exponent or 0.0) < 1,
                "recall_exponent",
                f"{self.recall_exponent} is not allowed; give 0, or 1 to 30",
            ),
            (
                kinematic is not None and bool(self.law[0]),
                "kinematic_fraction",
                "is not allowed beside back stresses; give a backstress [C, 0] instead",
            ),
            (
                kinematic is not None and not given,
                "kinematic_fraction",
                "is not allowed without steel, yield_stress or stress_strain",
            ),
        )
        return self

    @model_validator(mode="after")
    def _keys_of_the_profile(self) -> Self:
        """Raise SceneError for an arc without radius, for a key of an arc beside another profile,
        and for a key that says how a file is read where the profile is no file.
        """
        profile: str = getattr(self, "profile", "")
        for key in self._ARC_KEYS:
            value = getattr(self, key)
            if profile == "arc" and value is None and key.endswith("radius"):
                raise SceneError(key, 'not given; profile arc needs it, e.g. 80 or "80 mm"')
            if profile != "arc" and value is not None:
                raise SceneError(key, f"{value:g} is not allowed; only profile arc takes it")
        given = self.model_dump(exclude_defaults=True, include={*_FILE_KEYS})
        drawn = getattr(self, "sections", None)
        if given and not (drawn or is_profile_file(profile)):
            key, value = next(iter(given.items()))
            raise SceneError(key, f"{value} is not allowed; only a profile from a file takes it")
        return self

    @property
    def yields(self) -> bool:
        """Whether the body has a yield stress, so that yield may be simulated: a steel, a yield
        stress or a curve is set.
        """
        return bool(self.steel or self.stress_strain or self.yield_stress)

    @property
    def curve(self) -> tuple[tuple[float, float], ...]:
        """Points (plastic strain, true stress in MPa) of the flow curve: of `steel`, of the file
        `stress_strain`, or `yield_stress` at zero strain. After the last point the slope is
        `hardening_modulus`, or zero without it. Empty for a body that stays elastic.
        """
        if self.yield_stress is not None:
            return ((0.0, self.yield_stress),)
        if self.steel is not None:
            return ((0.0, steels()[self.steel].yield_stress),)
        if self.stress_strain is not None:
            return files.read_curve(self.stress_strain)
        return ()

    @property
    def law(self) -> Law:
        """What cycles add to the flow curve, of `steel` or of the keys."""
        if self.steel is not None:
            steel = steels()[self.steel]
            return steel.backstress, steel.recall_exponent, (0.0, 0.0)
        return self.backstress or (), self.recall_exponent or 0.0, self.isotropic or (0.0, 0.0)

    @property
    def cyclic(self) -> bool:
        """Whether the steel has back stresses that are recalled, or Voce's growth."""
        return bool(self.law[0]) or self.isotropic is not None

    @property
    def first_yield(self) -> float:
        """Yield stress of a body that yields, before any hardening, MPa."""
        return float(self.curve[0][1])

    @property
    def hardens(self) -> bool:
        """Whether a body that yields hardens in any way."""
        grows = self.curve[-1][1] > self.curve[0][1]
        return bool(self.hardening_modulus) or grows or self.cyclic


class Rail(BodySection):
    """A straight rail.

    Inherited from `BodySection`: young_modulus (MPa), poisson_ratio, steel, yield_stress (MPa),
    hardening_modulus (MPa), kinematic_fraction, stress_strain (a file), and for a profile's file
    profile_unit, profile_mirror, profile_flip, profile_shift and smoothing (mm); and the table
    surface.

    profile: 54E1 (UIC54), 60E1 (UIC60), arc, or the path of a file of points.
    profile_origin: "file": the file's origin is the crown centre; "auto": as format and shape tell.
    crown_radius: mm, radius of an arc; inf is flat. Required for arc, not allowed (None) otherwise.
    inclination: tangent of the angle by which the rail leans towards the track's middle (y < 0),
        e.g. 1/20; negative: away from it.
    sections: path of a table of sections along the rail, .csv (x_mm, file) or .slcs of CONTACT, in
        place of profile; None: the rail is straight. y counts from below the tape circle.
    position: mm, place along the sections at which the axle stands.
    roller_radius: mm, of a roller at its highest point, in place of a straight rail; None: none.
    gauge: mm between both rails, `gauge_height` below their tops, which places the wheelset; None:
        the wheel's tape circle (70 mm from the flange back) stands over the crown.
    gauge_height: mm below the highest point of a rail at which the gauge is measured. Only beside
        gauge.
    friction_coefficient: of a wing; None: that of [friction].
    extent: "head" meshes the head, unless the plan needs the section; "section" web and foot too,
        of 54E1 or 60E1; "half-space" makes rail and wheel unbounded bodies under Hertz's parabolic
        gap.
    length: mm of the rail that is meshed, half to each side of the contact; None: the plan chooses.
        Where rolling_radius is inf, it is the length of the line contact, and required.
    depth: mm of the block below the crown's top, where it is held; None: the plan chooses. Only for
        arc.
    width: mm of the block across; None: the plan chooses. Only for arc.
    """

    profile: Annotated[str, _profile("rail", *RAILS, "arc")] = "54E1"
    profile_origin: Literal["auto", "file"] = "auto"
    sections: (
        Annotated[str, BeforeValidator(partial(files.existing, suffixes=(".csv", ".slcs")))] | None
    ) = None
    position: Annotated[float, Range(units.LENGTH, -1e6, 1e6)] = 0.0
    roller_radius: Annotated[float, Range(units.LENGTH, 10, 1e6)] | None = None
    crown_radius: units.Radius | None = None
    inclination: Annotated[float, Range(units.SLOPE, -0.2, 0.2, note=', e.g. "1:20"')] = 0.0
    gauge: units.Gauge | None = None
    gauge_height: Annotated[float, Range(units.LENGTH, 1, 50)] = GAUGE_HEIGHT
    friction_coefficient: Annotated[float, units.PAIRED_COEFFICIENT] | None = None
    extent: Literal["head", "section", "half-space"] = "head"
    length: units.BodyLength | None = None
    depth: units.BodyLength | None = None
    width: units.BodyLength | None = None

    _ARC_KEYS: ClassVar = ("crown_radius", "depth", "width")

    @model_validator(mode="after")
    def _depth_of_the_flat_and_gauge(self) -> Self:
        """Raise SceneError for a flat without depth, which only a wheel can have, and for a height
        of the gauge without a gauge.
        """
        flat, high = self.surface, self.gauge_height
        bare = flat is not None and flat.kind == "flat" and flat.depth is None
        drawn = self.sections and self.model_dump(exclude_defaults=True, include={*_PLAIN_KEYS})
        beside = self.roller_radius and self.model_dump(exclude_defaults=True, include=_STRAIGHT)
        useless = self.gauge is None and high != GAUGE_HEIGHT
        refuse_first(
            (bare, "surface.depth", "not given; a flat of the rail needs it"),
            (useless, "gauge_height", f"{high:g} is not allowed without gauge"),
            (drawn, next(iter(drawn or ("",))), "is not allowed beside sections; leave it out"),
            (
                self.position and not self.sections,
                "position",
                f"{self.position:g} is not allowed without sections",
            ),
            (beside, next(iter(beside or ("",))), "is not allowed beside roller_radius"),
        )
        return self

    @property
    def varies(self) -> bool:
        """Whether its section changes along the way: of sections, or a roller."""
        return bool(self.sections or self.roller_radius)


class Wheel(BodySection):
    """A wheel.

    Inherited from `BodySection`: young_modulus (MPa), poisson_ratio, steel, yield_stress (MPa),
    hardening_modulus (MPa), kinematic_fraction, stress_strain (a file), and for a profile's file
    profile_unit, profile_mirror, profile_flip, profile_shift and smoothing (mm); and the table
    surface.

    profile: cylinder, cone20, cone40, arc, S1002, or the path of a file of points.
    profile_origin: "file": the file's origin is the tape circle; "flange_back": its y begins at the
        flange back; "auto": as format and shape tell.
    tape_circle: mm from the flange back to the tape circle; None: as the file of the profile tells,
        else 70. Not for S1002, which has it at 70.
    rolling_radius: mm, nominal, at the tape circle; inf is a straight bar with the profile of the
        tread, solved in a section across the rail.
    transverse_radius: mm, radius of an arc across the rail; negative is concave, inf is straight.
        Required for arc, not allowed (None) otherwise.
    width: mm across the rail that are meshed, half to each side of the contact, within the profile;
        None: the whole profile.
    rim_depth: mm of the rim that is meshed, inwards to where it is held; None: the plan chooses.
    segment_length: mm of the circumference that is meshed, half to each side of the contact, at
        most 2.4 rolling radii; None: the plan chooses.
    """

    profile: Annotated[str, _profile("wheel", *WHEELS, "arc")] = "cylinder"
    profile_origin: Literal["auto", "file", "flange_back"] = "auto"
    tape_circle: Annotated[float, Range(units.LENGTH, 30, 120, note=", e.g. 70")] | None = None
    rolling_radius: units.Radius = 420.0
    transverse_radius: units.SignedRadius | None = None
    width: units.BodyLength | None = None
    rim_depth: units.BodyLength | None = None
    segment_length: units.BodyLength | None = None

    _ARC_KEYS: ClassVar = ("transverse_radius",)

    @model_validator(mode="before")
    @classmethod
    def _turned(cls, data: Any) -> Any:
        """Replace the position of the surface by the arc, mm, where it is an angle (text)."""
        given: Any = data.get("surface") if isinstance(data, dict) else None
        angle = units.angle(given.get("position")) if isinstance(given, dict) else None
        if angle is None:
            return data
        radius = units.to_base(data.get("rolling_radius", 420.0), units.LENGTH)
        return {**data, "surface": {**given, "position": angle * radius}}

    @model_validator(mode="after")
    def _tape_circle_and_segment(self) -> Self:
        """Raise SceneError for another tape circle of S1002 than its own, and for a segment longer
        than 2.4 rolling radii.
        """
        most, segment, circle = 2.4 * self.rolling_radius, self.segment_length, self.tape_circle
        refuse_first(
            (
                segment is not None and segment > most,
                "segment_length",
                f"{segment or 0:g} is not allowed; give at most 2.4 rolling_radius ({most:g})",
            ),
            (
                self.profile == "S1002" and circle not in (None, 70.0),
                "tape_circle",
                f"{circle or 0:g} is not allowed; S1002 has its tape circle at 70",
            ),
        )
        return self


class Wheelset(Section):
    """Position of the wheelset on the track, which wheel is solved, and what is on the other side.

    Shift, yaw and roll are in the axes of the right side, whichever wheel is solved. Everything
    else is in the axes of the wheel that is solved: those of the left one are the mirror image.

    shift: mm, lateral displacement towards the field side (+y) of the right rail, which brings the
        flange of the right wheel towards that rail.
    yaw: rad, rotation of the axle about the vertical axis z, from x to y.
    roll: rad, rotation of the axle about x, from y to z; each wheel then touches its rail at a
        height of its own. None: both rails are equally high, and the roll follows.
    back_to_back: mm between the backs of both flanges.
    side: wheel that is solved, on its rail, "right" or "left". The tables [rail] and [wheel]
        describe it.
    other_rail: profile of the other rail: 54E1, 60E1, or a file, which is read by the keys of
        [rail]; None: the same profile.
    other_wheel: profile of the other wheel: cylinder, cone20, cone40, S1002, or a file, which is
        read by the keys of [wheel]; None: the same profile.
    other_radius: mm, nominal rolling radius of the other wheel; None: the same.
    """

    shift: Annotated[float, Range(units.LENGTH, -30, 30)] = 0.0
    yaw: units.AxleAngle = 0.0
    roll: units.AxleAngle | None = None
    back_to_back: units.Gauge = 1360.0
    side: Literal["right", "left"] = "right"
    other_rail: Annotated[str, _profile("rail", *RAILS)] | None = None
    other_wheel: Annotated[str, _profile("wheel", *WHEELS)] | None = None
    other_radius: units.BodyLength | None = None

    @property
    def unlike(self) -> bool:
        """Whether the other side has a profile or a rolling radius of its own."""
        return bool(self.other_rail or self.other_wheel or self.other_radius)
