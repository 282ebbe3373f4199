"""gmsh (OpenCASCADE kernel) builds the bodies: a section swept along the rail or about the axle,
or the section alone."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

try:
    import gmsh
except OSError as missing:  # a library of the system
    missing.args = (f"gmsh cannot be loaded: {missing}; on Debian apt install libglu1-mesa libgl1",)
    raise
import numpy as np

from railhead.meshing.bodies import (
    BODY_NAMES,
    CONTACT,
    FACE_NAMES,
    SUPPORT,
    SYMMETRY_X,
    Body,
    Options,
)
from railhead.meshing.grading import Grading
from railhead.theory.array_types import Array

REPAIR_BELOW = 0.1  # quality of a curved tetrahedron that is straightened
STRAIGHTENING_PASSES = 5
CORNERS = {"support", "free"}, {"support", "contact"}  # roles of curves that meet
# Element size where these meet, over that of the grading there, and its growth with the distance:
CORNER_SIZE, CORNER_GROWTH = 1 / 16, 0.5
MIDDLES = {  # corners of each edge, side and cell with a middle node, in gmsh's order of nodes
    ("tetrahedron", 2): "01 12 20",
    ("tetrahedron", 3): "01 12 20 30 23 13",
    ("hexahedron", 2): "01 12 23 30 0123",
    ("hexahedron", 3): "01 03 04 12 15 23 26 37 45 47 56 67 0321 0154 0473 1265 2376 4567 01234567",
}


@contextmanager
def model(bodies: list[Body], grading: Grading, options: Options) -> Iterator[Any]:
    """Context that yields `gmsh.model`, meshed, with physical groups for the bodies and their
    faces. With a stretch, nodes are in stretched coordinates until `undo_stretch`.

    bodies: the sections and how each is swept.
    grading: element size; in the plane 'xz' x takes the place of y.
    options: type of the cells, degree, symmetry, plane.
    The tags of the groups are those of `meshing.bodies`. gmsh is closed when the context ends.
    """
    with _session() as gmsh_model:
        if options.plane == "xz":
            grading = grading.turned()
        groups: dict[tuple[int, int], list[int]] = {}
        for body in bodies:
            if options.plane:
                _plane_surface(body, options, groups)
            else:
                _sweep(body, grading, options, groups)
        gmsh_model.occ.synchronize()
        for (dim, tag), entities in sorted(groups.items()):
            gmsh_model.addPhysicalGroup(dim, entities, tag, (BODY_NAMES | FACE_NAMES)[tag])
        _mesh(bodies, grading, options)
        yield gmsh_model


@contextmanager
def _session() -> Iterator[Any]:
    """Context that starts gmsh in silence on one thread, yields `gmsh.model` with one empty model,
    and closes gmsh at the end.
    """
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add("railhead")
        yield gmsh.model
    finally:
        gmsh.finalize()


ModelSnapshot = tuple[list[tuple[Any, ...]], list[tuple[int, int, str, Array]]]
"""Mesh of each entity, and the physical groups."""


def snapshot_model() -> ModelSnapshot:
    """Nodes, elements and physical groups of the current gmsh model, as data that can be sent to
    another process.

    Returns a list with (entity, nodes, elements) of each entity and a list with (dimension, tag,
    name, entities) of each physical group.
    """
    model, mesh = gmsh.model, gmsh.model.mesh
    entities = [(at, mesh.getNodes(*at)[:2], mesh.getElements(*at)) for at in model.getEntities()]
    groups = [
        (*at, model.getPhysicalName(*at), model.getEntitiesForPhysicalGroup(*at))
        for at in model.getPhysicalGroups()
    ]
    return entities, groups


@contextmanager
def restore_model(found: ModelSnapshot) -> Iterator[Any]:
    """Context that yields a new gmsh model with the mesh and the physical groups of a result of
    `snapshot_model`; gmsh is closed when the context ends.
    """
    entities, groups = found
    with _session() as gmsh_model:
        for at, nodes, elements in entities:
            gmsh_model.addDiscreteEntity(*at)
            gmsh_model.mesh.addNodes(*at, *nodes)
            gmsh_model.mesh.addElements(*at, *elements)
        for dim, tag, name, members in groups:
            gmsh_model.addPhysicalGroup(dim, members, tag, name)
        yield gmsh_model


def _wire(body: Body, *, flat: bool = False) -> list[int]:
    """Add the section of a body to the OpenCASCADE kernel of gmsh's current model, without
    synchronising; returns the tags of its curves, a closed chain in the order of `body.section`.

    flat: whether the section is drawn in gmsh's plane z = 0, with y and z of space as gmsh's x and
        y, instead of in its place in space. A curve with a centre becomes a circular arc, one with
        two points a line, any other a spline.
    """
    occ = gmsh.model.occ

    def point(yz: Array) -> int:
        """gmsh tag of a new point at (y, z) in the body's coordinates, mm."""
        x, y, z = body.pose.outward(np.array([0.0, *yz]))
        return int(occ.addPoint(y, z, 0.0) if flat else occ.addPoint(x, y, z))

    section = body.section
    corners = [point(curve.points[0]) for curve in section]
    tags = []
    for index, curve in enumerate(section):
        start, end = corners[index], corners[(index + 1) % len(corners)]
        if curve.centre is not None:
            tags.append(occ.addCircleArc(start, point(curve.centre), end))
        elif len(curve.points) == 2:
            tags.append(occ.addLine(start, end))
        else:
            inner = [point(yz) for yz in curve.points[1:-1]]
            tags.append(occ.addSpline([start, *inner, end]))
    return tags


