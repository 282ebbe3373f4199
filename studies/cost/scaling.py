"""How time and memory grow with the unknowns, and what contact costs over linear elasticity."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from railhead.cli import study
from studies import tables

SIZES = (0.53, 0.4, 0.3, 0.22, 0.16, 0.142, 0.112)  # mm in the patch of hertz_ellipse


@dataclass(frozen=True)
class Record:
    """One mesh of hertz_ellipse in a process of its own. seconds: mesh to findings; linear:
    set-up of the preconditioner and one linear elastic solve to 1e-8 of its right-hand side; equal:
    the same to the residual (N) that the contact ends with; contact: set-up, all Newton steps."""

    patch_size: float
    unknowns: int
    seconds: float
    newton_iterations: int
    linear_iterations: int
    linear_seconds: float
    equal_seconds: float
    contact_seconds: float
    peak_bytes: int

    @property
    def ratio(self) -> float:
        """Contact solve over linear elastic solve."""
        return self.contact_seconds / self.linear_seconds

    @property
    def equal(self) -> float:
        """The same, both to one residual."""
        return self.contact_seconds / self.equal_seconds


def measure(patch_size: float) -> Record:
    """Solve once in this process; the linear solve follows, on the same matrices."""
    import resource

    from mpi4py import MPI

    from railhead.planning import plan as planning
    from railhead.postprocess import read
    from railhead.postprocess.findings import Frame
    from railhead.run import build, mesh_solution
    from railhead.scene import catalogue
    from railhead.solver.algebra import linear
    from railhead.solver.fields import gather

    plan = planning.make(catalogue.find("hertz_ellipse").replace([f"mesh.patch_size={patch_size}"]))
    frame = Frame(plan.contact.origin, 0.0)
    start = time.perf_counter()
    model = build.model(plan, build.generate(plan, plan.grading(), MPI.COMM_WORLD))
    built = time.perf_counter() - start

    start = time.perf_counter()
    solution = mesh_solution.solve(plan, model, frame, lambda step, residual: None)
    contact = time.perf_counter() - start
    start = time.perf_counter()
    fields = gather(model, solution)
    if fields is not None:
        read.findings(fields, frame)
    finding = time.perf_counter() - start
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    # The linear problem in which the Hertz ellipse is bonded: the same bulk, the same solver.
    del model.hierarchy  # so that it is set up here, too
    problem, e = model.problem, plan.estimate
    newton = solution.newton
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
    elastic, equal = solving

    return Record(
        patch_size,
        model.unknowns,
        built + contact + finding,
        len(solution.newton.history),
        sum(step.linear_iterations for step in solution.newton.history),
        elastic,
        equal,
        contact,
        peak,
    )


def main(out: Path, *, quick: bool) -> None:
    """Write scaling.csv and page.md; quick: the two smallest."""
    records = []
    for size in SIZES[:2] if quick else SIZES:
        print(f"patch size {size:g} mm", file=sys.stderr)
        done = subprocess.run(
            [sys.executable, "-m", "studies.cost.scaling", str(size)],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | {"PYTHONPATH": str(study.ROOT)},
        )
        records.append(Record(**json.loads(done.stdout.splitlines()[-1])))
    tables.write_csv(out / "scaling.csv", records)
    (out / study.PAGE).write_text(page(records), encoding="utf-8")


def page(records: list[Record]) -> str:
    """The table, and the growth from the first to the last mesh in words."""
    first, last = records[0], records[-1]
    growth = (last.seconds / last.unknowns) / (first.seconds / first.unknowns)
    rows = [
        (
            r.unknowns,
            f"{r.seconds:.1f}",
            f"{1e6 * r.seconds / r.unknowns:.0f}",
            f"{r.peak_bytes / r.unknowns / 1e3:.1f}",
            r.newton_iterations,
            r.linear_iterations,
            f"{r.linear_seconds:.2f}",
            f"{r.contact_seconds:.2f}",
            f"{r.ratio:.2f}",
            f"{r.equal:.2f}",
        )
        for r in records
    ]
    return tables.render(
        "scaling",
        first=first,
        last=last,
        growth=growth,
        ratios=[r.ratio for r in records],
        equal=[r.equal for r in records],
        rows=rows,
    )


if __name__ == "__main__":
    print(json.dumps(vars(measure(float(sys.argv[1])))))
