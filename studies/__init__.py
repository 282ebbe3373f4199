"""The evidence. `railhead study NAME` runs a study in a checkout of the repository.

A study is a module with a function main(out, *, quick), which writes tables, pictures and page.md
into the folder `out`. One that needs other programs has KEEPS: names in its
folder that a new run leaves.
"""

STUDIES = {
    "accuracy_cost": (
        "studies.cost.accuracy_cost",
        "error against time: penalty and Nitsche, four elements, four sizes, asked accuracies",
    ),
    "calibrate": (
        "studies.accuracy.calibrate",
        "error laws by family, from random scenes of known answer",
    ),
    "creep": (
        "studies.mechanics.creep",
        "creep curves against half-spaces, FASTSIM and linear theory; what friction costs, changes",
    ),
    "effect_accuracy": (
        "studies.accuracy.effect_accuracy",
        "error against time of every effect: yield, friction, real profiles; asked accuracies",
    ),
    "effects": (
        "studies.accuracy.effects",
        "each effect on and off: seconds, unknowns and change of the answer; off costs nothing",
    ),
    "error_bounds": (
        "studies.accuracy.error_bounds",
        "estimates against true errors, 20 random scenes of each family",
    ),
    "friction_bounds": (
        "studies.accuracy.friction_bounds",
        "estimates of rolling half-spaces against finer grids of another scheme, 100 random scenes",
    ),
    "fuzz": (
        "studies.hard.fuzz",
        "500 fuzzed scenes: no traceback, no abort, no wrong number with status 0",
    ),
    "hard_cases": (
        "studies.hard.hard_cases",
        "hard cases: loads, starts, shapes, stiffness, meshes, places, factors, random scenes",
    ),
    "pass_bounds": (
        "studies.accuracy.pass_bounds",
        "estimates of passes against twice the elements, 16 random lines",
    ),
    "passes": (
        "studies.mechanics.passes",
        "the thesis's rail run in over 20 passes under 22.5 t, and the map of shakedown verdicts",
    ),
    "peers": (
        "studies.peers.peers_study",
        "hertz_ellipse by other codes, measured beside this one (`make peers` gets them)",
    ),
    "plasticity": (
        "studies.mechanics.plasticity",
        "yield of the thesis's rail from 5 to 200 kN, and of a sphere up to 100 times first yield",
    ),
    "profiles": (
        "studies.mechanics.profiles",
        "noise of measured profiles: seeds, levels and spacings on worn rails and wheels",
    ),
    "ranks": (
        "studies.cost.ranks",
        "one process against two, by parts of a run, and a forecast for more",
    ),
    "scaling": (
        "studies.cost.scaling",
        "time and memory per unknown, contact against one linear elastic solve",
    ),
    "speed": (
        "studies.cost.speed",
        "processor seconds of a position by half-spaces: all, or patch and forces alone",
    ),
    "thesis": (
        "studies.thesis.thesis_study",
        "every claim of the 2012 thesis recomputed, with a verdict, and its figures drawn again",
    ),
    "wear_bounds": (
        "studies.accuracy.wear_bounds",
        "estimates of wear against more steps and finer grids, 20 random routes",
    ),
}
"""Module of each study by its name, and what the study shows, in one line."""
