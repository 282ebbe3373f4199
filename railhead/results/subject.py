"""What the pictures and the report of a scene call it."""

import math
from pathlib import Path

from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import BASE_UNITS, Subject, Units, brief


def subject(plan: Plan, load: float, units: Units = BASE_UNITS) -> Subject:
    """Title of a scene with its load, pair of profiles and friction, and what labels of pictures
    say of it. load: vertical load of the solution, N, or of the scene. units: of the numbers that
    are shown.
    """
    scene, half_space = plan.scene, plan.contact.half_space
    rail, wheel = scene.rail, scene.wheel
    kilo = load >= 1e3 and "N" not in units.chosen
    title = f"{scene.name}: {f'{brief(load / 1e3)} kN' if kilo else units.text(load, 'N')}, "
    title += f"wheel R {units.text(wheel.rolling_radius, 'mm', 6)}, tread "
    title += f"{_profile(wheel.profile, wheel.transverse_radius, units)}, on rail "
    title += _profile(rail.sections or rail.profile, rail.crown_radius, units)
    title += ", as half-spaces" if half_space else ""
    has_friction = plan.effects["friction"].on
    if has_friction:
        values = sorted({mu for _, mu in scene.friction.table or scene.friction.pairs})
        text = f"{values[0]:g} to {values[-1]:g}" if len(values) > 1 else f"{values[0]:g}"
        title += f", friction\N{NO-BREAK SPACE}{text}"
    return Subject(
        title,
        gauge=rail.profile != "arc" and not half_space,
        rolls=scene.rolling.prescribed and has_friction,
        has_friction=has_friction,
        revolved=plan.contact.revolved,
        method="half-spaces" if plan.by_half_spaces else "finite elements",
        units=units,
    )


def _profile(profile: str, radius: float | None, units: Units) -> str:
    """Name of a profile, of a file without its folder; of an arc its radius, or "flat"."""
    if profile != "arc":
        return Path(profile).name
    if radius is None or math.isinf(radius):
        return "flat"
    return f"R {units.text(radius, 'mm', 6)}"
