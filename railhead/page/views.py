"""What the page shows of a scene, as plain data: controls, profiles in contact, half-spaces, radii.

Each function takes a case as `railhead run` does, and values by dotted key, texts as after --set.
All raise SceneError for a wrong key or value, and where the wheel cannot stand.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import tomli_w

from railhead.cli import geometry
from railhead.contact import solid
from railhead.geometry import profiles, wheelset
from railhead.scene import catalogue
from railhead.scene.scene import Scene, unit_questions
from railhead.theory.array_types import Array

Values = Mapping[str, str]
SAMPLES = 300  # points of an outline
CELLS = 90  # of the picture of a pressure, along each axis
WHEELS = ("S1002", "cylinder", *profiles.CONES)


class Slider(NamedTuple):
    """A number that the page lets people move.

    id: of the element. key: dotted key. label: words. unit: of the ends.
    factor: from the unit to the base unit.
    low, high, step: ends and steps, in the unit.
    """

    id: str
    key: str
    label: str
    unit: str
    factor: float
    low: float
    high: float
    step: float


LOAD = Slider("load", "load", "Load", "kN", 1e3, 1, 250, 1)
ON_TRACK = (
    Slider("shift", "wheelset.shift", "Shift to the right", "mm", 1.0, -10, 10, 0.1),
    Slider("yaw", "wheelset.yaw", "Yaw", "mrad", 1e-3, -20, 20, 0.5),
    Slider("roll", "wheelset.roll", "Roll (empty: it follows)", "mrad", 1e-3, -10, 10, 0.1),
)


def scene_of(case: str, values: Values) -> Scene:
    """The scene of a case with the values set, as the command builds it."""
    return catalogue.find(case).replace([f"{key}={value}" for key, value in values.items()])


def arguments(case: str, values: Values) -> list[str]:
    """Arguments of `railhead run` that give the scene of `scene_of`."""
    return ["run", case, *(word for pair in values.items() for word in ("--set", "=".join(pair)))]


def controls(case: str, values: Values) -> dict[str, Any]:
    """Name and kind of a scene ("track", "sections" or "half-space"), the sliders that move it with
    the texts of its own values, and its choices by key, its own first.
    """
    scene = scene_of(case, values)
    kind: str = "half-space"
    sliders: tuple[Slider, ...] = (LOAD,)
    choices: dict[str, list[str]] = {}
    if scene.rail.extent != "half-space":
        kind, sliders = "track", (*ON_TRACK, LOAD)
        choices = {
            "rail.profile": [scene.rail.profile, *profiles.STANDARD_RAILS],
            "wheel.profile": [scene.wheel.profile, *WHEELS],
            "wheelset.side": [scene.wheelset.side, "right", "left"],
        }
    return {
        "name": scene.name,
        "kind": kind,
        "sliders": [each._asdict() | {"text": _text(scene, each)} for each in sliders],
        "choices": {key: list(dict.fromkeys(each)) for key, each in choices.items()},
    }


def _text(scene: Scene, slider: Slider) -> str:
    """The value of a slider in a scene, with its unit; empty where there is none."""
    value = scene.value(slider.key)
    return f"{value / slider.factor:.12g} {slider.unit}" if isinstance(value, float) else ""


def rigid(case: str, values: Values) -> dict[str, Any]:
    """The scene as TOML, the command that gives its answer by half-spaces, questions about its
    units, and the bodies before any load: by side of the track outlines [y, z] in mm, in the axes
    of the side, with contact points; none between half-spaces.
    """
    scene = scene_of(case, values)
    said = {
        "scene": tomli_w.dumps(scene.model_dump(exclude_none=True, exclude_defaults=True)),
        "command": shlex.join(["railhead", *arguments(case, values), "--fast"]),
        "questions": list(unit_questions(scene)),
        "sides": {},
        "place": "half-spaces have no profiles",
    }
    return said if scene.rail.extent == "half-space" else said | _on_track(scene)


def _on_track(scene: Scene) -> dict[str, Any]:
    """Both sides of a wheelset on its track, and in words where it stands."""
    placed, gauge = solid.place(scene, geometry.CLEARANCE), scene.rail.gauge
    sides = {}
    for name, side in (("left", placed.left), ("right", placed.right)):
        pair, depth = side.pair, scene.rail.gauge_height
        y, tread = (np.linspace(*each.domain, SAMPLES) for each in (pair.rail, pair.wheel))
        sides[name] = {
            "rail": plain([y, pair.rail.height(y)]),
            "wheel": plain(pair.outline(side.pose, tread).points[:, 1:].T),
            "touches": [
                {
                    "y": each.y,
                    "z": each.z,
                    "text": f"{name}: y = {each.y:.2f} mm, angle {math.degrees(each.angle):.2f}°, "
                    f"gap {each.gap:.3f} mm, rolling radius {each.radius:.3f} mm",
                }
                for each in side.touches
            ],
            "face": None if gauge is None else wheelset.gauge_face(pair.rail, depth),
        }
    track = "tape circles over the crown centres"
    if gauge is not None:
        track = f"gauge {gauge:g} mm, {scene.rail.gauge_height:g} mm below the tops"
    difference = placed.rolling_radius_difference
    return {
        "sides": sides,
        "shift": placed.shift,
        "difference": difference,
        "place": f"{track}; roll {1e3 * placed.roll:.3f} mrad; rolling radius difference "
        f"{difference:.3f} mm (right less left)",
    }


def radii(case: str, values: Values) -> dict[str, Any]:
    """Rolling radius difference over the shift [mm, mm], jumps and equivalent conicity, as
    `railhead locate` has them; empty where no wheelset stands on a track.
    """
    scene = scene_of(case, values)
    if scene.rail.extent == "half-space":
        return {}
    found = geometry.locate(scene)
    assert isinstance(found, geometry.Location)
    said = {f"{each:g}": found.level.conicities.get(each) for each in (1.0, 3.0, 5.0)}
    return {
        "curve": plain(found.radii.differences),
        "jumps": found.radii.jumps,
        "conicity": {key: value for key, value in said.items() if value is not None},
    }


def half_spaces(case: str, values: Values) -> dict[str, Any]:
    """The answer of `railhead run --fast`: "result" and estimates of summary.json, sentences on
    yield, failed checks, and the pressure over the patch for a picture.
    """
    from railhead.planning import simulation_plan as planning
    from railhead.results import pipeline
    from railhead.results.report import terminal
    from railhead.run.progress import Progress

    scene = scene_of(case, values).replace(["effects.finite_bodies=off"])
    found = pipeline.solve(planning.make(scene), Progress(quiet=True))
    summary = found.summary
    result = summary["result"] or {}
    failed = terminal.recorded(lambda console: terminal.show_failure(summary, console))
    return {
        "result": result,
        "estimates": summary["accuracy"]["bound"],
        "sentence": terminal.yields(result),
        "failed": failed.export_text(),
        "pressure": _pressure(found.surface) if result else None,
    }


def _pressure(surface: Any) -> dict[str, Any]:
    """Pressure for a picture: x and s (mm) and pressures (MPa) of a grid around the patch, a row
    for each s, null beside the bodies; of a line s and pressures.
    """
    from matplotlib.tri import LinearTriInterpolator, Triangulation

    local, pressure = surface.local, surface.pressure
    if surface.triangles.shape[1] == 2:
        axis = int(np.ptp(local[:, 1]) > np.ptp(local[:, 0]))
        order = np.argsort(local[:, axis])
        return {"s": plain(local[order, axis]), "pressure": plain(pressure[order])}
    loaded = local[pressure > 0]
    middle, half = (loaded.max(axis=0) + loaded.min(axis=0)) / 2, np.ptp(loaded, axis=0) * 0.6
    x, s = (np.linspace(m - h, m + h, CELLS) for m, h in zip(middle, half, strict=True))
    between = LinearTriInterpolator(Triangulation(*local.T, surface.triangles), pressure)
    return {"x": plain(x), "s": plain(s), "pressure": plain(between(*np.meshgrid(x, s)))}


def plain(values: Any) -> list[Any]:
    """Lists of numbers, rounded to 1e-4, None for what is no number or masked; of pairs of arrays
    lists of them.
    """
    rounded: Array = np.round(np.ma.filled(np.ma.asarray(values, dtype=float), np.nan), 4)
    return np.where(np.isfinite(rounded), rounded, None).tolist()  # type: ignore[call-overload]