def _plane_surface(body: Body, options: Options, groups: dict[tuple[int, int], list[int]]) -> None:
    """Add the section of a body to gmsh's current model as a surface in gmsh's plane z = 0.

    groups: (dimension, physical tag) -> gmsh entities; the surface and its contact, support and
        symmetry edges are added to it.
    """
    curves = _wire(body, flat=True)
    loop = gmsh.model.occ.addCurveLoop(curves)
    groups.setdefault((2, body.tag), []).append(gmsh.model.occ.addPlaneSurface([loop]))
    _group_faces(body, curves, options, groups)


def _group_faces(
    body: Body, faces: list[int], options: Options, groups: dict[tuple[int, int], list[int]]
) -> None:
    """Add the faces of a body (edges in a section) to the groups of their roles; free ones to none.

    faces: gmsh tags, one for each curve of the section in its order.
    groups: (dimension, physical tag) -> gmsh entities.
    """
    tags = {"contact": CONTACT + body.tag, "support": SUPPORT + body.tag}
    tags["symmetry"] = options.symmetry
    for curve, face in zip(body.section, faces, strict=True):
        if curve.role in tags:
            groups.setdefault((options.dim - 1, tags[curve.role]), []).append(face)


def _sweep(
    body: Body, grading: Grading, options: Options, groups: dict[tuple[int, int], list[int]]
) -> None:
    """Add a body to the gmsh model by sweeping its section from x = 0 along the rail or about its
    axle, to both sides or, with `options.half`, to one.

    groups: (dimension, physical tag) -> gmsh entities; the new volumes and faces are added to it.
    A wheel whose mesh is stretched is swept straight. Hexahedra are swept in layers. Raises
    RuntimeError where gmsh makes another number of side faces than the section has curves.
    """
    occ = gmsh.model.occ
    curves = _wire(body)
    face = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    if options.half:
        groups.setdefault((2, SYMMETRY_X), []).append(face)
    ahead, across = _sweep_directions(body, grading).T[:2]
    structured: dict[str, Any] = {}
    if options.cell == "hexahedron":
        ends = grading.layers(body.reach)
        structured = {"numElements": [1] * len(ends), "heights": ends, "recombine": True}
    for sign in (1,) if options.half else (1, -1):
        if body.axle is None or grading.stretch != 1:
            made = occ.extrude([(2, face)], *sign * body.reach * ahead, **structured)
        else:
            height, radius = body.axle
            angle = -sign * body.reach / radius
            centre = body.pose.outward(np.array([0.0, 0.0, height]))
            made = occ.revolve([(2, face)], *centre, *across, angle, **structured)
        end, volume, lateral = made[0][1], made[1][1], [tag for _, tag in made[2:]]
        if len(lateral) != len(curves):
            raise RuntimeError(
                f"{BODY_NAMES[body.tag]}: gmsh swept {len(curves)} curves into {len(lateral)} faces"
            )
        groups.setdefault((3, body.tag), []).append(volume)
        if body.end_role == "support":
            groups.setdefault((2, SUPPORT + body.tag), []).append(end)
        _group_faces(body, lateral, options, groups)


