"""The study of other codes: meshes, accounting, reading, page; codes that are absent or made up."""

import importlib.util
import sys

import numpy as np
import pytest
from one_line import refusal

from railhead.theory.elastic import hertz
from studies import processes
from studies.peers import block_meshes, peers_page, peers_study

CASE = {
    "load": 25e3,
    "travel": 0.04,
    "rail_radius": 300.0,
    "wheel_radius": 420.0,
    "young": 207e3,
    "poisson": 0.3,
}
CODE = """
TITLE, METHOD, SETTINGS = "{title}", "finite elements", "As it is."
PIP, DEBIAN, MODULES = (), ("python3-numpy",), ({modules})
RUNS = {{"fine": {{"factor": 1.0}}, "never": {{"factor": None}}}}


def solve(case, mesh, factor):
    x, y = [0.0, 2.0, 0.0, 2.0, 1.0, 3.0], [0.0, 0.0, 2.0, 2.0, 1.0, 0.5]
    p = [800 * (1 - (a / 4.3) ** 2 - (b / 3.4) ** 2) ** 0.5 for a, b in zip(x, y)]
    return {{"unknowns": 7, "force": case["load"], "pressure_max": 800.0 * factor,
            "x": x, "y": y, "pressure": p}}
"""


def exact(load: float = 25e3) -> hertz.Ellipse:
    return hertz.point_contact(
        1 / 420, 1 / 300, hertz.contact_modulus(207e3, 0.3, 207e3, 0.3), load
    )


def found(**changes: object) -> dict:
    """Exact Hertz at 24 kN as a code would give it."""
    ellipse = exact(24e3)
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 5, 11), np.linspace(0, 4, 9)))
    return {
        "unknowns": 12,
        "force": 24e3,
        "pressure_max": ellipse.p0,
        "x": x.tolist(),
        "y": y.tolist(),
        "pressure": ellipse.pressure(x, y).tolist(),
        **changes,
    }


def made_up(folder, title: str, modules: str = ""):
    file = folder / f"{title}.py"
    file.write_text(CODE.format(title=title, modules=modules))
    spec = importlib.util.spec_from_file_location(title, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_errors_are_against_hertz_at_the_force_that_a_run_carries() -> None:
    read = peers_page.read(CASE, found(tau_max=1.02 * exact(24e3).axis_extrema(0.3).tau_max))
    for name in ("p_max", "p_fit", "a", "b", "area"):
        assert read[f"error_{name}"] == pytest.approx(0, abs=1e-9)
    assert read["error_tau_max"] == pytest.approx(0.02) and read["error_approach"] is None
    off = peers_page.read(CASE, found(pressure_max=1.01 * exact(24e3).p0))
    assert off["error_p_max"] == pytest.approx(0.01)


def test_a_fit_has_the_axes_in_their_order_and_refuses_what_is_no_ellipse() -> None:
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 3, 8), np.linspace(0, 2, 8)))
    p = 5 * np.sqrt(np.maximum(0, 1 - (x / 3) ** 2 - (y / 2) ** 2))
    assert peers_page.fitted(x, y, p) == pytest.approx((5, 3, 2))
    for flat in (np.ones_like(p), np.zeros_like(p), 1 + x):
        with pytest.raises(ValueError, match="no ellipse"):
            peers_page.fitted(x, y, flat)


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_blocks_lie_on_their_arcs_and_show_their_faces(cell, tmp_path) -> None:
    block_meshes.write(tmp_path / "mesh.npz", CASE, cell, 4.0)
    mesh = dict(np.load(tmp_path / "mesh.npz"))
    for body, sign in (("rail", 1), ("wheel", -1)):
        points, corners = mesh[f"{body}_points"], mesh[f"{body}_corners"]
        x, y, z = points[mesh[f"{body}_contact"]].T
        centre = (np.hypot(y, z + 300) - 300) if body == "rail" else (np.hypot(x, z - 420) - 420)
        assert np.abs(centre).max() < 1e-9 and z.min() >= -6 and z.max() <= 6
        a, b, c = points[corners[:, :3]].transpose(1, 0, 2)
        assert (np.sign(np.cross(b - a, c - a)[:, 2]) == sign).all()
        for (owner, side), face in zip(mesh[f"{body}_sides"], corners, strict=True):
            assert set(mesh[f"{body}_cells"][owner][block_meshes.FACES[cell][side]]) == set(face)
        whole = points[mesh[f"{body}_cells"]]
        edges = whole[:, [1, 3, 4] if cell == "hexahedron" else [1, 2, 3]] - whole[:, :1]
        assert (np.linalg.det(edges) > 0).all()
        assert (np.abs(points[mesh[f"{body}_x0"], 0]) < 1e-9).all()
        assert np.abs(points[mesh[f"{body}_far"], 2]) == pytest.approx(60)


def test_the_cost_is_of_the_process_and_what_it_waits_for(tmp_path) -> None:
    work = "import subprocess, sys; b = bytearray(80_000_000); b[::4096] = b'x' * len(b[::4096])"
    child = "import time; t = time.process_time()\nwhile time.process_time() < t + 0.3: pass"
    code = f"{work}; subprocess.run([sys.executable, '-c', {child!r}])"
    cost = processes.run([sys.executable, "-c", code], tmp_path)
    assert 0.3 < cost["cpu_seconds"] < 3 and cost["seconds"] >= cost["cpu_seconds"] * 0.9
    assert 80e6 < cost["peak_bytes"] < 130e6
    small = processes.run([sys.executable, "-c", ""], tmp_path)
    assert small["peak_bytes"] < 40e6  # not that of the test


@pytest.mark.parametrize(
    "command, said",
    [
        ([sys.executable, "-c", "raise RuntimeError('a  b')"], "RuntimeError: a b"),
        ([sys.executable, "-c", "import time; time.sleep(60)"], "not back after 2 s"),
        ([sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"], "status -9"),
        (["no-such-program"], "no-such-program"),
    ],
)
def test_a_command_that_fails_says_why_and_has_no_cost(command, said: str, tmp_path) -> None:
    """Not that of an earlier command in the same folder."""
    processes.run([sys.executable, "-c", ""], tmp_path)
    assert said in refusal(
        lambda: processes.run(command, tmp_path, limit=2.0), processes.FailedError
    )


def test_a_code_is_run_and_one_that_raises_is_a_row_without_numbers(tmp_path) -> None:
    code = made_up(tmp_path, "there")
    good, bad = (
        peers_study.solve(code, name, run, CASE, {}, tmp_path) for name, run in code.RUNS.items()
    )
    assert (good["error_p_max"], good["error_a"]) == pytest.approx(
        (800 / exact().p0 - 1, 4.3 / exact().a - 1)
    )
    assert (good["setting"], good["failure"], good["unknowns"]) == ("fine", "", 7)
    assert bad["failure"].startswith("TypeError") and bad["error_p_max"] is None
    assert "No module named 'absent' (apt-get install" in refusal(
        lambda: peers_study.version(made_up(tmp_path, "absent", "'absent',"), tmp_path),
        processes.FailedError,
    )
