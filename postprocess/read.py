"""All findings of a solution in one call."""

from __future__ import annotations

from typing import TYPE_CHECKING

from railhead.postprocess.findings import Findings, Frame
from railhead.postprocess.friction import traction
from railhead.postprocess.patch import patch, quality, section
from railhead.postprocess.patch.patch import PressureMoments
from railhead.postprocess.patch.separate_patches import separate_patches
from railhead.postprocess.stress import bodies

if TYPE_CHECKING:
    from railhead.solver.fields import Fields
    from railhead.solver.solution import FrictionSolution


def moments(fields: Fields, frame: Frame) -> PressureMoments:
    """Moments of the pressure; see `patch.moments` and `section.moments`."""
    return (section if fields.kinematics.dim == 2 else patch).moments(fields, frame)


def findings(
    fields: Fields,
    frame: Frame,
    rubbing: FrictionSolution | None = None,
    *,
    parabolic: bool = False,
) -> Findings:
    """Patch, recovered surface fields, and stresses below the contact in every meshed body.

    rubbing: of a solution with friction; parabolic: see `patch.read`. Where there are several
    patches, the frame becomes that of the most loaded one.
    """
    flat = fields.kinematics.dim == 2
    separate = [] if flat else separate_patches(fields)
    frame = separate[0].frame if len(separate) > 1 else frame
    if flat:
        found, surfaces, moments, recovered = section.read(fields, frame, parabolic=parabolic)
        lines = section.axis_pressures(surfaces[0], found, fields)
    else:
        found, surfaces, moments, recovered, lines = patch.read(
            fields, separate, frame, parabolic=parabolic
        )
    size = moments.a if flat else min(found.a, found.b)
    inner = bodies.read(fields, frame, found.centre, size, separate[1:], rubbing)
    axes, others, largest, edges, misfit = inner
    across = quality.elements_across(fields, frame, found)
    return Findings(
        frame,
        found,
        surfaces[0],
        axes,
        *lines,
        moments.shape_error,
        moments.hertzian and len(separate) < 2,
        largest,
        others,
        noise=quality.noise(fields, recovered),
        elements_across=across,
        edge_distance=quality.edge_distance(fields, found, edges),
        misfit=misfit,
        opposite=surfaces[1],
        unread_peak=0.0 if flat else traction.unread_peak(rubbing, min(across) / 2),
    )
