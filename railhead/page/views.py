"""What the page shows of a scene, as plain data: controls, profiles in contact, half-spaces, radii.

Each function takes a case as `railhead run` does, and values by dotted key, texts as after --set.
All raise SceneError for a wrong key or value, and where the wheel cannot stand.
"""

import math
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w

from railhead.cli.examined import geometry
from railhead.contact import crossing, solid
from railhead.geometry import profiles, wheelset
from railhead.geometry.placement import ContactPoint, Pose, ProfilePair
from railhead.geometry.profiles import Profile
from railhead.meshing.bodies import BODY_NAMES
from railhead.results import result_folder
from railhead.scene import catalogue
from railhead.scene.scene import Scene, unit_questions
from railhead.theory.array_types import Array

Values = Mapping[str, str]
SAMPLES = 300  # points of an outline
NEAR = 5.0  # of the patch's larger half length: what of the bodies is shown at first
FIELDS = "solution", "contact"  # files of a result
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
POSITION = Slider("position", "rail.position", "Position of the axle", "mm", 1.0, 0, 0, 0.5)
SLIDERS = (POSITION, *ON_TRACK, LOAD)


def scene_of(case: str, values: Values) -> Scene:
    """The scene of a case with the values set, as the command builds it."""
    return catalogue.find(case).replace([f"{key}={value}" for key, value in values.items()])


def arguments(case: str, values: Values) -> list[str]:
    """Arguments of `railhead run` that give the scene of `scene_of`."""
    return ["run", case, *(word for pair in values.items() for word in ("--set", "=".join(pair)))]


def on_meshes(case: str, values: Values) -> Values:
    """Values with which finite elements solve a scene, that of a --fast result too."""
    off = scene_of(case, values).effects.finite_bodies == "off"
    return {**values, "effects.finite_bodies": "auto"} if off else values


def controls(case: str, values: Values) -> dict[str, Any]:
    """Name and kind of a scene ("track", "sections" or "half-space"), the sliders that move it with
    the texts of its own values, and its choices by key, its own first.
    """
    scene = scene_of(case, values)
    kind, sliders = _kind(scene), _sliders(scene)
    choices: dict[str, list[str]] = {
        "rail.profile": [scene.rail.profile, *profiles.STANDARD_RAILS],
        "wheel.profile": [scene.wheel.profile, *WHEELS],
        "wheelset.side": [scene.wheelset.side, "right", "left"],
    }
    if kind != "track":
        choices = {}
    return {
        "name": scene.name,
        "kind": kind,
        "sliders": [each._asdict() | {"text": _text(scene, each)} for each in sliders],
        "choices": {key: list(dict.fromkeys(each)) for key, each in choices.items()},
    }


def _sliders(scene: Scene) -> list[Slider]:
    """Sliders that move a scene, wide enough for its own values."""
    sliders = [*ON_TRACK, LOAD]
    if scene.rail.sections:
        x = np.concatenate([head.x for head in crossing.heads(scene).values()])
        sliders = [POSITION._replace(low=x.min(), high=x.max()), *sliders]
    elif scene.rail.extent == "half-space":
        sliders = [LOAD]
    values = [(each, _number(scene, each)) for each in sliders]
    return [
        each if at is None else each._replace(low=min(each.low, at), high=max(each.high, at))
        for each, at in values
    ]


def _number(scene: Scene, slider: Slider) -> float | None:
    """The value of a slider in a scene, in its unit; None where there is none."""
    value = scene.value(slider.key)
    return value / slider.factor if isinstance(value, float) else None


def _kind(scene: Scene) -> str:
    """Kind of a scene, as of `controls`."""
    if scene.rail.varies:
        return "sections"
    return "half-space" if scene.rail.extent == "half-space" else "track"


def _text(scene: Scene, slider: Slider) -> str:
    """The value of a slider in a scene, with its unit; empty where there is none."""
    value = _number(scene, slider)
    return "" if value is None else f"{value:.12g} {slider.unit}"


def described(case: str, values: Values) -> dict[str, Any]:
    """The scene as TOML, the command that gives its answer by half-spaces, questions about its
    units, and where its sliders stand, by id and in their units.
    """
    scene = scene_of(case, values)
    return {
        "scene": tomli_w.dumps(scene.model_dump(exclude_none=True, exclude_defaults=True)),
        "command": shlex.join(["railhead", *arguments(case, values), "--fast"]),
        "questions": " ".join(unit_questions(scene)),
        "stand": {each.id: _number(scene, each) for each in SLIDERS},
    }


def rigid(case: str, values: Values) -> dict[str, Any]:
    """In words where the wheel stands, and panels with the bodies before any load: outlines [y, z]
    in mm by body and contact points; no panels between half-spaces.
    """
    scene = scene_of(case, values)
    kind = _kind(scene)
    if kind == "half-space":
        return {"place": "half-spaces have no profiles", "panels": []}
    return _on_sections(scene) if kind == "sections" else _on_track(scene)


