"""What is meshed: sections, how they are swept, and the numbers of bodies and faces in a mesh."""

from dataclasses import dataclass, field

from railhead.geometry.outlines import Curve
from railhead.geometry.placement import Pose, upright

RAIL, WHEEL = 1, 2
BODY_NAMES = {RAIL: "rail", WHEEL: "wheel"}
CONTACT, SUPPORT = 10, 20  # facet tag of a body's face: CONTACT + RAIL and so on
SYMMETRY_X, SYMMETRY_Y = 31, 32
FACE_NAMES = {SYMMETRY_X: "symmetry_x", SYMMETRY_Y: "symmetry_y"} | {
    kind + tag: f"{name}_{face}"
    for tag, name in BODY_NAMES.items()
    for kind, face in ((CONTACT, "contact"), (SUPPORT, "support"))
}
ELEMENTS_PER_TURN = 6  # on fillets


@dataclass(frozen=True)
class Body:
    """A section in the plane x = 0 that is swept along x, or about an axle.

    tag: RAIL or WHEEL, see `meshing.bodies`.
    section: closed chain of curves in the body's coordinates (y, z), mm; in the plane 'xz' they
        stand for (x, z) in space.
    reach: length of the sweep to each side of the section, mm; no effect where only sections are
        meshed.
    axle: (z of the axle in the body's coordinates, radius at which `reach` is measured), mm: the
        sweep is a revolution; None: the sweep is straight.
    end_role: 'support' where the end faces of the sweep are supported, otherwise 'free'.
    pose: position and rotation of the body's coordinates in space.
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

    cell: 'tetrahedron' or 'hexahedron'; in a section these stand for triangles and quadrilaterals.
    geometry_degree: polynomial degree of the cells' geometry, 1 or 2; not that of the displacement.
    half: whether solids are swept to x >= 0 only, with a symmetry plane at x = 0. No effect in a
        section, nor on a cut at y = 0: their outlines are cut already.
    plane: '' sweeps the sections to solids; 'xz' or 'yz' meshes the sections alone, in the plane
        along or across the rail.
    per_turn: least number of tetrahedra or triangles on a full turn of a curved edge; no effect on
        hexahedra and quadrilaterals.
    """

    cell: str
    geometry_degree: int
    half: bool
    plane: str = ""
    per_turn: int = ELEMENTS_PER_TURN

    @property
    def dim(self) -> int:
        """Number of coordinates of the mesh: 2 for sections, 3 for solids."""
        return 2 if self.plane else 3

    @property
    def symmetry(self) -> int:
        """Facet tag of the symmetry plane at which an outline of a body is cut."""
        return SYMMETRY_X if self.plane == "xz" else SYMMETRY_Y

    @property
    def section_axes(self) -> slice:
        """Which of gmsh's x, y, z are the coordinates of a section: x, y of one that is meshed, y,
        z of one that is swept.
        """
        return slice(self.dim - 2, self.dim)


def other(tag: int) -> int:
    """Tag of the other body: RAIL for WHEEL, and WHEEL for RAIL."""
    return RAIL if tag == WHEEL else WHEEL
