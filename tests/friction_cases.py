"""Cases of friction for half-space references: a motion or a force, and no finite elements."""

import numpy as np

from railhead.run.half_spaces.tangential_contact import FrictionCase
from railhead.scene.scene import Scene
from railhead.solver.system.solution import FrictionSolution
from railhead.theory.friction import tangential

MU = 0.3


def friction_case(
    scene: Scene,
    limit: float,
    motion: tuple[float, ...] = (0.0, 0.0, 0.0),
    *,
    force: tuple[float, float] = (0.0, 0.0),
    rolling: bool = True,
    half_space_shift: bool = False,
) -> FrictionCase:
    """Bodies of a scene with the friction limit mu N, N, and a rigid motion or a force."""
    none = np.zeros((0, 3))
    solution = FrictionSolution(
        points=none,
        weights=none[:, 0],
        pressure=none[:, 0],
        traction=none,
        slip=none,
        sticks=none[:, 0] > 0,
        rigid_motion=motion,
        force=force,
        moment=0.0,
        friction_limit=limit,
        load_steps=none,
        dissipated_energy=0.0,
        coupling_iterations=1,
        rigid_slip=none,
        newton_steps=0,
    )
    return FrictionCase(
        solution=solution,
        coefficient=MU,
        pair=tangential.pair(
            scene.wheel.young_modulus,
            scene.wheel.poisson_ratio,
            scene.rail.young_modulus,
            scene.rail.poisson_ratio,
        ),
        rolling=rolling,
        half_space_shift=half_space_shift,
    )
