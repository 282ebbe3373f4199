"""K in the free unknowns: whole blocks and a border against the triple product P^T K P."""

from dataclasses import replace

import numpy as np
import pytest

from railhead.solver.algebra import multigrid
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.material import assemble
from railhead.solver.space import supports as space_supports
from studies.hard.block_pairs import contact_model, two_blocks


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


def test_a_pin_holds_the_approach_alone() -> None:
    model = contact_model()
    free, here = model.problem.stiffness, model.reduction.approach
    x = free.vector()
    x.setRandom()
    change = free.pinned(free.typical) * x - free * x
    assert change.array[here] == pytest.approx(free.typical * x.array[here], rel=1e-9)
    change.array[here] = 0.0
    assert change.norm() < 1e-12 * free.typical


def test_the_coarse_tangent_knows_the_pin() -> None:
    """Of a problem with a spring on its approach the P1 level has the same spring."""
    model = contact_model()
    pinned = replace(model.problem, stiffness=model.problem.stiffness.pinned(1e9))
    free, held = (
        multigrid.CoarseTangent(each, model.hierarchy) for each in (model.problem, pinned)
    )
    change = held.bulk.getDiagonal() - free.bulk.getDiagonal()
    assert change.max()[1] == pytest.approx(1e9) == pytest.approx(change.norm())


def test_an_approach_needs_a_place() -> None:
    """Without anything held every place holds an unknown."""
    model = contact_model()
    none = np.zeros_like(model.supports(model.bulk.space).fixed)
    with pytest.raises(ValueError, match="nothing is held"):
        space_supports.reduce(
            space_supports.Held(fixed=none, hubs=[(none, np.eye(3)[0])]), model.comm
        )
