"""Constraints, transfer, tangent, energy, preconditioners: the algebra of the contact problem.

K in the free unknowns: whole blocks and a border against the triple product P^T K P.
"""

import weakref
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra import linear, multigrid, newton
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.algebra.stiffness import assemble
from railhead.solver.space import supports as space_supports
from railhead.solver.space.contact_interface import ContactLaw
from railhead.solver.space.operators import petsc_matrix, vector
from railhead.solver.system.setup import LoadPath
from studies.hard.block_pairs import contact_model, press, two_blocks

LAWS = [*(ContactLaw("nitsche", theta) for theta in (1, 0, -1)), ContactLaw("penalty")]
IDS = ["theta=1", "theta=0", "theta=-1", "penalty"]


def loaded(model):
    """The model's problem under a load, and a state near its solution."""
    return model.problem, press(model, load=2000.0)


def solved_linearly(
    model,
    radius: float,
    tolerance: float,
    share: float | None = None,
    preconditioner: linear.Preconditioner | None = None,
) -> tuple[int, float]:
    """Iterations of a linear solve where points within a radius (mm) touch and that share of the
    right-hand side is enough; the residual that is left, over the right-hand side."""
    problem, active = model.problem, np.linalg.norm(model.interface.points, axis=1) < radius
    rhs, out = problem.predictor(active), problem.force.duplicate()
    conditioned = preconditioner or model.preconditioner
    enough = None if share is None else lambda _: share * rhs.norm()
    count = linear.solve(problem, conditioned, active, rhs, out, tolerance, enough)
    return count, (problem.tangent(active) * out - rhs).norm() / rhs.norm()


def test_planes_in_general_position_leave_the_right_freedom() -> None:
    normals = [np.array([1.0, 1.0, 0.0]) / np.sqrt(2), np.array([0.0, 0.6, 0.8])]
    masks = [np.array([True, False, True, False]), np.array([True, True, False, False])]
    supports = space_supports.Held(
        fixed=np.array([False, False, False, True]),
        planes=list(zip(masks, normals, strict=True)),
    )
    reduction = space_supports.reduce(supports, MPI.COMM_SELF)
    assert reduction.matrix.getSize() == (12, 12) and reduction.unknowns == 1 + 2 + 2
    assert not reduction.aligned
    y = reduction.matrix.createVecRight()
    y.setRandom()
    u = (reduction.matrix * y).array.reshape(4, 3)
    for mask, normal in zip(masks, normals, strict=True):
        assert np.abs(u[mask & ~supports.fixed] @ normal).max() < 1e-14
    assert np.all(u[3] == 0)
    np.testing.assert_allclose(reduction.squared_norms().array, reduction.free)


def weighted(rows: PETSc.Mat, weights: np.ndarray, y: PETSc.Vec) -> np.ndarray:
    """rows^T diag(weights) rows y."""
    out = y.duplicate()
    rows.multTranspose(vector(rows, weights * (rows * y).array), out)
    return np.array(out.array)


