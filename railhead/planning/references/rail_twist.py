"""How far a load beside the web twists a rail, and what that does to the patch.

A wheel that only moves down presses along the contact normal. The moment of that force about the
centre of twist turns the head; where the radii of both bodies change, another place is another
patch. The compliance was measured with finite elements: 54E1 and 60E1, a metre long, foot held
(`railhead study calibrate`).
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

from railhead.contact.solid import Contact
from railhead.geometry import profiles
from railhead.geometry.placement import PlacementError
from railhead.planning.references import boundary_elements, closed_forms
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.line import Hertz

MEASURED = json.loads(
    (Path(__file__).parents[1] / "data" / "twist.json").read_text(encoding="utf-8")
)
COMPLIANCE: dict[str, float] = MEASURED["compliance"]  # twist times E over the moment, 1/mm3
CENTRE: float = MEASURED["centre_mm"]  # depth of the centre of twist below the crown (67 to 76 mm)


def lever(contact: Contact, centre: float = CENTRE) -> float:
    """Distance in y of the contact normal from the centre of twist, at the height of this centre,
    mm, positive on the field side.
    centre: depth of the centre of twist below the crown, mm.
    """
    touch, inclination = contact.touch, contact.scene.rail.inclination
    return touch.y + (touch.z + centre) * touch.slope - centre * inclination


def twist(contact: Contact, ellipse: Hertz) -> float:
    """Rotation of the rail head, rad, positive towards the middle of the track, under the vertical
    load of `ellipse`, whose own load is the normal force. A measured rail is taken for the softer
    one of the standard rails.
    """
    moment = -ellipse.load * math.cos(contact.touch.angle) * lever(contact)
    rail = contact.scene.rail
    compliance = COMPLIANCE.get(rail.profile, max(COMPLIANCE.values()))
    return compliance * moment / rail.young_modulus


def twisted(contact: Contact, angle: float, aside: float) -> Contact:
    """Contact with the wheel lowered onto the rail whose head is turned by `angle` (rad) about its
    crown and moved by -aside (mm) along y relative to the wheel. The turn is positive towards the
    middle of the track.
    Raises PlacementError for half-spaces, and where the wheel misses the rail.
    """
    if contact.pair is None or contact.pose is None:
        raise PlacementError("half-spaces do not twist")
    rail = contact.scene.rail
    if rail.profile in COMPLIANCE:
        slope = math.tan(math.atan(rail.inclination) + angle)
        turned = profiles.rail_head(rail.profile, slope)
    else:
        turned = profiles.rolled(contact.pair.rail, math.tan(angle))
    pair = replace(contact.pair, rail=turned)
    beside = contact.pose.moved(y=aside)
    pose = beside.moved(z=-pair.touches(beside)[0].gap)
    return replace(contact, touch=pair.touches(pose)[0], pair=pair, pose=pose)


def change(contact: Contact, before: BoundaryElementSolution, angle: float, aside: float) -> float:
    """Relative change of the largest pressure or of the area, the larger one and never negative,
    where the rail is turned by `angle` (rad) and moved by -aside (mm), by boundary elements.
    before: solution without twist, under the same load.
    Raises ValueError where the wheel misses the twisted rail or there is no closed patch.
    """
    other = twisted(contact, angle, aside)
    load = contact.scene.load or before.load
    hertz = closed_forms.ellipse(contact.scene, other, load)
    after = boundary_elements.solve(other, hertz, load)
    pressure, area = after.max_pressure / before.max_pressure, after.area / before.area
    return max(abs(pressure - 1), abs(area - 1))
