"""Search for the largest stress in a body."""

import numpy as np
from solved import solved

from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery
from railhead.theory.elastic.subsurface import von_mises


def test_no_search_starts_outside_the_body() -> None:
    """Above the rail the smooth stresses, extrapolated, are several times the largest ones."""
    fields = solved("hertz_ellipse", "mesh.patch_size=1.2").fields
    cells = np.flatnonzero(fields.body == 1)
    recovery = Recovery(fields, cells)
    search = Search(fields, Solid(fields, cells), recovery, np.zeros((0, 3)), 1.0)
    usual = search.highest(von_mises, np.zeros((0, 3)))
    above = np.array([[0.0, 0.0, 6.0]])
    assert usual is not None
    assert von_mises(recovery.at(above))[0] > 2 * usual.value
    assert search.highest(von_mises, above) == usual
