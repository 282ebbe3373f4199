"""The quantities of an answer: what may be asked for, and what each is called, its unit, who shows
it and who judges it.

A scene asks for `GROUPS` of quantities (key `quantities`, option --only). Each record below is a
part of "result" in summary.json, and each of its fields is described by a `Quantity`. From
`QUANTITIES` are made: the tables of the terminal and of report.html, result.csv, the columns of
sweep.csv, the error estimates, the comparison with a second method and the attributes of `Result`.
A new quantity is a field here and the line that computes it.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

T = TypeVar("T")
METADATA = "quantity"
GROUPS: dict[str, tuple[str, ...]] = {
    "patch": (),
    "stresses": (),
    "forces": (),
    "friction_stresses": ("forces",),
    "second_method": (),
    "pictures": ("stresses", "forces", "friction_stresses"),
    "fatigue": ("stresses", "forces", "friction_stresses"),
}
"""What a scene may ask for, and what else each of it needs. Patch and pressure are always found."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """Name, unit, tables and error estimate of one value of a result: a number, a word, or a list.

    key: last key of its place in summary.json, which ends in the unit.
    unit: product of powers of mm, N and MPa, or W; empty for ratios, words and lists.
    label: name of its row in tables, indented where the row belongs to the one above; empty: no
        row.
    table: "contact", "load", "yield", "friction" or "steel": the table that has the row.
    column: name of its column in sweep.csv, without the unit; empty: no column.
    bound: name of its error bound in `Result.estimate`. In `QUANTITIES` an empty one is filled with
        the name of the field.
    estimated: whether its error is estimated, from the calibrated error envelope of its key, or
        without one from the scatter of three meshes. Not set for friction:
        `estimates.friction_values` chooses those that are estimated as well.
    over_friction_limit: whether its errors are relative to mu N and not to the value.
    absolute: whether its errors are in its unit and not relative to the value.
    like: key of the quantity whose relative error it has, where it has no estimate of its own.
    scatter: name in `Patch.scatter` of the difference between two readings; empty: none.
    ridge_stress: whether it is a largest stress in the bodies, whose reading error follows from
        that of the largest pressure (`estimates.reading_errors`).
    compared: whether an estimated quantity is compared with a second method.
    record: class of the record below this key; None where the key holds a value or a list.
    path: keys from "result" of summary.json down to the value; filled in `QUANTITIES` only.
    """

    key: str
    unit: str = ""
    label: str = ""
    table: str = "contact"
    column: str = ""
    bound: str = ""
    estimated: bool = False
    over_friction_limit: bool = False
    absolute: bool = False
    like: str = ""
    scatter: str = ""
    ridge_stress: bool = False
    compared: bool = False
    record: type | None = None
    path: tuple[str, ...] = ()

    @property
    def header(self) -> str:
        """Header of the column in sweep.csv: "name [unit]", or the name of what has no unit."""
        return f"{self.column} [{self.unit}]" if self.unit else self.column

    def value(self, result: Mapping[str, Any] | None) -> Any:
        """Value in a dictionary nested as "result" of summary.json, for a quantity of `QUANTITIES`;
        None where the value is missing.
        """
        inner: Any = result
        for key in self.path:
            inner = None if inner is None else inner.get(key)
        return inner


def quantity(key: str, unit: str = "", label: str = "", **more: Any) -> Any:
    """A dataclass field with a `Quantity` as metadata and the default None. more: other attributes
    of `Quantity`.
    """
    described = Quantity(key=key, unit=unit, label=label, **more)
    return dataclasses.field(default=None, metadata={METADATA: described})


friction, steel, plastic = (
    partial(quantity, table=name) for name in ("friction", "steel", "yield")
)
"""`quantity` for the tables "friction", "steel" and "yield"."""


@dataclass(frozen=True, kw_only=True)
class PatchQuantities:
    """The contact patch, images in symmetry planes included. Lengths lie in the tangent plane at
    the first contact, or in that of the patch where it is turned by more than 0.02 rad.

    a: half length along the rail, mm. Of several patches it is that of the most loaded one.
    b: half length along the common tangent across the rail, mm; of several patches as a.
    area: of all patches, mm2.

    In plane strain the half length along the line of contact is prescribed.
    """

    a: float = quantity(
        "a_mm",
        "mm",
        "half length a, along",
        column="a",
        estimated=True,
        scatter="a",
        compared=True,
    )
    b: float = quantity(
        "b_mm",
        "mm",
        "half length b, across",
        column="b",
        estimated=True,
        scatter="b",
        compared=True,
    )
    area: float = quantity(
        "area_mm2",
        "mm2",
        "patch area",
        column="area",
        estimated=True,
        scatter="area",
        compared=True,
    )


@dataclass(frozen=True, kw_only=True)
class PressureQuantities:
    """The contact pressure of all patches.

    max: largest pressure, MPa.
    mean: integral of the pressure over the area, divided by the area, MPa. At an inclined contact
        it is not the (vertical) load over the area.
    """

    max: float = quantity(
        "max_MPa",
        "MPa",
        "largest pressure",
        column="p_max",
        bound="pressure_max",
        estimated=True,
        scatter="max_pressure",
        compared=True,
    )
    mean: float = quantity("mean_MPa", "MPa", "mean pressure", column="p_mean", like="area_mm2")


@dataclass(frozen=True, kw_only=True)
class AxisStress:
    """Largest stresses in one body on the normal through the centre of the most loaded patch.

    body: "rail", or "wheel" where the rail is rigid.
    tau_max: largest shear stress, MPa.
    tau_max_depth: its depth below the tangent plane, mm.
    von_mises_max: largest von Mises stress, MPa.
    von_mises_max_depth: its depth below the tangent plane, mm.
    """

    body: str = quantity("body")
    tau_max: float = quantity("tau_max_MPa")
    tau_max_depth: float = quantity("tau_max_depth_mm")
    von_mises_max: float = quantity("von_mises_max_MPa")
    von_mises_max_depth: float = quantity("von_mises_max_depth_mm")


@dataclass(frozen=True, kw_only=True)
class StressQuantities:
    """Largest stresses of both bodies, away from sharp edges and held faces.

    Places are points in space: x along the rail from the first contact, y across to the field side,
    z up, both from the rail's crown centre (of half-spaces from the first contact). Of a model cut
    at symmetry planes they lie in the meshed part, x >= 0 or y >= 0. In a meridian section x is the
    radius. Places are None where they are not known.

    tau_max: largest shear stress, half the difference of the largest and the smallest principal
        stress, MPa.
    tau_max_depth: its depth below the surface, mm; 0 at the surface.
    tau_max_body: "rail" or "wheel", where it lies.
    tau_max_place: its place (x, y, z), mm.
    von_mises_max: largest von Mises stress, MPa.
    von_mises_max_depth: its depth below the surface, mm; 0 at the surface.
    von_mises_max_body: "rail" or "wheel", where it lies.
    von_mises_max_place: its place (x, y, z), mm.
    axis: largest stresses on the normal through the centre of the most loaded patch.
    surface_centre: normal stresses along x, along the tangent across and along the normal, at the
        centre of the most loaded patch, in the body of `axis`, MPa, tension positive.
    at_edges: larger stresses at sharp edges and held faces, where they depend on the mesh:
        dictionaries with "quantity", "body", "value_MPa" and "place_mm" (x, y, z). Empty where
        there are none; None of exact Hertz.
    """

    tau_max: float = quantity(
        "tau_max_MPa",
        "MPa",
        "largest shear stress",
        column="tau_max",
        estimated=True,
        ridge_stress=True,
        compared=True,
    )
    tau_max_depth: float = quantity(
        "tau_max_depth_mm", "mm", "   its depth", column="tau_max depth"
    )
    tau_max_body: str = quantity("tau_max_body", "", "   its body", column="tau_max body")
    tau_max_place: list[float] = quantity("tau_max_place_mm")
    von_mises_max: float = quantity(
        "von_mises_max_MPa",
        "MPa",
        "largest von Mises stress",
        column="von_mises_max",
        estimated=True,
        ridge_stress=True,
        compared=True,
    )
    von_mises_max_depth: float = quantity("von_mises_max_depth_mm", "mm", "   its depth")
    von_mises_max_body: str = quantity("von_mises_max_body", "", "   its body")
    von_mises_max_place: list[float] = quantity("von_mises_max_place_mm")
    axis: AxisStress = quantity("axis", record=AxisStress)
    surface_centre: list[float] = quantity("surface_centre_MPa")
    at_edges: list[dict[str, Any]] | None = quantity("at_edges")


@dataclass(frozen=True, kw_only=True)
class MainFriction:
    """Main quantities of friction of solids or sections of one material that roll, or errors.

    force_along: force along the rail, N.
    force_across: force across the rail, N.
    moment_Nmm: moment about the normal, N mm.
    traction_max: largest traction, MPa.
    t_gamma: energy dissipated per rolled length, N.
    stick_share: share of the patch that sticks, 0 to 1.
    """

    force_along: float = quantity("force_along_N")
    force_across: float = quantity("force_across_N")
    moment_Nmm: float = quantity("moment_Nmm")  # noqa: N815
    traction_max: float = quantity("traction_max_MPa")
    t_gamma: float = quantity("t_gamma_N")
    stick_share: float = quantity("stick_share")


@dataclass(frozen=True, kw_only=True)
class TemperatureRise:
    """Largest rise of the surfaces' temperature in the patch above the bulk of each body, K; it is
    negative where the other body is colder and slip does not make up for it.

    rail: of the rail.
    wheel: of the wheel.
    """

    rail: float = friction(
        "rail",
        "K",
        "temperature rise of the rail",
        column="rise rail",
        like="temperature_rise_rail_K",
    )
    wheel: float = friction(
        "wheel", "K", "   of the wheel", column="rise wheel", like="temperature_rise_wheel_K"
    )


@dataclass(frozen=True, kw_only=True)
class FrictionQuantities:
    """Friction of the wheel on the rail, and its effect on the steel. None where a quantity does
    not belong to the motion (rolling, or a shift).

    Axes are those of the first contact: x along the rail, to where the wheel rolls; the common
    tangent across to the field side; the normal out of the rail. Forces are tangential, of all
    patches and of the whole model.

    force_along: component along the rail (+x) of the force of the wheel on the rail, N.
    force_across: component along the common tangent across of the force of the wheel on the rail,
        N.
    moment_Nmm: moment of the wheel on the rail about the normal at the first contact, N mm; 0 with
        symmetry planes.
    limit: integral of the friction coefficient times the pressure, N.
    coefficient: the limit over the normal force.
    coefficient_least: least friction coefficient in the patch; None where it is the same
        everywhere.
    coefficient_slipping: mean one where the surfaces slip, weighted by pressure; None where it is
        the same everywhere, or nothing slips.
    temperature_rise: largest rises of the surfaces' temperatures; None where not simulated.
    creepage_along: velocity of the wheel's surface relative to the rail's over the rolling speed,
        along +x; None of a shift.
    creepage_across: the same ratio along the tangent across; None of a shift.
    spin_per_mm: angular velocity of the wheel about the normal over the rolling speed, 1/mm; None
        of a shift.
    axle: radius by which the axle turns, "free" or "nominal"; None unless the wheelset gives the
        creepages.
    shift_along: displacement of the wheel over the rail along +x, mm; None in rolling.
    shift_across: rigid displacement of the wheel over the rail from rest along the tangent across,
        of solid half-spaces that of distant points, mm; None in rolling.
    turn_rad: rotation of the wheel over the rail about the normal, rad; None in rolling.
    stick_share: share of the patch's area that sticks, 0 to 1.
    traction_max: largest magnitude of the traction, MPa.
    t_gamma: energy dissipated per rolled length, N; None of a shift.
    power_W: t_gamma times the speed, W; None without `rolling.speed`.
    without_creepage: of like bodies that roll, what they do without creepage, since unlike shapes
        are strained unlike by pressing; None of half-spaces, of a shift and of unlike materials.
    resolution: error by the mesh of each quantity, absolute. Of solids it comes from two readings
        of the strain of the pressed surfaces, of sections it is all that they do without creepage.
        That of the stick share includes its border: 3 n^(-3/4) with n contact points, in a section
        one point. None where `without_creepage` is.
    below_resolution: keys of the quantities that mesh or grid do not resolve; None in a result of
        an older version.
    wear_number: scalar product of force and mean creepage, largest of all patches, N; None of a
        shift and of unlike materials.
    t_gamma_over_area: t_gamma over the area of the patch, N/mm2; None of a shift.
    wear_regime: "mild", "severe" or "catastrophic", by t_gamma_over_area; None of a shift.
    von_mises_max: largest von Mises stress of both bodies with friction, MPa.
    von_mises_max_depth: its depth below the surface, mm.
    von_mises_max_at: "surface" down to a tenth of the smaller half length, else "below".
    traction_coefficient: tangential over normal force; None of a shift.
    first_yield_p0_over_k: largest pressure over yield stress in shear at which this contact would
        begin to yield; None of a shift.
    shakedown_limit_p0_over_k: the same ratio up to which a line contact shakes down or, if less, a
        surface with the largest traction everywhere; None of a shift.
    shear_yield: yield stress in shear k of the weaker body, MPa; None of a shift and without a
        yield stress.
    p0_over_k: largest pressure over k; None where k is.
    surface_fatigue_index: FI_surf, largest traction minus k, over the largest pressure: above 0 the
        surface ratchets. None where k is.
    shakedown: effect of repeated passes: "elastic", "shakes down", "ratchets" or "open"; None where
        k is.
    """

    force_along: float = friction(
        "force_along_N",
        "N",
        "force along the rail",
        column="force along",
        over_friction_limit=True,
    )
    force_across: float = friction(
        "force_across_N",
        "N",
        "force across",
        column="force across",
        over_friction_limit=True,
    )
    moment_Nmm: float = friction(  # noqa: N815
        "moment_Nmm", "N mm", "moment about the normal", column="moment"
    )
    limit: float = friction("limit_N", "N", column="mu N")
    coefficient: float = friction("coefficient")
    coefficient_least: float | None = friction(
        "coefficient_least", "", "least friction coefficient", column="least mu"
    )
    coefficient_slipping: float | None = friction("coefficient_slipping", "", "   where it slips")
    temperature_rise: TemperatureRise | None = friction(
        "temperature_rise_max_K", record=TemperatureRise
    )
    creepage_along: float | None = friction(
        "creepage_along", "", "creepage along", column="creepage along"
    )
    creepage_across: float | None = friction(
        "creepage_across", "", "creepage across", column="creepage across"
    )
    spin_per_mm: float | None = friction("spin_per_mm", "1/mm", "spin", column="spin")
    axle: str | None = friction("axle", "", "axle", column="axle")
    shift_along: float | None = friction(
        "shift_along_mm", "mm", "shift along", column="shift along"
    )
    shift_across: float | None = friction(
        "shift_across_mm", "mm", "shift across", column="shift across"
    )
    turn_rad: float | None = friction("turn_rad")
    stick_share: float = friction(
        "stick_share",
        "",
        "share of the patch that sticks",
        column="stick share",
        absolute=True,
    )
    traction_max: float = friction("traction_max_MPa", "MPa", "largest traction")
    t_gamma: float | None = friction(
        "t_gamma_N", "N", "T-gamma: energy per rolled length", column="T-gamma"
    )
    power_W: float | None = friction("power_W", "W", "power")  # noqa: N815
    without_creepage: MainFriction | None = friction("without_creepage", record=MainFriction)
    resolution: MainFriction | None = friction("resolution", record=MainFriction)
    below_resolution: list[str] | None = friction("below_resolution")
    wear_number: float | None = steel(
        "wear_number_N", "N", "T-gamma without spin, worst patch", column="wear number"
    )
    t_gamma_over_area: float | None = steel(
        "t_gamma_over_area_MPa",
        "N/mm2",
        "T-gamma over the area",
        column="T-gamma/area",
        like="t_gamma_N",
    )
    wear_regime: str | None = steel(
        "wear_regime", "", "   wear by it (R8T on 900A)", column="wear regime"
    )
    von_mises_max: float = steel("von_mises_max_MPa")
    von_mises_max_depth: float = steel("von_mises_max_depth_mm")
    von_mises_max_at: str = steel("von_mises_max_at", "", "where von Mises stress is largest")
    traction_coefficient: float | None = steel(
        "traction_coefficient", "", "tangential over normal force", like="t_gamma_N"
    )
    first_yield_p0_over_k: float | None = steel(
        "first_yield_p0_over_k", "", "p0/k at first yield", like="von_mises_max_MPa"
    )
    shakedown_limit_p0_over_k: float | None = steel(
        "shakedown_limit_p0_over_k", "", "p0/k at which a line shakes down"
    )
    shear_yield: float | None = steel("shear_yield_MPa", "MPa", "yield stress in shear k")
    p0_over_k: float | None = steel("p0_over_k", "", "p0/k", column="p0/k", like="max_MPa")
    surface_fatigue_index: float | None = steel(
        "surface_fatigue_index",
        "",
        "surface fatigue index",
        column="surface fatigue index",
        absolute=True,
        like="fi_surface",
    )
    shakedown: str | None = steel("shakedown", "", "   passing again and again", column="shakedown")


@dataclass(frozen=True, kw_only=True)
class PlasticQuantities:
    """Yield under the load, and the state after unloading.

    load_over_first_yield: load over the load of first yield, above 1; from the largest von Mises
        stresses of elastic solutions.
    load_steps: number of load steps from first yield until the load is reached, halved ones and
        those that failed counted.
    strain_max: largest equivalent plastic strain.
    body: "rail" or "wheel", where it lies.
    place: its place (x, y, z) in space, mm, as the places of `StressQuantities`.
    volume_mm3: volume that yields, of the whole model, mm3.
    depth: largest depth of the region that yields, from the tangent plane of the patch, mm.
    top: its smallest depth, mm.
    residual_depth_rail: largest depth of the imprint in the rail after unloading, mm; None for a
        rigid rail, and where the load is not removed.
    residual_depth_wheel: the same of the wheel.
    residual_von_mises_max: largest von Mises stress after unloading, MPa; None where the load is
        not removed.
    elastic_p0_over_k: largest pressure without yield over the yield stress in shear of the body
        `body`.
    """

    load_over_first_yield: float = plastic(
        "load_over_first_yield", "", "load over that of first yield", column="load/first yield"
    )
    load_steps: int = plastic("load_steps")
    strain_max: float = plastic("strain_max", "", "largest plastic strain", column="plastic strain")
    body: str = plastic("body", "", "   its body")
    place: list[float] = plastic("place_mm")
    volume_mm3: float = plastic("volume_mm3", "mm3", "volume that yields")
    depth: float = plastic("depth_mm", "mm", "   its largest depth")
    top: float = plastic("top_mm", "mm", "   its least depth")
    residual_depth_rail: float | None = plastic(
        "residual_depth_rail_mm", "mm", "imprint left in the rail", column="residual depth rail"
    )
    residual_depth_wheel: float | None = plastic(
        "residual_depth_wheel_mm", "mm", "imprint left in the wheel", column="residual depth wheel"
    )
    residual_von_mises_max: float | None = plastic(
        "residual_von_mises_max_MPa", "MPa", "von Mises stress left"
    )
    elastic_p0_over_k: float = plastic("elastic_p0_over_k", "", "elastic p0/k")


@dataclass(frozen=True, kw_only=True)
class SurfaceShapeQuantities:
    """Where surfaces that vary along the rail touch.

    position: place of the centre of pressure of the most loaded patch along the rail, from where
        the smooth bodies touch, mm, positive to where the wheel rolls.
    height: largest less smallest height in the patches that is added to both surfaces, mm.
    """

    position: float = quantity("position_mm", "mm", column="contact ahead")
    height: float = quantity("height_in_patch_mm", "mm", column="height in patch")


@dataclass(frozen=True, kw_only=True)
class FatigueDepths:
    """Depths below the surface at which the stresses of a criterion are largest, mm.

    dang_van: of Dang Van's stress.
    findley: of Findley's stress.
    """

    dang_van: float = steel(
        "dang_van", "mm", "depth of the Dang Van stress", column="Dang Van depth"
    )
    findley: float = steel("findley", "mm", "depth of the Findley stress", column="Findley depth")


@dataclass(frozen=True, kw_only=True)
class FatigueQuantities:
    """Fatigue of the steel below the patch with the largest pressure while the wheel rolls over it,
    elastic and without residual stress; of the rail, of the wheel where the rail is rigid.

    dang_van: largest stress of Dang Van, tau + c s_h, MPa.
    findley: largest stress of Findley, shear amplitude plus k times the normal stress of a plane,
        MPa.
    depth: of each, mm.
    fi_subsurface: subsurface fatigue index p0 (1 + f^2)/6, f tangential over normal force, MPa;
        None of a line.
    fi_surface: surface fatigue index, largest traction less k over the largest pressure; None
        without a yield stress.
    dang_van_over_limit, findley_over_limit: over the limits that the scene gives; None without.
    """

    dang_van: float = steel("dang_van_MPa", "MPa", "largest Dang Van stress", column="Dang Van")
    findley: float = steel("findley_MPa", "MPa", "largest Findley stress", column="Findley")
    depth: FatigueDepths = steel("depth_mm", record=FatigueDepths)
    fi_subsurface: float | None = steel(
        "fi_subsurface_MPa",
        "MPa",
        "subsurface fatigue index",
        column="subsurface fatigue index",
        like="max_MPa",
    )
    fi_surface: float | None = steel("fi_surface", absolute=True)
    dang_van_over_limit: float | None = steel(
        "dang_van_over_limit",
        "",
        "Dang Van stress over its limit",
        column="Dang Van over limit",
        like="dang_van_MPa",
    )
    findley_over_limit: float | None = steel(
        "findley_over_limit",
        "",
        "Findley stress over its limit",
        column="Findley over limit",
        like="findley_MPa",
    )


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The quantities of one method for a scene, as under "result" or "hertz" of summary.json.

    patch: half lengths and area.
    pressure: largest pressure of all patches, and mean over their area, MPa.
    approach: approach of the bodies' supports along the vertical, mm; of half-spaces that of
        distant points, of half-planes that of points one relative radius from the contact. None
        of exact Hertz where no formula is known.
    load: vertical component of the force between the bodies, friction included, of the whole model,
        N. At a contact angle the normal force is larger.
    side_force: force of the contact pressure on the rail across the track, without friction, N,
        positive to the field side; None of half-spaces and exact Hertz.
    contact_point: centre of pressure (x, y, z) of the most loaded patch in space, on its tangent
        plane, mm. Of exact Hertz it is the first contact.
    stress: largest stresses.
    friction: None without friction.
    plastic: None without yield.
    surface_shape: None where nothing that varies is added to the surfaces.
    fatigue: None where it is not asked for, of steel that yields, and where no wheel rolls along
        x.
    """

    patch: PatchQuantities = quantity("patch", record=PatchQuantities)
    pressure: PressureQuantities = quantity("pressure", record=PressureQuantities)
    approach: float = quantity(
        "approach_mm", "mm", "approach", column="found approach", estimated=True, compared=True
    )
    load: float = quantity("load_N", "N", "load", table="load", column="found load")
    side_force: float | None = quantity(
        "side_force_N", "N", "side force on the rail", table="load", column="side force"
    )
    contact_point: list[float] | None = quantity("contact_point_mm")
    stress: StressQuantities = quantity("stress", record=StressQuantities)
    friction: FrictionQuantities | None = quantity("friction", record=FrictionQuantities)
    plastic: PlasticQuantities | None = quantity("plastic", record=PlasticQuantities)
    surface_shape: SurfaceShapeQuantities | None = quantity(
        "surface_shape", record=SurfaceShapeQuantities
    )
    fatigue: FatigueQuantities | None = quantity("fatigue", record=FatigueQuantities)


