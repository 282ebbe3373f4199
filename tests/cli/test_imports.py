"""What a command imports: only what it uses, as imports are half of a short run."""

import subprocess
import sys

import pytest

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


def test_the_package_and_the_list_import_nothing_heavy() -> None:
    assert loaded("import railhead") == set()
    assert loaded(command("list")) == set()


def test_a_scene_comes_before_the_threads_of_numpy_are_set() -> None:
    """`process.prepare` sets them, and numpy reads that when it loads: `python cases/CASE.py` makes
    its scene first."""
    assert loaded("from railhead.cases.hertz_ellipse import SCENE") == set()


@pytest.mark.parametrize("case", ["hertz_ellipse", "uic54_thesis", "two_cylinders"])
def test_a_plan_imports_no_solver(case: str) -> None:
    assert loaded(command("plan", case)) == {"numpy", "scipy"}


def test_the_solver_is_imported_while_gmsh_works() -> None:
    assert "dolfinx" not in loaded("from railhead.run import refinement")
