"""What commands cost, and what a position costs by what is asked of it, in processor seconds."""

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np

import railhead
from railhead.cli.study import ROOT
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction
from railhead.theory.friction.tangential import pair
from studies import tables

REPEATS = 3  # the median of so many runs, after one that is not counted
UNIT = "hertz_ellipse by finite elements, mesh.patch_size = 0.3"
ASKED: Mapping[str, tuple[str, ...]] = {
    "all": (),
    "patch, forces": ("quantities=patch,forces",),
}
ROLLS = (
    "friction.coefficient=0.3",
    "effects.finite_bodies=off",
    "effects.plasticity=off",
)
WHEELSET = "wheelset.yaw=1mrad", "rolling.from_wheelset=true"
SCENES = {
    "S1002 on 60E1 at 2 mm that rolls": ("s1002_60e1", (*ROLLS, "wheelset.shift=2mm", *WHEELSET)),
    "ellipse that rolls": ("hertz_ellipse", (*ROLLS, "rolling.creepage_along=0.1%")),
}
SHIFTS = "wheelset.shift=-5:5:0.5mm"
CREEPAGES = 100  # solved one by one on 24 cells each way
WHEEL = (
    "run s1002_60e1 --set friction.coefficient=0.3 --set wheelset.shift=2mm"
    " --set rolling.from_wheelset=true --without plasticity"
)
ELLIPSE = "run hertz_ellipse --set friction.coefficient=0.3 --set rolling.creepage_along=0.1%"
CROWN, ROUTE = "wear examples/wear_crown.toml", "wear examples/wear_route.toml --fast"
COMMANDS = (
    ("ellipse", "run hertz_ellipse"),
    ("ellipse that rolls with friction", ELLIPSE),
    ("the same, half-spaces", f"{ELLIPSE} --fast"),
    ("real profiles", "run s1002_60e1"),
    ("a wheelset that rolls with friction", WHEEL),
    ("the same, half-spaces", f"{WHEEL} --fast"),
    ("the same, half-spaces, an axle without torque",
     f"{WHEEL} --fast --set rolling.axle=torque_free"),
    ("wear of one position, half-spaces, finite elements at the end", CROWN),
    ("wear of one position, half-spaces", f"{CROWN} --fast"),
    ("wear over a route of 12 positions in 5 steps, half-spaces", ROUTE),
    ("a creep table for vehicle programs", "table"),
)  # fmt: skip
"""Commands of `railhead` after what they do; they begin at the top of the checkout."""


def main(out: Path, *, quick: bool) -> None:
    """Measure each row (quick: the ellipses alone, once); write both CSV files and the page."""
    repeats = 1 if quick else REPEATS
    spent: dict[tuple[str, str], float] = {}
    commands: list[tables.Row] = []
    with Progress(quiet=False) as progress:
        for task, line in COMMANDS[: 2 if quick else None]:
            progress.stage(line)
            more = ["--no-pictures"] if line.startswith("run") else []
            _, each = tables.timed(command, *line.split(), *more)
            commands.append({"task": task, "command": line, "seconds": each})
        progress.stage(UNIT)
        unit = catalogue.find("hertz_ellipse").replace(["mesh.patch_size=0.3"])
        spent[UNIT, "all"] = seconds(partial(railhead.solve, unit, quiet=True), repeats)
        for name, (case, keys) in list(SCENES.items())[1 if quick else 0 :]:
            for asked, only in ASKED.items():
                progress.stage(f"{name}: {asked}")
                scene = catalogue.find(case).replace([*keys, *only])
                spent[name, asked] = seconds(partial(railhead.solve, scene, quiet=True), repeats)
        progress.stage("creep forces")
        one = "a creep force on 24 x 24 cells", "forces"
        spent[one] = seconds(creep_forces, repeats) / CREEPAGES
        if not quick:
            progress.stage("sweep")
            sets = [f"--set={key}" for key in (*ROLLS, *WHEELSET)]
            over = f"--over={SHIFTS}", "--only=patch,forces"
            text = "21 shifts of S1002 on 60E1, a sweep from its start to its table"
            spent[text, "patch, forces"] = tables.timed(
                command, "sweep", "s1002_60e1", *sets, *over
            )[1]
    rows = [
        {"what": what, "asked": asked, "seconds": each, "units": each / spent[UNIT, "all"]}
        for (what, asked), each in spent.items()
    ]
    tables.publish(out, page(rows, commands), {"seconds": "s"}, speed=rows, speed_commands=commands)


def seconds(work: Callable[[], object], repeats: int) -> float:
    """Median processor seconds of a function, after one call that is not counted."""
    return median([tables.timed(work)[1] for _ in range(repeats + 1)][1:])


def command(*arguments: str) -> None:
    """Run a command of `railhead`. RuntimeError: it writes nothing; a check may fail."""
    line = [str(Path(sys.executable).with_name("railhead")), *arguments, "--quiet"]
    alone = {
        key: value for key, value in os.environ.items() if not key.startswith(("OMPI", "PMIX"))
    }
    with TemporaryDirectory() as folder:
        line += [f"--out={folder}/out"]  # a command of this process could not start mpirun
        subprocess.run(line, check=False, cwd=ROOT, env=alone, stdout=subprocess.DEVNULL)
        if not Path(folder, "out").is_dir():
            raise RuntimeError(f"{line} wrote nothing")


def creep_forces() -> None:
    """Tractions of a circle of half-spaces at growing creepages, each from the one before."""
    x = (np.arange(24) + 0.5) / 12 - 1
    pressure = np.sqrt(np.maximum(1 - x[:, None] ** 2 - x**2, 0.0))
    like = pair(1.0, 0.28, 1.0, 0.28)
    friction, found = HalfSpaceFriction(x, x, pressure, 0.3, like, rolling=True), None
    for step in range(CREEPAGES):
        found = friction.solve(Creepage(0.02 * (step + 1), 0.01, 0.1), found)


def page(rows: list[tables.Row], commands: list[tables.Row]) -> str:
    """Text of the page."""
    solids = sorted(
        row["seconds"]
        for row in commands
        if row["command"].startswith("run") and "--fast" not in row["command"]
    )
    return tables.render(
        "speed",
        least=f"{solids[0]:.0f}",
        most=f"{solids[-1]:.0f}",
        rows=tables.cells(rows, "{what}", "{asked}", "{seconds:.3f}", "{units:.3f}"),
        commands=tables.cells(commands, "{task}", "`{command}`", "{seconds:.1f}"),
    )