def _sweep_directions(body: Body, grading: Grading) -> Array:
    """Directions (3, 3) of a swept body in the coordinates that gmsh meshes in, as columns: along
    the sweep, across it, upwards. There x of space is divided by the stretch.
    """
    columns = body.pose.rotation.copy()
    columns[0, 0] /= grading.stretch
    return columns


def undo_stretch(bodies: list[Body], grading: Grading) -> None:
    """Move the nodes of the current gmsh model from coordinates in which x is divided by the
    stretch to space. Nothing is done for a stretch of 1.

    The elements get their true length along x. A wheel with an axle, which was meshed as a straight
    prism, is bent around the axle.
    """
    if grading.stretch == 1:
        return
    swept = [(b, v) for b in bodies for v in gmsh.model.getEntitiesForPhysicalGroup(3, b.tag)]
    for body, volume in swept:  # two sweeps share their section, which stays where it is
        tags, points, _ = gmsh.model.mesh.getNodes(3, volume, includeBoundary=True)
        beside = np.asarray(points).reshape(-1, 3) - body.pose.origin
        x, y, z = np.linalg.solve(_sweep_directions(body, grading), beside.T)
        if body.axle is not None:
            height, radius = body.axle
            angle, distance = x / radius, height - z
            x, z = distance * np.sin(angle), height - distance * np.cos(angle)
        places = body.pose.outward(np.column_stack([x, y, z]))
        for tag, place in zip(tags, places, strict=True):
            gmsh.model.mesh.setNode(tag, place, [])


def _mesh(bodies: list[Body], grading: Grading, options: Options) -> None:
    """Mesh the current gmsh model: set element sizes and algorithms, generate, raise the degree of
    the geometry, and straighten badly bent simplices.

    bodies: what is meshed. grading: element size, in the plane 'xz' as `Grading.turned`. options:
        type of the cells, degree of the geometry, plane.
    """
    hexahedra = options.cell == "hexahedron"
    flat = hexahedra or bool(options.plane)
    expression = grading.expression(section=flat, coordinates="xyz"[options.section_axes])
    for y, z in _held_corners(bodies) if options.plane else ():
        away = f"Sqrt((x-({y:.15g}))^2+(y-({z:.15g}))^2)"
        size = f"{CORNER_SIZE * grading.at(y, z):.15g}+{CORNER_GROWTH}*{away}"
        expression = f"Min({expression},{size})"
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", expression)
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    settings = {
        "MeshSizeExtendFromBoundary": 0,
        "MeshSizeFromPoints": 0,
        "MeshSizeFromCurvature": 0 if hexahedra else options.per_turn,
        "MeshSizeMin": 0.2 * grading.size,
        "MeshSizeMax": grading.coarsest,
        "Algorithm3D": 10,  # HXT: faster, better shaped than Delaunay; not used by sweeps in layers
        "LcIntegrationPrecision": 1e-6,  # of sizes along a curve; 1e-9 takes three times as long
        # Below this quality tetrahedra are improved. With 0.3 those at fillets, which cannot be,
        # take half of the time of a coarse mesh of real bodies.
        "OptimizeThreshold": 0.2 if options.geometry_degree > 1 else 0.3,
    }
    if hexahedra:
        settings |= {"RecombineAll": 1, "RecombinationAlgorithm": 3}
        for _, curve in gmsh.model.getEntities(1):
            _at_least_two_elements(curve, grading, options)
    for name, value in settings.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.model.mesh.generate(options.dim)
    if options.geometry_degree > 1:
        gmsh.model.mesh.setOrder(options.geometry_degree)
        _straighten(options.cell, options.dim)


