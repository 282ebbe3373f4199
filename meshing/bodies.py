"""What is meshed: sections and how they are swept."""

from __future__ import annotations

from dataclasses import dataclass, field

from railhead.geometry.outlines import Curve
from railhead.geometry.pose import Pose, upright

ELEMENTS_PER_TURN = 6  # on fillets


@dataclass(frozen=True)
class Body:
    """A section in the plane x = 0 that is swept along x, or about an axle.

    tag: RAIL or WHEEL.
    section: closed chain of curves (y, z), mm.
    reach: length of the sweep each way, mm.
    axle: z of the axle and the radius at which `reach` is measured (mm): the sweep is a revolution;
        None for a prism.
    end_role: 'free' or 'support' of the end faces.
    pose: of the swept body in space.
    """

    tag: int
    section: list[Curve]
    reach: float
    axle: tuple[float, float] | None = None
    end_role: str = "free"
    pose: Pose = field(default_factory=lambda: upright(0.0))


@dataclass(frozen=True)
class Options:
    """How bodies are meshed.

    cell: 'tetrahedron' or 'hexahedron'; in a section triangles or quadrilaterals.
    geometry_degree: 1 or 2.
    half: only x >= 0.
    plane: '' sweeps the sections; 'xz' or 'yz' meshes them as they are, in the plane along or
        across the rail.
    per_turn: tetrahedra or triangles on a full turn of a fillet, at least.
    """

    cell: str
    geometry_degree: int
    half: bool
    plane: str = ""
    per_turn: int = ELEMENTS_PER_TURN

    @property
    def dim(self) -> int:
        """Coordinates of the mesh."""
        return 2 if self.plane else 3
