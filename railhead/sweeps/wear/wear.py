"""Wear over the route of a scene: solved step by step in a folder, and its files."""

from __future__ import annotations

import math
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.geometry.worn_profile import Places
from railhead.meshing.mesh import MeshError
from railhead.postprocess.findings import Subject, Units
from railhead.results import pipeline, result_folder
from railhead.run.half_spaces.worn_contact import BODIES
from railhead.run.progress import Progress, Tell
from railhead.scene.catalogue import INPUT, copy_files, portable
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import store, worker_pool
from railhead.sweeps.wear import wear_route, wear_run
from railhead.sweeps.wear.wear_result import WearResult
from railhead.sweeps.wear.wear_route import Route
from railhead.theory.array_types import Array

SUMMARY, HISTORY, REPORT = "wear.json", "history.csv", "report.html"
LINES, DAMAGE = "wear.csv", "damage.csv"  # over y: worn depth; all else
PLACE, DEPTH = ("body", "y [mm]"), ("depth [mm]", "depth [mm] estimate")
LIMITS = tuple(f"wear.{name}_limit" for name in ("depth", "flange", "conicity"))
PROFILES = {body: f"{body}_profile.csv" for body in BODIES}
PICTURES = ("depth", "history")
LATER = (
    *(INPUT, result_folder.SCENE, SUMMARY, LINES, DAMAGE, HISTORY, REPORT, *PROFILES.values()),
    *(f"{name}.{kind}" for name in PICTURES for kind in ("png", "svg", "pdf")),
)
DECIMALS = 7  # of profiles, mm
AS_WRITTEN = {"profile_mirror": "off", "profile_flip": "off", "profile_origin": "file"}
"""Keys with which the files of worn profiles are read back."""


def wear(
    scene: Scene,
    out: str | Path,
    *,
    force: bool = False,
    pictures: bool = True,
    quiet: bool = True,
    progress: Tell | None = None,
) -> WearResult:
    """Wear over the route of a scene, solved in a folder on all cores. A run that was begun there
    for the same scene goes on after its last step.

    out: the folder, into which the files of the result are written.
    force: whether another result in the folder is replaced.
    pictures: whether PNG files and report.html are written, too.
    quiet: whether no progress is shown. progress: as of `Progress`.
    Raises SceneError for a scene, a route or a folder that cannot be used, for wear that is more
    than profiles have, and under mpirun; OSError where nothing can be written.
    """
    if MPI.COMM_WORLD.size > 1:
        raise SceneError("wear", "uses all cores by itself; start it without mpirun")
    folder, route = Path(out), wear_route.read(scene)
    expected = wear_run.expected(route)
    with ExitStack() as stack:
        stack.enter_context(result_folder.claimed(folder))
        store.begin(folder, _request(route), "replace" if force else "refuse", LATER)
        copy_files({file for each in _scenes(route) for file in each.files}, folder)
        shown = stack.enter_context(Progress(quiet=quiet, tell=progress))
        shown.stage(expected)
        submit = None
        if min(worker_pool.workers(1), len(route.positions)) > 1:
            submit = stack.enter_context(worker_pool.submitting(1, 0))
        found = WearResult(route, wear_run.solve(route, folder, submit, shown))
        _write_profiles(found, folder)
        if scene.effects.finite_bodies != "off":
            found = replace(found, beside=_beside(found, folder, shown))
        shown.stage("writing files" + " and pictures" * pictures)
        _save(found, folder, pictures=pictures)
    return found


def _beside(found: WearResult, folder: Path, progress: Progress) -> dict[str, Any]:
    """Entry "beside" of wear.json: the position with the largest share on the worn profiles in a
    folder, by finite elements and by half-spaces, elastic and without friction; or the reason why
    finite elements fail.
    """
    number = int(np.argmax(found.route.shares))
    scene = found.route.positions[number].scene
    for body in found.route.worn:
        own = {"profile", "rolling_radius", "inclination"}
        shape = {key: "none" for key in wear_route.SHAPE[body] if key not in own} | AS_WRITTEN
        scene = scene.replace(
            **{f"{body}.{key}": value for key, value in shape.items()},
            **{f"{body}.profile": str(folder / PROFILES[body])},
        )
    switches = {"finite_bodies": "auto", "friction": "off", "plasticity": "off"}
    scene = scene.replace(**{f"effects.{key}": value for key, value in switches.items()})
    try:
        solved = pipeline.run(scene, progress, MPI.COMM_SELF).summary
        bodies, half_spaces = solved["result"], solved["half_space"]
        bound = solved["accuracy"]["bound"]
        return {
            "position": number + 1,
            **{
                name: {
                    "pressure_max_MPa": each["pressure"]["max_MPa"],
                    "area_mm2": each["patch"]["area_mm2"],
                }
                for name, each in (("finite_elements", bodies), ("half_spaces", half_spaces))
            },
            "bound": {"pressure_max_MPa": bound.get("max_MPa"), "area_mm2": bound.get("area_mm2")},
            "checks": solved["checks"]["failed"],
        }
    except (SceneError, MeshError, KeyError, TypeError) as error:
        return {"position": number + 1, "reason": f"{type(error).__name__}: {error}"}


