"""Tables of points as people and programs write them."""

import numpy as np
import pytest

from railhead.geometry.measured import formats
from railhead.geometry.measured.formats import FormatError

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
    "named columns": "no,y,z\n" + numbered(","),
    "names and units, blanks": "y [mm] z [mm]\n" + written(" "),
    "columns the other way": "z;y\n" + swapped(";"),
    "comments beside points": written(" ").replace("\n", "  # fine\n"),
}


@pytest.mark.parametrize("text", GOOD.values(), ids=GOOD)
def test_usual_dialects_give_the_same_points(text: str, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_bytes(text.encode())
    np.testing.assert_allclose(formats.read(file).points, POINTS, atol=1e-9)


@pytest.mark.parametrize("header", ["", "# rail 12\n", "Position;Hoehe;Extra\n", "a;b;c\n"])
def test_three_columns_need_a_header_that_names_y_and_z(header: str, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(header + numbered(";"))
    with pytest.raises(FormatError) as caught:
        formats.read(file)
    line = 2 if header else 1
    text = f"rail.csv, line {line}: has 3 columns; give a header line that names y and z"
    assert str(caught.value) == text


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("x;y;z", (1, 2)), ("y;sigma;elevation", (0, 2)), ("No;y;depth", (1, 2)),
        ("t [s];lat [mm];vert [mm]", (1, 2)), ("X;Y;Angle", (0, 1)), ("x;q;z", (0, 2)),
        ("Wheel diameter;920;1\nz;no;y", (2, 0)),
    ],
)  # fmt: skip
def test_names_tell_y_and_z(header: str, columns: tuple, tmp_path) -> None:
    numbers = np.random.default_rng(3).uniform(-9, 9, (15, 3)).round(3)
    file = tmp_path / "rail.csv"
    file.write_text(header + "\n" + "\n".join(";".join(map(str, row)) for row in numbers))
    found = formats.read(file)
    np.testing.assert_allclose(found.points, numbers[:, list(columns)])
    assert found.remarks == (f"columns {columns[0] + 1} and {columns[1] + 1} of 3",)


@pytest.mark.parametrize("coding", ["utf-16", "latin-1"])
def test_other_codings_are_read(coding: str, tmp_path) -> None:
    file = tmp_path / "rail.txt"
    file.write_bytes(("# Höhe über SO\n" + written(" ")).encode(coding))
    np.testing.assert_allclose(formats.read(file).points, POINTS, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("y [mm], z [mm]", "mm"), ("y (m), z (m)", "m"), ("y/inch, z/inch", "inch"),
        ("y_mm,z_mm", "mm"), ("# unit: inches", "inch"), ("y (cm), z (cm)", "cm"),
        ("Y [µm],Z [µm]", "um"), ("y (in),z (in)", "inch"), ("y,z\ncm,cm", "cm"),
        ("y,z (um)", "um"), ("x [m]\ny [mm], z [mm]", "mm"), ("# 60 kg/m", ""),
        ("# 0.1 mm/m, 5 kN/mm", ""), ("y,z", ""), ("y_left,z_left", ""),
        ("Chainage (m),Line\ny,z", ""), ("# station [m]: 1200", ""),
    ],
)  # fmt: skip
def test_units_are_taken_from_headers(header: str, unit: str, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(header + "\n" + written(","))
    assert formats.read(file).unit == unit


BAD = {
    "empty": ("", 1, "two numbers"),
    "words": ("rail\nof steel\n", 1, "two numbers"),
    "broken": (written(",").replace("-15.00000", "oops", 1), 5, "no point"),
    "one number": (written(",") + "\n7\n", 16, "no point"),
    "not a number": (written(",").replace("-15.00000", "nan", 1), 5, "no point"),
    "ambiguous": ("\n".join(f"{y},{y},-{y},5" for y in range(20)), 1, "4 columns"),
    "more columns than names": ("y,z\n" + "\n".join(f"{y},5,-{y},5" for y in range(20)), 1,
                                "fewer than the 4 of the points"),
    "short": (written(",").split("\n-15")[0], 4, "at least 12"),
    "a column too few": ("z,no,y\n" + "\n".join(f"1,{i},2" for i in range(20)) + "\n1,2", 22,
                         "column 3"),
    "binary": ("\0\1\2" * 50, 1, "no text"),
    "points in thousands": (written(";", comma=True).replace("35,", "1.035,"), 15, "no point"),
    "beyond numbers": (written(",").replace("-15.00000", "1e999", 1), 5, "no point"),
    "two heights": ("rail\ny;z_left;z_worn\n" + "1;2;3\n" * 15, 2, "several columns"),
    "decimal commas, y in whole mm": (
        "\n".join(f"{y:.0f},{z:.4f}".replace(".", ",") for y, z in POINTS), 1, "3 columns"
    ),
    "two units": ("rail\ny/mm,z/um\n" + written(","), 2, "in mm and um; give both in one of mm, m"),
    "two units, blanks": ("y [mm] z [m]\n" + written(" "), 1, "in mm and m; give"),
    "degrees": ("y [°];z [mm]\n" + written(";"), 1, "in ° and mm; give both"),
    "unknown unit": ("y (yd),z (yd)\n" + written(","), 1, "in yd; give both in one of mm, m, inch"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "line", "words"), BAD.values(), ids=BAD)
def test_wrong_files_name_file_line_and_what_is_allowed(text, line, words, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    file.write_text(text)
    with pytest.raises(FormatError) as caught:
        formats.read(file)
    message = str(caught.value)
    assert message.startswith(f"rail.csv, line {line}: ") and "give" in message
    assert words in message and len(message.splitlines()) == 1
