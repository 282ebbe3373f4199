"""Fatigue of the steel below a contact: stress paths while the wheel rolls over it, and the largest
stresses of Dang Van and Findley on them.

The paths are those of half-spaces under the pressure and the tractions that were found, along the
rail through the patch with the largest pressure, and end without stress. Below a line they are sums
over strips that narrow towards the edges, below other patches over the cells of a grid. They begin
at 0.01 of the smaller half length: nearer to the surface a sliding edge makes a cusp of the model.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator, PchipInterpolator

from railhead.postprocess.findings import Array, Findings, Frame, OnePatch, Surface
from railhead.theory import fatigue
from railhead.theory.bem import grid_stress
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic.line import Strips
from railhead.theory.elastic.subsurface import von_mises
from railhead.theory.friction.solution import FrictionSolution

DEPTHS = np.array([0.01, 0.02, 0.04, 0.07, 0.11, 0.15, *np.arange(4, 17) / 20, 0.9, 1.0, 1.2, 1.5])
"""Over the smaller half length."""
ROUGH = 100  # steps to the centre of a path that find the worst of several
STRIPS = 400
ALONG, ACROSS = (64, 1024), 25  # fewest and most cells along a patch, and cells across it
FINER = 2.5  # cells along a patch in a depth
SIDES = np.linspace(-0.8, 0.8, 5)  # of paths side by side, over the half length across
UNLIKE = 1e-6  # half lengths by which points are moved: cells of a grid lie on circles by four
DEEP = 0.2  # least depth at which finite bodies are compared, over the smaller half length
SLOPES = {"dang_van": 0.33, "findley": 0.3}
"""Weights of the hydrostatic stress and of the normal stress where a scene gives none."""
Residual = Callable[[Array, Array], Array]
"""Depths (d,) and places across (k,), mm -> residual stress (d, k, 6), MPa."""


def read(
    found: Findings,
    surface: Surface,
    friction: FrictionSolution | None,
    poisson: float,
    *,
    slopes: Sequence[float],
    line: bool,
    body: str,
    residual: Residual | None = None,
) -> dict[str, Any]:
    """The largest stresses of Dang Van and Findley, MPa ("dang_van_MPa", "findley_MPa"), their
    depths, mm ("depth_mm") and the angles of their planes to the surface, degrees ("plane_deg"), by
    criterion; both over the depth ("profile"); and the relative error of each ("estimate"): the
    change from half as many strips or cells at these depths and beside, and by how much the largest
    von Mises stress deeper than 0.2 (DEEP) of the smaller half length differs from that of the
    bodies on the axis.

    found: findings. surface, friction: of the whole patch. poisson: Poisson's ratio of `body`,
        "rail" or "wheel". slopes: weights of the hydrostatic stress (Dang Van) and of the normal
        stress (Findley). line: whether the contact is a line across the rail. residual: stresses
        that stay in the body, of all times of the paths; None: none.
    """
    sign = 1.0 if body == "rail" else -1.0
    one = max(found.patch.each, key=lambda each: each.max_pressure, default=None)
    at = None if line or one is None else _on_patch(found, surface, friction, one, sign)
    least = found.patch.a if one is None or line else min(one.a, one.b)
    depth = least * DEPTHS

    def below(deep: Array, parts: int) -> tuple[list[Array], Array]:
        """Paths below the contact, by their length, and stresses below its middle, at depths."""
        if one is None or at is None:
            paths, axis = _along_line(found, friction, poisson, sign, STRIPS // parts, deep)
        else:
            paths, axis = _below_patch(one, at, poisson, parts, deep)
        if residual is not None:
            lines = SIDES * one.b if one is not None and at is not None else np.zeros(1)
            ends = np.cumsum([len(each) for each in paths])[:-1]
            left = np.split(residual(deep, lines)[:, :, None], ends)
            paths = [each + stays for each, stays in zip(paths, left, strict=True)]
        return paths, axis

    paths, axis = below(depth, 1)
    bodies = 0.0
    if body in found.depth:
        own = found.depth[body]
        deep = depth > DEEP * least
        there = np.interp(depth[deep], own.depth, von_mises(own.stress))
        bodies = float(np.abs(von_mises(axis[deep]) / there.max() - there / there.max()).max())
    values, normals = _criteria(paths, slopes)
    worst = values.argmax(axis=0)
    near = np.unique((worst + [[-1], [0], [1]]).clip(0, DEPTHS.size - 1))
    before, _ = _criteria(below(depth[near], 2)[0], slopes)
    change = np.abs(before.max(axis=0) / values.max(axis=0) - 1)
    upright = np.abs([normals[n][k][2] for n, k in enumerate(worst)]).clip(max=1.0)
    names = [f"{name}_MPa" for name in SLOPES]
    largest = values.max(axis=0).tolist()
    return {
        **dict(zip(names, largest, strict=True)),
        "depth_mm": dict(zip(SLOPES, depth[worst].tolist(), strict=True)),
        "plane_deg": dict(zip(SLOPES, np.degrees(np.arccos(upright)).tolist(), strict=True)),
        "profile": {"depth_mm": depth.tolist(), **dict(zip(names, values.T.tolist(), strict=True))},
        "estimate": dict(zip(names, (change + bodies).tolist(), strict=True)),
    }


def _criteria(every: Sequence[Array], slopes: Sequence[float]) -> tuple[Array, Array]:
    """Stresses (d, 2) of Dang Van and Findley, MPa, at d depths, each the largest of k paths side
    by side, and the normals (2, d, 3) of their planes. every: paths (n, k, t, 6) of the same
    length t, of n depths each, d in all.
    """
    values, normals = [], []
    for paths in every:
        flat = paths.reshape(-1, *paths.shape[2:])
        rough = fatigue.dang_van(flat, slopes[0], ROUGH)[0].reshape(paths.shape[:2])
        worst = paths[np.arange(len(paths)), rough.argmax(axis=1)]
        stress, _, planes = fatigue.dang_van(worst, slopes[0])
        other, others = fatigue.findley(paths, slopes[1])
        values.append(np.column_stack([stress, other]))
        normals.append([planes, others])
    return np.concatenate(values), np.concatenate(normals, axis=1)


def _ratios(friction: FrictionSolution, frame: Frame) -> tuple[Array, Array]:
    """Places (n, 2), mm, in the plane of a frame and tractions over the pressure (n, 2) there."""
    touches = friction.pressure > 0
    local, traction = (
        values[touches] @ frame.axes.T[:, :2]
        for values in (friction.points - np.array(frame.origin), friction.traction)
    )
    return local, traction / friction.pressure[touches, None]


def _along_line(
    found: Findings,
    friction: FrictionSolution | None,
    poisson: float,
    sign: float,
    count: int,
    depth: Array,
) -> tuple[list[Array], Array]:
    """Paths (d, 1, t, 6) at depths (d,), mm, below a line across the rail by `count` strips, alone
    in a list, and the stress (d, 6) below its middle. Arguments as of `read`; sign: of the
    tractions on the body.
    """
    half, middle, along = found.patch.a, found.patch.centre[0], found.along
    edges = middle - half * np.cos(np.pi * np.arange(count + 1) / count)
    x = (edges[1:] + edges[:-1]) / 2
    inside = np.abs(along.coordinate - middle) < (1 - 1e-9) * half
    squares = np.pad(along.pressure[inside] ** 2, 1)
    nodes = np.array([edges[0], *along.coordinate[inside], edges[-1]])
    pressure = np.sqrt(PchipInterpolator(nodes, squares)(x).clip(min=0.0))
    traction = None
    if friction is not None:
        places, ratios = _ratios(friction, found.frame)
        order = places[:, 0].argsort()
        traction = sign * pressure * np.interp(x, places[order, 0], ratios[order, 0])
    beside = half * np.cosh(np.linspace(0.0, 3.0, count // 8))
    x = np.concatenate([middle - beside[::-1], x, middle + beside])
    paths = np.zeros((depth.size, 1, x.size + 1, 6))
    for path, deep in zip(paths[:, 0], depth, strict=True):
        strips = Strips(edges, x, np.full_like(x, deep), poisson)
        path[:-1, [0, 1, 2, 4]] = strips.stress(pressure, traction)
    return [paths], paths[:, 0, np.abs(x - middle).argmin()]


Tractions = Callable[[Array], tuple[Array, Array | None]]
"""Places (nx, ns, 2), mm, in the plane of a patch -> pressure (nx, ns) and tractions (2, nx, ns) on
the body, MPa."""


def _on_patch(
    found: Findings,
    surface: Surface,
    friction: FrictionSolution | None,
    one: OnePatch,
    sign: float,
) -> Tractions:
    """Pressure and tractions around a patch; arguments as of `_along_line`."""
    frame = Frame(one.centre, one.angle, one.lean)
    nearest = None if friction is None else NearestNDInterpolator(*_ratios(friction, frame))
    squares_of = None
    if not found.hertzian:
        touched = (surface.pressure[surface.triangles] > 0).any(axis=1)
        known = np.unique(surface.triangles[touched])
        unlike = UNLIKE * one.b * np.random.default_rng(0).random((known.size, 2))
        places = frame.local(surface.points[known])[:, :2] + unlike
        squares_of = LinearNDInterpolator(places, surface.pressure[known] ** 2, 0.0)

    def at(places: Array) -> tuple[Array, Array | None]:
        """Pressure and tractions at places."""
        if squares_of is None:
            squares = one.max_pressure**2 * (1 - ((places / (one.a, one.b)) ** 2).sum(axis=-1))
        else:
            squares = squares_of(places)
        pressure = np.sqrt(squares.clip(min=0.0))
        if nearest is None:
            return pressure, None
        return pressure, sign * pressure * np.moveaxis(nearest(places), -1, 0)

    return at


def _below_patch(
    one: OnePatch, at: Tractions, poisson: float, parts: int, depth: Array
) -> tuple[list[Array], Array]:
    """Paths (n, k, t, 6) below k lines along a patch at depths (d,), mm, ascending: by their length
    t, n depths each. Stress (d, 6) below the middle of the patch. at: pressure and tractions around
    it. parts: of the number of cells each way.
    """
    across = ACROSS // parts
    s = one.b * (2 * np.arange(across) + 1 - across) / across
    rows = np.rint((across - 1) / 2 * (1 + SIDES)).astype(int)
    needed = np.exp2(np.ceil(np.log2(2 * FINER * one.a / depth))).clip(*ALONG).astype(int) // parts
    every, middle = [], []
    for along in sorted({*needed.tolist()}, reverse=True):
        x = one.a * (2 * np.arange(-along // 4, along + along // 4) + 1 - along) / along
        pressure, traction = at(np.stack(np.meshgrid(x, s, indexing="ij"), axis=-1))
        window = PatchSolution(x, s, 0 * s, pressure, 0 * pressure, 0.0)
        layers = [
            grid_stress.layer(window, poisson, traction, deep)[:, rows]
            for deep in depth[needed == along]
        ]
        every.append(np.pad(np.stack(layers).swapaxes(1, 2), ((0, 0), (0, 0), (0, 1), (0, 0))))
        middle.append(every[-1][:, SIDES.size // 2, np.abs(x).argmin()])
    return every, np.concatenate(middle)
