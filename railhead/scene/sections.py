"""The tables of a scene: frozen, without unknown keys, and one line of text when wrong.

Lengths are in mm, stresses in MPa, and wherever a number is expected a string with its unit is read
as well. A key that may be None leaves the choice to the plan.
"""

import os
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, model_validator

from railhead.geometry.measured.extensions import BODY_BY_EXTENSION, EXTENSIONS
from railhead.scene import curves, steels, units
from railhead.scene.units import show

ALIASES = {"UIC54": "54E1", "UIC60": "60E1"}


class SceneError(ValueError):
    """The input is wrong: ``key`` says where, ``text`` what it was and what is allowed there."""

    def __init__(self, key: str, text: str) -> None:
        super().__init__(key, text)
        self.key, self.text = key, text

    def __str__(self) -> str:
        key = self.key if self.key and self.key.isprintable() else show(self.key)
        return f"{key}: {self.text}"


class Section(BaseModel):
    """A frozen table of keys; a wrong key or value raises `SceneError`. A key with the value
    ``none`` has its default."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise self._first_problem(error) from None

    @model_validator(mode="before")
    @classmethod
    def _unset(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        return {
            key: value for key, value in data.items()
            if not (key in cls.model_fields and isinstance(value, str) and value == "none")
        }  # fmt: skip

    @classmethod
    def _first_problem(cls, error: ValidationError) -> SceneError:
        """Put the first of pydantic's findings into one line."""
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
            case _:  # string_unicode: half of a surrogate pair, in a key or in a value
                return SceneError(key, f"{value} is not Unicode text; give whole characters")


def _readable(path: str) -> bool:
    """Return whether `path` is a file that can be read, with a name that TOML can hold."""
    is_text = path.encode(errors="ignore").decode() == path
    return is_text and os.path.isfile(path) and os.access(path, os.R_OK)


def _profile(body: str, *names: str) -> BeforeValidator:
    """Return a validator of a profile: one of `names`, an alias, or a file (kept absolute)."""
    suffixes = [suffix for suffix in EXTENSIONS
                if BODY_BY_EXTENSION.get(suffix, body) == body]  # fmt: skip
    kinds = f"a {', '.join(suffixes[:-1])} or {suffixes[-1]} file"

    def validate(value: object) -> str:
        text = str(value) if isinstance(value, str | Path) else ""
        text = ALIASES.get(text, text)
        if text in names:
            return text
        if not text.lower().endswith(tuple(suffixes)):
            allowed = ", ".join(names)
            raise ValueError(f"{show(value)} is not allowed; give {allowed} or {kinds}")
        path = os.path.abspath(text)
        if not _readable(path):
            raise ValueError(f"{show(value)} is not a readable file; give {kinds} that exists")
        return path

    return BeforeValidator(validate)


def is_profile_file(profile: str) -> bool:
    """Whether a checked profile is the path of a file, not the name of a standard profile."""
    return os.path.isabs(profile)


def _curve() -> BeforeValidator:
    """Return a validator of a .csv file with a stress-strain curve (kept absolute)."""

    def validate(value: object) -> str:
        path = os.path.abspath(str(value))
        if not path.lower().endswith(".csv") or not _readable(path):
            raise ValueError(f"{show(value)} is not a readable .csv file; give one that exists")
        curves.read(path)
        return path

    return BeforeValidator(validate)


def _check_arc(profile: str, key: str, radius: float | None) -> None:
    """Require `radius` of the profile ``arc``, and of no other."""
    if profile == "arc" and radius is None:
        raise SceneError(key, 'not given; profile arc needs it, e.g. 80 or "80 mm"')
    if profile != "arc" and radius is not None:
        raise SceneError(key, f"{radius:g} is not allowed; only profile arc takes it")


Switch = Literal["auto", "on", "off"]


