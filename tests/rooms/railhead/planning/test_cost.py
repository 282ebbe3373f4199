"""Time and memory that plans predict against what was measured on two cores, by kind of model."""

import pytest
from solved import planned

from railhead.planning import cost

ROLLING = ("friction.coefficient=0.3", "rolling.creepage_along=0.001")
FAST = "effects.finite_bodies=off"
HEXAHEDRA = "mesh.cell=hexahedron"


@pytest.fixture
def reference(monkeypatch) -> None:
    """The machine that the costs were measured on."""
    monkeypatch.setattr(cost, "correction", lambda: 1.0)


@pytest.mark.parametrize(
    ("case", "keys", "megabytes"),
    [
        ("hertz_ellipse", ["mesh.patch_size=0.16"], 2176),
        ("s1002_60e1", ["mesh.patch_size=0.2"], 2244),
        ("uic54_22t5_axle", [], 761),  # yields
        ("hertz_ellipse", [*ROLLING, "mesh.patch_size=0.36"], 804),
        ("hertz_ellipse", [HEXAHEDRA, "mesh.patch_size=0.3"], 1040),
        ("hertz_ellipse", ["mesh.order=1", "mesh.patch_size=0.13"], 806),
        ("long_roller", ["mesh.patch_size=0.02"], 1600),
    ],
)
def test_no_run_takes_more_memory_than_predicted(reference, case, keys, megabytes) -> None:
    predicted = planned(case, *keys).memory / 1e6
    assert megabytes < predicted < 2 * megabytes


@pytest.mark.parametrize(
    ("case", "keys", "seconds"),
    [
        ("hertz_ellipse", ["mesh.patch_size=0.7"], 1.4),
        ("hertz_ellipse", ["mesh.patch_size=0.142"], 43.9),
        ("s1002_60e1", ["effects.plasticity=off"], 10.7),
        ("uic54_thesis", ["mesh.patch_size=0.3"], 5.8),
        ("uic54_22t5_axle", [], 15.0),  # yields
        ("hertz_ellipse", [*ROLLING, "mesh.patch_size=0.8"], 7.1),
        ("hertz_ellipse", [*ROLLING, "mesh.patch_size=0.36"], 21.5),
        ("hertz_ellipse", [HEXAHEDRA, "mesh.patch_size=0.2"], 96.0),
        ("hertz_ellipse", ["mesh.order=1", "mesh.patch_size=0.12"], 35.2),
        ("long_roller", ["mesh.patch_size=0.02"], 29.7),
        ("s1002_60e1", [FAST], 0.2),
        ("s1002_60e1", [FAST, *ROLLING], 1.2),
        ("s1002_60e1", [FAST, *ROLLING, "quantities=patch,forces"], 0.36),
    ],
)
def test_time_is_predicted_within_a_factor_of_two(reference, case, keys, seconds) -> None:
    predicted = planned(case, *keys).mesh_seconds
    assert seconds / 2 < predicted < 2 * seconds