def test_what_is_added_to_the_stiffness_may_couple_to_the_approach() -> None:
    """As the normal stress of cells beside the hub does."""
    problem = contact_model().problem
    start, columns, values = problem.stress.getValuesCSR()
    table = sp.csr_matrix((values, columns, start), problem.stress.getSize()).tolil()
    table[:, problem.stiffness.columns[0]] = np.linspace(-1.0, 2.0, table.shape[0])[:, None]
    rows = petsc_matrix(table.tocsr(), table.shape[1], MPI.COMM_SELF)
    y, changed = problem.force.duplicate(), problem.stiffness.copy()
    y.setRandom()
    changed.add(rows, problem.weight)
    expected = (problem.stiffness * y).array + weighted(rows, problem.weight, y)
    np.testing.assert_allclose((changed * y).array, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("law", LAWS, ids=IDS)
def test_tangent_is_the_derivative_of_the_residual(law) -> None:
    """Central differences of R along a random direction, relative error below 1e-6."""
    problem, solution = loaded(contact_model(law=law))
    y = solution.newton.y
    assert problem.contact_force(0 * solution.pressure) == 0
    rng = np.random.default_rng(3)
    step = y.duplicate()
    step.array[:] = rng.standard_normal(step.local_size) * 1e-4 * abs(y.array).max()
    indicator = problem.indicator(y)
    change = -(problem.normal_operator * step).array
    t = 0.5 * np.min(np.abs(indicator / change))  # no point changes sides
    both = []
    for sign in (1, -1):
        state = y.copy()
        state.axpy(sign * t, step)
        both.append(problem.residual(state, problem.pressure(state)))
    difference = (both[0] - both[1]) / (2 * t)
    exact = problem.tangent(indicator > 0) * step
    assert (difference - exact).norm() < 1e-6 * exact.norm()
    assembled = problem.assembled_tangent(indicator > 0)
    assert (assembled * step - exact).norm() < 1e-12 * exact.norm()
    diagonal = problem.tangent(indicator > 0).getDiagonal()
    assert (diagonal - assembled.getDiagonal()).norm() < 1e-12 * diagonal.norm()


@pytest.mark.parametrize("law", LAWS, ids=IDS)
def test_what_other_points_leave_is_the_error_of_the_linear_problem(law) -> None:
    """|R(y + x) - R(y) - T x| where points change sides along x."""
    problem, solution = loaded(contact_model(law=law))
    y = solution.newton.y
    x = -0.3 * y
    indicator = problem.indicator(y)
    active = indicator > 0
    moved = y + x
    assert np.any((problem.indicator(moved) > 0) != active)
    linearised = problem.residual(y, problem.pressure(y)) + problem.tangent(active) * x
    error = problem.residual(moved, problem.pressure(moved)) - linearised
    left = problem.active_set_residual(active, indicator)(x)
    assert left > 0 and abs(left - error.norm()) < 1e-8 * error.norm()


def test_a_linear_solve_ends_where_it_is_enough() -> None:
    """At the residual that is asked for, at the latest at the tolerance."""
    loaded(model := contact_model(linear="multigrid"))
    for share in (1e-2, 1e-4):
        assert 1e-3 * share < solved_linearly(model, 3.0, 1e-7, share)[1] <= share
    assert solved_linearly(model, 3.0, 1e-7, 0.0)[1] <= 1e-7


def test_a_linear_solve_reaches_what_any_must() -> None:
    """However little is enough: of a penalty a thousandth of its right-hand side."""
    loaded(model := contact_model(law=ContactLaw("penalty"), linear="multigrid"))
    _, left = solved_linearly(model, 3.0, 1e-7, np.inf)
    assert 1e-7 < left <= linear.LARGEST_RESIDUAL["penalty"]


@pytest.mark.parametrize("law", LAWS, ids=IDS)
def test_coarse_tangent_is_the_galerkin_product(law) -> None:
    """Filled anew for another active set, it is Q^T T Q of the assembled tangent T."""
    model = contact_model(law=law, linear="multigrid")
    loaded(model)
    coarse = model.preconditioner.coarse
    radius = np.linalg.norm(model.interface.points, axis=1)
    for limit in (1.0, 3.0):
        q = model.preconditioner.pc.getMGInterpolation(1)
        product = model.problem.assembled_tangent(radius < limit).ptap(q)
        y = q.createVecRight()
        y.setRandom()
        y.array[product.getDiagonal().array == 0] = 0.0
        expected = product * y
        assert (
            coarse.assembled_tangent(radius < limit) * y - expected
        ).norm() < 1e-12 * expected.norm()


def test_an_updated_preconditioner_is_as_good_as_a_new_one() -> None:
    """p-multigrid that served a small patch, then a large one, against one made for the large."""
    problem, _ = loaded(model := contact_model(linear="multigrid"))
    used, fresh = model.new_preconditioner(problem), model.new_preconditioner(problem)
    solved_linearly(model, 1.0, 1e-8, preconditioner=used)
    (count, _), (least, _) = (
        solved_linearly(model, 3.0, 1e-8, preconditioner=each) for each in (used, fresh)
    )
    assert count <= least + 1 < 40


def test_a_preconditioner_follows_the_active_set() -> None:
    """Set up again for a much larger patch, and not for nearly the same one."""
    model = contact_model(linear="direct")
    radius = np.linalg.norm(model.interface.points, axis=1)
    assert model.preconditioner.update_if_outdated(radius < 4.0)
    almost = radius < 4.0
    almost[np.argmin(radius)] = False
    assert not model.preconditioner.update_if_outdated(almost)
    assert model.preconditioner.update_if_outdated(radius < 5.0)


def test_line_search_stops_an_overshoot_and_lets_good_steps_pass() -> None:
    problem, solution = loaded(contact_model())
    start = solution.newton.y.copy()
    start.scale(0.9)
    to_solution = solution.newton.y - start
    assert newton.line_search(problem, start, to_solution) == 1.0
    far = to_solution.copy()
    far.scale(8.0)
    assert newton.line_search(problem, start, far) == pytest.approx(1 / 8, rel=0.2)


@pytest.mark.parametrize("degree, below", [(2, None), (2, 0), (1, None)],
                         ids=["p-multigrid", "GAMG below", "linear elements"])  # fmt: skip
def test_direct_and_multigrid_give_the_same_solution(monkeypatch, degree, below) -> None:
    reference = loaded(contact_model(degree=degree, linear="direct"))[1]
    if below is not None:
        monkeypatch.setattr(multigrid, "COARSE_DIRECT_BELOW", below)
    found = loaded(contact_model(degree=degree, linear="multigrid"))[1]
    assert reference.newton.converged and found.newton.converged
    assert found.approach == pytest.approx(reference.approach, rel=1e-8)
    one, other = (each.displacement.array for each in (found, reference))
    np.testing.assert_allclose(one, other, atol=1e-8 * abs(other).max())


def test_prolongation_carries_rigid_motion_and_the_approach() -> None:
    """Q y1 represents the same displacement as y1 does in the P1 space."""
    model = contact_model()
    coarse = compat.vector_space(model.bulk.space.mesh, 1)
    reduction = space_supports.reduce(model.supports(coarse), model.comm)
    full = compat.interpolation(coarse, model.bulk.space)
    q = space_supports.reduced_prolongation(full, model.reduction, reduction)
    y = q.createVecRight()
    y.setRandom()
    direct = full * (reduction.matrix * y)
    assert (direct - (model.reduction.matrix * (q * y))).norm() < 1e-12 * direct.norm()


def test_a_set_up_is_given_back_before_the_next_one() -> None:
    """However often a preconditioner is renewed, one set-up is in memory."""
    alive: list[weakref.ref] = []

    class Shell:
        """Context of a PETSc preconditioner that lives as long as that."""

    class Counted(linear.Preconditioner):
        def set_up(self, active) -> None:
            assert not any(each() for each in alive)
            pc, context = self.start(self.problem.assembled_tangent(active)), Shell()
            pc.setType("python")
            pc.setPythonContext(context)
            alive.append(weakref.ref(context))

    model = contact_model()
    preconditioner = Counted(model.problem)
    radius = np.linalg.norm(model.interface.points, axis=1)
    for limit in (1.0, 3.0, 1.0, 3.0):
        assert preconditioner.update_if_outdated(radius < limit)
    assert len(alive) == 4


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda setup: {"law": ContactLaw("nitche")}, "method 'nitche' is unknown"),
        (lambda setup: {"law": ContactLaw(theta=2)}, "theta 2 is not allowed"),
        (lambda setup: {"law": ContactLaw(gamma_factor=0.0)}, "gamma_factor 0.0 is not allowed"),
        (lambda setup: {"linear": "foo"}, "linear 'foo' is unknown"),
        (lambda setup: {"slave": 7}, "slave 7 is no body that deforms"),
        (
            lambda setup: {"load_path": LoadPath(steps=2, unload=False, near=len)},
            "load_path needs a body",
        ),
        (lambda setup: {"moving": replace(setup.moving, support=97)}, "no support facet carries"),
        (lambda setup: {"moving": replace(setup.moving, contact=98)}, "no contact facet carries"),
        (lambda setup: {"fixed": replace(setup.fixed, tag=9), "slave": 9}, "no cell carries"),
        (lambda setup: {"planes": ((96, (0.0, 1.0, 0.0)),)}, "no plane facet carries the tag 96"),
    ],
)
def test_a_setup_that_does_not_fit_its_mesh_is_refused(make, said) -> None:
    with pytest.raises(ValueError, match=said):
        contact_model(**make(two_blocks()[1]))


