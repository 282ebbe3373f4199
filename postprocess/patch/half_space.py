"""Findings of half-spaces: from exact Hertz, or from the pressure of boundary elements."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from railhead.postprocess.findings import (
    HERTZIAN,
    Array,
    AxisPressure,
    DepthAxis,
    Findings,
    Frame,
    Largest,
    OnePatch,
    Patch,
    Peak,
    Place,
    Surface,
    has_own_plane,
)
from railhead.postprocess.friction import AT_SURFACE
from railhead.postprocess.patch import compare
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.bem import grid_stress
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.line import Hertz
from railhead.theory.elastic.subsurface import EllipsoidalPressure
from railhead.theory.friction.solution import FrictionSolution, GridTraction

SurfaceMap = Callable[[Array, Array], Array]
"""Places x (n,), s (n,), mm, on the developed surface -> points (n, 3) in space, mm."""
Search = Callable[..., list[tuple[Array, float]]]
"""`grid_stress.peaks` or `grid_stress.at_surface`."""
DEEP = 3.0  # smaller half lengths: end of the axes below the patches
EXTENTS = 4e-3  # relative error of half extents of boundary elements, 128 cells on ellipses
DEPTHS = 61  # points on each of them
STRIP, LONG = 128, 1e4  # cells along a section; length of cells across it over its patch
LINES = 65  # of the grid on which an exact pressure is drawn, each way
AT_EDGE = 4.0  # error of the largest stress at the surface over its change from half as many cells:
# at the edge of a patch that slips in part it rises as the square root of the distance. Of a shift
# at 0.7 mu N (R 420 x 300, mu 0.5) 602 MPa on 64 cells, 591 on 32; Mindlin's tractions have 645.


def of_hertz(
    hertz: Hertz, frame: Frame, poisson: Mapping[str, float], *, section: bool
) -> Findings:
    """Findings of exact Hertz. Displacement and gap are NaN. frame: axes at the first contact,
    where the middle of the patch lies. poisson: Poisson's ratio by body, 'rail' or 'wheel'.
    section: whether the contact is one of a section, which has no separate patches.
    """
    a, b = hertz.a, hertz.b
    ticks = np.linspace(-1.05, 1.05, LINES)
    along, across = ticks * a, ticks * b
    one = OnePatch(
        centre=frame.place(0.0, 0.0),
        angle=frame.angle,
        a=a,
        b=b,
        area=hertz.area,
        max_pressure=hertz.p0,
        share=1.0,
    )
    x, s = np.meshgrid(along, across, indexing="ij")
    local = np.column_stack([x.ravel(), s.ravel()])
    return Findings(
        frame=frame,
        patch=Patch(
            a=a,
            b=b,
            centre=(0.0, 0.0),
            area=hertz.area,
            max_pressure=hertz.p0,
            mean_pressure=hertz.p_mean,
            outlines=[hertz.outline],
            each=() if section else (one,),
        ),
        surface=_surface(
            [frame.origin + np.column_stack([local, 0 * local[:, 0]]) @ frame.axes],
            [hertz.pressure(x, s)],
            [np.full_like(x, np.nan)],
            frame,
        ),
        depth={body: _on_axis(hertz, body, nu, frame) for body, nu in poisson.items()},
        along=AxisPressure(along, hertz.pressure(along, 0 * along)),
        across=AxisPressure(across, hertz.pressure(0 * across, across)),
        shape_error=0.0,
        hertzian=True,
        largest={
            body: compare.exact_largest(hertz, body, nu, frame) for body, nu in poisson.items()
        },
    )


def of_boundary_elements(
    solution: BoundaryElementSolution,
    points: SurfaceMap,
    frame: Frame,
    poisson: Mapping[str, float],
) -> Findings:
    """Findings of boundary elements on a developed surface, without friction. Stresses are those
    of the pressure on the coarser grid of the solution, or on its own where there is none.

    points: maps x, s (n,) to points (n, 3) on the surface, mm. frame: axes at the first contact;
        those of the most loaded patch are used instead where there are several, or one that is
        turned from the first contact. poisson: Poisson's ratio by body.
    The half lengths a and b are those of the most loaded patch on the plane of the frame, as is
    the area of a single patch; of several patches each area is that on its own tangent plane.
    "scatter": relative change from the coarser grids of the solution, of the area at least what
    chords along and across differ by; that of a and b is always 0.4 % (EXTENTS); empty where there
    are no coarser grids.
    """
    kept = [one for one in solution.patches if one.force > SMALLEST * solution.force]
    centres, main = points(*np.transpose([one.centroid for one in kept])), kept[0]
    each = tuple(
        OnePatch(
            centre=(float(x), float(y), float(z)),
            angle=one.plane,
            lean=one.lean,
            a=one.half_extents_on(one.plane)[0],
            b=one.half_extents_on(one.plane)[1],
            area=one.area,
            max_pressure=one.max_pressure,
            share=one.force / solution.force,
        )
        for one, (x, y, z) in zip(kept, centres, strict=True)
    )
    if has_own_plane([one.angle for one in each], frame.angle):
        frame = Frame(each[0].centre, each[0].angle, main.lean)
    error, (a, b) = _shape_error(main), main.half_extents_on(frame.angle)
    area, scatter = _area(solution, frame.angle), {}
    if coarser := solution.coarse:
        spread = sum(patch.area_spread for patch in solution.patches)
        scatter = {
            "a": EXTENTS,
            "b": EXTENTS,
            "area": max(abs(_area(coarser, frame.angle) - area), 2 * spread) / area,
            "max_pressure": abs(coarser.max_pressure / solution.max_pressure - 1),
        }
    i, j = np.unravel_index(int(np.argmax(main.pressure)), main.pressure.shape)
    lines = [points(main.x, np.full_like(main.x, main.s[j]))]
    lines += [points(np.full_like(main.s, main.x[i]), main.s)]
    along, across = (frame.local(line)[:, axis] for axis, line in enumerate(lines))
    x, s, _ = frame.local(np.array([each[0].centre]))[0]
    coarse = solution.coarse or solution
    axes = [
        {body: _below(coarse.windows, patch, points, body, nu) for body, nu in poisson.items()}
        for patch in kept
    ]
    shown = next(iter(poisson), "")
    return Findings(
        frame=frame,
        patch=Patch(
            a=a,
            b=b,
            centre=(float(x), float(s)),
            area=area,
            max_pressure=solution.max_pressure,
            mean_pressure=solution.force / area,
            outlines=[frame.local(points(*one.outline.T))[:, :2] for one in solution.patches],
            each=each,
            scatter=scatter,
        ),
        surface=_surface(
            [points(*window.places) for window in solution.windows],
            [window.pressure for window in solution.windows],
            [window.gap for window in solution.windows],
            frame,
        ),
        depth=axes[0],
        also=tuple(axis[shown] for axis in axes[1:] if axis),
        along=AxisPressure(along, main.pressure[:, j], float(across[j])),
        across=AxisPressure(across, main.pressure[i], float(along[i])),
        shape_error=error,
        hertzian=error < HERTZIAN and len(each) < 2,
        largest=largest(coarse.windows, points, poisson),
    )


def _area(solution: BoundaryElementSolution, plane: float) -> float:
    """Area of the patches, mm2: of a single patch on the plane at the contact angle `plane` (rad),
    of several each on its own tangent plane.
    """
    patches = solution.patches
    return patches[0].area_on(plane) if len(patches) == 1 else solution.area


def with_rigid_bodies(found: Findings, poisson: Mapping[str, float]) -> Findings:
    """Findings of half-spaces, frictionless, of which those were not meshed whose Poisson's ratio
    is given, by 'rail' or 'wheel', with their stresses under the pressure that was found.
    """
    patch = found.patch
    centre = replace(found.frame, origin=found.frame.place(*patch.centre))
    pressure = EllipsoidalPressure(a=patch.a, b=patch.b, p0=patch.max_pressure)
    more = {body: compare.exact_largest(pressure, body, nu, centre) for body, nu in poisson.items()}
    axes = {body: _on_axis(pressure, body, nu, centre) for body, nu in poisson.items()}
    return replace(found, largest=found.largest | more, depth=found.depth | axes)


def with_tractions(
    found: Findings,
    sheared: Sequence[tuple[PatchSolution, Array]],
    coarse: Sequence[tuple[PatchSolution, Array]],
    points: SurfaceMap,
    poisson: Mapping[str, float],
) -> Findings:
    """Findings with stresses, largest ones and those on depth axes, by pressure and tractions
    together, and the change of the largest ones from coarser grids; all else stays. sheared,
    coarse: windows and their tractions, and as they are on coarser grids. points, poisson,
    tractions: as in `largest`.
    """
    windows, tractions = zip(*sheared, strict=True)
    parts = [part for window in windows for part in window.separate()]
    parts = sorted(parts, key=lambda part: -part.force)[: max(len(found.patch.each), 1)]
    axes = [
        {body: _below(windows, part, points, body, nu, tractions) for body, nu in poisson.items()}
        for part in parts
    ]
    fine, body = largest(windows, points, poisson, tractions), next(iter(poisson))
    others, sheared_less = zip(*coarse, strict=True)
    before = largest(others, points, poisson, sheared_less)
    return replace(
        found,
        largest=fine,
        depth=axes[0],
        also=tuple(axis[body] for axis in axes[1:]),
        surface_error=_changes(fine, before, fine, AT_SURFACE * min(found.patch.a, found.patch.b)),
    )


def with_surface(
    found: Findings, friction: FrictionSolution, poisson: Mapping[str, float], *, section: bool
) -> Findings:
    """Findings of finite elements with the largest stresses of half-spaces under the pressure and
    the tractions of grids, which resolve the border of stick, where these are larger just below the
    surface. Where those of the elements are that near to it, half-spaces replace them. Unchanged
    without grids. poisson: Poisson's ratio by body. section: whether it is one of plane strain.
    """
    if section:
        friction = _on_strips(friction, found.frame)
    if not friction.grids or friction.coarse is None:
        return found
    deep = AT_SURFACE * min(found.patch.a, found.patch.b)
    peaks = [peak for each in found.largest.values() for peak in (each.tau, each.von_mises)]
    near = min(peak.depth for peak in peaks) < deep
    search = grid_stress.peaks if near else grid_stress.at_surface
    fine, coarse = (_of_grids(each, poisson, search) for each in (friction, friction.coarse))

    def shown(own: Peak, other: Peak) -> Peak:
        """Of the peaks of elements and of half-spaces the one that counts."""
        return other if own.depth < deep or other.value > own.value else own

    both = {
        body: replace(
            each,
            tau=shown(each.tau, fine[body].tau),
            von_mises=shown(each.von_mises, fine[body].von_mises),
        )
        for body, each in found.largest.items()
    }
    return replace(found, largest=both, surface_error=_changes(fine, coarse, both, deep))


def _on_strips(friction: FrictionSolution, frame: Frame) -> FrictionSolution:
    """Friction of a section with grids of two long cells across it, 128 (STRIP) and half as many
    along it, to which pressure and tractions of its points are interpolated. Points on one side of
    a symmetry plane have images, whose tractions are the other way round.
    """
    local, traction = frame.local(friction.points), friction.traction @ frame.axes.T
    axis = int(np.argmax(np.ptp(local[:, :2], axis=0)))
    t, known = local[:, axis], np.stack([friction.pressure, traction[:, axis]])
    touches = friction.pressure > 0
    if not touches.any() or not (t[touches].min() < 0 < t[touches].max()):
        t, known = np.append(t, -t), np.hstack([known, known * [[1.0], [-1.0]]])
        touches = np.append(touches, touches)
    order, (low, high) = np.argsort(t), (t[touches].min(), t[touches].max())
    axes = frame.axes if axis == 0 else frame.axes[[1, 0, 2]] * [[1.0], [-1.0], [1.0]]
    grids = []
    for cells in (STRIP // 2, STRIP):
        x = low + (high - low) * (np.arange(cells) + 0.5) / cells
        y = LONG * (high - low) * np.array([-0.25, 0.25])
        pressure, q = (
            np.repeat(np.interp(x, t[order], each[order])[:, None], 2, 1) for each in known
        )
        grids.append(
            GridTraction(
                origin=np.array(frame.origin),
                axes=axes,
                x=x,
                y=y,
                pressure=pressure,
                traction=np.stack([q, 0 * q]),
            )
        )
    coarse, fine = ((each,) for each in grids)
    return replace(friction, grids=fine, coarse=replace(friction, grids=coarse))


def _of_grids(
    friction: FrictionSolution, poisson: Mapping[str, float], search: Search
) -> dict[str, Largest]:
    """Largest stresses by body of half-spaces under grids of tractions, found by `search`."""
    found: dict[str, Largest] = {}
    for grid in friction.grids:
        none = np.zeros_like(grid.pressure)
        window = PatchSolution(grid.x, grid.y, np.zeros_like(grid.y), grid.pressure, none, 0.0)

        def points(x: Array, s: Array, grid: GridTraction = grid) -> Array:
            """Points (n, 3) in space, mm, at places of the grid's plane."""
            return np.asarray(grid.origin + np.column_stack([x, s]) @ grid.axes[:2])

        here = largest([window], points, poisson, [grid.traction], search)
        for body, each in here.items():
            if body not in found or each.von_mises.value > found[body].von_mises.value:
                found[body] = each
    return found


