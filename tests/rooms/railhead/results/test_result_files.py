"""The files of a solved scene."""

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from solved import solved

ROLLS = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


@pytest.mark.parametrize(
    ("case", "assignments", "pictures"),
    [
        ("sphere_on_plane", (), {"patch.png"}),
        ("long_roller", ("rail.extent=half-space",), {"pressure.png"}),
        pytest.param("hertz_ellipse", ROLLS, {"patch.png", "friction.png"}, marks=pytest.mark.slow),
    ],
)
def test_half_spaces_are_drawn_without_bodies(
    case: str,
    assignments: tuple[str, ...],
    pictures: set[str],
    tmp_path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And no word in their pictures names finite elements."""
    words: list[str] = []
    own = Figure.savefig

    def spy(self: Figure, *args: object, **options: object) -> None:
        own(self, *args, **options)
        words.extend(text.get_text() for text in self.findobj(Text))

    monkeypatch.setattr(Figure, "savefig", spy)
    solved(case, "effects.finite_bodies=off", *assignments).save(tmp_path / "out", report=False)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {name for name in names if name.endswith(".png")} == pictures
    assert not [name for name in names if name.endswith(".vtu")]
    said = " ".join(words)
    assert "half-spaces" in said
    assert "finite element" not in said and "FE" not in said.split()