def oblique(supports: space_supports.Held) -> space_supports.Held:
    """The same with its first plane turned out of the axes."""
    (members, _), *others = supports.planes
    return replace(supports, planes=[(members, np.array([0.6, 0.8, 0.0])), *others])


CHANGES = {
    "load": lambda supports: supports,
    "approach given": lambda supports: replace(supports, hubs=[]),
    "oblique plane": oblique,
    "rigid counterface": lambda supports: replace(
        supports, hubs=[(np.zeros_like(mask), way) for mask, way in supports.hubs]
    ),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_products_diagonal_and_assembled_matrix_are_those_of_the_triple_product(change) -> None:
    model, (made, setup) = contact_model(), two_blocks()
    reduction = space_supports.reduce(change(model.supports(model.bulk.space)), model.comm)
    _, full = assemble(made.mesh, made.cell_tags, model.materials, setup.degree)
    product = full.convert("aij", type(full)()).ptap(reduction.matrix)
    found = Stiffness.reduced(full, reduction)

    holds = reduction.free.copy()
    moves = reduction.approach >= 0 and not reduction.rigid_approach
    holds[reduction.approach] |= moves
    x = found.vector()
    x.array[holds] = np.random.default_rng(1).standard_normal(holds.sum())
    expected = product * x
    assert (found * x - expected).norm() < 1e-13 * expected.norm()
    assert (found.assembled() * x - expected).norm() < 1e-13 * expected.norm()
    np.testing.assert_allclose(
        found.diagonal().array[holds], product.getDiagonal().array[holds], rtol=1e-13
    )
    assert found.blocks.getBlockSize() == 3
    idle = ~holds
    idle[reduction.approach] &= reduction.approach < 0
    assert np.all(found.diagonal().array[idle] > 0)  # a factorisation needs them
    assert reduction.unknowns == holds.sum() + reduction.rigid_approach


def test_the_coarse_tangent_knows_the_pin() -> None:
    """Of a problem with a spring on its approach the P1 level has the same spring."""
    model = contact_model()
    pinned = replace(model.problem, stiffness=model.problem.stiffness.pinned(1e9))
    free, held = (
        each.coarser(model.hierarchy.prolongation, model.hierarchy.stiffness)
        for each in (model.problem, pinned)
    )
    change = held.stiffness.diagonal() - free.stiffness.diagonal()
    assert change.max()[1] == pytest.approx(1e9) == pytest.approx(change.norm())


def test_an_approach_needs_a_place() -> None:
    """Without anything held every place holds an unknown."""
    model = contact_model()
    none = np.zeros_like(model.supports(model.bulk.space).fixed)
    with pytest.raises(ValueError, match="nothing is held"):
        space_supports.reduce(
            space_supports.Held(fixed=none, hubs=[(none, np.eye(3)[0])]), model.comm
        )
