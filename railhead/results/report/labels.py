"""Names of the summary in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from railhead.results.report.output_units import Units
from railhead.scene.scene import Scene, unit
from railhead.scene.sections import Section

EFFECTS = {
    "plane_strain": "line contact, solved in a section",
    "axisymmetry": "body of revolution, solved in a meridian section",
    "symmetry_x": "symmetry along the rail (half is solved)",
    "symmetry_y": "symmetry across the rail (half is solved)",
    "deformable_rail": "the rail deforms",
    "deformable_wheel": "the wheel deforms",
    "true_profile": "true profiles instead of radii",
    "rail_section": "whole rail with web and foot",
    "far_field": "half-spaces around the bodies",
    "finite_bodies": "bodies that end, by finite elements",
    "mean_dilatation": "nearly incompressible material",
    "friction": "friction, traction and creepage",
    "plasticity": "steel that yields",
    "heat": "heat of friction (told, not simulated)",
    "small_patch": "patch small beside the radii (after)",
    "inside_the_bodies": "patch away from the edges (after)",
    "thick_bodies": "bodies thick enough (after)",
}
CHECKS = {
    "effects_left_out": "effects that are called for are simulated",
    "converged": "the solver converged",
    "force_balance": "forces are in balance",
    "approach_reached": "the given approach is met",
    "patch_settled": "the mesh is fine where the patch is",
    "elements_across": "elements across the patch",
    "pressure_noise": "noise of the pressure",
    "penetration": "overlap of the bodies",
    "flux_rail": "the stresses below the patch carry the load, rail",
    "flux_wheel": "the stresses above the patch carry the load, wheel",
    "stress_misfit": "smooth stresses against the elements' own",
    "shear_over_pressure": "largest shear stress over pressure, at most",
    "shear_over_pressure_least": "largest shear stress over pressure, at least",
    "mises_over_shear": "von Mises over shear stress, at most",
    "mises_over_shear_least": "von Mises over shear stress, at least",
    "small_strain": "strains are small: pressure over modulus",
    "pressure_of_steel": "a pressure that some steel bears, MPa",
    "edge_distance": "patch away from edges",
    "grid_error": "the cells of half-spaces are small enough",
    "pressure_over_mean": "largest over mean pressure",
    "tangential_flux_rail": "the stresses below the patch carry the tangential force, rail",
    "tangential_flux_wheel": "the stresses above the patch carry the tangential force, wheel",
    "accuracy": "the asked accuracy",
}
AGAINST = "second_opinion_"


def effect(name: str) -> str:
    """Words for the name of an effect or of a check of it after the solution."""
    return EFFECTS.get(name, name.replace("_", " "))


def check(name: str) -> str:
    """Words for the name of a check."""
    if name.startswith(AGAINST):
        bare = name.removeprefix(AGAINST).rsplit("_", 1)[0].replace("_", " ")
        return f"second method (half-spaces): {'pressure' if bare == 'max' else bare}"
    return CHECKS.get(name, name.replace("_", " "))


def scene_rows(scene: Scene, units: Units) -> Iterator[tuple[str, str]]:
    """Pairs (key in words, value with unit) of all keys of a scene that have a value other than
    "auto".
    """
    for key, value in scene:
        if not isinstance(value, Section):
            yield from _row(key, value, units)
        elif key != "effects":
            for inner, each in value:
                yield from _row(f"{key}.{inner}", each, units)
    for name, state in scene.effects:
        if state != "auto":
            yield f"effect: {name.replace('_', ' ')}", str(state)


def _row(key: str, value: Any, units: Units) -> Iterator[tuple[str, str]]:
    """The pair (key in words, value with unit) of one key; nothing for None and "auto"."""
    if value in (None, "auto"):
        return
    text = str(value)
    if isinstance(value, float):
        base = unit(key)
        if base == "rad":
            value, base = 1e3 * value, "mrad"
        text = f"{units.value(value, base):.6g} {units.unit(base)}".strip()
    yield key.replace(".", ": ").replace("_", " "), text
