"""All findings of a solution in one call."""

from __future__ import annotations

import numpy as np

from meshing.tags import BODIES
from postprocess import patch, stress
from postprocess.findings import Findings, Frame
from solver.gather import Fields

DEPTH_SAMPLES = 121
DEPTH_REACH = 3.0  # over the smaller semi-axis


def findings(fields: Fields, frame: Frame) -> Findings:
    """Patch, recovered surface fields, and stresses below the contact in every meshed body."""
    found, surface, moments = patch.read(fields, frame)
    depth = np.linspace(0.0, DEPTH_REACH * min(found.a, found.b), DEPTH_SAMPLES)
    axes = {
        name: stress.below(fields, frame, found.centre, tag, name, depth)
        for tag, name in BODIES.items()
        if np.any(fields.body == tag)
    }
    return Findings(
        frame,
        found,
        surface,
        axes,
        patch.axis_pressure(surface, found, 0, fields),
        patch.axis_pressure(surface, found, 1, fields),
        moments.shape_error,
        moments.shape_error < patch.HERTZIAN,
    )