def _held_corners(bodies: list[Body]) -> list[Array]:
    """Points (2,) in the plane of the sections, mm, at which a support ends: stresses are singular
    there, and the approach of a short body depends on how they are resolved.
    """
    return [
        body.pose.outward(np.array([0.0, *body.section[index].points[0]]))[1:]
        for body in bodies
        for index, curve in enumerate(body.section)
        if {body.section[index - 1].role, curve.role} in CORNERS
    ]


def _at_least_two_elements(curve: int, grading: Grading, options: Options) -> None:
    """Divide a curve into two elements where it is shorter than four of the element sizes at its
    middle.

    curve: gmsh tag. grading: element size.
    Recombination to quadrilaterals alone halves every curve, so that no curve may hold one element.
    """
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, curve))
    middle = gmsh.model.getValue(1, curve, [(low + high) / 2])
    if gmsh.model.occ.getMass(1, curve) < 4 * grading.at(*middle[options.section_axes]):
        gmsh.model.mesh.setTransfiniteCurve(curve, 3)


def _straighten(cell: str, dim: int) -> None:
    """Move the middle nodes of badly bent quadratic cells to the middle of their corners.

    cell: as `Options.cell`. dim: 2 in a section, 3 for solids. Cells whose quality is below 0.1
        (`REPAIR_BELOW`) are straightened, in at most five passes. They are coarse ones on fillets,
        far from the patch. gmsh's own high-order optimisation gives another mesh in each run.
    """
    middles = [[int(corner) for corner in each] for each in MIDDLES[cell, dim].split()]
    nodes, places, _ = gmsh.model.mesh.getNodes()
    coordinates = dict(zip(nodes, np.asarray(places).reshape(-1, 3), strict=True))
    for _ in range(STRAIGHTENING_PASSES):
        bad = qualities(dim) < REPAIR_BELOW
        if not bad.any():
            return
        tags = np.concatenate(gmsh.model.mesh.getElements(dim)[1])
        for element in tags[bad]:
            nodes = gmsh.model.mesh.getElement(element)[1]
            for middle, corners in zip(nodes[-len(middles) :], middles, strict=True):
                straight = np.mean([coordinates[nodes[each]] for each in corners], axis=0)
                gmsh.model.mesh.setNode(middle, straight, [])
                coordinates[middle] = straight


def qualities(dim: int = 3) -> np.ndarray:
    """Quality (m,) of all m elements of one dimension in the current gmsh model, in its present
    coordinates (stretched before `undo_stretch`): 1 ideal, 0 flat, negative inverted.

    dim: dimension of the elements, 2 or 3. For quadrilaterals and hexahedra the quality is the
        smallest scaled Jacobian. For simplices it is the smaller of that and the signed inverse
        condition number, because the Jacobian does not show a straight sliver.
    """
    types, tags, _ = gmsh.model.mesh.getElements(dim)
    quality = []
    for number, members in zip(types, tags, strict=True):
        kind = gmsh.model.mesh.getElementProperties(number)[0]  # as 'Tetrahedron 10'
        structured = kind.startswith(("Hexahedron", "Quadrilateral"))
        names = ["minSJ"] if structured else ["minSJ", "minSICN"]
        measures = [gmsh.model.mesh.getElementQualities(members, name) for name in names]
        quality.append(np.min(measures, axis=0))
    return np.concatenate(quality)
