"""Wear over the route of a scene: solved step by step in a folder, its files and pictures."""

from collections.abc import Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.geometry.profiles import Places
from railhead.half_spaces.worn_contact import BODIES
from railhead.meshing.mesh import MeshError
from railhead.postprocess.findings import Subject
from railhead.results import pipeline, result_folder
from railhead.run.progress import Progress, Tell
from railhead.scene.catalogue import INPUT, copy_files, portable
from railhead.scene.quantities import GROUPS
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import store, worker_pool
from railhead.sweeps.wear import wear_run
from railhead.sweeps.wear.wear_result import Row, WearResult, amount
from railhead.sweeps.wear.wear_run import Route, Run
from railhead.theory.array_types import Array

SUMMARY, HISTORY, REPORT = "wear.json", "history.csv", "report.html"
LINES, DAMAGE = "wear.csv", "damage.csv"  # over y: worn depth; all else
FATIGUE, MAP = "fatigue.csv", "fatigue_map.png"  # over y and depth
PLACE, DEPTH = ("body", "y [mm]"), ("depth [mm]", "depth [mm] estimate")
LIMITS = tuple(f"wear.{name}_limit" for name in ("depth", "flange", "conicity"))
PROFILES = {body: f"{body}_profile.csv" for body in BODIES}
PICTURE = "depth.png"
LATER = (
    *(INPUT, result_folder.SCENE, SUMMARY, LINES, DAMAGE, FATIGUE, HISTORY, REPORT),
    *(MAP, PICTURE, *PROFILES.values()),
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
    pictures: whether depth.png and report.html are written, too.
    quiet: whether no progress is shown. progress: as of `Progress`.
    Raises SceneError for a scene, a route or a folder that cannot be used, for wear that is more
    than profiles have, and under mpirun; OSError where nothing can be written.
    """
    if MPI.COMM_WORLD.size > 1:
        raise SceneError("wear", "uses all cores by itself; start it without mpirun")
    folder, route = Path(out), wear_run.read(scene)
    wear_run.refuse_amount(route)
    with ExitStack() as stack:
        stack.enter_context(result_folder.claimed(folder))
        store.begin(folder, _request(route), "replace" if force else "refuse", LATER)
        copy_files({file for each in _scenes(route) for file in each.files}, folder)
        shown = stack.enter_context(Progress(quiet=quiet, tell=progress))
        submit = None
        if min(worker_pool.workers(1), len(route.positions)) > 1:
            submit = stack.enter_context(worker_pool.submitting(1, 0))
        runs, beside = wear_run.solve(route, folder, submit, shown), None
        _write_profiles(runs["main"], folder)
        if scene.effects.finite_bodies != "off":
            beside = _beside(route, folder, shown)
        grooves = _grooves(route, shown) if route.yields else None
        tired = _fatigue(route, folder, shown) if route.tires else None
        found = WearResult(route, runs, beside, grooves, tired)
        shown.stage("writing files" + " and pictures" * pictures)
        _save(found, folder, pictures=pictures)
    return found


def _beside(route: Route, folder: Path, progress: Progress) -> dict[str, Any]:
    """Entry "beside" of wear.json: the position with the largest share on the worn profiles in a
    folder, by finite elements and by half-spaces, elastic and without friction; or the reason why
    one of both fails.
    """
    number = int(np.argmax(route.shares))
    switches = {"finite_bodies": "auto", "friction": "off", "plasticity": "off"}
    changes = {f"effects.{key}": value for key, value in switches.items()}
    changes |= _worn(route, folder) | {"quantities": ",".join(GROUPS)}
    solved = _solved(route, number, changes, progress)
    if "failure" in solved:
        return {"position": number + 1, "reason": solved["failure"]}
    found = {"finite_elements": solved["result"], "half_spaces": solved["half_space"]}
    for name, each in found.items():
        if not each or "reason" in each:
            why = each["reason"] if each else "no patch"
            return {"position": number + 1, "reason": f"{name.replace('_', ' ')}: {why}"}
    bound = solved["accuracy"]["bound"]
    return {
        "position": number + 1,
        **{
            name: {
                "pressure_max_MPa": each["pressure"]["max_MPa"],
                "area_mm2": each["patch"]["area_mm2"],
            }
            for name, each in found.items()
        },
        "bound": {"pressure_max_MPa": bound.get("max_MPa"), "area_mm2": bound.get("area_mm2")},
        "checks": solved["checks"]["failed"],
    }


def _worn(route: Route, folder: Path) -> dict[str, Any]:
    """Keys of a scene with the worn profiles in a folder, with their values."""
    changes, own = dict[str, Any](), {"profile", "rolling_radius", "inclination"}
    for body in route.worn:
        shape = {key: "none" for key in wear_run.SHAPE[body] if key not in own} | AS_WRITTEN
        shape["profile"] = str(folder / PROFILES[body])
        changes |= {f"{body}.{key}": value for key, value in shape.items()}
    return changes


def _solved(
    route: Route, number: int, changes: Mapping[str, Any], progress: Progress
) -> dict[str, Any]:
    """Content of summary.json of a position by its index, with other values of some keys; the
    "failure" alone where it cannot be solved.
    """
    try:
        scene = route.positions[number].scene.replace(**changes)
        return pipeline.run(scene, progress, MPI.COMM_SELF).summary
    except (SceneError, MeshError) as error:
        return {"failure": f"{type(error).__name__}: {error}"}


def _grooves(route: Route, progress: Progress) -> dict[str, Any]:
    """Entry "yield" of wear.json: numbers of the positions whose steel yields; of that with the
    highest stress that can be rolled its number, load over that of first yield, and the depth of
    the groove, mm, after one pass and after two over its new rail without friction, with the failed
    checks; and by number of each position with a higher stress why it has no passes ("unknown").
    """
    changes = {"rolling.passes": 2, "quantities": "stresses", "effects.friction": "off"}
    unknown, solved = dict[str, str](), dict[str, Any]()
    for number in sorted(route.yields, key=lambda each: -route.yields[each]):
        solved = _solved(route, number, changes, progress)
        result = solved.get("result") or {}
        if "passes" in result:
            solved = {
                "position": number + 1,
                "load_over_first_yield": result["yield"]["load_over_first_yield"],
                "groove_mm": [each["groove_mm"] for each in result["passes"]],
                "checks": solved["checks"]["failed"],
            }
            break
        unknown[f"{number + 1}"] = solved.get("failure") or "the passes were not solved"
        solved = {}
    return {"positions": [each + 1 for each in route.yields], "unknown": unknown, **solved}


def _fatigue(route: Route, folder: Path, progress: Progress) -> list[dict[str, Any]]:
    """Entry "fatigue" of wear.json: of each position, on the new ("first") and the worn profiles
    ("last") in a folder, its number, share, y of the patch and "fatigue" of its elastic result by
    half-spaces; or the reason why there is none.
    """
    asked, rows = {"quantities": wear_run.TIRES[0], "effects.plasticity": "off"}, []
    for name, shape in (("first", {}), ("last", _worn(route, folder))):
        for number, share in enumerate(route.shares):
            solved = _solved(route, number, asked | shape, progress)
            result = solved.get("result") or {}
            if "fatigue" in result:
                own = {"y_mm": result["contact_point_mm"][1], **result["fatigue"]}
            else:
                own = {"reason": solved.get("failure") or "nothing touches"}
            rows.append({"position": number + 1, "profiles": name, "share": share, **own})
    return rows


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
    tired = [each for each in found.fatigue or () if "profile" in each]
    if tired:
        files[FATIGUE] = result_folder.encoded([row for each in tired for row in _below(each)])
    for name, content in files.items():
        store.write_whole(folder, folder / name, content)
    if not pictures:
        return
    from railhead.postprocess.pictures import profile_plots, sweep_plots
    from railhead.results.report import html

    title, failures = f"wear of {scene.name}", list[str]()
    bodies = {body: _worn_body(found, body) for body in found.route.worn}
    subject, limits = Subject(f"{title}, after {amount(found.rows[-1])}"), scene.wear
    flange = found.rows[-1]["flange_thickness_mm"], limits.flange_limit
    drawn = {
        PICTURE: partial(
            profile_plots.worn, bodies, subject, depth_limit=limits.depth_limit, flange=flange
        )
    }
    if tired:
        places, profiles = zip(*((each["y_mm"], each["profile"]) for each in tired), strict=True)
        drawn[MAP] = partial(sweep_plots.fatigue_map, places, profiles, Subject(title))
    for name, draw in drawn.items():
        with result_folder.attempt(failures, folder / name, folder):
            draw(folder / name)
    if failures:
        raise OSError("\n".join(failures))
    text = html.template("wear.html.j2").render(
        title=title,
        summary=found.summary,
        verdict=found.words(),
        pictures=[html.picture((folder / name).read_bytes()) for name in drawn],
        scene=html.scene_rows(scene),
        date=result_folder.now(),
        versions=html.versions(),
    )
    store.write_whole(folder, folder / REPORT, text.encode())


def _worn_body(found: WearResult, body: str) -> tuple[Places, Array, Array]:
    """Places along the new profile of a body, the worn depth (n,) there, mm, and y, depth and its
    error (3, m) of its lines, mm.
    """
    names = ("y [mm]", *DEPTH)
    lines = [[row[name] for name in names] for row in found.lines() if row["body"] == body]
    run = found.runs["main"]
    return run.places[body], run.depths[body], np.array(lines, dtype=float).reshape(-1, 3).T


def _below(tired: Mapping[str, Any]) -> list[Row]:
    """Rows of fatigue.csv of a position: the stresses of both criteria over the depth."""
    given = {name: tired[name] for name in ("position", "profiles", "share")}
    given["y [mm]"] = tired["y_mm"]
    columns = {
        "depth [mm]": "depth_mm",
        "Dang Van [MPa]": "dang_van_MPa",
        "Findley [MPa]": "findley_MPa",
    }
    cells = zip(*(tired["profile"][key] for key in columns.values()), strict=True)
    return [given | dict(zip(columns, each, strict=True)) for each in cells]


def _write_profiles(run: Run, folder: Path) -> None:
    """Write the worn profiles of a run into a folder. OSError: one cannot be written."""
    for body, places in run.places.items():
        slope = run.route.scene.rail.inclination if body == "rail" else 0.0
        text = _profile(places, run.depths[body], slope)
        store.write_whole(folder, folder / PROFILES[body], text.encode())


def _profile(places: Places, depth: Array, slope: float) -> str:
    """Text of a profile's file: points y, z in mm after a depth (n,), as they are before the rail
    is inclined by a slope (tangent).
    """
    back = np.array([[1.0, -slope], [slope, 1.0]]) / np.hypot(1.0, slope)
    lines = (f"{y:.{DECIMALS}f},{z:.{DECIMALS}f}" for y, z in places.worn(depth) @ back)
    note = f"# railhead {result_folder.VERSION}, worn profile; y to the field side"
    return "\n".join([note, "y [mm],z [mm]", *lines, ""])
