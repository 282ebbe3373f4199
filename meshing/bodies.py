"""What is meshed: sections and how they are swept."""

from __future__ import annotations

from dataclasses import dataclass

from meshing.outlines import Curve


@dataclass(frozen=True)
class Body:
    """A section in the plane x = 0 swept to +-reach.

    tag: RAIL or WHEEL. reach: length each way, mm; axle: (z of the axle, radius at which reach is
    measured) turns the sweep into a revolution. end_role: 'free' or 'support' of the end faces.
    """

    tag: int
    section: list[Curve]
    reach: float
    axle: tuple[float, float] | None = None
    end_role: str = "free"


@dataclass(frozen=True)
class Options:
    """cell 'tetrahedron' or 'hexahedron', degree 1 or 2 of the geometry, half: only x >= 0."""

    cell: str
    geometry_degree: int
    half: bool