class BodySection(Section):
    """What a body is made of: elastic constants, and how it yields: as a `steel` does, at
    `yield_stress`, with a constant `hardening_modulus`, or along `stress_strain`, a .csv file of
    plastic strain and true stress (MPa). `kinematic_fraction` of the hardening moves the yield
    surface, the rest widens it. A body without any stays elastic.

    How a profile's file is read: `profile_unit` of its numbers, `profile_mirror` left and right,
    `profile_flip` up and down, `profile_origin` as in the file; `smoothing` is the length in mm of
    waves that keep half of their height. What is ``auto`` is found out from the points.
    """

    young_modulus: units.Modulus = 207000.0
    poisson_ratio: units.PoissonRatio = 0.3
    steel: Annotated[str, steels.name_validator()] | None = None
    yield_stress: units.Stress | None = None
    hardening_modulus: units.Hardening | None = None
    kinematic_fraction: units.Share | None = None
    stress_strain: Annotated[str, _curve()] | None = None
    profile_unit: Literal["auto", "mm", "m", "inch"] = "auto"
    profile_mirror: Switch = "auto"
    profile_flip: Switch = "auto"
    profile_origin: Literal["auto", "file"] = "auto"
    smoothing: units.Wavelength | Literal["auto"] = "auto"

    @model_validator(mode="after")
    def _one_way_to_yield(self) -> Self:
        given = [key for key in ("steel", "stress_strain", "yield_stress") if getattr(self, key)]
        if len(given) > 1:
            raise SceneError(given[1], f"is not allowed beside {given[0]}; give one of them")
        if self.hardening_modulus is not None and given != ["yield_stress"]:
            raise SceneError("hardening_modulus", "is not allowed without yield_stress")
        if self.kinematic_fraction is not None and not given:
            raise SceneError(
                "kinematic_fraction", "is not allowed without steel, yield_stress or stress_strain"
            )
        return self

    def _check_file(self, profile: str) -> None:
        """Refuse keys that say how a file is read where the profile is no file."""
        for key in ("profile_unit", "profile_mirror", "profile_flip", "profile_origin",
                    "smoothing"):  # fmt: skip
            value = getattr(self, key)
            if value != "auto" and not is_profile_file(profile):
                text = f"{value} is not allowed; only a profile from a file takes it; give auto"
                raise SceneError(key, text)

    @property
    def yields(self) -> bool:
        """Whether the body is elastic-plastic: a steel, a yield stress or a curve is set."""
        return bool(self.steel or self.stress_strain or self.yield_stress)

    @property
    def curve(self) -> tuple[tuple[float, float], ...]:
        """Points (plastic strain, true stress in MPa) of the steel or of `stress_strain`.

        The stress is constant after the last. Empty where the body has neither."""
        if self.steel is not None:
            return ((0.0, steels.by_name()[self.steel].yield_stress),)
        if self.stress_strain is not None:
            return tuple(curves.read(self.stress_strain))
        return ()


class Rail(BodySection):
    """The rail: straight, its crown radius in mm, its inclination the tangent of an angle.

    ``depth`` (below the crown) and ``width`` are those of a block under an arc.
    ``gauge`` is the distance of the two rails, 14 mm below their tops, in mm; without it the
    wheel's tape circle (70 mm from the flange back) stands over the crown centre.
    """

    profile: Annotated[str, _profile("rail", "54E1", "60E1", "arc")] = "54E1"
    crown_radius: units.Radius | None = None
    inclination: units.Slope = 0.0
    gauge: units.Gauge | None = None
    extent: Literal["head", "section", "half-space"] = "head"
    length: units.BodyLength | None = None
    depth: units.BodyLength | None = None
    width: units.BodyLength | None = None

    @model_validator(mode="after")
    def _radius_of_an_arc(self) -> Self:
        _check_arc(self.profile, "crown_radius", self.crown_radius)
        self._check_file(self.profile)
        for key, value in (("depth", self.depth), ("width", self.width)):
            if value is not None and self.profile != "arc":
                raise SceneError(key, f"{value:g} is not allowed; only profile arc takes it")
        return self


class Wheel(BodySection):
    """The wheel; ``segment_length`` is the arc length that is kept along the rail, in mm.

    A rolling radius of inf is a straight bar with the tread's section.
    """

    profile: Annotated[str, _profile("wheel", "cylinder", "cone20", "cone40", "arc", "S1002")] = (
        "cylinder"
    )
    rolling_radius: units.Radius = 420.0
    transverse_radius: units.SignedRadius | None = None
    width: units.BodyLength | None = None
    rim_depth: units.BodyLength | None = None
    segment_length: units.BodyLength | None = None

    @model_validator(mode="after")
    def _radius_of_an_arc(self) -> Self:
        _check_arc(self.profile, "transverse_radius", self.transverse_radius)
        self._check_file(self.profile)
        return self


class Wheelset(Section):
    """Where the wheel stands: ``shift`` brings its flange to the rail, in mm; ``yaw`` turns the
    axle about the vertical, in rad; the roll follows, as both wheels touch both rails.
    ``back_to_back`` is the distance of the flange backs, in mm.
    """

    shift: units.Shift = 0.0
    yaw: units.Yaw = 0.0
    back_to_back: units.Gauge = 1360.0


