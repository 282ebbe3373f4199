"""Contact fields painted with a known pressure as finite elements would compute it."""

import basix
import numpy as np

from railhead.solver.material import Material
from railhead.solver.system.fields import ContactFields, Fields

JITTER = 0.2  # of an element
STEEL = Material(207000.0, 0.3)
YOUNG, POISSON, LAME = STEEL.young_modulus, STEEL.poisson_ratio, STEEL.lame


def painted(
    square,
    half: tuple[float, float],
    size: float,
    waver: float = 0.05,
    seed: int = 0,
    even: bool = False,
) -> Fields:
    """A flat rail whose pressure is sqrt(max(square, 0)) at (x, s).

    Triangles with legs of about `size` cover +-half (x from 0 where it is even, cut at x = 0). On
    each of them the pressure is projected on linear functions, a random linear part of mean zero is
    added, `waver` times the pressure, the negative part is cut off and the integral restored:
    integrals over triangles are kept, values are not.
    """
    rng = np.random.default_rng(seed)
    low = 0.0 if even else -half[0]
    counts = [int(np.ceil((half[0] - low) / size)), int(np.ceil(2 * half[1] / size))]
    x, s = (np.linspace(a, b, n + 1) for a, b, n in zip((low, -half[1]), half, counts, strict=True))
    grid = np.stack(np.meshgrid(x, s, indexing="ij"), axis=-1)
    inner = (slice(1, -1), slice(1, -1))
    grid[inner] += JITTER * size * rng.uniform(-1, 1, grid[inner].shape)
    numbers = np.arange(grid[..., 0].size).reshape(grid.shape[:2])
    corner = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    triangles = np.concatenate(
        [np.column_stack([corner[i].ravel() for i in three]) for three in ((0, 1, 2), (0, 2, 3))]
    )
    nodes = grid.reshape(-1, 2)
    corners = nodes[triangles]
    edges = corners[:, 1:] - corners[:, :1]
    area = np.abs(np.linalg.det(edges)) / 2

    fine, fine_weight = basix.make_quadrature(basix.CellType.triangle, 20)
    at = corners[:, :1] + np.einsum("qk,fkd->fqd", fine, edges)
    exact = np.sqrt(np.maximum(square(at[..., 0], at[..., 1]), 0.0))
    linear = np.column_stack([1 - fine.sum(axis=1), fine])
    mass = linear.T @ (linear * fine_weight[:, None])
    nodal = np.linalg.solve(mass, np.einsum("qk,q,fq->kf", linear, fine_weight, exact)).T
    noise = rng.standard_normal(nodal.shape)
    noise -= noise.mean(axis=1, keepdims=True)
    mean = nodal.mean(axis=1, keepdims=True)
    nodal = nodal + waver * np.sqrt(12.0) * noise * mean

    xi, weight = basix.make_quadrature(basix.CellType.triangle, 5)
    shape = np.column_stack([1 - xi.sum(axis=1), xi])
    points = (corners[:, :1] + np.einsum("qk,fkd->fqd", xi, edges)).reshape(-1, 2)
    pressure = np.maximum(nodal @ shape.T, 0.0)
    pressure *= mean / np.maximum(2 * pressure @ weight, 1e-300)[:, None]
    outside = square(points[:, 0], points[:, 1]).reshape(pressure.shape)
    indicator = np.where(pressure > 0, pressure, np.minimum(outside, -1e-6)).ravel()
    count = len(triangles)
    contact = ContactFields(
        points=np.column_stack([points, np.zeros(len(points))]),
        weights=(2 * area[:, None] * weight).ravel(),
        pressure=np.maximum(indicator, 0.0),
        indicator=indicator,
        gap=np.zeros(len(points)),
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        facet=np.repeat(np.arange(count), len(xi)),
        xi=np.tile(xi, (count, 1)),
        facet_nodes=triangles,
        facing=np.ones(count, dtype=bool),
    )
    return Fields(
        points=np.column_stack([nodes, np.zeros(len(nodes))]),
        displacement=np.zeros((len(nodes), 3)),
        cells=np.zeros((0, 4), dtype=np.int64),
        body=np.zeros(0, dtype=np.int64),
        lame=np.zeros((0, 2)),
        cell="tetrahedron",
        degree=1,
        slave=1,
        mirrors=((1.0, 0.0, 0.0),) if even else (),
        contact=contact,
    )


def measured(square, half: tuple[float, float]):
    """a, b, area and largest pressure where a known p^2 is positive, by brute force."""
    x, s = (np.linspace(-reach, reach, 4001) for reach in half)
    values = square(x[:, None], s[None, :])
    inside = values > 0
    cell = (x[1] - x[0]) * (s[1] - s[0])
    return np.array(
        [
            np.ptp(x[inside.any(axis=1)]) / 2,
            np.ptp(s[inside.any(axis=0)]) / 2,
            cell * inside.sum(),
            np.sqrt(values.max()),
        ]
    )
