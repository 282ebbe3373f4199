"""What a command imports: only what it uses, as imports are half of a short run."""

import subprocess
import sys

HEAVY = ("numpy", "scipy", "mpi4py", "petsc4py", "dolfinx", "gmsh", "meshio", "pyvista",
         "matplotlib", "pint", "jinja2")  # fmt: skip


def loaded(code: str) -> set[str]:
    """Which of HEAVY a new interpreter has imported after some code."""
    ask = f"\nimport sys; print(*(set({HEAVY}) & set(sys.modules)), file=sys.stderr)"
    done = subprocess.run(
        [sys.executable, "-c", code + ask], capture_output=True, text=True, check=True, timeout=100
    )
    return set(done.stderr.split())


def command(*arguments: str) -> str:
    """Code that runs the command to its end."""
    main = f"from railhead.cli import commands; assert commands._status({list(arguments)}) == 0"
    return f"from railhead.run import process; process.prepare(); {main}"


def test_the_package_the_list_and_a_scene_import_nothing_heavy() -> None:
    """`process.prepare` sets the threads of numpy, which reads them when it loads:
    `python cases/CASE.py` makes its scene first."""
    code = "import sys, railhead; assert not {'pydantic', 'railhead.scene'} & set(sys.modules)"
    scene = "from railhead.cases.hertz_ellipse import SCENE"
    assert loaded(f"{code}\n{command('list')}\n{scene}") == set()


def test_a_plan_imports_no_solver() -> None:
    """Of a solid of half-spaces, one of real bodies, and a section."""
    plans = [command("plan", case) for case in ("hertz_ellipse", "uic54_thesis", "two_cylinders")]
    assert loaded("\n".join(plans)) == {"numpy", "scipy"}


def test_half_spaces_import_no_solver_and_no_mesh(tmp_path) -> None:
    fast = command("run", "s1002_60e1", "--fast", "--quiet", "--no-pictures", f"--out={tmp_path}")
    assert not {"petsc4py", "dolfinx", "meshio", "matplotlib"} & loaded(fast)


def test_a_run_without_pictures_imports_nothing_that_draws(tmp_path) -> None:
    """matplotlib alone takes a fifth of a second."""
    run = command("run", "long_roller", "--quiet", "--no-pictures", f"--out={tmp_path / 'out'}")
    assert not {"pyvista", "matplotlib", "jinja2"} & loaded(run)


MESHES = """
import sys
from contextlib import suppress
from mpi4py import MPI
from railhead.meshing import isolated_process
from railhead.planning import simulation_plan
from railhead.run import mesh_solution, refinement
from railhead.scene import catalogue

def in_the_place_of_gmsh(*_, meanwhile, **__):
    assert "dolfinx" not in sys.modules
    meanwhile()
    raise InterruptedError

isolated_process.run = in_the_place_of_gmsh
plan = simulation_plan.make(catalogue.find("long_roller"))
with suppress(InterruptedError):
    mesh_solution.generate(plan, plan.grading, MPI.COMM_SELF)
"""


def test_the_solver_is_imported_while_gmsh_works() -> None:
    assert {"dolfinx", "petsc4py"} <= loaded(MESHES)
