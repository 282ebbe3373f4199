"""gmsh (OpenCASCADE kernel) builds the bodies: a section swept along the rail or about the axle."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import gmsh
import numpy as np

from meshing.bodies import Body, Options
from meshing.outlines import Curve
from meshing.sizing import Grading
from meshing.tags import BODIES, CONTACT, SUPPORT, SYMMETRY_X, SYMMETRY_Y

REPAIR_BELOW = 0.1  # quality of a curved tetrahedron that is straightened
STRAIGHTENING_PASSES = 5
ELEMENTS_PER_TURN = 6  # on fillets
TET10_EDGES = ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))  # gmsh's order of the middle nodes


@contextmanager
def model(bodies: list[Body], grading: Grading, options: Options) -> Iterator[Any]:
    """The meshed gmsh model with physical groups for the bodies and their faces."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add("railhead")
        groups: dict[tuple[int, int], list[int]] = {}
        for body in bodies:
            _sweep(body, grading, options, groups)
        gmsh.model.occ.synchronize()
        for (dim, tag), entities in sorted(groups.items()):
            gmsh.model.addPhysicalGroup(dim, entities, tag, _name(dim, tag))
        _mesh(grading, options)
        yield gmsh.model
    finally:
        gmsh.finalize()


def _name(dim: int, tag: int) -> str:
    if dim == 3:
        return BODIES[tag]
    if tag in (SYMMETRY_X, SYMMETRY_Y):
        return "symmetry_x" if tag == SYMMETRY_X else "symmetry_y"
    kind = "contact" if tag // 10 * 10 == CONTACT else "support"
    return f"{BODIES[tag % 10]}_{kind}"


def _sweep(
    body: Body, grading: Grading, options: Options, groups: dict[tuple[int, int], list[int]]
) -> None:
    occ = gmsh.model.occ
    curves = _wire(body.section)
    face = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    if options.half:
        groups.setdefault((2, SYMMETRY_X), []).append(face)
    structured: dict[str, Any] = {}
    if options.cell == "hexahedron":
        ends = grading.layers(body.reach)
        structured = {"numElements": [1] * len(ends), "heights": ends, "recombine": True}
    for sign in (1,) if options.half else (1, -1):
        if body.axle is None:
            made = occ.extrude([(2, face)], sign * body.reach, 0, 0, **structured)
        else:
            height, radius = body.axle
            angle = -sign * body.reach / radius
            made = occ.revolve([(2, face)], 0, 0, height, 0, 1, 0, angle, **structured)
        end, volume, lateral = made[0][1], made[1][1], [tag for _, tag in made[2:]]
        if len(lateral) != len(curves):
            raise RuntimeError(
                f"{BODIES[body.tag]}: gmsh swept {len(curves)} curves into {len(lateral)} faces"
            )
        groups.setdefault((3, body.tag), []).append(volume)
        if body.end_role == "support":
            groups.setdefault((2, SUPPORT + body.tag), []).append(end)
        for curve, surface in zip(body.section, lateral, strict=True):
            tag = {
                "contact": CONTACT + body.tag,
                "support": SUPPORT + body.tag,
                "symmetry": SYMMETRY_Y,
            }.get(curve.role)
            if tag is not None:
                groups.setdefault((2, tag), []).append(surface)


def _wire(section: list[Curve]) -> list[int]:
    """Closed chain of curves in the plane x = 0."""
    occ = gmsh.model.occ
    corners = [occ.addPoint(0.0, *curve.points[0]) for curve in section]
    tags = []
    for index, curve in enumerate(section):
        start, end = corners[index], corners[(index + 1) % len(corners)]
        if curve.centre is not None:
            tags.append(occ.addCircleArc(start, occ.addPoint(0.0, *curve.centre), end))
        elif len(curve.points) == 2:
            tags.append(occ.addLine(start, end))
        else:
            inner = [occ.addPoint(0.0, *point) for point in curve.points[1:-1]]
            tags.append(occ.addSpline([start, *inner, end]))
    return tags


def _mesh(grading: Grading, options: Options) -> None:
    hexahedra = options.cell == "hexahedron"
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", grading.expression(section=hexahedra))
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0 if hexahedra else ELEMENTS_PER_TURN)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.2 * grading.size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", grading.coarsest)
    if hexahedra:
        gmsh.option.setNumber("Mesh.RecombineAll", 1)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 3)
        for _, curve in gmsh.model.getEntities(1):
            _at_least_two_elements(curve, grading)
    else:
        gmsh.option.setNumber("Mesh.Algorithm3D", 10)  # HXT: faster, better shaped than Delaunay
    gmsh.model.mesh.generate(3)
    if options.geometry_degree > 1:
        gmsh.model.mesh.setOrder(options.geometry_degree)
        if not hexahedra:
            _straighten()


def _at_least_two_elements(curve: int, grading: Grading) -> None:
    """Full-quad recombination halves every curve, so none may carry a single element."""
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, curve))
    middle = gmsh.model.getValue(1, curve, [(low + high) / 2])
    if gmsh.model.occ.getMass(1, curve) < 4 * grading.at(middle[1], middle[2]):
        gmsh.model.mesh.setTransfiniteCurve(curve, 3)


def _straighten() -> None:
    """Straighten the edges of badly bent tetrahedra (coarse ones on fillets, far from the patch).

    gmsh's own high-order optimisation gives another mesh in each run.
    """
    coordinates = dict(zip(*_nodes(), strict=True))
    for _ in range(STRAIGHTENING_PASSES):
        bad = qualities() < REPAIR_BELOW
        if not bad.any():
            return
        tags = np.concatenate(gmsh.model.mesh.getElements(3)[1])
        for element in tags[bad]:
            nodes = gmsh.model.mesh.getElement(element)[1]
            for middle, (start, end) in zip(nodes[4:], TET10_EDGES, strict=False):
                straight = 0.5 * (coordinates[nodes[start]] + coordinates[nodes[end]])
                gmsh.model.mesh.setNode(middle, straight, [])
                coordinates[middle] = straight


def _nodes() -> tuple[np.ndarray, np.ndarray]:
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    return tags, np.asarray(coordinates).reshape(-1, 3)


def qualities() -> np.ndarray:
    """Shape of each volume element of the current model: 1 ideal, 0 flat, negative inverted.

    The smallest scaled Jacobian; for tetrahedra, where it says nothing of a straight sliver, the
    smaller of it and the inverse condition number.
    """
    types, tags, _ = gmsh.model.mesh.getElements(3)
    quality = []
    for kind, members in zip(types, tags, strict=True):
        names = ["minSJ"] if "Hexahedron" in _kind(kind) else ["minSJ", "minSICN"]
        measures = [gmsh.model.mesh.getElementQualities(members, name) for name in names]
        quality.append(np.min(measures, axis=0))
    return np.concatenate(quality)


def _kind(element_type: int) -> str:
    return str(gmsh.model.mesh.getElementProperties(element_type)[0])
