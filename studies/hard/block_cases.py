"""Hard cases solved directly on two blocks: starts, invariances, paths, poor meshes."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing.mesh import ContactMesh
from railhead.postprocess import read
from railhead.postprocess.findings import Findings, Frame
from railhead.results.checks import BALANCE_TOLERANCE, NOISE_LIMIT
from railhead.solver.compat import cell_nodes
from railhead.solver.contact import ContactModel
from railhead.solver.material import Material
from railhead.solver.space.contact_interface import ContactLaw, Gap
from railhead.solver.system.fields import gather
from railhead.solver.system.setup import ContactBody, Setup
from railhead.solver.system.solution import Solution
from studies.hard import block_pairs
from studies.hard.case import CaseErrors, Deviation

Array = NDArray[np.float64]
Start = Callable[[ContactModel], NDArray[np.bool_]]
LOAD = 3000.0
EXACTLY = 1e-8  # what an invariance may be off by: the tolerance of Newton's method
SOLUTION = "pressure, approach"
LAWS = {
    "": ContactLaw(),
    "theta 0": ContactLaw(theta=0),
    "theta -1": ContactLaw(theta=-1),
    "penalty": ContactLaw("penalty"),
}
TRANSFORMS: dict[str, tuple[Array, float, float]] = {
    "rotated": (Rotation.from_euler("xyz", [0.5, -0.8, 1.1]).as_matrix(), 1.0, 1.0),
    "mirrored": (np.diag([1.0, 1.0, -1.0]), 1.0, 1.0),
    "in m and Pa": (np.eye(3), 1e-3, 1e6),
    "in GPa": (np.eye(3), 1.0, 1e-3),
    "a thousand times larger": (np.eye(3), 1e3, 1.0),
}
"""Orthogonal matrix, and lengths and stresses in the new units over those in mm and MPa."""


def near(radius: float = 3.0) -> Start:
    """Start at which the points within a radius (mm) of the axis touch, close to the patch of
    LOAD."""
    return lambda model: np.linalg.norm(model.interface.points[:, :2], axis=1) < radius


def random(share: float) -> Start:
    """Start at which a random share of all points touches, the same in each run."""
    generator = np.random.default_rng(1)
    return lambda model: generator.random(len(model.interface.points)) < share


@dataclass(frozen=True)
class Solved:
    """A contact model with one solution.

    model: the model.
    solution: its solution.
    load: load that was prescribed, N.
    """

    model: ContactModel
    solution: Solution
    load: float

    def findings(self) -> Findings:
        """Patch, pressure and stresses read from the solution."""
        fields = gather(self.model, self.solution)
        assert fields is not None
        return read.findings(fields, Frame((0.0, 0.0, 0.0), 0.0))

    @property
    def failed(self) -> tuple[str, ...]:
        """Checks that a solution without a scene can fail, as `results.checks` names them."""
        found, load = self.solution, self.load
        off = max(abs(found.load / load - 1), abs(found.reaction / load - 1))
        passed = {"converged": found.newton.converged, "force_balance": off < BALANCE_TOLERANCE}
        return tuple(name for name, holds in passed.items() if not holds)

    def measured(
        self, deviation: float, limit: float, name: str, findings: Findings | None = None
    ) -> CaseErrors:
        """Errors of the case: a named deviation with its limit, the failed checks and the costs;
        findings: judged by their noise, too."""
        history = self.solution.newton.history
        noise = None if findings is None else findings.noise
        rough = noise is not None and not noise <= NOISE_LIMIT
        return CaseErrors(
            {name: Deviation(deviation, limit)},
            (*self.failed, *(["pressure_noise"] if rough else [])),
            len(history),
            sum(step.linear_iterations for step in history),
            noise,
        )


def solve(made: ContactMesh, setup: Setup, start: Start, load: float = LOAD) -> Solved:
    """Model of a mesh, solved under a load (N) from the active points that `start` gives."""
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    return Solved(model, model.solve(load=load, active=start(model)), load)


def differ(one: Solution, other: Solution) -> float:
    """Largest difference of the pressures over the largest, or relative one of the approaches."""
    pressure = np.abs(one.pressure - other.pressure).max() / other.pressure.max()
    return float(max(pressure, abs(one.approach / other.approach - 1)))


def offset(distance: float, gap: Gap = block_pairs.GAP) -> Gap:
    """The gap function `gap` with `distance` mm added to the gaps."""

    def moved(points: Array) -> tuple[Array, Array]:
        gaps, normals = gap(points)
        return gaps + distance, normals

    return moved


def start_from(share: float | None = None, distance: float = 0.0, law: str = "") -> CaseErrors:
    """Start from bodies `distance` mm apart and a bad active set, a random share of all points
    (None: a good one): the answer must be that of a good start. law: key of LAWS."""
    made, setup = block_pairs.two_blocks(law=LAWS[law])
    start = near() if share is None else random(share)
    good = solve(made, setup, near())
    bad = solve(made, replace(setup, gap=offset(distance, setup.gap)), start)
    shifted = replace(bad.solution, approach=bad.solution.approach - distance)
    return bad.measured(differ(shifted, good.solution), EXACTLY, SOLUTION)


def transformed(how: str) -> CaseErrors:
    """The scene turned or mirrored, or in other units, see TRANSFORMS: the same answer."""
    matrix, length, stress = TRANSFORMS[how]
    made, setup = block_pairs.two_blocks()
    good = solve(made, setup, near())
    gap = setup.gap

    def turned(points: Array) -> tuple[Array, Array]:
        gaps, normals = gap(np.asarray(points @ matrix / length))
        return gaps * length, normals @ matrix.T

    moved, other = block_pairs.two_blocks(own=True)
    moved.mesh.geometry.x[:] = length * moved.mesh.geometry.x @ matrix.T
    steel = Material(block_pairs.STEEL.young_modulus * stress, block_pairs.STEEL.poisson_ratio)
    other = replace(
        other,
        fixed=block_pairs.side(other.fixed.tag, steel),
        moving=block_pairs.side(other.moving.tag, steel),
        gap=turned,
        direction=tuple(matrix @ np.array(other.direction)),
        planes=tuple((tag, tuple(matrix @ np.array(normal))) for tag, normal in other.planes),
    )

    def back(model: ContactModel) -> Array:
        """Contact points in the frame and the units of the good solution."""
        return np.asarray(model.interface.points @ matrix / length)

    found = solve(
        moved,
        other,
        lambda model: np.linalg.norm(back(model)[:, :2], axis=1) < 3.0,
        LOAD * stress * length**2,
    )
    same = cKDTree(back(found.model)).query(good.model.interface.points)[1]
    solution = replace(
        found.solution,
        pressure=np.asarray(found.solution.pressure[same] / stress),
        approach=found.solution.approach / length,
    )
    return found.measured(differ(solution, good.solution), EXACTLY, SOLUTION)


def path(loads: list[float]) -> CaseErrors:
    """Loads up and down on one mesh, each from the last one's active set; the last load solved
    afresh is the reference."""
    made, setup = block_pairs.two_blocks()
    stepping = solve(made, setup, near(), loads[0])
    steps = [stepping]
    for load in loads[1:]:
        active = steps[-1].solution.pressure > 0
        steps.append(Solved(stepping.model, stepping.model.solve(load=load, active=active), load))
    fresh = solve(made, setup, near(), loads[-1]).solution
    worst = max(steps, key=lambda step: len(step.solution.newton.history))
    return replace(
        steps[-1].measured(differ(steps[-1].solution, fresh), EXACTLY, SOLUTION),
        newton=len(worst.solution.newton.history),
        failed=tuple(dict.fromkeys(name for step in steps for name in step.failed)),
    )


def against_matched(
    h: float, ratio: float, limit: float, fine: float = 0.7, **changes: Any
) -> CaseErrors:
    """Meshes of sizes h and ratio * h: approach and largest pressure of a matched mesh of size
    `fine` (mm) are the reference."""
    found = solve(*block_pairs.two_blocks(h=h, ratio=ratio, **changes), near())
    return against(solve(*block_pairs.two_blocks(h=fine), near()), found, limit)


def against(good: Solved, found: Solved, limit: float) -> CaseErrors:
    """Approach and largest pressure of a solution against those of a good one."""
    findings, exact = found.findings(), good.findings()
    deviation = max(
        abs(found.solution.approach / good.solution.approach - 1),
        abs(findings.patch.max_pressure / exact.patch.max_pressure - 1),
    )
    return found.measured(deviation, limit, "max_MPa, approach_mm", findings)


def slivers(quality: float, count: int, limit: float) -> CaseErrors:
    """`count` cells at the contact face squashed to a scaled Jacobian of `quality`: the regular
    mesh is the reference for approach and largest pressure."""
    made, setup = block_pairs.two_blocks(h=1.0)
    good = solve(*block_pairs.two_blocks(h=1.0), near())
    squashed = squash(made, setup.fixed, quality, count)
    measured = against(good, solve(made, setup, near()), limit)
    deviations = measured.deviations if squashed == count else {}
    return replace(measured, deviations=deviations, remark=f"{squashed} cells squashed")


def squash(made: ContactMesh, body: ContactBody, quality: float, count: int) -> int:
    """Move inner corners of tetrahedra on the contact face towards it until one of the cells
    around has a scaled Jacobian of `quality`; returns how many corners, at most `count`."""
    x, topology = made.mesh.geometry.x, made.mesh.topology
    for pair in ((2, 3), (3, 0)):
        topology.create_connectivity(*pair)
    nodes = cell_nodes(made.mesh)
    cells = [
        topology.connectivity(2, 3).links(facet)[0] for facet in made.facet_tags.find(body.contact)
    ]
    outer = {node for cell in cells for node in nodes[cell] if abs(x[node, 2]) < 1e-9}
    squashed = 0
    for cell in sorted(cells, key=lambda c: float(np.linalg.norm(x[nodes[c]].mean(axis=0)))):
        inner = [node for node in nodes[cell] if node not in outer and (x[node, :2] > 1e-9).all()]
        if len(inner) != 1 or squashed == count:
            continue
        apex, start = inner[0], x[inner[0]].copy()
        around = nodes[(nodes == apex).any(axis=1)]
        foot = x[[node for node in nodes[cell] if node != apex]].mean(axis=0)
        sign = np.sign(scaled_jacobian(x[around]))
        for height in np.geomspace(1.0, 1e-3, 400):
            x[apex] = foot + height * (start - foot)
            worst = float((sign * scaled_jacobian(x[around])).min())
            if worst < 1.05 * quality:
                break
        if worst > 0.5 * quality:
            squashed += 1
        else:
            x[apex] = start
    return squashed


def scaled_jacobian(corners: Array) -> Array:
    """(n, 4, 3) -> (n,) scaled Jacobian of tetrahedra, 1 or -1 for the regular one: sqrt(2) 6 V
    over the largest product of the three edges at a corner."""
    edges = corners[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]] - corners[:, :, None]
    product = np.linalg.norm(edges, axis=3).prod(axis=2).max(axis=1)
    return np.asarray(np.sqrt(2) * np.linalg.det(edges[:, 0]) / product)


def two_patches(height: float, h: float, fine: float, limit: float) -> CaseErrors:
    """Two bumps at y = -6 and 6 mm, the second lower by `height` mm; a finer mesh is the
    reference for the approach and for the load's share on the first."""

    def gap(points: Array) -> tuple[Array, Array]:
        x, y = points[:, 0], points[:, 1]
        one = 0.5 * (x**2 / 3000 + (y + 6) ** 2 / 2000)
        two = 0.5 * (x**2 / 3000 + (y - 6) ** 2 / 2000) + height
        return np.minimum(one, two), np.tile([0.0, 0.0, 1.0], (len(points), 1))

    def share(of: Solved) -> float:
        interface = of.model.interface
        force = interface.weights * of.solution.pressure
        return float(force[interface.points[:, 1] < 0].sum() / force.sum())

    one, two = (
        solve(*block_pairs.two_blocks(20.0, size, fine=(0.2, 0.45), half=False, gap=gap), near(9.0))
        for size in (h, fine)
    )
    deviation = max(
        abs(one.solution.approach / two.solution.approach - 1), abs(share(one) / share(two) - 1)
    )
    measured = one.measured(deviation, limit, "approach_mm, share of the load")
    return replace(measured, remark=f"{share(one):.0%} on the first")


