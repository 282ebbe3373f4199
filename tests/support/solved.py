"""Results that several tests read: each scene is solved once in a process.

For tests that change nothing of the program (by monkeypatch) and do not compare two solves of one
scene. Fields, findings and solution are shared: read them, do not write into them.
"""

import functools
from copy import deepcopy
from dataclasses import replace

from mpi4py import MPI

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.postprocess.pictures import gallery
from railhead.run import mesh_solution

KEPT = 10  # results; each is some tens of MB


def scene_of(scene: rh.Scene | str, *assignments: str) -> rh.Scene:
    """A scene, or a shipped case by its name, with some keys changed (`"mesh.order=1"`)."""
    return (rh.find(scene) if isinstance(scene, str) else scene).replace(assignments)


def planned(scene: rh.Scene | str, *assignments: str) -> planning.Plan:
    """The plan of `scene_of` the same, made once too."""
    return _planned(scene_of(scene, *assignments))


def solved(scene: rh.Scene | str, *assignments: str) -> rh.Result:
    """The result of `scene_of` the same. Its summary is a copy of its own."""
    result = _solved(scene_of(scene, *assignments))
    return replace(result, summary=deepcopy(result.summary))


def passed(scene: rh.Scene | str, *assignments: str) -> rh.Result:
    """The result of `scene_of` the same, of which all checks hold."""
    result = solved(scene, *assignments)
    assert result.passed, result.summary["checks"]
    return result


def assembled(plan: planning.Plan):
    """The contact model of a plan on a mesh of its own."""
    made = mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD)
    return mesh_solution.assemble(plan, made)


def friction(result: rh.Result):
    """What the summary says of friction: forces, creepages, share of stick."""
    return result.summary["result"]["friction"]


def draw_only(monkeypatch, name: str) -> None:
    """Of the pictures of a run this one alone is drawn (`"patch"`)."""
    every, file = gallery.drawings, f"{name}.png"
    monkeypatch.setattr(gallery, "drawings", lambda *given: {file: every(*given)[file]})


@functools.lru_cache(maxsize=96)
def _planned(scene: rh.Scene) -> planning.Plan:
    return planning.make(scene)


@functools.lru_cache(maxsize=KEPT)
def _solved(scene: rh.Scene) -> rh.Result:
    return rh.solve(scene, quiet=True)
