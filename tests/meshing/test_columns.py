"""Which columns are y and z, and what is neither."""

import numpy as np
import pytest

from railhead.meshing.columns import ColumnError, chosen

Y = np.linspace(-36, 36, 145)
Z = -(Y**2) / 400
NUMBER = np.arange(len(Y))
RANDOM = np.random.default_rng(5).uniform(0, 1, len(Y))


def header(*names: str) -> list[tuple[int, list[str]]]:
    return [(3, list(names))]


@pytest.mark.parametrize(
    ("names", "columns", "found"),
    [
        (("y", "sigma", "elevation"), (Y, RANDOM, Z), (0, 2)),
        (("y", "Q", "elev"), (Y, 0 * Y + 1, Z), (0, 2)),
        (("y", "z_nom", "measured"), (Y, Z, Z), (0, 2)),
        (("measured", "y", "z_nom"), (Z, Y, Z), (1, 0)),
        (("a", "b", "y"), (Z, RANDOM, Y), (2, 0)),
        (("X", "Y", "Angle"), (Y, Z, Y), (0, 1)),
        (("No", "y", "depth"), (NUMBER, Y, -Z), (1, 2)),
        (("x", "y", "z"), (0 * Y + 12.5, Y, Z), (1, 2)),
        (("x", "y", "z"), (0.01 * NUMBER, Y, Z), (1, 2)),
        (("x", "y", "z"), (Y, 0 * Y + 5, Z), (0, 2)),
        (("x", "y", "z"), (Y, 0.01 * RANDOM, Z), (0, 2)),
        (("Position", "Nominal", "Measured"), (Y, Z, Z), (0, 2)),
        (("Position", "Soll", "Ist"), (Y, Z, Z), (0, 2)),
    ],
)
def test_names_tell_y_and_z(names, columns, found) -> None:
    assert chosen(header(*names), np.column_stack(columns)) == (*found, 3)


@pytest.mark.parametrize(
    ("names", "columns", "words"),
    [
        (("y", "flag", "value"), (Y, 0 * Y + 1, Z), "column 2: it is constant or scatters"),
        (("y", "sigma", "value"), (Y, RANDOM, Z), "column 2: it is constant or scatters"),
        (("X", "Y", "Z"), (Y, 0.1 * NUMBER, Z), "x and y, which both run"),
        (("x", "y", "height"), (0.06 * NUMBER, Y, Z), "x and y, which both run"),
        (("Position", "Soll", "Ist", "Winkel"), (Y, Z, Z, Z), "and not two others"),
        (("phi", "r"), (Y, Z), "an angle or a diameter, 'phi'"),
        (("y [mm]", "Diameter [mm]"), (Y, Z), "an angle or a diameter, 'diameter [mm]'"),
        (("No", "Winkel", "z"), (NUMBER, Y, Z), "an angle or a diameter, 'winkel'"),
    ],
)
def test_names_of_other_columns_are_refused(names, columns, words: str) -> None:
    with pytest.raises(ColumnError, match="give a header that names y and z") as caught:
        chosen(header(*names), np.column_stack(columns))
    assert words in str(caught.value) and caught.value.at == 3


@pytest.mark.parametrize("beside", [0 * Y, 0 * Y + 255, RANDOM, np.round(RANDOM)])
@pytest.mark.parametrize("numbered", [False, True])
def test_what_is_no_height_is_not_taken_for_one(beside: np.ndarray, numbered: bool) -> None:
    """A flag or a scatter between y and z made a flat rail."""
    columns = [*([NUMBER] if numbered else []), Y, beside, Z]
    with pytest.raises(ColumnError, match=f"no height in column {len(columns) - 1}") as caught:
        chosen([], np.column_stack(columns))
    assert caught.value.at == 0


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_narrow_crown_with_noise_is_a_height(noise: float) -> None:
    """25 mm of R500, 0.16 mm high, in any order."""
    rng = np.random.default_rng(1)
    y = np.arange(-12.5, 12.5, 0.1)
    z = -(y**2) / 1000 + rng.normal(0, noise, len(y))
    rows = rng.permutation(np.column_stack([y, z, 0 * y]))
    assert chosen([], rows) == (0, 1, 0)


@pytest.mark.parametrize(
    "above", [("Wheel diameter [mm]", "920"), ("wheel", "diameter"), ("Winkel", "0"),
              ("Rail", "60E1"), ("Date", "01.05.2024")]
)  # fmt: skip
@pytest.mark.parametrize(("names", "found"), [(("y", "z"), (0, 1)), (("z", "y"), (1, 0))])
def test_lines_above_the_header_name_no_columns(above, names, found) -> None:
    """They are about the whole: the header stands below them."""
    rows = np.column_stack([Y, Z] if found == (0, 1) else [Z, Y])
    assert chosen([(1, above), (2, names)], rows) == (*found, 2)


def test_a_table_without_names_has_y_and_z() -> None:
    rows = np.column_stack([Y, 460 - Z])
    for names in (("y", "radius"), ("wheel", "left"), ("diameter", "920")):
        assert chosen(header(*names), rows)[:2] == (0, 1)
