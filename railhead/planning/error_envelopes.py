"""Error laws: envelopes of the error of a quantity over the resolution, by family of scenes.

At n elements per smaller semi-axis the error scatters below an envelope that falls with n, as the
unstructured meshes of two sizes share no nodes. Envelopes are calibrated on runs of known answer
(`railhead study calibrate` makes data/laws.json) and hold inside their family only: same cells,
same contact law, same kind of patch.

What measured profiles leave uncertain: half-spaces are solved on profiles smoothed with one, with
two and with half a smoothing length. The longer one takes away what may be shape, the shorter one
lets in what may be noise. Drawn profiles, which are not smoothed, are taken through either half of
their points, with twice their rounding. The largest change of pressure or area, times SAFETY, holds
the error in nine of ten seeds of the study `profiles`, and of drawn profiles in 224 of 225 (3 to 5
decimals, points 0.1 to 0.5 mm apart).
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.optimize import brentq

from railhead.contact import closed_forms, crossing, solid
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.planning.context import Context
from railhead.scene.scene import Scene
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic import hertz

T = TypeVar("T")
STEP = 1.6  # factor on the resolution from one mesh of a sequence to the next
STRETCHES = (2.0, 0.5)  # factors on the smoothing lengths
SAFETY = 2.0  # factor on the change, chosen on six seeds of each pair of the study
AIM = 0.95  # share of the prescribed accuracy that mesh and reading may take
RANGE = (3.0, 60.0)  # elements per smaller semi-axis that are considered
TURNED = {"a_mm": "b_mm", "b_mm": "a_mm"}
"""Half lengths along and across the rail change places in line contacts across it."""
USUAL = {"half-spaces": "ellipse", "bodies": "soft bodies"}
"""Family of solids by shape (`Plan.setting`), with quadratic tetrahedra and the default law, of all
materials."""
LAWS = Path(__file__).with_name("data") / "laws.json"


@dataclass(frozen=True)
class ErrorEnvelope:
    """Bound of a relative error: value * (6/n)^order + floor at n elements per smaller semi-axis.
    value: bound at n = 6 above the floor.
    order: power with which the bound falls.
    floor: part that no finer mesh takes away.
    """

    value: float
    order: float
    floor: float = 0.0

    def __call__(self, n: float) -> float:
        """Bound of the relative error at n elements per smaller semi-axis, also beyond the
        calibrated range.
        """
        return float(self.value * (6.0 / n) ** self.order + self.floor)


NONE = ErrorEnvelope(0.0, 1.0)
"""Of what has no error."""


def widest(one: ErrorEnvelope, other: ErrorEnvelope, ends: Sequence[float]) -> ErrorEnvelope:
    """Law without a floor that lies above two laws between the ends of a range of n: the larger one
    or, where they cross, the power of n through the larger values at both ends (in logarithms all
    are lines).
    """
    first, last = (max(one, other, key=lambda law: law(n)) for n in ends)
    if first is last:
        return first
    order = math.log(first(ends[0]) / last(ends[1])) / math.log(ends[1] / ends[0])
    return ErrorEnvelope(first(ends[0]) * (ends[0] / 6.0) ** order, order)


NEARLY_ELLIPTIC = {
    "a_mm": ErrorEnvelope(2.3e-3, 2.0),
    "b_mm": ErrorEnvelope(2.3e-3, 2.0),
    "area_mm2": ErrorEnvelope(4.6e-3, 2.0),
    "max_MPa": ErrorEnvelope(2.4e-3, 2.0),
}
"""Reading errors of half lengths that fourth moments correct (`postprocess.patch`), by key."""


def holds(where: Mapping[str, Sequence[Any]], setting: Mapping[str, Any]) -> bool:
    """Whether every value of a setting (`Plan.setting`) lies within what was calibrated
    (`Family.where`)."""
    return all(
        where[name][0] <= value <= where[name][1]
        if isinstance(value, float)
        else value in where[name]
        for name, value in setting.items()
    )


@dataclass(frozen=True)
class Family:
    """Scenes whose errors were measured together. The error of a quantity has two parts: that of
    the mesh, and that of reading, the difference of two ways of postprocessing the same solution.
    name: name of the family.
    where: by key of `Plan.setting`, the range of a float (two ends), or all allowed values of a
        word, a truth value, an integer or None.
    resolution: smallest and largest calibrated n, elements per smaller semi-axis.
    laws: envelope of the mesh error by key of summary.json, relative.
    reading: relative reading error of each quantity over the resolution, by key, which most
        solutions stay below; for the choice of resolutions and for prices.
    overlap: relative error by key for an overlap of the bodies as large as the approach.
    beyond: order of the mesh error on meshes finer than the calibrated ones, by key.
    coarser: what is added to the order of the mesh error below n = 6, by key, where the elements
        far from the patch are larger, too.
    Everywhere here n is the number of elements per smaller semi-axis of the patch.
    """

    name: str
    where: Mapping[str, Sequence[Any]]
    resolution: tuple[float, float]
    laws: Mapping[str, ErrorEnvelope]
    reading: Mapping[str, ErrorEnvelope]
    overlap: Mapping[str, float]
    beyond: Mapping[str, float] = field(default_factory=dict)
    coarser: Mapping[str, float] = field(default_factory=dict)

    def mesh(self, name: str, n: float) -> float:
        """Envelope of the relative mesh error of a quantity, at n elements per smaller semi-
        axis; beyond the calibrated range the envelope falls at most as the first power of n, where
        no other order was measured (`beyond`).
        name: key of the quantity in summary.json. KeyError: the family has no law for it.
        """
        law, top = self.laws[name], self.resolution[1]
        if n <= top:
            return law(n) * max(1.0, 6.0 / n) ** self.coarser.get(name, 0.0)
        return law(top) * (top / n) ** self.beyond.get(name, min(law.order, 1.0))

    def covers(self, n: float) -> bool:
        """Whether n elements per smaller semi-axis lie within the calibrated range, or are finer by
        at most a factor 1.6 (STEP).
        """
        low, high = self.resolution
        return low <= n * (1 + 1e-9) and n <= STEP * high * (1 + 1e-9)

    def expected(self, n: float) -> tuple[float, str, float]:
        """Largest of the relative errors of the calibrated quantities at n elements per smaller
        semi-axis, which are sums of mesh and reading error; the key of its quantity; and its mesh
        error.
        """
        mesh = {name: self.mesh(name, n) for name in self.reading}
        return max((part + self.reading[name](n), name, part) for name, part in mesh.items())

    @property
    def least(self) -> float:
        """Smallest relative accuracy that may be asked for: errors of mesh and reading on the
        finest mesh that the laws cover, over 0.95 (AIM), their share of an accuracy.
        """
        return self.expected(STEP * self.resolution[1])[0] / AIM

    def finest(self, accuracy: float) -> float:
        """Elements per smaller semi-axis at which all quantities are expected to meet the relative
        accuracy, of which mesh and reading may take 0.95 (AIM), within the range that the laws
        cover: the coarsest one where that is enough, the finest one where none meets it.
        """
        low, high = self.resolution[0], STEP * self.resolution[1]
        if self.expected(low)[0] <= AIM * accuracy:
            return low
        if accuracy <= self.least:
            return high
        return float(brentq(lambda n: self.expected(n)[0] - AIM * accuracy, low, high))


def _turned(values: Mapping[str, T]) -> dict[str, T]:
    """The mapping with the names of the half lengths along and across exchanged."""
    return {TURNED.get(name, name): value for name, value in values.items()}


def load_steps(overload: float, *, line: bool) -> Mapping[str, float]:
    """Relative errors that load steps of one multiple of the load of first yield leave, by key of
    summary.json; those of n steps for each multiple are smaller by n^1.5 (STEP_ORDER). Empty where
    none were measured. overload: load over that of first yield; line: whether it is a line contact.
    """
    fits = (
        each
        for each in _laws()["load_steps"]
        if each["line"] == line and overload <= each["overload"]
    )
    return next(fits, {"errors": {}})["errors"]


@cache
def _laws() -> dict[str, Any]:
    """What the file LAWS holds."""
    return dict(json.loads(LAWS.read_text(encoding="utf-8")))


@cache
def families() -> tuple[Family, ...]:
    """All calibrated families, from the file LAWS."""
    return tuple(
        Family(
            name,
            entry["where"],
            tuple(entry["resolution"]),
            {key: ErrorEnvelope(*law) for key, law in entry["laws"].items()},
            {key: ErrorEnvelope(*law) for key, law in entry["reading"].items()},
            entry["overlap"],
            entry.get("beyond", {}),
            entry.get("coarser", {}),
        )
        for name, entry in _laws()["families"].items()
    )


def family(setting: Mapping[str, Any], *, parabolic: bool, friction: bool = False) -> Family | None:
    """The family that the setting (`Plan.setting`) lies in, turned for a width across the rail;
    None where no family was calibrated for the setting. friction: whether lines of like bodies rub,
    which adds laws of their forces over mu N and motions, and widens those of stresses; measured up
    to a Poisson's ratio of 0.4.

    The approach depends on distant elements, whatever the contact law: the envelope of a family of
    both shapes is not below that of the same shape with the default law (USUAL). Reading errors of
    nearly elliptic patches of bodies are not below NEARLY_ELLIPTIC where the gap is no parabola
    (`Plan.parabolic`).
    """
    found = next((each for each in families() if holds(each.where, setting)), None)
    usual = next((each for each in families() if each.name == USUAL.get(setting["shape"])), None)
    if found and usual and len(found.where["shape"]) > 1:
        own, other = found.laws["approach_mm"], usual.laws["approach_mm"]
        found = replace(
            found, laws={**found.laws, "approach_mm": widest(own, other, found.resolution)}
        )
    fourth = setting["shape"] == "bodies" and setting["ellipse"] and not setting["overload"]
    if found and fourth and not parabolic:
        reading = {
            name: widest(law, NEARLY_ELLIPTIC.get(name, law), found.resolution)
            for name, law in found.reading.items()
        }
        found = replace(found, reading=reading)
    if found and friction:
        known, wider = _laws()["friction"], dict(found.laws)
        if not holds(known["where"], setting):
            return None
        for key, law in known["laws"].items():
            wider[key] = widest(ErrorEnvelope(*law), wider.get(key, NONE), known["resolution"])
        read = ErrorEnvelope(*known["reading"])  # of the largest stresses, which do not converge
        reading = dict.fromkeys(wider, NONE) | {**found.reading}
        reading |= {key: read for key in known["laws"] if key in found.reading}
        found = replace(found, resolution=known["resolution"], laws=wider, reading=reading)
    if found and setting["turned"]:
        found = replace(
            found,
            laws=_turned(found.laws),
            reading=_turned(found.reading),
            overlap=_turned(found.overlap),
        )
    return found


def of_profiles(context: Context) -> dict[str, Any] | None:
    """Relative error that the measured profiles of a scene may hide (`around`), as "relative", and
    why it is infinite, as "reason": boundary elements find no patch. None where no profile is
    measured, for half-spaces, and in sections, whose contacts no half-space has.
    """
    scene, contact = context.contact.scene, context.contact
    measured = bool(solid.measured_bodies(scene))
    if not contact.curved_solid or not (measured or scene.rail.varies):
        return None
    try:
        if isinstance(contact, crossing.HeadContact):
            found = of_sections(context, contact.crossing, measured=measured)
            return {"relative": found, "reason": ""}
        return {"relative": around(scene, context.half_spaces.boundary_elements), "reason": ""}
    except ValueError as error:
        return {"relative": math.inf, "reason": str(error)}


def of_sections(context: Context, found: crossing.Crossing, *, measured: bool) -> float:
    """Relative error of sizes and values that the sections of a rail may hide: twice (SAFETY) the
    largest change when every second section is left out, and when a measured wheel is smoothed as
    in `around`. It is the change of Hertz's pressure or area on a head that may touch, or what the
    changed height of a head moves of the load between two. Raises ValueError (SceneError is one)
    where the wheel then touches otherwise.
    """
    scene, sink = context.scene, context.hertz.approach
    others = [crossing.touch(scene, every=2)]
    others += [crossing.touch(scene, stretch=each) for each in STRETCHES * measured]
    near = [name for name in found.heads if found.placed(name)[0].gap < 2 * sink]
    modulus, changes = closed_forms.contact_modulus(scene), []
    for other in others:
        for name in near:
            if name not in other.heads:
                raise ValueError(f"without every second section nothing touches the {name}")
            first, second = (
                hertz.point_contact(at.curvature_x, at.curvature_y, modulus, context.hertz.load)
                for at in (each.heads[name].touches[0] for each in (found, other))
            )
            changes += [second.p0 / first.p0 - 1, second.area / first.area - 1]
        moved = [other.alone(name) - found.alone(name) for name in near]
        changes.append(float(np.ptp(moved)) / (2 * sink))  # 3/2 of it of a force, a third of that
    return SAFETY * max(map(abs, changes))


def around(scene: Scene, solution: BoundaryElementSolution) -> float:
    """Relative error of sizes and values of the answer that measured profiles may hide: twice
    (SAFETY) the largest relative change of largest pressure or area when the smoothing
    length of the measured profiles is doubled or halved, and half of the points of drawn ones are
    left out.
    solution: boundary elements with the usual smoothing.
    Raises ValueError (SceneError is one) where one length leaves no contact.
    """
    changes = []
    for stretch in STRETCHES:
        contact = solid.locate(scene, solid.pairs(scene, stretch))
        other = HalfSpacePair(contact, closed_forms.ellipse(scene, contact)).pressed(scene.load)
        changes += [other.max_pressure / solution.max_pressure - 1, other.area / solution.area - 1]
    return SAFETY * max(map(abs, changes))
