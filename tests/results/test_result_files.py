"""The files of a solved scene."""

from pathlib import Path

import pytest
from solved import solved

ROLLS = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


@pytest.mark.parametrize(
    ("case", "assignments", "pictures"),
    [
        ("sphere_on_plane", (), {"patch.png"}),
        ("long_roller", ("rail.extent=half-space",), {"pressure.png"}),
        ("hertz_ellipse", ROLLS, {"patch.png", "friction.png"}),
    ],
)
def test_half_spaces_are_drawn_without_bodies(
    case: str, assignments: tuple[str, ...], pictures: set[str], tmp_path: Path
) -> None:
    result = solved(case, "effects.finite_bodies=off", *assignments)
    result.save(tmp_path / "out", report=False)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {name for name in names if name.endswith(".png")} == pictures
    assert not [name for name in names if name.endswith(".vtu")]
