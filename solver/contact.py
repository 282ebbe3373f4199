"""A contact model: two bodies in contact, with plasticity and friction where the setup has them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from railhead.solver.system.contact_system import ContactSystem, LoadCase
from railhead.solver.system.friction_history import FrictionHistory
from railhead.solver.system.load_stepping import Response, plastic_problem
from railhead.solver.system.setup import Setup
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Mask


class ContactModel(ContactSystem):
    """Two bodies in contact on a mesh; matrices that serve all load cases are assembled once.

    setup: bodies, contact law and supports. With a load path the bodies may yield. With friction
        settings the surfaces carry tangential tractions.
    plastic_problem: contact problem with plastic strain; None where the setup has no load path.
    All attributes of `ContactSystem` belong to the model too. Its arguments are a dolfinx mesh
    (mm), MeshTags of the cells and facets, and the setup (collective). Raises ValueError for a tag
    of the setup that no cell or facet carries; those of a rigid body are not looked for. The
    support of the fixed body may be missing where the setup has symmetry planes.
    """

    def __init__(self, mesh: Any, cell_tags: Any, facet_tags: Any, setup: Setup) -> None:
        super().__init__(mesh, cell_tags, facet_tags, setup)
        self.plastic_problem = (
            None if setup.load_path is None else plastic_problem(self, setup.load_path)
        )

    def solve(
        self,
        *,
        load: float = 0.0,
        approach: float = 0.0,
        active: Mask,
        max_steps: int = 30,
        progress: Callable[[int, float], None] = lambda step, residual: None,
        friction: FrictionMethod | None = None,
    ) -> Solution:
        """Solve one load case: press the bodies, then apply friction, then remove the load where
        the load path says so (collective).

        load: N, of the whole model, along the direction of the setup, under load control. Under
            approach control it is allowed only with a far field, which it scales.
        approach: mm, under approach control.
        active: (n,) contact points of this rank that touch at the start of the iterations; where no
            rank has one, the twelve points with the smallest initial gap.
        max_steps: largest number of Newton's steps in each solve of the pressure.
        progress: called with the number and the relative residual of each of Newton's steps.
        friction: method for the tractions; without effect where the setup has no friction. None:
            `condensed_friction`.
        Raises ValueError for a negative or infinite load, for `active` of another shape or type,
        for a load under approach control without a far field, or an approach under load control. A
        solution that did not converge is returned too: see `Solution.newton`. Friction is left out
        where pressing did not converge.
        """
        if not 0 <= load < math.inf:
            raise ValueError(f"load must be finite and not negative, N, not {load!r}")
        count = len(self.interface.points)
        if np.shape(active) != (count,) or np.asarray(active).dtype != bool:
            raise ValueError(f"active must be {count} booleans, one for each of interface.points")
        if approach and self.setup.load_control:
            raise ValueError("approach is unknown under load control; give a load")
        if load and not self.setup.load_control and self.setup.far_field is None:
            raise ValueError("load is unknown under approach control; give an approach")
        case = LoadCase(
            load=load,
            approach=approach,
            active=active,
            max_steps=max_steps,
            progress=progress,
        )
        response = self.response()
        solution = response.press(case)
        if self.setup.friction is not None and solution.newton.converged:
            solution = (friction or condensed_friction)(self, response, case, solution)
        return response.unload(solution)

    def response(self) -> Response:
        """Response of the bodies to one load case, without a history yet: elastic, or with yield
        where the setup has a load path. The latter resets the plastic history of
        `plastic_problem`, which all responses share.
        """
        return Response(self, self.plastic_problem)


FrictionMethod = Callable[[ContactModel, Response, LoadCase, Solution], Solution]
"""From a model, the response of its bodies, the load case and the frictionless solution to the
solution with friction."""


def condensed_friction(
    model: ContactModel, response: Response, case: LoadCase, pressed: Solution
) -> Solution:
    """Solution with friction of a pressed contact by static condensation to its contact points
    (collective). case: that of `pressed`. A solution that did not converge is returned too, see
    `Solution.newton`. Raises ValueError where something rolls and a surface ends upstream of the
    patch.
    """
    assert model.setup.friction is not None
    return FrictionHistory(model, response, model.setup.friction, case, pressed).solve()