def _on_track(scene: Scene) -> dict[str, Any]:
    """Both sides of a wheelset on its track, in axes of their own, and where it stands."""
    placed, gauge, panels = solid.place(scene, geometry.CLEARANCE), scene.rail.gauge, []
    for name, side in (("left", placed.left), ("right", placed.right)):
        pair = side.pair
        face = None if gauge is None else wheelset.gauge_face(pair.rail, scene.rail.gauge_height)
        panels.append(_panel(name, [pair.rail], pair, side.pose, side.touches) | {"face": face})
    track = "tape circles over the crown centres"
    if gauge is not None:
        track = f"gauge {gauge:g} mm, {scene.rail.gauge_height:g} mm below the tops"
    difference = placed.rolling_radius_difference
    text = f"{track}; roll {1e3 * placed.roll:.3f} mrad; rolling radius difference "
    text += f"{difference:.3f} mm (right less left)"
    return {"panels": panels, "stands": [placed.shift, difference], "place": text}


def _on_sections(scene: Scene) -> dict[str, Any]:
    """The wheel on the heads of its rail, each by its section at its lowest place."""
    found = crossing.contact(scene.replace(["effects.finite_bodies=off"]))
    assert found.pair is not None and found.pose is not None
    heads = [profile for body, profile, _ in found.cross_profiles if body == "rail"]
    touches = found.touches(geometry.CLEARANCE)
    panel = _panel(scene.wheelset.side, heads, found.pair, found.pose, touches) | {"face": None}
    height = found.crossing.height(found.crossing.lift)
    text = f"lowest point of the tape circle {height:.3f} mm over z = 0 of the sections"
    return {"panels": [panel], "place": text}


def _panel(
    name: str, rails: list[Profile], pair: ProfilePair, pose: Pose, touches: list[ContactPoint]
) -> dict[str, Any]:
    """Outlines of rails and of a wheel in a pose, with contact points; name: of the side."""
    tread = np.linspace(*pair.wheel.domain, SAMPLES)
    heads = [(y := np.linspace(*each.domain, SAMPLES), each.height(y)) for each in rails]
    return {
        "side": name,
        "rails": [plain(each) for each in heads],
        "wheel": plain(pair.outline(pose, tread).points[:, 1:].T),
        "touches": [
            {
                "y": each.y,
                "z": each.z,
                "text": f"{name}: y = {each.y:.2f} mm, angle {math.degrees(each.angle):.2f}°, "
                f"gap {each.gap:.3f} mm, rolling radius {each.radius:.3f} mm",
            }
            for each in touches
        ],
    }


def radii(case: str, values: Values) -> dict[str, Any]:
    """Rolling radius difference over the shift [mm, mm], jumps and equivalent conicity, as
    `railhead locate` has them; empty where no wheelset stands on a track.
    """
    scene = scene_of(case, values)
    if _kind(scene) != "track":
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
        "position": scene.rail.position,
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


def plan(case: str, values: Values) -> dict[str, Any]:
    """What `railhead plan` prints, effects, mesh and price, and the price alone."""
    from railhead import api
    from railhead.planning import simulation_plan as planning

    planned = api.Planned(planning.make(scene_of(case, on_meshes(case, values))))
    seconds = planned.plan.price.seconds
    price = f"{planned.plan.unknowns} unknowns, about {seconds:.1f} s of processor time"
    return {"text": str(planned), "price": price}


def profile(path: str, body: str) -> dict[str, Any]:
    """What `railhead profile` prints of a file of a body, and its key in a scene. Raises SceneError
    for a file that is no profile.
    """
    from railhead.results.report import terminal

    text = terminal.recorded(geometry.profile(path, body).show).export_text()
    return {"key": f"{body}.profile", "path": path, "text": text}


def bodies(folder: str) -> dict[str, Any]:
    """Surfaces of the bodies of a result, cut across the rail at the contact: "parts" by name, with
    points [x, y, z] in mm, triangles [i, j, k] and the largest shear stress at the points, MPa; of
    "contact" the pressure. "ends" of x, y and z around the contact, mm.
    """
    import pyvista

    file = Path(folder) / result_folder.SUMMARY
    result, found = result_folder.from_json(file)["result"], {}
    at, half = np.array(result["contact_point_mm"]), result["patch"]
    reach = NEAR * max(half["a_mm"] or 0.0, half["b_mm"] or 0.0)
    solution, contact = (pyvista.read(file.with_name(f"{name}.vtu")) for name in FIELDS)
    parts = {name: solution.extract_cells(solution["body"] == n) for n, name in BODY_NAMES.items()}
    for name, part in (parts | {"contact": contact}).items():
        cut = part.clip("x", origin=at, invert=False) if part.n_cells else part
        skin = cut.extract_surface(algorithm="dataset_surface").triangulate()
        if skin.n_cells:
            found[name] = {
                "points": plain(skin.points.T),
                "triangles": skin.regular_faces.T.tolist(),
                "values": plain(skin["pressure" if name == "contact" else "max_shear"]),
            }
    return {"parts": found, "ends": plain(np.column_stack([at - reach, at + reach]))}


def plain(values: Any) -> list[Any]:
    """Lists of numbers, rounded to 1e-4, None for what is no number or masked; of several arrays
    lists of them.
    """
    rounded: Array = np.round(np.ma.filled(np.ma.asarray(values, dtype=float), np.nan), 4)
    return np.where(np.isfinite(rounded), rounded, None).tolist()  # type: ignore[call-overload]
