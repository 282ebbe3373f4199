"""One rank and two give the same numbers."""

import json
import subprocess
from pathlib import Path
from typing import Any

import command
import pytest
from solved import solved


def pair(
    ranks: int, folder: Path, *assignments: str, case: str = "uic54_thesis"
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Summaries on one rank, in this process, and on more, on equal meshes."""
    ranked = [
        "mpirun", "--oversubscribe", "-n", str(ranks),
        *command.START,
        "run", case, "--quiet", "--no-pictures", "--out", "out",
        *(part for text in assignments for part in ("--set", text)),
    ]  # fmt: skip
    done = subprocess.run(
        ranked, cwd=folder, env=command.environment() | command.ROOT, capture_output=True,
        timeout=300, check=False,
    )  # fmt: skip
    one = solved(case, *assignments)
    assert done.returncode == (0 if one.passed else 1), done.stderr
    more = json.loads((folder / "out/summary.json").read_text())
    assert more["cost"]["cells"] == one.summary["cost"]["cells"]
    return one.summary, more


@pytest.mark.parametrize(
    ("ranks", "mesh"),
    [
        pytest.param(2, ("mesh.patch_size=1.7",), marks=pytest.mark.slow),
        pytest.param(2, ("mesh.patch_size=0.6", "mesh.cell=hexahedron"), marks=pytest.mark.slow),
        pytest.param(3, ("mesh.patch_size=1.0",), marks=pytest.mark.slow),
    ],
    ids=["2", "2, hexahedra", "3"],
)
def test_same_numbers_on_several_ranks(ranks: int, mesh: tuple[str, ...], tmp_path) -> None:
    """Of hexahedra each rank has one body: no facets, or no slave."""
    one, more = pair(ranks, tmp_path, *mesh, "solver.tolerance=1e-9")
    assert more["cost"]["ranks"] == ranks
    assert more["cost"]["dofs"] == one["cost"]["dofs"]
    for part in ("patch", "pressure", "stress"):
        for key, value in one["result"][part].items():
            if isinstance(value, float):
                assert more["result"][part][key] == pytest.approx(value, rel=1e-6), key
    stress, other = one["result"]["stress"], more["result"]["stress"]
    for name in ("tau_max", "von_mises_max"):
        assert other[f"{name}_body"] == stress[f"{name}_body"]
        assert other[f"{name}_place_mm"] == pytest.approx(stress[f"{name}_place_mm"], abs=1e-4)
        key = f"{name}_MPa"
        assert other["axis"][key] == pytest.approx(stress["axis"][key], rel=1e-6)
    surface = stress["surface_centre_MPa"]
    assert other["surface_centre_MPa"] == pytest.approx(surface, rel=1e-6)
    assert more["result"]["approach_mm"] == pytest.approx(one["result"]["approach_mm"], rel=1e-6)
    assert more["checks"]["force_balance"] < 1e-8
    for key in ("penetration", "pressure_noise", "flux_rail", "edge_distance"):
        assert more["checks"][key] == pytest.approx(one["checks"][key], rel=1e-6), key


@pytest.mark.parametrize(
    ("case", "keys"),
    [
        pytest.param(
            "long_roller",
            ("mesh.patch_size=0.5", "rolling.creepage_along=0.05%"),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "long_roller",
            ("mesh.patch_size=0.5", "friction.force_along=9900", "wheel.young_modulus=inf"),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "hertz_ellipse",
            ("mesh.patch_size=1.2", "rolling.creepage_along=0.05%"),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_friction_is_the_same_on_two_ranks(case: str, keys: tuple[str, ...], tmp_path) -> None:
    """Rolling; a rigid wheel whose patch grows with friction; and solids, whose smooth tractions
    are solved to 1e-3."""
    off = 1e-5 if case == "hertz_ellipse" else 1e-6
    given = ("friction.coefficient=0.3", *keys)
    one, two = pair(2, tmp_path, *given, case=case)
    for key, value in one["result"]["friction"].items():
        if isinstance(value, float) and not key.endswith("depth_mm"):
            size = one["result"]["friction"]["limit_N"] if key.endswith("_N") else abs(value)
            assert abs(two["result"]["friction"][key] - value) <= off * size, key


@pytest.mark.slow
def test_yield_is_the_same_on_two_ranks(tmp_path) -> None:
    """A sphere at twenty times its first-yield load, where contact points yield on one rank and not
    on the other, and what it leaves."""
    keys = ("wheel.yield_stress=20.2", "solver.tolerance=1e-9")
    one, two = pair(2, tmp_path, *keys, case="sphere_on_plane")
    for part in ("patch", "pressure", "plastic"):
        for key, value in one["result"][part].items():
            if isinstance(value, float):
                assert two["result"][part][key] == pytest.approx(value, rel=1e-6), key


@pytest.mark.slow
def test_passes_are_the_same_on_two_ranks(tmp_path) -> None:
    """They are solved on one rank, from the load that the scene gives."""
    keys = "load=1150kN rail.extent=half-space rail.yield_stress=480 mesh.patch_size=2.2"
    one, more = pair(2, tmp_path, *keys.split(), "rolling.passes=2", case="long_roller")
    for own, other in zip(one["result"]["passes"], more["result"]["passes"], strict=True):
        for key in ("strain_increment_max", "forward_mm", "groove_mm", "residual_along_MPa"):
            assert other[key] == pytest.approx(own[key], rel=1e-6), key
