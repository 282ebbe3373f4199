"""CalculiX: finite elements by an input deck (Debian; GPL-2.0)."""

import re
import subprocess
from pathlib import Path

import numpy as np

TITLE = "CalculiX"
METHOD = "finite elements"
SETTINGS = """`LINMORTAR` on C3D8 has a penalty of 1000 E per mm, and SPOOLES solves. Symmetry
conditions on the dependent nodes would stop ccx with a singular matrix, so springs of 1e8 N/mm hold
them. The pressure is CPRESS at the node."""
PIP = ()
DEBIAN = ("calculix-ccx", "python3-numpy")
MODULES = ()
RUNS = {f"mortar, C3D8, {size} mm": {"mesh": ["hexahedron", size]} for size in (1.0, 0.7, 0.5)}
PENALTY = 1000  # times E per mm
NEAR = {"rail": 7.0, "wheel": 11.0}  # mm around the centre where contact is looked for


def solve(case, mesh):
    """Deck, ccx, and what it printed. RuntimeError: ccx reports an error."""
    Path("job.inp").write_text(deck(case, mesh))
    done = subprocess.run(["ccx", "-i", "job"], capture_output=True, text=True, check=False)
    if done.returncode or "*ERROR" in done.stdout:
        said = [line.strip() for line in done.stdout.splitlines() if line.strip()]
        wrong = [line for line in said if "*ERROR" in line] or said[-1:]
        raise RuntimeError(f"ccx: {' '.join(wrong[:1])}")
    return read(mesh, Path("job.dat").read_text(), Path("job.frd").read_text())


def deck(case, mesh) -> str:
    """Text of the input deck: in one step the wheel's far end moves down on the clamped rail."""
    first_node = {"rail": 1, "wheel": 1 + len(mesh["rail_points"])}
    first_cell = {"rail": 1, "wheel": 1 + len(mesh["rail_cells"])}
    lines = ["*NODE"]
    for body, first in first_node.items():
        points = enumerate(mesh[f"{body}_points"], first)
        lines += [
            ", ".join([str(number), *(f"{x:.10g}" for x in point)]) for number, point in points
        ]
    for body, first in first_cell.items():
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={body}")
        cells = enumerate(mesh[f"{body}_cells"] + first_node[body], first)
        lines += [", ".join(map(str, [number, *cell])) for number, cell in cells]
    for body, first in first_cell.items():
        corners = mesh[f"{body}_points"][mesh[f"{body}_corners"]]
        near = np.hypot(*corners.mean(axis=1)[:, :2].T) < NEAR[body]
        lines.append(f"*SURFACE, NAME=S{body}, TYPE=ELEMENT")
        lines += [f"{first + cell}, S{side + 1}" for cell, side in mesh[f"{body}_sides"][near]]
    lines += [
        *("*MATERIAL, NAME=STEEL", "*ELASTIC", f"{case['young']}, {case['poisson']}"),
        *(f"*SOLID SECTION, ELSET={body}, MATERIAL=STEEL" for body in first_cell),
        "*SURFACE INTERACTION, NAME=TOUCH",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{PENALTY * case['young']:g}",
        "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=LINMORTAR",
        "Srail, Swheel",
    ]
    springs = len(mesh["rail_cells"]) + len(mesh["wheel_cells"])
    for body, first in first_node.items():
        for name, direction in (("x0", 1), ("y0", 2)):
            held = mesh[f"{body}_{name}"]
            if body == "rail":
                dependent = np.intersect1d(held, mesh["rail_contact"])
                lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=K{name}")
                lines += [f"{springs + 1 + i}, {n + first}" for i, n in enumerate(dependent)]
                lines += [f"*SPRING, ELSET=K{name}", f"{direction}", "1.e8"]
                springs += len(dependent)
                held = np.setdiff1d(held, dependent)
            lines += ["*BOUNDARY", *(f"{n + first}, {direction}" for n in held)]
        lines += [f"*NSET, NSET=FAR{body}", *(f"{n + first}," for n in mesh[f"{body}_far"])]
    lines += [
        *("*BOUNDARY", "FARrail, 1, 3", "FARwheel, 1, 2"),
        *("*STEP, INC=200", "*STATIC, SOLVER=SPOOLES", "1., 1."),
        *("*BOUNDARY", f"FARwheel, 3, 3, {-case['travel']}"),
        *("*NODE PRINT, NSET=FARrail, TOTALS=ONLY", "RF"),
        *("*EL FILE", "S", "*CONTACT FILE", "CSTR", "*END STEP", ""),
    ]
    return "\n".join(lines)


def read(mesh, dat: str, frd: str):
    """The reaction from job.dat, pressures and stresses from the last blocks of job.frd."""
    force = re.findall(r"total force .*\n\s*\n?\s*(\S+)\s+(\S+)\s+(\S+)", dat)[-1][2]
    blocks: dict[str, dict[int, list[float]]] = {}
    block = None
    for line in frd.splitlines():
        if line.startswith(" -4"):
            block = blocks[line.split()[1]] = {}
        elif line.startswith(" -1") and block is not None:
            ends = range(13, len(line.rstrip()), 12)
            block[int(line[3:13])] = [float(line[at : at + 12]) for at in ends]
        elif line.startswith(" -3"):
            block = None
    points, corners = mesh["rail_points"], np.unique(mesh["rail_corners"])
    at = {node: values[3] for node, values in blocks["CONTACT"].items()}  # CPRESS
    pressure = np.array([at.get(node + 1, 0.0) for node in corners])
    x, y = points[corners, :2].T
    axis = np.flatnonzero((np.hypot(*points[:, :2].T) < 1e-6) & (points[:, 2] > -5))
    return {
        "unknowns": 3 * (len(points) + len(mesh["wheel_points"])),
        "force": 4 * abs(float(force)),
        "pressure_max": pressure[np.argmin(np.hypot(x, y))],
        "x": x,
        "y": y,
        "pressure": pressure,
        "tau_max": max(_tresca(blocks["STRESS"][int(node) + 1]) for node in axis),
    }


def _tresca(s) -> float:
    """Largest shear stress of xx, yy, zz, xy, yz, zx."""
    values = np.linalg.eigvalsh([[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])
    return (values[2] - values[0]) / 2