def _changes(
    fine: Mapping[str, Largest],
    coarse: Mapping[str, Largest],
    printed: Mapping[str, Largest],
    deep: float,
) -> dict[str, float]:
    """Relative errors of the largest printed stresses by key of summary.json: how far those of the
    finer grid, and their change from the coarser one, lie above; of the body that has the largest.
    The change counts four times (AT_EDGE) where the largest is less deep than `deep`, mm.
    """
    errors = {}
    for key, name in (("tau_max_MPa", "tau"), ("von_mises_max_MPa", "von_mises")):
        one, two, shown = (
            max((getattr(each, name) for each in of.values()), key=lambda peak: peak.value)
            for of in (fine, coarse, printed)
        )
        change = abs(one.value - two.value) * (AT_EDGE if one.depth < deep else 1.0)
        errors[key] = max(one.value + change - shown.value, 0.0) / shown.value
    return errors


def largest(
    windows: Sequence[PatchSolution],
    points: SurfaceMap,
    poisson: Mapping[str, float],
    tractions: Sequence[Array] | None = None,
    search: Search = grid_stress.peaks,
) -> dict[str, Largest]:
    """Largest stresses by body below windows that do not overlap, each by its own pressure and
    tractions alone.

    points: maps x, s (n,) to points (n, 3) on the surface, mm. poisson: Poisson's ratio by body.
    tractions: of the wheel on the rail along x and s in each window, (2, nx, ns), MPa; None: no
        tractions.
    search: how, in one window.
    """
    pressed = [number for number, window in enumerate(windows) if window.pressure.any()]

    @cache
    def peaks_of(nu: float, drag: float) -> list[list[tuple[Array, float]]]:
        """Peaks in each pressed window of a body that the tractions drag along (-1 or 1)."""
        return [
            search(windows[k], nu, None if tractions is None else drag * tractions[k])
            for k in pressed
        ]

    found = {}
    for body, nu in poisson.items():
        into, both = -1.0 if body == "rail" else 1.0, []
        drag = 0.0 if tractions is None else -into  # the wheel is dragged the other way
        for peaks in zip(*peaks_of(nu, drag), strict=True):
            number = max(range(len(peaks)), key=lambda k: peaks[k][1])
            (x, s, z), value = peaks[number]
            window = windows[pressed[number]]
            s = s if window.s.size > 2 else 0.0  # all places along a line are alike
            angle = float(np.interp(s, window.s, window.angle))
            at = points(np.array([x]), np.array([s]))[0]
            at = at - into * z * Frame((0.0, 0.0, 0.0), angle, window.lean).axes[2]
            both.append(Peak(value, -float(z), (float(at[0]), float(at[1]), float(at[2]))))
        found[body] = Largest(both[0], both[1])
    return found