def _scenes(route: Route) -> list[Scene]:
    """The scene of a route, and those of its positions."""
    return [route.scene, *(position.scene for position in route.positions)]


def _request(route: Route) -> dict[str, Any]:
    """All that determines the records of a route; limits, which are read from them, do not.
    OSError: a file cannot be read.
    """
    scenes = [portable(scene.replace(**dict.fromkeys(LIMITS, "none"))) for scene in _scenes(route)]
    return {
        "railhead": result_folder.VERSION,
        "scene": scenes[0],
        "positions": scenes[1:],
        "shares": list(route.shares),
    }


def _save(found: WearResult, folder: Path, *, pictures: bool) -> None:
    """Write the files of a result into its folder. OSError: one cannot be written."""
    scene, lines = found.route.scene, list(found.lines())
    files = {
        result_folder.SCENE: result_folder.scene_toml("wear", scene).encode(),
        LINES: result_folder.encoded(
            result_folder.signed([{name: row[name] for name in PLACE + DEPTH} for row in lines])
        ),
        DAMAGE: result_folder.encoded(
            result_folder.signed(
                [{name: row[name] for name in row if name not in DEPTH} for row in lines]
            )
        ),
        HISTORY: result_folder.encoded(result_folder.signed(found.rows)),
        SUMMARY: result_folder.to_json(result_folder.origin() | found.summary).encode(),
    }
    for name, content in files.items():
        store.write_whole(folder, folder / name, content)
    if not pictures:
        return
    from railhead.results.report import html
    from railhead.sweeps.wear import wear_plots

    title, failures = f"wear of {scene.name}", list[str]()
    drawings = {
        "depth.png": partial(wear_plots.depth, lines, found.route.worn, Subject(title)),
        "history.png": partial(wear_plots.history, found.rows, Subject(title)),
    }
    result_folder.draw(
        drawings, folder, lambda name: result_folder.attempt(failures, folder / name, folder)
    )
    if failures:
        raise OSError("\n".join(failures))
    text = html.template("wear.html.j2").render(
        title=title,
        summary=found.summary,
        verdict=words(found),
        pictures=[html.picture((folder / name).read_bytes()) for name in drawings],
        scene=list(html.scene_rows(scene, Units())),
        date=result_folder.now(),
        versions=html.versions(),
    )
    store.write_whole(folder, folder / REPORT, text.encode())


def _write_profiles(found: WearResult, folder: Path) -> None:
    """Write the worn profiles into a folder. OSError: one cannot be written."""
    run, inclination = found.runs["main"], found.route.scene.rail.inclination
    for body, places in found.places(run).items():
        slope = inclination if body == "rail" else 0.0
        text = _profile(places, run.depths()[body], slope)
        store.write_whole(folder, folder / PROFILES[body], text.encode())


def _profile(places: Places, depth: Array, slope: float) -> str:
    """Text of a profile's file: points y, z in mm after a depth (n,), as they are before the rail
    is inclined by a slope (tangent).
    """
    back = np.array([[1.0, -slope], [slope, 1.0]]) / np.hypot(1.0, slope)
    lines = (f"{y:.{DECIMALS}f},{z:.{DECIMALS}f}" for y, z in places.worn(depth) @ back)
    note = f"# railhead {result_folder.VERSION}, worn profile; y to the field side"
    return "\n".join([note, "y [mm],z [mm]", *lines, ""])


def words(found: WearResult) -> list[str]:
    """Lines that say what was worn, within which errors, and which checks failed."""
    summary = found.summary
    bound = summary["accuracy"]["bound"]

    def within(name: str, key: str, unit: str) -> str:
        """A number with its unit and its error."""
        value, error = summary[name][key], bound[name][key]
        off = "its error is not known" if error is None else f"+- {error:.2g} of it"
        return "not known" if value is None else f"{value:.4g} {unit} {off}"

    lines = [f"{summary['steps']} steps, {len(found.route.shares)} positions"]
    for body in found.route.worn:
        depth, area = within("depth_max_mm", body, "mm"), within("worn_mm2", body, "mm2")
        lines.append(f"{body}: at most {depth} deep, {area} of the section")
    first, last = (within("pressure_max_MPa", key, "MPa") for key in ("first", "last"))
    lines.append(f"largest pressure: {first}, then {last}")
    for name, limit in summary["limits_reached"].items():
        after = [
            f"{limit[key]:.4g} +- {limit[f'{key} estimate'] or math.nan:.2g} {key}"
            for key in ("axles", "distance_km")
            if limit[key]
        ]
        lines.append(f"{name} {limit['limit']:g}: {' and '.join(after) or 'not reached'}")
    if beside := summary["beside"]:
        text = beside.get("reason") or "; ".join(
            f"{name.replace('_', ' ')} {beside[name]['pressure_max_MPa']:.5g} MPa on "
            f"{beside[name]['area_mm2']:.4g} mm2"
            for name in ("finite_elements", "half_spaces")
        )
        lines.append(f"position {beside['position']}, worn: {text}")
    for name, why in summary["left_out"].items():
        lines.append(f"left out: {name.replace('_', ' ')} ({why})")
    failed = summary["checks"]["failed"]
    lines.append(f"checks: {'FAILED ' + ', '.join(failed) if failed else 'all passed'}")
    return lines
