"""How time and memory grow with the unknowns, and what contact costs over linear elasticity."""

import resource
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from railhead.planning import simulation_plan as planning
from railhead.postprocess import read
from railhead.postprocess.findings import Frame
from railhead.run import mesh_solution
from railhead.scene import catalogue
from railhead.solver.algebra import linear
from railhead.solver.system.fields import gather
from studies import processes, tables

SIZES = (0.53, 0.4, 0.3, 0.22, 0.16, 0.142, 0.112)  # mm in the patch of hertz_ellipse


def measure(patch_size: float) -> dict[str, Any]:
    """Solve hertz_ellipse once in this process; the linear solve follows, on the same matrices.

    seconds: mesh to findings; linear: set-up of the preconditioner and one linear elastic solve to
    1e-8 of its right-hand side; equal: the same to the residual (N) that the contact ends with;
    contact: set-up, all Newton steps.
    """
    plan = planning.make(catalogue.find("hertz_ellipse").replace([f"mesh.patch_size={patch_size}"]))
    frame = Frame(plan.contact.origin, 0.0)
    clock = [time.perf_counter()]
    model = mesh_solution.assemble(plan, mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD))
    clock.append(time.perf_counter())
    solution = mesh_solution.solve(plan, model)
    clock.append(time.perf_counter())
    fields = gather(model, solution)
    if fields is not None:
        read.findings(fields, frame)
    clock.append(time.perf_counter())
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    # The linear problem in which the Hertz ellipse is bonded: the same bulk, the same solver.
    del model.hierarchy  # so that it is set up here, too
    problem, e, newton = model.problem, plan.hertz, solution.newton
    left = (newton.residual or 0.0) * problem.contact_force(newton.pressure)
    start = time.perf_counter()
    x, y = model.interface.points[:, :2].T
    active = (x / e.a) ** 2 + (y / e.b) ** 2 < 1
    preconditioner = model.new_preconditioner(problem)
    preconditioner.rebuild(active)
    rhs, out = problem.predictor(active), problem.force.duplicate()
    setting = time.perf_counter() - start
    solving = []
    for tolerance in (1e-8, left / rhs.norm()):
        start = time.perf_counter()
        linear.solve(problem, preconditioner, active, rhs, out, tolerance)
        solving.append(setting + time.perf_counter() - start)

    return {
        "patch_size": patch_size,
        "unknowns": model.unknowns,
        "seconds": clock[-1] - clock[0],
        "newton_iterations": len(newton.history),
        "linear_iterations": sum(step.linear_iterations for step in newton.history),
        "linear_seconds": solving[0],
        "equal_seconds": solving[1],
        "contact_seconds": clock[2] - clock[1],
        "peak_bytes": peak,
    }


def main(out: Path, *, quick: bool) -> None:
    """Write scaling.csv and page.md; quick: the two smallest."""
    sizes = tables.told(SIZES[: 2 if quick else None], "patch size {:g} mm".format)
    records = [processes.measured("studies.cost.scaling", size) for size in sizes]
    tables.publish(out, page(records), scaling=records)


def page(records: Sequence[tables.Row]) -> str:
    """The table, and the growth from the first to the last mesh in words."""
    rows = [
        {
            **r,
            "each": 1e6 * r["seconds"] / r["unknowns"],
            "memory": r["peak_bytes"] / r["unknowns"] / 1e3,
            "ratio": r["contact_seconds"] / r["linear_seconds"],
            "equal": r["contact_seconds"] / r["equal_seconds"],
        }
        for r in records
    ]
    return tables.render(
        "scaling",
        first=rows[0],
        last=rows[-1],
        growth=rows[-1]["each"] / rows[0]["each"],
        ratios=[r["ratio"] for r in rows],
        equal=[r["equal"] for r in rows],
        rows=tables.cells(
            rows,
            *("{unknowns}", "{seconds:.1f}", "{each:.0f}", "{memory:.1f}"),
            *("{newton_iterations}", "{linear_iterations}", "{linear_seconds:.2f}"),
            *("{contact_seconds:.2f}", "{ratio:.2f}", "{equal:.2f}"),
        ),
    )


if __name__ == "__main__":
    processes.answer(measure)
