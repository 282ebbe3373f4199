"""The arrays of what the pictures of a run show."""

import numpy as np
import pytest
from solved import solved

import railhead as rh

FLAT = ("hertz_ellipse", "friction.coefficient=0.3", "friction.force_along=1kN",
        "mesh.patch_size=0.9", "effects.finite_bodies=off")  # fmt: skip


@pytest.mark.parametrize("scene", [FLAT, ("long_roller", "mesh.patch_size=1.2")])
def test_arrays_have_names_and_are_of_the_whole_patch(scene: tuple[str, ...], tmp_path) -> None:
    solved(*scene).save(tmp_path / "out", pictures=False)
    arrays, result = np.load(tmp_path / "out" / "pictures.npz"), rh.load(tmp_path / "out")
    assert arrays["found.surface.pressure"].max() == pytest.approx(result.pressure.max, rel=0.02)
    low, high = (getattr(arrays["found.surface.points"][:, 0], end)() for end in ("min", "max"))
    assert low == pytest.approx(-high) and high > result.patch.a
    assert ("friction.traction" in arrays) == (scene is FLAT)
    with pytest.raises(ValueError, match="loaded"):
        result.plot("pressure")
