"""Memory and processor time that plans predict against what was measured, by kind of model."""

import pytest
from solved import planned

from railhead.planning import cost

ROLLING = ("friction.coefficient=0.3", "rolling.creepage_along=0.001")
WHEELSET = ("friction.coefficient=0.3", "rolling.from_wheelset=true")
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
    assert megabytes < planned(case, *keys).price.memory / 1e6 < 2 * megabytes


@pytest.mark.parametrize(
    ("case", "keys", "seconds"),
    [
        ("hertz_ellipse", [], 2.1),
        ("uic54_thesis", [], 2.7),
        ("uic54_thesis", ["mesh.patch_size=0.22"], 13.9),
        ("s1002_60e1", [], 9.3),
        ("uic54_22t5_axle", [], 9.8),  # yields
        ("sphere_on_plane", [], 1.2),
        ("long_roller", ["mesh.patch_size=0.02"], 30.8),
        ("hertz_ellipse", [HEXAHEDRA, "mesh.patch_size=0.3"], 7.7),
        ("hertz_ellipse", [HEXAHEDRA, "mesh.patch_size=0.2"], 49.0),
        ("hertz_ellipse", ["mesh.order=1", "mesh.patch_size=0.12"], 26.7),
        ("hertz_ellipse", [*ROLLING], 5.6),
        ("hertz_ellipse", [*ROLLING, "mesh.patch_size=0.36"], 12.2),
        ("hertz_ellipse", [*ROLLING, "wheel.young_modulus=1e5", "mesh.patch_size=0.6"], 21.7),
        ("uic54_thesis", [*ROLLING], 7.0),
        ("s1002_60e1", [*WHEELSET, "wheelset.shift=2"], 27.2),
        ("s1002_60e1", [*WHEELSET, "wheelset.shift=6"], 29.5),
        ("s1002_60e1", [FAST], 1.0),
        ("s1002_60e1", [FAST, *WHEELSET, "wheelset.shift=2"], 2.5),
        ("s1002_60e1", [FAST, *WHEELSET, "quantities=patch,forces"], 1.2),
    ],
)
def test_processor_time_without_pictures_is_predicted_within_a_factor_of_1_5(
    reference, case, keys, seconds
) -> None:
    assert seconds / 1.5 < planned(case, *keys).price.solving_seconds < 1.5 * seconds


@pytest.mark.parametrize(
    ("case", "keys", "seconds"),
    [
        ("uic54_thesis", [], 6.9),
        ("s1002_60e1", [*WHEELSET, "wheelset.shift=2"], 33.3),
        ("uic54_22t5_axle", [], 20.7),  # yields
        ("long_roller", [], 4.1),
        ("s1002_60e1", [FAST], 1.6),
    ],
)
def test_pictures_are_a_part_of_what_a_run_takes(reference, case, keys, seconds) -> None:
    plan, plain = planned(case, *keys), planned(case, *keys, "quantities=patch,forces")
    assert seconds / 1.5 < plan.price.seconds < 1.5 * seconds
    assert plain.price.seconds == plain.price.solving_seconds
