"""From a plan to a meshed contact model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mpi4py import MPI

from railhead.meshing import mesh
from railhead.meshing.sizing import Grading
from railhead.planning.plan import Plan

if TYPE_CHECKING:
    from railhead.solver.contact import ContactModel


def generate(plan: Plan, grading: Grading, comm: MPI.Intracomm) -> mesh.ContactMesh:
    """Mesh the bodies of a plan with element sizes `grading`; collective. Raises MeshError where
    gmsh fails.
    """
    return mesh.generate(plan.parts(), grading, plan.options, comm, meanwhile=_load_solver)


def _load_solver() -> None:
    """Import the modules of solver and reading while gmsh meshes in another process; the import
    takes about as long as a small mesh.
    """
    from railhead.postprocess import read  # noqa: F401
    from railhead.solver import fields  # noqa: F401


def model(plan: Plan, made: mesh.ContactMesh) -> ContactModel:
    """The assembled contact model of a plan on its mesh."""
    from railhead.run.model_setup import setup
    from railhead.solver.contact import ContactModel

    return ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup(plan))