def _below(
    windows: Sequence[PatchSolution],
    patch: PatchSolution,
    points: SurfaceMap,
    body: str,
    poisson: float,
    tractions: Sequence[Array] | None = None,
) -> DepthAxis:
    """Stresses in a body on the axis below the centre of pressure of a patch, by pressure and
    tractions of that window of `windows` whose middle is nearest to the centre. points: maps x, s
    (n,) to points (n, 3) on the surface, mm. body: 'rail' or 'wheel', with Poisson's ratio
    `poisson`. tractions: of the wheel on the rail, as in `largest`; None: no tractions.
    """
    x, s = patch.centroid
    away = [math.hypot(each.x.mean() - x, each.s.mean() - s) for each in windows]
    nearest, sign = int(np.argmin(away)), 1.0 if body == "rail" else -1.0
    window, traction = windows[nearest], None if tractions is None else sign * tractions[nearest]
    least = grid_stress.SURFACE * (window.x[1] - window.x[0])
    depth: Array = np.linspace(0, DEEP * min(patch.half_extents), DEPTHS).clip(least)
    places = np.column_stack([np.full(DEPTHS, x), np.full(DEPTHS, s), -depth])
    stress = grid_stress.stress(window, poisson, places, traction)
    stress[:, 4:] *= sign  # the wheel is the mirror image
    at = points(np.array([x]), np.array([s]))[0]
    frame = Frame((at[0], at[1], at[2]), patch.plane, patch.lean)
    return DepthAxis(body, depth, stress, _line(frame, body))


