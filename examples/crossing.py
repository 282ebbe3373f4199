"""Section files of an artificial crossing, drawn from formulae: a wing rail that goes aside, and a
nose that rises. Writes crossing/nose.csv, crossing/wing.csv and crossing/crossing.toml.

x runs along the rail, y to the field side from below the tape circle, z up; mm.
"""

from pathlib import Path

import numpy as np

FOLDER = Path("crossing")
SCENE = """\
name = "crossing"
load = "80 kN"

[rail]
sections = "nose.csv"
position = 194.5
steel = "R260"

[wing]
sections = "wing.csv"
steel = "R260"

[wheel]
profile = "cone40"
rolling_radius = 460
steel = "ER7"
"""


def head(middle, height, half_width, radius):
    """Points (n, 2) of an arc with flanks of slope 4."""
    q = np.linspace(-half_width - 5, half_width + 5, 241)
    arc = np.minimum(abs(q), half_width)
    flank = 4 * np.maximum(abs(q) - half_width, 0)
    z = height - (radius - np.sqrt(radius**2 - arc**2)) - flank
    return np.column_stack([middle + q, z])


def nose(x):
    """Points of the nose at x: it grows wider, and rises by 1:25 until x = 250."""
    s = np.clip(x, 250, 350) - 250
    rise = 0.04 * (min(x, 250) - 250) + 0.04 * s - 0.04 * s**2 / 200
    return head(-20, rise - 2, 8 + 0.055 * x, 80)


def wing(x):
    """Points of the wing rail at x: it goes aside 1:10 and falls by 1:100."""
    return head(25 + x / 10, -0.4 - x / 100, 20, 300)


def write(name, places, points):
    """Writes a file for each section, and the table that names them."""
    rows = ["x_mm,file"]
    for x in places:
        np.savetxt(FOLDER / f"{name}_{x}.txt", points(x), fmt="%.5f")
        rows.append(f"{x},{name}_{x}.txt")
    (FOLDER / f"{name}.csv").write_text("\n".join(rows) + "\n")


FOLDER.mkdir(exist_ok=True)
write("nose", range(0, 401, 10), nose)
write("wing", range(-100, 501, 100), wing)
(FOLDER / "crossing.toml").write_text(SCENE)
print(FOLDER / "crossing.toml")
