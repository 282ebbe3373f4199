"""All results of a solution in one call: patch, surface fields and stresses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from railhead.postprocess.findings import Findings, Frame
from railhead.postprocess.friction import traction
from railhead.postprocess.patch import patch, quality, section
from railhead.postprocess.patch.separate_patches import separate_patches
from railhead.postprocess.stress import bodies

if TYPE_CHECKING:
    from railhead.solver.fields import Fields
    from railhead.solver.solution import FrictionSolution


def findings(
    fields: Fields,
    frame: Frame,
    rubbing: FrictionSolution | None = None,
    *,
    parabolic: bool = False,
) -> Findings:
    """Read the patch, the smooth fields on the contact surfaces and the stresses in every meshed
    body out of a solution.

    fields: the solution. frame: contact frame; where there are several patches, that of the most
        loaded one is used instead. rubbing: solution with friction, or None. parabolic: whether
        Hertz's theory is exact, that is for elastic half-spaces whose gap is quadratic; second
        moments of the pressure then give the semi-axes.
    """
    flat = fields.kinematics.dim == 2
    separate = [] if flat else separate_patches(fields)
    frame = separate[0].frame if len(separate) > 1 else frame
    if flat:
        reading = section.read(fields, frame, parabolic=parabolic)
    else:
        reading = patch.read(fields, separate, frame, parabolic=parabolic)
    found, shape = reading.patch, reading.moments
    size = shape.a if flat else min(found.a, found.b)
    stress = bodies.read(fields, frame, found.centre, size, separate[1:], rubbing)
    elements = quality.elements_across(fields, frame, found)
    return Findings(
        frame=frame,
        patch=found,
        surface=reading.surfaces[0],
        opposite=reading.surfaces[1],
        depth=stress.axes,
        also=stress.other_axes,
        largest=stress.largest,
        misfit=stress.misfit,
        along=reading.along,
        across=reading.across,
        shape_error=shape.shape_error,
        hertzian=shape.hertzian and len(separate) < 2,
        noise=quality.noise(fields, reading.recovered_pressure),
        elements_across=elements,
        edge_distance=quality.edge_distance(fields, found, stress.edges),
        unread_peak=0.0 if flat else traction.unread_peak(rubbing, min(elements) / 2),
    )