def _on_axis(
    pressure: Hertz | EllipsoidalPressure, body: str, poisson: float, frame: Frame
) -> DepthAxis:
    """Exact stresses in a body with this name and Poisson's ratio on the axis below the centre of
    Hertz's pressure, the origin of the frame.
    """
    depth = np.linspace(0, DEEP * min(pressure.half_lengths), DEPTHS, dtype=np.float64)
    stress = np.zeros((DEPTHS, 6))
    stress[:, :3] = pressure.axis_stress(poisson, depth)
    return DepthAxis(body, depth, stress, _line(frame, body))


def _line(frame: Frame, body: str) -> tuple[Place, Place]:
    """Origin of a frame, mm, and the unit vector along its normal into a body."""
    into = frame.axes[2] * (-1.0 if body == "rail" else 1.0)
    return frame.place(0.0, 0.0), (float(into[0]), float(into[1]), float(into[2]))


def _surface(
    points: Sequence[Array], pressure: Sequence[Array], gap: Sequence[Array], frame: Frame
) -> Surface:
    """Fields on grids of cells: of each grid points (nx ns, 3), pressure and gap (nx, ns). Points
    beyond the profile are in no triangle; displacements are NaN.
    """
    triangles, start = [], 0
    for each in pressure:
        number = start + np.arange(each.size).reshape(each.shape)
        corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        one, two, three, four = (corner.ravel() for corner in corners)
        triangles += [np.column_stack([one, two, three]), np.column_stack([one, three, four])]
        start += each.size
    place, known = np.concatenate(points), np.concatenate(triangles)
    known = known[np.isfinite(place[known]).all(axis=(1, 2))]
    return Surface(
        points=place,
        local=frame.local(place)[:, :2],
        triangles=known,
        pressure=np.concatenate([each.ravel() for each in pressure]),
        gap=np.concatenate([each.ravel() for each in gap]),
        displacement=np.full_like(place, np.nan),
    )


def _shape_error(patch: PatchSolution) -> float:
    """Largest deviation of the moments <t^3> and <t^4> of a pressure from those of a semi-
    ellipsoid; t runs from the centre of pressure along x or s. That of <t^3> is |<t^3>|
    over <t^2>^(3/2), that of <t^4> is relative to 15/7 <t^2>^2.
    """
    errors = [0.0]
    sums = patch.pressure.sum(axis=1), patch.pressure.sum(axis=0)
    for t, weights in zip((patch.x, patch.s), sums, strict=True):
        away = t - np.average(t, weights=weights)
        second, third, fourth = (np.average(away**k, weights=weights) for k in (2, 3, 4))
        errors += [abs(third) / second**1.5, abs(fourth / second**2 * 7 / 15 - 1)]
    return float(max(errors))
