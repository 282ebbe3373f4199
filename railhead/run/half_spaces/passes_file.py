"""Passes in a file, from which a later run goes on."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from railhead.planning.effects.passes import alike, read
from railhead.postprocess.pass_rows import Passes, rail_state
from railhead.scene.scene import Scene

if TYPE_CHECKING:
    from railhead.solver.passes.rolling_block import RollingBlock

SAME = 1e-6  # of the largest coordinate: axes of one block


def save(passes: Passes, scene: Scene, path: Path) -> None:
    """Write the passes of a scene into a .npz file. OSError: it cannot be written."""
    state = passes.state
    assert state is not None and state.displacement is not None
    np.savez_compressed(
        path,
        scene=json.dumps(alike(scene)),
        rows=json.dumps(passes.rows),
        axes=passes.axes,
        **vars(state.history),
        residual=state.residual,
        surface=np.stack([state.profile.along, state.profile.up]),
        displacement=state.displacement,
        each_stress=np.stack([each.stress for each in passes.sections]),
        each_strain=np.stack([each.strain for each in passes.sections]),
        each_up=np.stack([each.up for each in passes.sections]),
    )


def load(path: str, rolling: RollingBlock) -> Passes:
    """Passes of a file, as far as more passes over a block need them; verdict and checks are not
    there. Raises ValueError for those of another block.
    """
    from railhead.solver.material.hardening import History

    held = read(path)[1]
    axes, start = np.concatenate(rolling.block.axes), rolling.start
    apart = np.inf
    if held["axes"].shape == axes.shape:
        apart = np.abs(held["axes"] - axes).max() / np.abs(axes).max()
    if apart > SAME or held["plastic"].shape != start.history.plastic.shape:
        raise ValueError(f"the passes in {path} are those of another block")
    rows = json.loads(str(held["rows"]))
    along, up = held["surface"]
    state = replace(
        start,
        history=History(held["plastic"], held["back"], held["equivalent"]),
        residual=held["residual"],
        profile=replace(start.profile, along=along, up=up),
        displacement=held["displacement"],
        count=len(rows),
    )
    empty = rail_state(rolling, state)
    each = zip(held["each_stress"], held["each_strain"], held["each_up"], strict=True)
    sections = [replace(empty, stress=s, strain=strain, up=u) for s, strain, u in each]
    return Passes(rows=rows, verdict="", sections=sections, state=state)
