"""Tables of points as people and programs write them."""

import numpy as np
import pytest

from railhead.meshing import instruments
from railhead.meshing.dialects import InstrumentError

Y = np.linspace(-35, 35, 15)
Z = -(Y**2) / 600
POINTS = np.column_stack([Y, np.round(Z, 5)])


def written(separator: str, comma: bool = False, form: str = "%.5f") -> str:
    rows = "\n".join(separator.join(form % value for value in row) for row in POINTS)
    return rows.replace(".", ",") if comma else rows


def numbered(separator: str) -> str:
    return "\n".join(
        separator.join([str(i), f"{y:.5f}", f"{z:.5f}"]) for i, (y, z) in enumerate(POINTS)
    )


def swapped(separator: str) -> str:
    return "\n".join(separator.join([f"{z:.5f}", f"{y:.5f}"]) for y, z in POINTS)


GOOD = {
    "commas": written(","),
    "commas and blanks": written(", "),
    "semicolons": written(";"),
    "tabs": written("\t"),
    "blanks": written("   "),
    "aligned": written(" ", form="%12.5f"),
    "decimal commas, semicolons": written(";", True),
    "decimal commas, tabs": written("\t", True),
    "decimal commas, blanks": written(" ", True),
    "decimal commas, commas and blanks": "\n".join(
        f"{y:.5f}".replace(".", ",") + ", " + f"{z:.5f}".replace(".", ",") for y, z in POINTS
    ),
    "exponents": written(",", form="%.7e"),
    "Fortran's exponents": written(" ", form="%.7e").replace("e", "D"),
    "byte order mark": "\ufeffy,z\n" + written(","),
    "windows": written(";").replace("\n", "\r\n"),
    "quoted": "\n".join(f'"{y:.5f}";"{z:.5f}"' for y, z in POINTS).join(["x;y\n", ""]),
    "separators at the end": written(";").replace("\n", ";\n") + ";",
    "# comments": "# rail 12\n# km 3,4\n" + written(","),
    "% comments": "% rail\n" + written(" ") + "\n% end\n",
    "! comments": "! rail\n!\n" + written(" "),
    "// comments": "// rail 1 2\n" + written("\t"),
    "; comments": "; rail\n" + written(","),
    "* comments": "* rail\n" + written(","),
    "names and units": "y [mm];z [mm]\n" + written(";"),
    "names, then units": "y;z\n[mm];[mm]\n" + written(";"),
    "words": "measured by hand\nleft rail\n\ny z\n" + written(" "),
    "a running number": numbered(";"),
    "named columns": "no,y,z\n" + numbered(","),
    "names and units, blanks": "y [mm] z [mm]\n" + written(" "),
    "columns the other way": "z;y\n" + swapped(";"),
    "comments beside points": written(" ").replace("\n", "  # fine\n"),
}


@pytest.mark.parametrize("text", GOOD.values(), ids=GOOD)
def test_usual_dialects_give_the_same_points(text: str, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_bytes(text.encode())
    np.testing.assert_allclose(instruments.read(file).points, POINTS, atol=1e-9)


@pytest.mark.parametrize("step", [1.0, 5.0])
@pytest.mark.parametrize("extra", ["0", "7.5", "y"])
def test_a_third_column_is_no_part_of_the_points(step: float, extra: str, tmp_path) -> None:
    """Not even where y goes up by 1 as a running number does."""
    points = POINTS * [step / 5, 1]
    file = tmp_path / "rail.csv"
    rows = (f"{y:.5f},{z:.5f},{y if extra == 'y' else extra}" for y, z in points)
    file.write_text("\n".join(rows))
    found = instruments.read(file)
    np.testing.assert_allclose(found.points, points)
    assert found.remarks == ("columns 1 and 2 of 3",)


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("Position;Hoehe;Extra", (0, 1)), ("No;Position;z", (1, 2)), ("z;Position;Extra", (1, 0)),
        ("t [s];lat [mm];vert [mm]", (1, 2)), ("x;y;z", (1, 2)), ("y;a;b", (0, 1)),
        ("z_nom;y;z", (1, 2)), ("z;y;z soll", (1, 0)), ("y;Design-z;z", (0, 2)),
    ],
)  # fmt: skip
def test_one_name_tells_where_the_other_is(header: str, columns: tuple, tmp_path) -> None:
    numbers = np.random.default_rng(3).uniform(-9, 9, (15, 3)).cumsum(axis=0).round(3)
    file = tmp_path / "rail.csv"
    file.write_text(header + "\n" + "\n".join(";".join(map(str, row)) for row in numbers))
    np.testing.assert_allclose(instruments.read(file).points, numbers[:, list(columns)])


