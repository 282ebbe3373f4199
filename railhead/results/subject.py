"""What the pictures and the report of a scene call it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import BASE_UNITS, Subject, Units, brief
from railhead.scene.bodies import Rail, Wheel, Wheelset


def subject(plan: Plan, load: float, units: Units = BASE_UNITS) -> Subject:
    """Title of a scene, names of its bodies, and labels of its directions for pictures. load:
    vertical load of the solution, N, or of the scene. units: of the numbers that are shown.
    """
    scene, contact = plan.scene, plan.contact
    bar = math.isinf(scene.wheel.rolling_radius)
    roller = contact.plane == "xz" and not bar and scene.rail.profile == "arc"
    short, long = zip(
        _rail(scene.rail, bar, contact.half_space, units),
        _wheel(scene.wheel, bar, roller, units),
        strict=True,
    )
    if short[0] == short[1]:
        short = f"lower {short[0]}", f"upper {short[1]}"
    long = _said(long[0], scene.rail), _said(long[1], scene.wheel)
    real = scene.rail.profile != "arc" and not contact.half_space
    kilo = load >= 1e3 and "N" not in units.chosen
    force = f"{brief(load / 1e3)} kN" if kilo else units.text(load, "N")
    has_friction = plan.effects["friction"].on
    end = ", as half-spaces" if contact.half_space else ""
    end += _stands(scene.wheelset, units)
    if has_friction:
        values = sorted({mu for _, mu in scene.friction.table or scene.friction.pairs})
        text = f"{values[0]:g} to {values[-1]:g}" if len(values) > 1 else f"{values[0]:g}"
        end += f", friction\N{NO-BREAK SPACE}{text}"
    along, across = "in the rolling direction", "along the axis" if roller else "across"
    if bar:
        along, across = "along the axes", "across the axes"
    if short[0] == "rail":
        along, across = "along the rail", "across the rail"
    return Subject(
        f"{scene.name}: {force}, {long[1]} on {long[0]}{end}",
        dict(zip(("rail", "wheel"), short, strict=True)),
        along,
        across,
        gauge=real,
        rolls=scene.rolling.prescribed and has_friction,
        has_friction=has_friction,
        revolved=contact.revolved,
        method="half-spaces" if plan.by_half_spaces else "finite elements",
        units=units,
    )


def _stands(wheelset: Wheelset, units: Units) -> str:
    """Side of a left wheel, lateral shift and yaw (mrad) of its wheelset as text; empty for a right
    wheel where both are zero.
    """
    shift, yaw = units.text(wheelset.shift, "mm").split(), 1e3 * wheelset.yaw
    end = ", left wheel" if wheelset.side == "left" else ""
    end += f", {chr(0xA0).join(('shifted', *shift))}" if wheelset.shift else ""
    return end + (f", yaw\N{NO-BREAK SPACE}{brief(yaw)}\N{NO-BREAK SPACE}mrad" if yaw else "")


def shared_y(plans: Iterable[Plan]) -> str:
    """Label of the y axis in a picture of several scenes: that of all of them if equal, else "y,
    mm".
    """
    words = {subject(plan, 0.0).y for plan in plans}
    return words.pop() if len(words) == 1 else "y, mm"


def _said(text: str, body: Rail | Wheel) -> str:
    """Name of a body, with "rigid" for a rigid one."""
    if not math.isinf(body.young_modulus):
        return text
    return f"a rigid {text[2:]}" if text.startswith("a ") else f"rigid {text}"


def _rail(rail: Rail, bar: bool, half_space: bool, units: Units) -> tuple[str, str]:
    """Short name of the lower body, and name with its size. bar: whether the wheel is a straight
    bar; half_space: whether the bodies are half-spaces.
    """
    if rail.profile != "arc":
        tilt = f", inclined 1:{1 / rail.inclination:.3g}" if rail.inclination else ""
        return "rail", f"rail {Path(rail.profile).name}{tilt}"
    crown = rail.crown_radius or math.inf
    if math.isinf(crown):
        return ("plane", "a plane") if half_space else ("block", "a flat block")
    if bar:
        return "cylinder", f"cylinder R {units.text(crown, 'mm', 6)}"
    return "rail", f"rail, crown R {units.text(crown, 'mm', 6)}"


def _wheel(wheel: Wheel, bar: bool, roller: bool, units: Units) -> tuple[str, str]:
    """Short name of the upper body, and name with its size. bar: whether the wheel is a straight
    bar; roller: whether it is a roller on an arc in a section along the rail.
    """
    rolling, tread = wheel.rolling_radius, wheel.transverse_radius
    if wheel.profile == "arc" and tread == rolling:
        return "sphere", f"sphere R {units.text(rolling, 'mm', 6)}"
    profile = Path(wheel.profile).name  # a file's name will do
    if bar:
        if tread:
            return "cylinder", f"cylinder R {units.text(tread, 'mm', 6)}"
        return "bar", f"straight bar, profile {profile},"
    if roller:
        return "roller", f"roller R {units.text(rolling, 'mm', 6)}"
    shape = f"tread {profile}"
    if wheel.profile == "arc":
        shape = f"tread arc R {units.text(tread or math.inf, 'mm', 6)}"
    return "wheel", f"wheel R {units.text(rolling, 'mm', 6)}, {shape},"