def read(record: type[T], values: Mapping[str, Any]) -> T:
    """A record of class `record` from its part of summary.json. Missing quantities are None; keys
    that the class does not have are ignored.
    """
    found = {}
    for each in dataclasses.fields(record):  # type: ignore[arg-type]
        described: Quantity = each.metadata[METADATA]
        value = values.get(described.key)
        inner = described.record
        found[each.name] = value if inner is None or value is None else read(inner, value)
    return record(**found)


def _described(record: type, above: tuple[str, ...] = ()) -> Iterator[Quantity]:
    """The `Quantity` of each value of a record class and of its inner records: numbers, words and
    lists, not the records themselves. Each gets its full path and, where it has none, the name of
    its field as `bound`. above: keys above the record.
    """
    for each in dataclasses.fields(record):
        known: Quantity = each.metadata[METADATA]
        path = (*above, known.key)
        if known.record is not None:
            yield from _described(known.record, path)
        else:
            yield dataclasses.replace(known, path=path, bound=known.bound or each.name)


QUANTITIES = tuple(_described(Answer))
"""All quantities of an answer, in the order of tables."""
ESTIMATED = {each.key: each for each in QUANTITIES if each.estimated}
"""By key, those whose error is estimated."""
SCATTER = {each.key: each.scatter for each in QUANTITIES if each.scatter}
"""By key, the name in `Patch.scatter` of what two readings of it differ by."""


def rows(table: str) -> list[Quantity]:
    """Quantities that have a row in a table: "contact", "load", "yield", "friction" or "steel"; in
    the order of `QUANTITIES`.
    """
    return [each for each in QUANTITIES if each.table == table and each.label]


def numeric_values(result: Mapping[str, Any] | None) -> dict[str, float]:
    """Values of the estimated quantities in a dictionary nested as "result" of summary.json, by
    key; those that are missing, or the whole dictionary, are left out.
    """
    values = {name: each.value(result) for name, each in ESTIMATED.items()}
    return {name: float(value) for name, value in values.items() if value is not None}