def line_contact(cell: str, h: float, limit: float, radius: float = 500.0) -> CaseErrors:
    """A cylinder on a plane, nu = 0 (plane strain and free ends are the same): half-width and mean
    pressure within half of it against Hertz's line contact for each half-width (mm).

    b = sqrt(4 P R / (pi E*)), p = p0 sqrt(1 - y^2/b^2), p0 = 2 P / (pi b), P in N/mm (Johnson 1985,
    section 4.2 (c)).
    """
    half_widths = [float(b) for b in np.linspace(0.8, 1.0, 6)]
    soft = Material(207000.0, 0.0)
    made, setup = block_pairs.two_blocks(
        size=20.0 * max(half_widths),
        length=2.0 * h,
        h=h,
        fine=(0.08, 0.08),
        cell=cell,
        degree=1 if cell == "hexahedron" else 2,
        materials=(soft, soft),
        gap=ParabolicGap(0.0, 1 / radius, 1),
    )
    model, found = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup), []
    y, w = model.interface.points[:, 1], model.interface.weights
    for b in half_widths:
        per_length = np.pi * 0.5 * soft.young_modulus * b**2 / (4 * radius)
        load = float(per_length * 4.0 * h)
        solved = Solved(model, model.solve(load=load, active=y < b), load)
        p = solved.solution.pressure
        half = y < 0.5 * b
        exact = 2 * per_length / (np.pi * b) * np.sqrt(1 - (y[half] / b) ** 2)
        deviation = max(
            abs(2 * float(np.sqrt(w @ (p * y**2) / (w @ p))) / b - 1),
            abs(float(w[half] @ p[half]) / float(w[half] @ exact) - 1),
        )
        found.append((deviation, solved))
    deviation, worst = max(found, key=lambda each: each[0])
    failed = tuple(dict.fromkeys(name for _, solved in found for name in solved.failed))
    return replace(worst.measured(deviation, limit, "b_mm, pressure"), failed=failed)
