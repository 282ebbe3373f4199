"""Patches many times longer than wide: stretched elements against exact Hertz, and their cost."""

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI

from railhead.meshing import mesh
from railhead.meshing.bodies import CONTACT, WHEEL
from railhead.meshing.sizing import MAX_STRETCH
from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.postprocess.findings import Frame
from railhead.postprocess.patch.moments import moments
from railhead.results.pipeline import run
from railhead.run import build
from railhead.run.mesh_solution import forecast_from_solution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.solver import compat


def planned(name: str, *assignments: str) -> Plan:
    return planning.make(catalogue.find(name).replace(assignments))


def test_a_needle_meets_exact_hertz_at_two_thirds_of_the_unknowns() -> None:
    """Axis ratio 9.9: 143 000 unknowns with elements as long as wide."""
    summary = run(catalogue.find("hertz_ellipse").replace(["rail.crown_radius=10"])).summary
    assert summary["checks"]["passed"] and summary["checks"]["hertzian"]
    difference = summary["difference"]
    for part in ("patch", "pressure"):
        assert max(map(abs, difference[part].values())) < 0.005
    for key in ("tau_max_MPa", "tau_max_depth_mm", "von_mises_max_MPa"):
        assert abs(difference["stress"][key]) < 0.005
    assert abs(difference["approach_mm"]) < 0.005
    assert summary["cost"]["dofs"] < 100_000


@pytest.mark.parametrize(
    "choice", [pytest.param((), marks=pytest.mark.slow), ("wheelset.yaw=20 mrad",)]
)
def test_a_stretched_wheel_lies_on_its_exact_surface(choice: tuple[str, ...]) -> None:
    """Corner and middle nodes in the patch and as far again."""
    plan = planned("s1002_60e1", "wheelset.shift=9", "mesh.patch_size=0.2", *choice)
    grading = plan.grading()
    assert grading.stretch == MAX_STRETCH
    made = build.generate(plan, grading, MPI.COMM_WORLD)
    space = compat.vector_space(made.mesh, 2)
    dofs = fem.locate_dofs_topological(space, 2, made.facet_tags.find(CONTACT + WHEEL))
    x = compat.dof_points(space)[dofs]
    zone = plan.forecast.zones[0]
    beside = np.abs(x - zone.centre)
    x = x[(beside[:, 0] < 2 * zone.a) & (np.hypot(beside[:, 1], beside[:, 2]) < 3 * zone.b)]
    assert len(x) > 500 and beside[:, 0].max() > 1.5 * zone.a
    assert plan.surfaces.gap(WHEEL).off_surface(x).max() < 1e-6


def test_quality_is_that_of_the_unstretched_elements() -> None:
    plan = planned("hertz_ellipse", "rail.crown_radius=10", "mesh.patch_size=0.3")
    made = build.generate(plan, plan.grading(), MPI.COMM_WORLD)
    assert made.quality > 0.3 > 3 * mesh.MIN_QUALITY


def test_nearly_round_patches_keep_their_elements() -> None:
    for name in ("hertz_ellipse", "sphere_on_plane", "uic54_thesis", "s1002_60e1"):
        assert planned(name).grading().stretch == 1


def test_a_round_patch_beside_a_long_one_keeps_its_elements_along_the_rail() -> None:
    plan = planned("s1002_60e1", "wheelset.shift=5")
    stretched = plan.sizing._stretched(2.0)
    assert stretched.stretch * stretched.size == pytest.approx(plan.patch_size)
    assert stretched.resolution == pytest.approx(plan.sizing.resolution)


@pytest.mark.parametrize(
    "radius, cell", [(60, "tetrahedron"), (20, "hexahedron"), (5, "tetrahedron")]
)
def test_unknowns_of_stretched_meshes_are_foreseen(radius: float, cell: str) -> None:
    plan = planned("hertz_ellipse", f"rail.crown_radius={radius}", f"mesh.cell={cell}")
    plan = plan.at_resolution(plan.sizing.default_resolution / 2)
    assert plan.grading().stretch > 1
    made = build.generate(plan, plan.grading(), MPI.COMM_WORLD)
    unknowns = build.model(plan, made).unknowns
    assert 1 / 1.5 < plan.unknowns / unknowns < 1.5


def test_a_mesh_around_a_found_needle_is_as_narrow_as_the_needle() -> None:
    plan = planned("hertz_ellipse", "rail.crown_radius=1.5").at_resolution(3.0)
    solved = mesh_and_solve(plan, Progress(quiet=True), MPI.COMM_WORLD)
    frame = Frame(plan.contact.origin, plan.contact.touch.angle)
    expected = forecast_from_solution(solved.fields, moments(solved.fields, frame), frame)
    assert expected.minor == pytest.approx(plan.forecast.minor, rel=0.1)
