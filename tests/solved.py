"""Results that several tests read: each scene is solved once in a process.

For tests that change nothing of the program (by monkeypatch) and do not compare two solves of one
scene. Fields, findings and solution are shared: read them, do not write into them.
"""

import functools
from copy import deepcopy
from dataclasses import replace

import railhead as rh

KEPT = 24  # results; each is some tens of MB


def solved(scene: rh.Scene | str, *assignments: str) -> rh.Result:
    """The result of a scene, or of a shipped case, with some keys changed (`"mesh.order=1"`).

    Its summary is a copy of its own.
    """
    if isinstance(scene, str):
        scene = rh.find(scene)
    result = _solved(scene.replace(assignments))
    return replace(result, summary=deepcopy(result.summary))


@functools.lru_cache(maxsize=KEPT)
def _solved(scene: rh.Scene) -> rh.Result:
    return rh.solve(scene, quiet=True)
