"""One rank and two give the same numbers."""

import json
import re
import subprocess

import command
import pytest
from solved import solved

RUBS = "friction.coefficient=0.3"
PLACES = "place_mm", ".friction.von_mises_max_depth_mm"  # told to 1e-4 mm
SAME = 1e-6


def numbers(value, path: str = "") -> dict[str, float | str]:
    """Numbers and names in nested tables and lists, by where they stand."""
    if isinstance(value, dict | list):
        pairs = value.items() if isinstance(value, dict) else enumerate(value)
        inner = (numbers(each, f"{path}.{key}") for key, each in pairs)
        return {key: each for table in inner for key, each in table.items()}
    return {path: value} if isinstance(value, float | str) else {}


def judged(summary) -> dict[str, float | str]:
    """The numbers of a result, and of checks that depend on distant elements or on all ranks."""
    checks = ("penetration", "pressure_noise", "flux_rail", "edge_distance")
    more = {key: summary["checks"][key] for key in checks if key in summary["checks"]}
    found = numbers(summary["result"] | {"checks": more})
    return {key: value for key, value in found.items() if not key.endswith("seconds")}


#: Ranks, case, keys, and how far off numbers may be. Of hexahedra each rank has one body: no
#: facets, or no slave.
RANKS = {
    "2, hexahedra": (
        2, "uic54_thesis", ["mesh.patch_size=0.6", "mesh.cell=hexahedron"], SAME
    ),
    "3": (3, "uic54_thesis", ["mesh.patch_size=1.0"], SAME),
    # Contact points yield on one rank and not on the other.
    "a sphere at 20 times first yield": (
        2, "sphere_on_plane", ["wheel.yield_stress=20.2"], SAME
    ),
    "rolling": (
        2, "long_roller", [RUBS, "mesh.patch_size=0.5", "rolling.creepage_along=0.05%"], SAME
    ),
    "a patch that grows with friction": (
        2, "long_roller",
        [RUBS, "mesh.patch_size=0.5", "friction.force_along=9900", "wheel.young_modulus=inf"],
        SAME,
    ),
    # The linear systems of smooth tractions are solved to 1e-3, and bodies add some per cent to
    # the slip: 3e-5 of the tractions.
    "solids that roll": (
        2, "hertz_ellipse", [RUBS, "mesh.patch_size=1.2", "rolling.creepage_along=0.05%"], 3e-5
    ),
    # Passes are solved on one rank, from the load that the scene gives.
    "passes": (
        2, "long_roller",
        ["load=1150kN", "rail.extent=half-space", "rail.yield_stress=480", "mesh.patch_size=2.2",
         "rolling.passes=2"],
        SAME,
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("ranks", "case", "keys", "off"), RANKS.values(), ids=RANKS)
def test_the_same_numbers_on_several_ranks(ranks, case, keys, off, tmp_path) -> None:
    keys = keys if RUBS in keys else [*keys, "solver.tolerance=1e-9"]
    ranked = [
        "mpirun", "--oversubscribe", "-n", str(ranks),
        *command.START,
        "run", case, "--quiet", "--no-pictures", "--out", "out",
        *(part for key in keys for part in ("--set", key)),
    ]  # fmt: skip
    done = subprocess.run(
        ranked, cwd=tmp_path, env=command.environment() | command.ROOT, capture_output=True,
        timeout=300, check=False,
    )  # fmt: skip
    one = solved(case, *keys)
    assert done.returncode == (0 if one.passed else 1), done.stderr
    more = json.loads((tmp_path / "out/summary.json").read_text())
    assert more["cost"]["ranks"] == ranks and more["checks"]["force_balance"] < 1e-8
    for key in ("cells", "dofs"):
        assert more["cost"][key] == one.summary["cost"][key]
    own, other = judged(one.summary), judged(more)
    limit = own.get(".friction.limit_N", 0.0)  # of forces
    for key, value in own.items():
        if isinstance(value, str):
            assert other[key] == value, key
            continue
        whole = own.get(
            re.sub(r"\.(grid_error|resolution)", "", key), value
        )  # of an error: its quantity
        size = max(abs(whole), limit) if key.endswith("_N") else abs(whole)
        room = 1e-4 if any(place in key for place in PLACES) else off * size
        assert other[key] == pytest.approx(value, abs=room, rel=0.0), key