class Solver(Section):
    """How the contact is enforced; ``gamma_factor`` multiplies the default stabilisation.

    Without ``theta`` Nitsche's method is symmetric (1) down to factor 1 and skew (-1) below it.
    """

    method: Literal["nitsche", "penalty"] = "nitsche"
    theta: units.Theta | None = None
    gamma_factor: units.Factor = 1.0
    linear: Literal["auto", "direct", "multigrid"] = "auto"
    max_newton: units.Iterations = 30

    @model_validator(mode="after")
    def _theta_of_nitsche(self) -> Self:
        if self.method == "penalty" and self.theta is not None:
            raise SceneError("theta", f"{self.theta} is not allowed; only method nitsche takes it")
        return self


class Mesh(Section):
    """The cells; without ``order`` tetrahedra are quadratic and hexahedra linear."""

    cell: Literal["tetrahedron", "hexahedron"] = "tetrahedron"
    order: units.Order | None = None
    patch_size: units.ElementSize | None = None

    @property
    def linear(self) -> bool:
        """Whether the cells are linear tetrahedra (in a section triangles), which lock."""
        return self.cell == "tetrahedron" and self.order == 1


class Friction(Section):
    """Dry friction. ``force_along`` and ``force_across`` (N) of the wheel on the rail shift it from
    rest; ``tangential_load`` is another name of the first. ``cycle``: there, back to the opposite
    forces and there again.
    """

    coefficient: units.FrictionCoefficient = 0.0
    force_along: units.SignedForce = 0.0
    force_across: units.SignedForce = 0.0
    cycle: bool = False

    @model_validator(mode="before")
    @classmethod
    def _other_name(cls, data: Any) -> Any:
        if isinstance(data, dict) and "tangential_load" in data:
            data = dict(data)
            force = data.pop("tangential_load")
            if data.get("force_along"):
                raise SceneError("tangential_load", "is not allowed beside force_along; give one")
            data["force_along"] = force
        return data


class Rolling(Section):
    """Steady rolling towards positive x. Of either direction a creepage (velocity of the wheel's
    surface relative to the rail's over the rolling speed) or a force of the wheel on the rail (N)
    to be met; ``spin`` in 1/mm about the normal out of the rail; ``speed`` in m/s is for the power
    and the flash temperature. ``from_wheelset`` takes creepages and spin from where the wheelset
    stands; beside it a torque may give ``force_along``, and ``axle`` says by which radius the axle
    turns: the mean of both wheels' rolling radii (free) or wheel.rolling_radius (nominal).
    """

    from_wheelset: bool = False
    axle: Literal["free", "nominal"] = "free"
    creepage_along: units.Creepage | None = None
    creepage_across: units.Creepage | None = None
    force_along: units.SignedForce | None = None
    force_across: units.SignedForce | None = None
    spin: units.Spin = 0.0
    speed: units.Speed | None = None

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        for way in ("along", "across"):
            if (
                getattr(self, f"creepage_{way}") is not None
                and getattr(self, f"force_{way}") is not None
            ):
                raise SceneError(f"force_{way}", f"is not allowed beside creepage_{way}; give one")
        if self.from_wheelset:
            for key in ("creepage_along", "creepage_across", "force_across", "spin"):
                if getattr(self, key) != type(self).model_fields[key].default:
                    raise SceneError(key, "is not allowed beside from_wheelset, which gives it")
        elif self.axle != "free":
            raise SceneError("axle", f"{self.axle} is not allowed without from_wheelset")
        if self.speed is not None and not self.prescribed:
            raise SceneError("speed", "is not allowed without a creepage, spin or force; give one")
        return self

    @property
    def prescribed(self) -> bool:
        """Whether a creepage, a force, a spin or the wheelset prescribes steady rolling."""
        chosen = (self.creepage_along, self.creepage_across, self.force_along, self.force_across)
        return self.from_wheelset or any(value is not None for value in chosen) or self.spin != 0


class Effects(Section):
    """Effects that a person may force; ``auto`` leaves them to the plan.

    ``symmetry`` is short for both planes.
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
    true_profile: Switch = "auto"
    mean_dilatation: Switch = "auto"
    plasticity: Switch = "auto"
    friction: Switch = "auto"
    heat: Switch = "auto"

    def state(self, name: str) -> Switch:
        """The switch of one effect; `symmetry` stands for both planes where theirs are auto."""
        choice: Switch = getattr(self, name)
        return self.symmetry if choice == "auto" and name.startswith("symmetry") else choice
