"""Contacts on too few facets."""

from __future__ import annotations

import numpy as np

from railhead.solver.model.assembly import Assembly
from railhead.solver.space.contact_interface import Interface
from railhead.solver.system.surfaces import Tie
from railhead.theory.array_types import Array

LEAST_FACETS = {1: 5.0, 2: 1.2}  # on the half width of discs, of a degree: below, pressures are off
# by a tenth and more
FLAT, ALL = 1e-6, 0.9  # range of the gap over a facet, and share of points, of contacts at once


def warn_where_coarse(model: Assembly, pairing: Interface, pressure: Array) -> None:
    """Warn of contacts that touch on a part of a curved surface with too few facets from the
    largest pressure to the edge (collective); pressure: at the points (n,).
    """
    on = pressure > 0
    size = np.bincount(pairing.facet, pairing.weights)[pairing.facet[on]]
    size = size / model.kinematics.measure(pairing.points[on])
    found = pairing.contact[on], pressure[on], size, pairing.initial_gap[on], pairing.points[on]
    every = [np.concatenate(parts) for parts in zip(*model.comm.allgather(found), strict=True)]
    least, dim = LEAST_FACETS[model.bulk.degree], model.kinematics.dim
    for number in np.unique(every[0]):
        p, sizes, gap, x = (each[every[0] == number] for each in every[1:])
        length = float(np.mean(sizes)) ** (1 / (dim - 1))
        facets = np.linalg.norm(x - x[p.argmax()], axis=1).max() / length
        whole = model.comm.allreduce(int((pairing.contact == number).sum()))
        tied = isinstance(model.contacts[number], Tie)
        if not tied and facets < least and np.ptp(gap) > FLAT * length and len(p) < ALL * whole:
            model.warn(
                f"contact {number} has {facets:.1f} facets from its largest pressure to its "
                f"edge: with less than {least} its pressure may be off by a tenth"
            )
