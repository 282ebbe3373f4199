"""Friction of elastic solids: half-spaces on a grid over each patch, and what finite bodies add.

The slip of the wheel over the rail at a traction q is

    rolling    slip = w - C' q - e0 - E q        C': minus the derivative of C along x
    a shift    slip = w - C q + E q

with the rigid slip w and the influence C of half-spaces (`theory.friction`). The bodies' own
response less that of half-spaces has a kernel that is smooth across the patch. So E q depends on
the moments of q alone, and it is sampled by smooth tractions (`theory.friction.smooth_tractions`):
six linear solves a patch, with the preconditioner that pressing leaves. e0 is the derivative of the
jump of the pressed surfaces. E of other patches is that of their last tractions. Then the bodies
are pressed again under the tractions.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from railhead.postprocess.friction import at_cells
from railhead.postprocess.patch.patch import SmoothPatch, smooth_patches
from railhead.scene.scene import SceneError
from railhead.solver.algebra.linear import StalledError
from railhead.solver.contact import ContactModel, condensed_friction
from railhead.solver.system.contact_system import LoadCase
from railhead.solver.system.fields import Fields, gather
from railhead.solver.system.load_stepping import Response
from railhead.solver.system.pressed_surfaces import (
    SurfacePoints,
    SurfaceResponse,
)
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array
from railhead.theory.friction.rolling import (
    CELLS,
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    cells_over,
    change,
    solve_for_forces,
)
from railhead.theory.friction.smooth_tractions import NARROW, SmoothTractions
from railhead.theory.friction.solution import FrictionSolution, GridTraction
from railhead.theory.friction.tangential import TractionInfluence

Stage = Callable[[str], None]
"""Called with what is being done, in words."""
MORE = 2  # cells beside the patch, which tractions may widen
CELLS_PER_EDGE = 4  # of an element: larger cells act as point forces on the elements
TURNS, TURN_TOLERANCE = 30, 1e-5  # of the tractions of several patches, over mu N
PRESSINGS, PRESS_TOLERANCE = 8, 1e-3  # of tractions and pressure, over mu N
LARGEST_CONDENSED = 150_000  # unknowns: 4 to 10 GB were measured at 135 000


class GridPatch:
    """Grid over one patch in its tangent plane, and the smooth tractions around it.

    patch: frame, symmetry planes and smooth pressure of the patch.
    x, y: cell centres (nx,), (ny,) along x and s of the patch's frame, mm. cell: area, mm2.
    points: points of the surfaces on the normals of the plane through the parts of the cells.
    divided: number of parts of a cell each way.
    modes: rigid slip (4, 2, nx, ny) along the tangents at the cells, in the four motions and units
        of `FrictionSettings.rigid_slip`; zero where the surfaces end.
    friction: coefficient of friction at the cells (nx, ny).
    tangents: (nx, ny, 2, 3) unit tangents along and across at the cells, in space; zero where the
        surfaces end.
    places: (nx, ny, 3) points of the slave on the normals through the cells, in space, mm; zero
        where the surfaces end.
    smooth: smooth tractions. narrow: the same, narrower, for a second reading of fields.
    around: points of the surfaces on the normals through the cells of the smooth tractions.
    pressed: pressure (nx, ny), MPa; of the last `press`.
    """

    pressed: Array

    def __init__(
        self, patch: SmoothPatch, response: SurfaceResponse, edge: float, cells: int
    ) -> None:
        """Collective. response: of the pressed bodies. edge: mean length of element edges, mm.
        cells: number over the patch each way (`cells_over`).
        """
        frame = patch.frame
        numbers = cells_over(patch.half, cells)

        def axes(divided: int) -> list[Array]:
            """Centres of cells along each axis, each divided into so many."""
            return [
                middle + half * ((2 * np.arange(-more, count + more) + 1) / count - 1)
                for middle, half, count, more in zip(
                    patch.centre,
                    patch.half,
                    [divided * each for each in numbers],
                    [divided * MORE] * 2,
                    strict=True,
                )
            ]

        def on_surfaces(x: Array, y: Array) -> SurfacePoints:
            """Points of the surfaces on the normals of the plane at x (nx,) and y (ny,), mm."""
            places = np.asarray(frame.origin + _places(x, y) @ frame.axes[:2])
            return response.at(places, frame.axes[2], patch.mirrors)

        largest = edge / CELLS_PER_EDGE
        self.patch = patch
        widest = max(2 * h / n for h, n in zip(patch.half, numbers, strict=True))
        self.divided = max(1, int(np.ceil(widest / largest)))
        self.points = on_surfaces(*axes(self.divided))
        self.x, self.y = axes(1)
        self.cell = float((self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))
        middles, grid = on_surfaces(self.x, self.y), (self.x.size, self.y.size)
        slip = response.settings.rigid_slip(middles.points)
        modes = np.nan_to_num(np.einsum("mnc,nkc->nmk", slip, middles.tangents))
        self.modes = middles.spread(modes).reshape(*grid, 4, 2).transpose(2, 3, 0, 1)
        self.tangents = middles.spread(middles.tangents).reshape(*grid, 2, 3)
        self.places = middles.spread(middles.points).reshape(*grid, 3)
        self.friction = response.settings.coefficient(self.places.reshape(-1, 3)).reshape(grid)
        self.smooth, self.narrow = (
            SmoothTractions(patch.centre, patch.half, largest, *width) for width in ((), (NARROW,))
        )
        self.around = on_surfaces(self.smooth.x, self.smooth.y)

    def press(self, patch: SmoothPatch) -> None:
        """Make `pressed` that of a state of the patch, scaled to the normal force of that state;
        zero where the surfaces end.
        """
        smooth = patch.pressure(self.patch.frame, _places(self.x, self.y))
        inside = self.tangents.any(axis=(2, 3))
        pressure = np.where(inside, smooth.reshape(inside.shape), 0.0)
        self.pressed = pressure * (patch.force / (self.cell * pressure.sum()))

    def forces(self, traction: Array) -> Array:
        """Forces (n, 2) along the tangents, N, at the places of `points`, of a traction (2, nx,
        ny), MPa, that is constant in each cell.
        """
        fine = traction.repeat(self.divided, axis=1).repeat(self.divided, axis=2)
        return np.asarray(self.cell / self.divided**2 * fine.reshape(2, -1).T)


class SolidFriction:
    """Friction of a pressed contact of elastic solids of like materials, with its patches.

    model: contact model.
    settings: friction settings.
    pressed: frictionless solution.
    stage: called with what is being done.
    pair: materials of both bodies.
    response: response of the pressed bodies to tractions.
    patches: grids over the patches.
    coarse: the same with half as many cells each way, and half of those, the coarsest first.
    """

    def __init__(
        self,
        model: ContactModel,
        pressed: Solution,
        smooth: list[SmoothPatch],
        stage: Stage,
        *,
        parabolic: bool = False,
    ) -> None:
        """Collective. pressed: the frictionless solution.

        smooth: patches, most loaded first, the same on all ranks.
        stage: called with what is being done.
        parabolic: whether Hertz's theory is exact.
        """
        assert model.setup.friction is not None
        self.model, self.settings, self.pressed = model, model.setup.friction, pressed
        self.stage, self._parabolic = stage, parabolic
        self.pair = model.setup.material_pair
        self.response = SurfaceResponse(model, self.settings, pressed)
        edge = self.response.edge
        *self.coarse, self.patches = (
            [GridPatch(patch, self.response, edge, cells) for patch in smooth] for cells in CELLS
        )
        self._press(smooth)
        count = len(self.patches)
        # As read, and what a second reading leaves of that: of e0, and of E.
        self._still, self._added = np.zeros((2, count, 20)), np.zeros((2, count, count, 20, 6))
        self._coefficients = np.zeros((count, 6))

    def unsuited(self) -> str:
        """Reason why smooth tractions do not represent what finite bodies add; empty if they do."""
        for each in self.patches:
            if len(each.patch.mirrors) < len(self.model.setup.planes):
                return "a patch beside a symmetry plane"
            inside = each.smooth.fields[0].ravel() > 0
            if not each.around.met[inside].all():
                return "a surface that ends within half a patch's length of the patch"
            for other in self.patches:
                at = each.patch.frame.local(other.around.points)
                away = (at[:, :2] - each.smooth.centre) / each.smooth.half
                near = np.linalg.norm(away, axis=1) < 1.0
                if other is not each and (near & (np.abs(at[:, 2]) < max(each.smooth.half))).any():
                    return "two patches within half their length of each other"
        return ""

    def sample(self) -> None:
        """Sample what finite bodies add, by linear solves with smooth tractions (collective).
        Raises StalledError where a linear solve fails.
        """
        rolling = self.settings.rolling
        if rolling:
            u = self.pressed.displacement
            self._still[:] = np.stack([self._read(each, u) for each in self.patches], axis=1)
        chosen = [
            (source, power, way)
            for source, each in enumerate(self.patches)
            for power in range(3)
            for way in range(2)
            if _symmetric(power, way, each.patch.mirrors)
        ]
        for done, (source, power, way) in enumerate(chosen, 1):
            self.stage(f"friction: response of the bodies, {done} of {len(chosen)}")
            loaded = self.patches[source]
            smooth = loaded.smooth
            traction = np.zeros((2, smooth.x.size, smooth.y.size))
            traction[way] = smooth.fields[power]
            u = self.response.displacement(loaded.around, smooth.cell * traction.reshape(2, -1).T)
            own = TractionInfluence(smooth.x, smooth.y, self.pair, rolling=False)(traction)
            for number, each in enumerate(self.patches):
                read = self._read(each, u, own if number == source else 0.0)
                self._added[:, number, source, :, 2 * power + way] = read if rolling else -read

    def _read(self, patch: GridPatch, u: PETSc.Vec, more: Array | float = 0.0) -> Array:
        """Coefficients (2, 20), as of `SmoothTractions.read`, of the jump of a displacement u (at
        all dofs, mm) over a patch or, when rolling, of its derivative along x (collective): as they
        are read, and less those of a second, narrower reading. more: (2, nx, ny) that is added to
        the jump first, mm.
        """
        jump = patch.around.jumps(u).T.reshape(2, *patch.smooth.fields.shape[1:]) + more
        wide, narrow = (
            each.read(jump, derivative=self.settings.rolling).ravel()
            for each in (patch.smooth, patch.narrow)
        )
        return np.stack([wide, wide - narrow])

    def tractions(
        self,
        creepage: Creepage,
        forces: tuple[float | None, float | None] = (None, None),
        *,
        modes: float = 1.0,
        misread: bool = False,
        start: list[TangentialSolution] | None = None,
        patches: list[GridPatch] | None = None,
    ) -> list[TangentialSolution]:
        """Tractions of all patches under one rigid motion, on every rank. Raises ValueError where
        they do not settle. Their moments are kept: the next call starts from them.

        creepage: rigid motion of the wheel over the rail; a direction with a force is solved for.
        forces: prescribed force of the wheel on the rail along and across, of all patches, N; None
            where the motion is prescribed.
        modes: factor on the rigid slip.
        misread: whether what is read of the bodies, e0 and E, has the error of its reading added.
        start: similar tractions to begin with.
        patches: the grids; None: the fine ones.
        """
        along, across = forces
        patches = patches or self.patches
        found: list[TangentialSolution] = []
        response = self._added[: 1 + misread].sum(axis=0)
        for _ in range(TURNS):
            drawn = self._drawn(patches, misread)
            bodies = [
                HalfSpaceFriction(
                    each.x,
                    each.y,
                    each.pressed,
                    each.friction,
                    self.pair,
                    rolling=self.settings.rolling,
                    modes=modes * each.modes,
                    drawn=drawn[number],
                    added=each.smooth.response(response[number, number], each.x, each.y),
                    interface=self.settings.interface,
                )
                for number, each in enumerate(patches)
            ]
            before, begins = found, found or start or None
            found = solve_for_forces(bodies, creepage, along=along, across=across, start=begins)
            for number, (each, solved) in enumerate(zip(patches, found, strict=True)):
                moments = each.smooth.coefficients(each.x, each.y, solved.traction)
                self._coefficients[number] = moments.ravel()
            if len(bodies) == 1 or change(found, before) <= TURN_TOLERANCE:
                return found
        raise ValueError("tractions of several patches do not settle")

    def _drawn(self, patches: list[GridPatch], misread: bool = False) -> list[Array]:
        """Part (2, nx, ny) of the slip of each patch that other patches and, when rolling, the
        pressed bodies take; misread: with the error of its reading.
        """
        others = self._added[0] * (1 - np.eye(len(self.patches)))[:, :, None, None]
        known = np.einsum("nsij,sj->ni", others, self._coefficients)
        known += self._still[: 1 + misread].sum(axis=0)
        return [
            each.smooth.values(own.reshape(-1, 2), each.x, each.y)
            for each, own in zip(patches, known, strict=True)
        ]

    def press_again(self, case: LoadCase, found: list[TangentialSolution]) -> Solution:
        """Solution of the bodies under tractions, whose `load` includes what these carry on
        inclined surfaces (collective). The pressures of all grids become those of this solution. A
        solution that did not converge says so and leaves them as they were. Raises ValueError where
        patches have merged.

        case: load case, with forces that are added to those of the tractions.
        found: tractions of each patch.
        """
        force, total = case.force, np.zeros(3)
        for each, solved in zip(self.patches, found, strict=True):
            forces = each.forces(solved.traction)
            load = each.points.loads(forces)
            force = load if force is None else force + load
            total += each.points.resultant(forces)
        far = self.response.far_displacement(self.settings.axes[:2] @ total)
        solution = self.model.press(replace(case, force=force, support_displacement=far))
        if solution.newton.converged:
            fields = gather(self.model, solution)
            smooth = shared_patches(self.model, fields, parabolic=self._parabolic)
            if len(smooth) < len(self.patches):
                raise ValueError("two patches have become one under the tractions")
            self._press(smooth)
        carried = float(total @ self.model.setup.direction)
        return replace(solution, load=solution.load + carried)

    def _press(self, smooth: list[SmoothPatch]) -> None:
        """Make the pressures of all grids those of a state of the patches."""
        for patches in (*self.coarse, self.patches):
            for each in patches:
                each.press(each.patch.nearest(smooth))

    def solve(self, case: LoadCase) -> Solution:
        """Solution with friction; a pressing that does not converge ends it, and the solution says
        so (collective). Its `reference` is the frictionless one. `sample` must have been called:
        without it the bodies respond as half-spaces. Raises ValueError where tractions are not
        found or do not balance with the pressure, and where patches merge.

        case: load case of the frictionless solution, with its active points.
        """
        settings, solution = self.settings, self.pressed
        motion, given = Creepage(*settings.creepage), dict(settings.force_controlled)
        forces = given.get(0), given.get(1)
        found: list[TangentialSolution] = []
        pressed_under: list[TangentialSolution] = []
        for _ in range(PRESSINGS):
            self.stage("friction: tractions")
            found = self.tractions(motion, forces, start=found)
            if change(found, pressed_under) <= PRESS_TOLERANCE:
                break
            self.stage("friction: pressing under the tractions")
            solution = self.press_again(replace(case, active=solution.pressure > 0), found)
            pressed_under = found
            if not solution.newton.converged:
                return replace(solution, reference=self.pressed)
        else:
            raise ValueError(f"no balance of tractions and pressure in {PRESSINGS} turns")
        grids = [
            (patches, self.tractions(motion, forces, patches=patches)) for patches in self.coarse
        ]
        coarser = None
        for patches, tractions in grids:
            coarser = replace(self._friction_solution(patches, tractions), coarse=coarser)
        described = replace(self._friction_solution(self.patches, found), coarse=coarser)
        if settings.rolling:
            misread = self.tractions(motion, forces, misread=True, start=found)
            still = self.tractions(Creepage(), modes=0.0)
            described = replace(
                described,
                misread=self._friction_solution(self.patches, misread, misread=True),
                without_creepage=self._friction_solution(self.patches, still),
            )
        return replace(solution, reference=self.pressed, friction=described)

    def _friction_solution(
        self, patches: list[GridPatch], found: list[TangentialSolution], misread: bool = False
    ) -> FrictionSolution:
        """Friction solution of tractions on grids, with vectors in space, at the cells of the
        meshed part that touch; their areas are those of the whole model. Force and moment are those
        of the wheel on the rail, of the whole model; the moment is 0 with symmetry planes. misread:
        as of `tractions`.
        """
        settings, setup = self.settings, self.model.setup
        planes = [np.array(normal) for _, normal in setup.planes]
        used = [
            (solved.pressure > 0) & np.all([each.places @ normal > 0 for normal in planes], axis=0)
            for each, solved in zip(patches, found, strict=True)
        ]
        described = at_cells(
            found,
            [each.places for each in patches],
            [each.tangents for each in patches],
            used,
            setup.parts,
            drawn=self._drawn(patches, misread),
            centred=settings.rolling,
        )
        force, moment = settings.resultants(
            described.points, described.weights, described.traction, setup.planes
        )
        grids = tuple(
            GridTraction(
                origin=np.array(each.patch.frame.origin),
                axes=each.patch.frame.axes,
                x=each.x,
                y=each.y,
                pressure=solved.pressure,
                traction=solved.traction,
            )
            for each, solved in zip(patches, found, strict=True)
        )
        return replace(described, force=force, moment=moment, grids=grids)


def solve_by_suited_method(
    model: ContactModel,
    response: Response,
    case: LoadCase,
    pressed: Solution,
    *,
    stage: Stage,
    parabolic: bool,
    misplaced: Callable[[Fields], bool],
) -> Solution:
    """Solution with friction of a pressed contact, by the method that suits it (collective):

        section in two dimensions                    static condensation
        bodies that yield                            static condensation
        unlike materials                             static condensation
        like elastic solids                          half-spaces and what finite bodies add
            near an edge, a plane or another patch   static condensation (`SolidFriction.unsuited`)

    response: what presses the bodies again under tractions where they are condensed; bodies that
        yield keep their history there.
    case: load case of the frictionless solution `pressed`.
    stage: called with what is being done.
    parabolic: whether Hertz's theory is exact.
    misplaced: whether the patch of a solution needs another mesh; then the pressed solution is
        returned. Not asked in a section.

    A linear solve that fails, and tractions that are not found, give a solution that has not
    converged. Raises SceneError for bodies with too many unknowns for condensation, and for a law
    of friction or a layer on such bodies.
    """
    if model.setup.kinematics.dim == 2:
        return condensed_friction(model, response, case, pressed)
    fields = gather(model, pressed)
    if model.comm.bcast(fields is not None and misplaced(fields)):
        return pressed
    if model.setup.load_path is not None:
        why = "bodies that yield"
    elif not model.setup.material_pair.like:
        why = "bodies of unlike materials"
    else:
        smooth = shared_patches(model, fields, parabolic=parabolic)
        friction = SolidFriction(model, pressed, smooth, stage, parabolic=parabolic)
        why = friction.unsuited()
        if not why:
            try:
                friction.sample()
                return friction.solve(case)
            except (StalledError, ValueError) as error:
                newton = replace(pressed.newton, reason=f"friction: {error}")
                return replace(pressed, newton=newton, reference=pressed)
    surfaces = model.setup.friction and model.setup.friction.interface
    if surfaces and (surfaces.law or surfaces.layer):
        text = f"is not allowed beside {why}: it needs half-spaces (effects.finite_bodies=off)"
        raise SceneError("friction.law" if surfaces.law else "friction.layer_thickness", text)
    if model.unknowns > LARGEST_CONDENSED:
        text = f"is not allowed with {model.unknowns} unknowns and {why}"
        raise SceneError(
            "friction", f"{text}, at most {LARGEST_CONDENSED}; give a larger mesh.patch_size"
        )
    stage("friction: condensing the bodies to the contact points")
    return condensed_friction(model, response, case, pressed)


def shared_patches(
    model: ContactModel, fields: Fields | None, *, parabolic: bool
) -> list[SmoothPatch]:
    """Patches with their smooth pressure, most loaded first, on all ranks (collective). fields: the
    solution; None off rank 0. parabolic: as of `smooth_patches`.
    """
    found = None if fields is None else smooth_patches(fields, parabolic=parabolic)
    shared: list[SmoothPatch] = model.comm.bcast(found)
    return shared


def _symmetric(power: int, way: int, mirrors: tuple[Array, ...]) -> bool:
    """Whether the smooth traction of P = 1, u, v (power 0, 1, 2) along (way 0) or across (1) is its
    own image in each symmetry plane.
    """
    axes = (int(np.argmax(np.abs(plane))) for plane in mirrors)
    return all((power == axis + 1) == (way == axis) for axis in axes)


def _places(x: Array, y: Array) -> Array:
    """Places (nx ny, 2) of the cells of a grid with centres x (nx,) and y (ny,)."""
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
