"""tamaas: boundary elements of a half-space by fast Fourier transforms (pip; AGPL-3.0)."""

import numpy as np

TITLE = "tamaas"
METHOD = "boundary elements"
SETTINGS = """The pressure has cells on a square of 12 mm. Both bodies are one half-space with their
contact modulus. Polonsky and Keer's conjugate gradients go to 1e-10, with the non-periodic kernel
(`dcfft`)."""
PIP = ("tamaas==2.9.0", "numpy", "scipy")
DEBIAN = ()
MODULES = ("tamaas",)
RUNS = {f"{n} x {n} cells": {"cells": n} for n in (32, 64, 128, 256)}
HALF = 6.0  # mm


def solve(case, mesh, cells):
    """Exactly the load of the case on cells x cells."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    tm.initialize(1)
    side = 2 * HALF
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [side] * 2, [cells] * 2)
    model.E, model.nu = case["young"] / 2, case["poisson"]  # both bodies alike: 1/E* adds up
    centres = (np.arange(cells) + 0.5) * side / cells - HALF
    x, y = np.meshgrid(centres, centres, indexing="ij")
    gap = x**2 / (2 * case["wheel_radius"]) + y**2 / (2 * case["rail_radius"])
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, -gap, 1e-10)
    solver.setIntegralOperator("dcfft")
    solver.max_iter = 5000
    solver.solve(case["load"] / side**2)
    pressure = np.asarray(model.traction)
    pressed = pressure > 0
    displacement = np.zeros_like(pressure)
    model.operators["dcfft"](model.traction, displacement)
    return {
        "unknowns": cells**2,
        "force": pressure.sum() * (side / cells) ** 2,
        "pressure_max": pressure.max(),
        "x": x[pressed],
        "y": y[pressed],
        "pressure": pressure[pressed],
        # Where they touch, displacement and gap add up to the approach.
        "approach": (displacement + gap)[pressed].mean(),
    }
