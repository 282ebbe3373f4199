"""The evidence. `railhead study NAME` runs a study in a checkout of the repository.

A study is a module with a line STUDY and a function main(out, *, quick), which writes tables,
pictures and page.md into the folder `out`. One that needs other programs has install() too, and
KEEPS: names in its folder that a new run leaves.
"""

STUDIES = {
    "accuracy_cost": "studies.accuracy.accuracy_cost",
    "calibrate": "studies.accuracy.calibrate",
    "creep": "studies.mechanics.creep",
    "effects": "studies.cost.effects",
    "error_bounds": "studies.accuracy.error_bounds",
    "fuzz": "studies.hard.fuzz.study",
    "hard_cases": "studies.hard.hard_cases",
    "load_sweep": "studies.mechanics.load_sweep",
    "peers": "studies.peers.study",
    "plasticity": "studies.mechanics.plasticity",
    "profiles": "studies.mechanics.profiles",
    "ranks": "studies.cost.ranks",
    "scaling": "studies.cost.scaling",
    "thesis": "studies.thesis.study",
}
"""Module of each study by its name."""
