"""Every table of numbers is read by its header: columns in any order, units, or one line."""

import os
import time
from pathlib import Path

import numpy as np
import pytest
from one_line import refusal

from railhead.geometry.measured import formats
from railhead.geometry.surfaces import read_map
from railhead.geometry.tables import FormatError
from railhead.scene import files
from railhead.sweeps.grid import read_rows

GRID = [(x, y, 0.001 * x - 0.01 * y) for x in range(5) for y in range(3)]
PLACES = [(float(y), -y * y / 600) for y in range(-20, 21)]


def written(folder: Path, header: str, rows, between: str = ",") -> Path:
    path = folder / "table.csv"
    path.write_text(header + "\n".join(between.join(map(str, row)) for row in rows))
    return path


@pytest.mark.parametrize(
    ("header", "order", "factors"),
    [
        ("", (0, 1, 2), (1, 1, 1)),
        ("x [m],y [m],height [m]\n", (0, 1, 2), (1e3, 1e3, 1e3)),
        ("x [in],y [in],height [um]\n", (0, 1, 2), (25.4, 25.4, 1e-3)),
        ("y,x,height\n", (1, 0, 2), (1, 1, 1)),
        ("# height_mm, x_mm, y_mm\n", (2, 0, 1), (1, 1, 1)),
        ("# units: m\n", (0, 1, 2), (1e3, 1e3, 1e3)),
    ],
)
def test_a_map_is_read_in_order_and_units_of_its_header(tmp_path, header, order, factors) -> None:
    rows = [[row[column] for column in order] for row in GRID]
    found = read_map(written(tmp_path, header, rows), 0.0)
    columns = zip((found.x, found.y, found.height.ravel()), factors, strict=True)
    x, y, height = (column / factor for column, factor in columns)
    np.testing.assert_allclose(x, np.arange(5))
    np.testing.assert_allclose(y, np.arange(3))
    np.testing.assert_allclose(height, [row[2] for row in GRID], atol=1e-12)


@pytest.mark.parametrize(
    ("header", "stress"),
    [
        ("", 500.0),
        ("plastic_strain,stress_MPa\n", 500.0),
        ("Plastic strain (-),True stress (N/mm2)\n", 500.0),
        ("plastic strain [-],stress [GPa]\n", 500e3),
        ("strain,stress / Pa\n", 500e-6),
    ],
)
def test_a_curve_is_read_in_the_units_of_its_header(tmp_path, header: str, stress: float) -> None:
    path = written(tmp_path, header, [(0, 500), (0.1, 600)])
    np.testing.assert_allclose(files.read_curve(str(path)), [(0, stress), (0.1, 1.2 * stress)])


def test_strains_in_per_cent_and_columns_in_another_order_are_the_same_curve(tmp_path) -> None:
    path = written(tmp_path, "stress;plastic strain [%]\n", [(500, 0), (600, 10)], ";")
    np.testing.assert_allclose(files.read_curve(str(path)), [(0, 500.0), (0.1, 600.0)])


def test_a_law_of_wear_in_other_units_is_the_same_law(tmp_path) -> None:
    law = files.wear_pairs(str(written(tmp_path, "", [(1, 5), (10, 50)])))
    head = "rate [ug/(m mm2)],T-gamma/A [N/m2]\n"
    other = files.wear_pairs(str(written(tmp_path, head, [(5, 1e6), (50, 1e7)])))
    assert law == ((1, 5), (10, 50))
    np.testing.assert_allclose(other, law)


@pytest.mark.parametrize(
    ("read", "header", "words"),
    [
        (read_map, "u,v,w\n", "'u,v,w' does not name them; give a header line that names x and y"),
        (read_map, "x [kN],y,height\n", "x is in 'kN'; give it in mm"),
        (read_map, "x [m],y [m],height\n", "height has no unit, and others have; give it in mm"),
        (read_map, "# rail 12 [MPa]\n", "does not name them"),
        (read_map, "x,x,height\n", "does not name them"),
        (files.read_curve, "engineering strain,stress\n", "names plastic strain and stress"),
        (files.read_curve, "# time, stress [ksi]\n", "names plastic strain and stress"),
        (files.read_curve, "strain,stress [kN]\n", "stress is in 'kN'; give it in MPa"),
        (files.wear_pairs, "T-gamma/A [N],rate\n", "T-gamma/A is in 'N'; give it in N/mm2"),
        (formats.read, "y [kN],z\n", "the columns are in kN"),
        (formats.read, "y [kN],z [mm]\n", "the columns are in kN and mm"),
    ],
)
def test_a_header_that_is_not_understood_is_refused(tmp_path, read, header, words) -> None:
    rows = {read_map: GRID, formats.read: PLACES}.get(read, [(1, 5), (10, 50)])
    path = written(tmp_path, header, rows)
    arguments = (path, 0.0) if read is read_map else (str(path),)
    if read is formats.read:
        arguments = (path,)
    assert words in refusal(lambda: read(*arguments), ValueError)


@pytest.mark.parametrize("line", ["9" * 30_000 + "x", " " * 30_000 + "x", "9" * 9_000 + "x"])
def test_a_long_line_is_read_or_refused_at_once(tmp_path, line: str) -> None:
    path = written(tmp_path, line + "\n", PLACES)
    start = time.process_time()
    if len(line) > 10_000:
        assert "characters" in refusal(lambda: formats.read(path), FormatError)
    else:
        assert len(formats.read(path).points) == len(PLACES)
    assert time.process_time() - start < 5


def test_what_waits_for_a_writer_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    assert "no regular file" in refusal(lambda: read_rows(tmp_path / "fifo"))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("complex", "height is complex128; give real numbers"),
        ("half", "map.npz is no whole .npz file of numbers; write it again by numpy.savez"),
        ("npy", "map.npz is no whole .npz file of numbers; write it again by numpy.savez"),
    ],
)
def test_a_map_of_arrays_that_is_none_is_one_line(tmp_path, content: str, words: str) -> None:
    path = tmp_path / "map.npz"
    heights = np.zeros((5, 3), complex if content == "complex" else float)
    np.savez(path, x=np.arange(5.0), y=np.arange(3.0), height=heights)
    if content == "half":
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    elif content == "npy":
        np.save(tmp_path / "map.npy", heights)
        (tmp_path / "map.npy").replace(path)
    assert refusal(lambda: read_map(path, 0.0), ValueError).endswith(words)
