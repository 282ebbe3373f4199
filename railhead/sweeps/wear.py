"""Wear over the route of a scene: solved step by step in a folder, and its files."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.geometry.worn_profile import Places
from railhead.results import result_folder
from railhead.run.half_spaces.worn_contact import BODIES
from railhead.run.progress import Progress, Tell
from railhead.scene.catalogue import INPUT, copy_files, portable
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import store, wear_route, wear_run, worker_pool
from railhead.sweeps.wear_result import WearResult
from railhead.sweeps.wear_route import Route
from railhead.theory.array_types import Array

SUMMARY, DEPTH, DAMAGE, HISTORY = "wear.json", "wear.csv", "damage.csv", "history.csv"
PROFILES = {body: f"{body}_profile.csv" for body in BODIES}
LATER = (INPUT, result_folder.SCENE, SUMMARY, DEPTH, DAMAGE, HISTORY, *PROFILES.values())
DECIMALS = 7  # of profiles, mm


def wear(
    scene: Scene,
    out: str | Path,
    *,
    force: bool = False,
    quiet: bool = True,
    progress: Tell | None = None,
) -> WearResult | None:
    """Wear over the route of a scene, solved in a folder; under MPI called on all ranks. A run that
    was begun there for the same scene goes on after its last step.

    out: the folder, into which the files of the result are written.
    force: whether another result in the folder is replaced.
    quiet: whether no progress is shown. progress: as of `Progress`.
    Returns None on all MPI ranks but the first. Raises SceneError for a scene, a route or a folder
    that cannot be used, OSError where nothing can be written.
    """
    comm, folder, problem = MPI.COMM_WORLD, Path(out), None
    route: Route | None = None
    with ExitStack() as claim:
        if comm.rank == 0:
            try:
                route = wear_route.read(scene)
                claim.enter_context(result_folder.claimed(folder))
                store.begin(folder, _request(route), "replace" if force else "refuse", LATER)
                copy_files({file for each in _scenes(route) for file in each.files}, folder)
            except (SceneError, OSError) as error:
                problem = error
        if (problem := comm.bcast(problem)) is not None:
            raise problem
        few = route is not None and min(worker_pool.workers(1), len(route.positions)) == 1
        alone = comm.size == 1 and few
        with ExitStack() as jobs, Progress(quiet=quiet, tell=progress) as shown:
            submit = None if alone else jobs.enter_context(worker_pool.submitting(comm.size, 0))
            if route is None:
                return None
            found = WearResult(route, wear_run.solve(route, folder, submit, shown))
            _save(found, folder)
            return found


def _scenes(route: Route) -> list[Scene]:
    """The scene of a route, and those of its positions."""
    return [route.scene, *(position.scene for position in route.positions)]


def _request(route: Route) -> dict[str, Any]:
    """All that determines the records of a route. OSError: a file cannot be read."""
    scenes = [portable(scene) for scene in _scenes(route)]
    return {
        "railhead": result_folder.VERSION,
        "wear": scenes[0],
        "positions": scenes[1:],
        "shares": list(route.shares),
    }


def _save(found: WearResult, folder: Path) -> None:
    """Write the files of a result into its folder. OSError: one cannot be written."""
    scene, run = found.route.scene, found.runs["main"]
    files = {
        result_folder.SCENE: result_folder.scene_toml("wear", scene).encode(),
        DEPTH: result_folder.encoded(result_folder.signed(found.depth_rows())),
        DAMAGE: result_folder.encoded(result_folder.signed(found.damage_rows())),
        HISTORY: result_folder.encoded(result_folder.signed(found.rows)),
        SUMMARY: result_folder.to_json(result_folder.origin() | found.summary).encode(),
    }
    for body, places in found.places(run).items():
        slope = scene.rail.inclination if body == "rail" else 0.0
        files[PROFILES[body]] = _profile(places, run.depths()[body], slope).encode()
    for name, content in files.items():
        store.write_whole(folder, folder / name, content)


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
        error = bound[name][key]
        text = f"{summary[name][key]:.4g} {unit}"
        return text if error is None else f"{text} +- {error:.2g} of it"

    lines = [f"{summary['steps']} steps, {len(found.route.shares)} positions"]
    for body in found.route.worn:
        depth, area = within("depth_max_mm", body, "mm"), within("worn_mm2", body, "mm2")
        lines.append(f"{body}: at most {depth} deep, {area} of the section")
    first, last = (within("pressure_max_MPa", key, "MPa") for key in ("first", "last"))
    lines.append(f"largest pressure: {first}, then {last}")
    for name, limit in summary["limits_reached"].items():
        after = [
            f"{value:.4g} {key}"
            for key, value in limit.items()
            if key in ("axles", "distance_km") and value
        ]
        lines.append(f"{name} {limit['limit']:g}: {' and '.join(after) or 'not reached'}")
    for name, why in summary["left_out"].items():
        lines.append(f"left out: {name.replace('_', ' ')} ({why})")
    failed = summary["checks"]["failed"]
    lines.append(f"checks: {'FAILED ' + ', '.join(failed) if failed else 'all passed'}")
    return lines
