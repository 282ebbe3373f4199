"""The route of a wear run: positions that wear the same profiles, each with its share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from railhead.planning import simulation_plan as planning
from railhead.run.half_spaces.worn_contact import BODIES, Position
from railhead.scene.files import wear_pairs
from railhead.scene.scene import Scene, SceneError, checked
from railhead.scene.sections import QUANTITIES, refuse_first
from railhead.sweeps.grid import read_rows
from railhead.theory import wear
from railhead.theory.wear import WearLaw

SHARE, AMOUNT = "share", {"rail": "axles", "wheel": "distance"}
FILE_KEYS = (
    *(f"profile_{key}" for key in ("unit", "mirror", "flip", "origin", "shift")),
    "smoothing",
)
SHAPE = {
    "rail": ("profile", "crown_radius", "inclination", "width", *FILE_KEYS),
    "wheel": ("profile", "transverse_radius", "rolling_radius", "tape_circle", *FILE_KEYS),
}
"""Keys of the shape of a body, which must be the same in all positions where it is worn."""
PHYSICS = ("finite_bodies", "rail_section", "plasticity", "plasticity_wheel", "heat")
"""Effects that are named where plans call for them."""
NO_SOLID = "wear needs the profiles of a rail and of a wheel, not half-spaces or a section"


@dataclass(frozen=True, kw_only=True)
class Route:
    """Positions that wear the profiles of a scene.

    scene: the scene, with its table [wear].
    positions: with their parts of the passages.
    shares: of all passages, one a position; their sum is 1.
    left_out: why effects are called for that wear leaves out, of the first such position, by name.
    """

    scene: Scene
    positions: tuple[Position, ...]
    shares: tuple[float, ...]
    left_out: dict[str, str]

    @property
    def worn(self) -> list[str]:
        """Names of the bodies that are worn, 'rail' and 'wheel'."""
        return [body for body in BODIES if self.scene.wear.on in (body, "both")]


def read(scene: Scene) -> Route:
    """The route of a scene. Raises SceneError for a table [wear], a file of positions or a position
    that cannot be used.
    """
    given = checked(scene).wear
    worn = [body for body in BODIES if given.on in (body, "both")]
    for body, key in AMOUNT.items():
        if (body in worn) != (getattr(given, key) is not None):
            needed = f"is not given; wear.on = {given.on} needs it"
            text = needed if body in worn else f"is not allowed beside wear.on = {given.on}"
            raise SceneError(f"wear.{key}", text)
    laws = {"energy": WearLaw.of_energy(given.rate), "usfd": WearLaw(wear.USFD)}
    law = laws.get(given.law) or WearLaw(wear_pairs(given.law))
    rows = _rows(scene)
    weights = [_weight(row.pop(SHARE, 1.0), number) for number, row in enumerate(rows, 1)]
    shares = tuple(weight / math.fsum(weights) for weight in weights)
    positions: list[Position] = []
    left_out: dict[str, str] = {}
    for number, (row, share) in enumerate(zip(rows, shares, strict=True), 1):
        try:
            position = scene.replace(**{"effects.finite_bodies": "off", **row})
            _refuse(position, scene, worn)
            plan = planning.make(position)
            refuse_first((not plan.contact.curved_solid, "rail.extent", NO_SOLID))
        except SceneError as error:
            where = f" (position {number})" if given.positions else ""
            raise SceneError(error.key, f"{error.text}{where}") from None
        for name in PHYSICS:
            effect = plan.effects[name]
            if effect.called_for and not effect.on:
                cost = f"; it may change a quantity by {effect.error:.1%}" if effect.error else ""
                left_out.setdefault(name, f"{effect.why}{cost}")
        axles, distance = share * (given.axles or 0.0), share * (given.distance or 0.0)
        positions.append(
            Position(scene=position, hertz=plan.hertz, law=law, axles=axles, distance=distance)
        )
    return Route(scene=scene, positions=tuple(positions), shares=shares, left_out=left_out)


def _rows(scene: Scene) -> list[dict[str, object]]:
    """Rows of values by dotted key of the route of a scene; one without values where it has none.
    Raises SceneError for a file that is no such table.
    """
    if scene.wear.positions is None:
        return [{}]
    try:
        rows = read_rows(Path(scene.wear.positions))
    except SceneError as error:
        raise SceneError("wear.positions", error.text) from None
    if own := [key for key in rows[0] if key.startswith("wear.")]:
        text = f"{own[0]} is of the whole route; give it in the scene, not in a position"
        raise SceneError("wear.positions", text)
    return rows


def _weight(value: object, number: int) -> float:
    """The share of a position. Raises SceneError for anything but a positive number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
        text = f"share {value!r} of position {number} is not allowed; give a positive number"
        raise SceneError("wear.positions", text)
    return float(value)


def _refuse(position: Scene, base: Scene, worn: Sequence[str]) -> None:
    """Raise SceneError for a position that does not roll with friction under a load, or with
    another shape of a body that is worn than in the base scene.
    """
    rolling = position.rolling
    refuse_first(
        (position.load is None, "load", "is not given; wear needs it"),
        (not rolling.prescribed, "rolling", "is not given; wear needs creepages, spin or a force"),
        (position.effects.friction == "off", "effects.friction", "off is not allowed in wear"),
        (rolling.passes is not None, "rolling.passes", "is not allowed in wear; leave it out"),
        (
            {*position.quantities} != {*QUANTITIES},
            "quantities",
            f"{','.join(position.quantities)} is not allowed in wear; leave it out",
        ),
        *(
            (part.surface is not None, f"{body}.surface", "is not allowed in wear; leave it out")
            for body, part in position.bodies.items()
        ),
        *(
            (
                position.value(f"{body}.{key}") != base.value(f"{body}.{key}"),
                f"{body}.{key}",
                f"must be the same in all positions, as the {body} is worn",
            )
            for body in worn
            for key in SHAPE[body]
        ),
    )
