"""The study of other codes: meshes, accounting, reading, page; codes that are absent or made up."""

import sys

import numpy as np
import pytest
from one_line import refusal

from railhead.theory.elastic import hertz
from studies import processes
from studies.peers import peers_page

CASE = {
    "load": 25e3,
    "travel": 0.04,
    "rail_radius": 300.0,
    "wheel_radius": 420.0,
    "young": 207e3,
    "poisson": 0.3,
}


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