@pytest.mark.parametrize("coding", ["utf-16", "latin-1"])
def test_other_codings_are_read(coding: str, tmp_path) -> None:
    file = tmp_path / "rail.txt"
    file.write_bytes(("# Höhe über SO\n" + written(" ")).encode(coding))
    np.testing.assert_allclose(instruments.read(file).points, POINTS, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("y [mm], z [mm]", "mm"), ("y (m), z (m)", "m"), ("y/inch, z/inch", "inch"),
        ("y_mm,z_mm", "mm"), ("# unit: inches", "inch"), ("# all lengths in metres", "m"),
        ("y (cm), z (cm)", "cm"), ("Y [µm],Z [µm]", "um"), ("y (ft),z (ft)", "ft"),
        ("y (in),z (in)", "inch"), ('y ["],z ["]', "inch"), ("y;z\ncm;cm", "cm"),
        ("y,z (um)", "um"), ("x [m]\ny [mm], z [mm]", "mm"), ("# gauge 1435 mm\ny/m,z/m", "m"),
        ("# 60 kg/m", ""), ("# 133 lb/ft\ny,z", ""), ("# 0.1 mm/m, 5 kN/mm", ""), ("t/m", ""),
        ("y,z", ""), ("# measured in March (in a tunnel)", ""),
        ("Chainage (m),Line\ny,z", ""), ("# station [m]: 1200", ""),
        ("Station [m],Temp [deg]\ny,z", ""), ("# lengths in m, rail 12\ny,z", "m"),
        ("Kilometer [km],Gleis\ny [mm],z [mm]", "mm"), ("# tape circle at 70 (mm)", "mm"),
        ("# at 12.5 km, measured in metre gauge network\ny,z", ""), ("# 1435 mm gauge", ""),
    ],
)  # fmt: skip
def test_units_are_taken_from_headers(header: str, unit: str, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(header + "\n" + written(","))
    assert instruments.read(file).unit == unit


BAD = {
    "empty": ("", 1, "two numbers"),
    "words": ("rail\nof steel\n", 1, "two numbers"),
    "broken": (written(",").replace("-15.00000", "oops", 1), 5, "no point"),
    "one number": (written(",") + "\n7\n", 16, "no point"),
    "not a number": (written(",").replace("-15.00000", "nan", 1), 5, "no point"),
    "ambiguous": ("\n".join(f"{y},{y},-{y},5" for y in range(20)), 1, "decimal marks"),
    "short": (written(",").split("\n-15")[0], 4, "at least 12"),
    "a column too few": ("z,no,y\n" + "\n".join(f"1,{i},2" for i in range(20)) + "\n1,2", 22,
                         "column 3"),
    "binary": ("\0\1\2" * 50, 1, "no text"),
    "points in thousands": (written(";", comma=True).replace("35,", "1.035,"), 15, "no point"),
    "beyond numbers": (written(",").replace("-15.00000", "1e999", 1), 5, "no point"),
    "a time": ("\n".join(f"{0.1 * i:.2f};{y};{z}" for i, (y, z) in enumerate(POINTS)), 1,
               "either may be y"),
    "two heights": ("rail\ny;z_left;z_worn\n" + "1;2;3\n" * 15, 2, "several columns"),
    "decimal commas, y in whole mm": (
        "\n".join(f"{y:.0f},{z:.4f}".replace(".", ",") for y, z in POINTS), 1, "decimal marks"
    ),
    "whole mm from a flange's tip": (
        "\n".join(f"{15 + i};{28 - i**1.1 / 4:.4f};{i / 3:.4f}" for i in range(80)), 1,
        "either may be y",
    ),
    "whole mm from 0 along a tread": (
        "\n".join(f"{i};{3 - i / 20:.4f};{i / 3:.4f}" for i in range(80)), 1, "either may be y"
    ),
    "two units": ("rail\ny/mm,z/um\n" + written(","), 2, "in mm and um; give both in one of mm, m"),
    "two units, blanks": ("y [mm] z [m]\n" + written(" "), 1, "in mm and m; give"),
    "an angle": ("phi [deg],r [mm]\n" + written(","), 1, "an angle or a diameter"),
    "degrees": ("a [deg],r [mm]\n" + written(","), 1, "in deg and mm; give both"),
    "radians": ("a [°];r [mm]\n" + written(";"), 1, "in ° and mm; give both"),
    "a flag": ("\n".join(f"{y};1;{z}" for y, z in POINTS), 1, "no height in column 2"),
    "unknown unit": ("y (yd),z (yd)\n" + written(","), 1, "in yd; give both in one of mm, m, inch"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "line", "words"), BAD.values(), ids=BAD)
def test_wrong_files_name_file_line_and_what_is_allowed(text, line, words, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(text)
    with pytest.raises(InstrumentError) as caught:
        instruments.read(file)
    message = str(caught.value)
    assert (
        message.startswith(f"rail.csv, line {line}: ")
        and "give" in message
        or "separate" in message
    )
    assert words in message and len(message.splitlines()) == 1
