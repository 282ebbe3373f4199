"""What must hold whatever the mesh: balance, action and reaction, frame invariance."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing.bodies import RAIL, WHEEL
from railhead.solver import compat
from railhead.solver.material.elasticity import Material
from railhead.solver.space.interface import ContactLaw

LAWS = [ContactLaw("nitsche", 1), ContactLaw("nitsche", -1), ContactLaw("penalty")]


@pytest.mark.parametrize("law", LAWS)
def test_force_balance_and_reaction(two_blocks, solve, law: ContactLaw) -> None:
    made, setup = two_blocks(law=law)
    _, solution = solve(made, setup, load=3000.0)
    assert solution.newton.converged
    assert solution.load == pytest.approx(3000.0, rel=1e-8)
    assert solution.reaction == pytest.approx(3000.0, rel=1e-8)


def test_action_equals_reaction_between_the_bodies(two_blocks, solve) -> None:
    """The contact forces on rail and wheel sum to zero, whoever carries the quadrature."""
    made, setup = two_blocks()
    model, solution = solve(made, setup, load=3000.0)
    push = model.interface.gap.createVecLeft()
    push.array[:] = model.interface.weights * solution.pressure
    force = model.interface.gap.createVecRight()
    model.interface.gap.multTranspose(push, force)
    nodal = force.array.reshape(-1, 3)
    cells = compat.cell_dofs(model.bulk.space)
    share = {
        tag: nodal[np.unique(cells[made.cell_tags.find(tag)])].sum(axis=0) for tag in (RAIL, WHEEL)
    }
    np.testing.assert_allclose(4 * share[WHEEL], [0, 0, 3000.0], atol=1e-4)
    np.testing.assert_allclose(share[RAIL], -share[WHEEL], atol=1e-9)


def test_approach_control_and_load_control_meet(two_blocks, solve) -> None:
    made, setup = two_blocks()
    _, by_load = solve(made, setup, load=3000.0)
    _, by_approach = solve(made, replace(setup, load_control=False), approach=by_load.approach)
    assert by_approach.load == pytest.approx(3000.0, rel=1e-7)
    np.testing.assert_allclose(
        by_approach.pressure, by_load.pressure, atol=1e-6 * by_load.pressure.max()
    )


def test_exchanging_the_roles_of_the_surfaces(two_blocks, solve) -> None:
    """Quadrature on the wheel instead of the rail: the same within the discretisation error."""
    made, setup = two_blocks(h=1.0)
    _, one = solve(made, setup, load=3000.0)
    swapped = replace(setup, slave=WHEEL, gap=ParabolicGap(1 / 2000, 1 / 1600, -1))
    _, two = solve(made, swapped, load=3000.0)
    assert two.newton.converged
    assert two.approach == pytest.approx(one.approach, rel=2e-3)


def test_frame_invariance(two_blocks, solve) -> None:
    """The whole scene rotated in space: same pressure and approach to 1e-8."""
    made, setup = two_blocks()
    _, reference = solve(made, setup, load=3000.0)
    turn = Rotation.from_euler("xyz", [0.5, -0.8, 1.1]).as_matrix()
    gap = setup.gap

    def turned_gap(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        distance, normal = gap(points @ turn)
        return distance, normal @ turn.T

    turned, other = two_blocks()
    turned.mesh.geometry.x[:] = turned.mesh.geometry.x @ turn.T
    setup = replace(
        other,
        gap=turned_gap,
        direction=tuple(turn @ np.array([0.0, 0.0, -1.0])),
        planes=tuple((tag, tuple(turn @ np.array(normal))) for tag, normal in other.planes),
    )
    _, solution = solve(turned, setup, load=3000.0)
    assert solution.approach == pytest.approx(reference.approach, rel=1e-8)
    np.testing.assert_allclose(
        solution.pressure, reference.pressure, atol=1e-8 * reference.pressure.max()
    )


def test_unit_invariance(two_blocks, solve) -> None:
    """Stiffness and load in other units: the same displacements."""
    made, setup = two_blocks()
    _, reference = solve(made, setup, load=3000.0)
    soft = Material(207.0, 0.3)
    scaled = replace(
        setup,
        fixed=replace(setup.fixed, material=soft),
        moving=replace(setup.moving, material=soft),
    )
    _, solution = solve(made, scaled, load=3.0)
    assert solution.approach == pytest.approx(reference.approach, rel=1e-8)


@pytest.mark.parametrize("rigid", [RAIL, WHEEL])
def test_rigid_body_is_the_limit_of_a_stiff_one(two_blocks, solve, rigid: int) -> None:
    """E ratio 1e5 against a body that is not there; the pressure agrees to the ratio."""
    steel = Material(207000.0, 0.3)
    stiff, hard = Material(207000.0e5, 0.3), Material(np.inf, 0.3)
    slave = WHEEL if rigid == RAIL else RAIL
    gap = ParabolicGap(1 / 2000, 1 / 1600, -1 if rigid == RAIL else 1)
    found = []
    for other in (stiff, hard):
        materials = (other, steel) if rigid == RAIL else (steel, other)
        made, setup = two_blocks(materials=materials, slave=slave, gap=gap)
        _, solution = solve(made, setup, load=3000.0)
        assert solution.newton.converged
        found.append(solution)
    assert found[0].approach == pytest.approx(found[1].approach, rel=1e-3)
    assert found[0].pressure.max() == pytest.approx(found[1].pressure.max(), rel=0.02)


def test_a_solved_scene_gives_its_memory_back() -> None:
    """The third run of 13 000 unknowns takes no more memory than the second."""
    from railhead.results.pipeline import run
    from railhead.scene import catalogue

    def resident() -> float:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096 / 1e6

    scene = catalogue.find("uic54_thesis").replace(["mesh.patch_size=1.2"])
    sizes = []
    for _ in range(3):
        run(scene)
        sizes.append(resident())
    assert sizes[2] - sizes[1] < 5
