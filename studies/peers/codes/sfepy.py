"""SfePy: finite elements with a penalty (pip; BSD-3-Clause)."""

import numpy as np

TITLE = "SfePy"
METHOD = "finite elements"
SETTINGS = """Linear hexahedra, the built-in term `dw_contact` (penalty 5 E per mm; at 50 E Newton's
method found no end), MKL PARDISO, residual to 1e-4, where the closest facets begin to alternate.
Pressure: the nodal force over the area that belongs to the node."""
PIP = ("sfepy==2026.3", "pypardiso==0.4.7", "numpy", "scipy")
DEBIAN = ()
MODULES = ("sfepy", "pypardiso")
RUNS = {f"{size} mm": {"mesh": ["hexahedron", 1, size]} for size in (1.4, 1.0, 0.7)}
NEAR = {"rail": 8.0, "wheel": 11.2}  # mm around the centre where contact is looked for
PENALTY, STEPS = 5.0, 40


def solve(case, mesh):
    """Regions, one solve, and the elastic forces at the rail's face. RuntimeError: no
    convergence.
    """
    from sfepy.base.base import IndexedStruct, output
    from sfepy.discrete import (
        Equation,
        Equations,
        FieldVariable,
        Function,
        Integral,
        Material,
        Problem,
    )
    from sfepy.discrete.conditions import Conditions, EssentialBC
    from sfepy.discrete.fem import FEDomain, Field, Mesh
    from sfepy.mechanics.matcoefs import stiffness_from_youngpoisson
    from sfepy.solvers.ls import PyPardisoSolver
    from sfepy.solvers.nls import Newton
    from sfepy.terms import Term

    output.set_output(quiet=True)
    first = {"rail": 0, "wheel": len(mesh["rail_points"])}
    points = np.concatenate([mesh[f"{body}_points"] for body in first])
    cells = [mesh[f"{body}_cells"] + at for body, at in first.items()]
    material = np.repeat([0, 1], [len(each) for each in cells]).astype(np.int32)
    group = np.repeat([0, 1], [len(mesh[f"{body}_points"]) for body in first]).astype(np.int32)
    both = np.concatenate(cells).astype(np.int32)
    domain = FEDomain("domain", Mesh.from_data("two", points, group, [both], [material], ["3_8"]))
    whole = domain.create_region("Whole", "all")
    nodes = {}
    for body, at in first.items():
        corners = mesh[f"{body}_corners"]
        middle = mesh[f"{body}_points"][corners].mean(axis=1)
        nodes[f"touch{body}"] = np.unique(corners[np.hypot(*middle[:, :2].T) < NEAR[body]]) + at
        nodes |= {f"{name}{body}": mesh[f"{body}_{name}"] + at for name in ("x0", "y0", "far")}
    regions = {}
    for name, found in nodes.items():
        chosen = Function(name, lambda coors, domain=None, ids=found: ids.astype(np.int32))
        regions[name] = domain.create_region(
            name, f"vertices by {name}", "facet", functions={name: chosen}
        )
    touching = domain.create_region("Contact", "r.touchrail +s r.touchwheel", "facet")
    field = Field.from_args("displacement", np.float64, 3, whole, approx_order=1)

    def elastic(u, v):
        return Term.new(
            "dw_lin_elastic(solid.D, v, u)", Integral("i", order=2), whole, solid=solid, v=v, u=u
        )

    stiffness = stiffness_from_youngpoisson(3, case["young"], case["poisson"])
    solid = Material("solid", D=stiffness)
    penalty = Material("penalty", **{".epss": PENALTY * case["young"]})
    u, v = (
        FieldVariable("u", "unknown", field),
        FieldVariable("v", "test", field, primary_var_name="u"),
    )
    contact = Term.new(
        "dw_contact(penalty.epss, v, u)",
        Integral("j", order=2),
        touching,
        penalty=penalty,
        v=v,
        u=u,
    )
    problem = Problem("contact", equations=Equations([Equation("e", elastic(u, v) + contact)]))
    status = IndexedStruct()
    control = {
        "i_max": STEPS,
        "eps_a": 1e-6,
        "eps_r": 1e-4,
        "eps_mode": "or",
        "ls_on": 1e10,
        "lin_red": None,
    }
    newton = Newton(control, lin_solver=PyPardisoSolver({}), status=status)
    problem.set_solver(newton)
    held = {
        "farrail": {"u.all": 0.0},
        "farwheel": {"u.[0,1]": 0.0, "u.2": -case["travel"]},
        "x0rail": {"u.0": 0.0},
        "x0wheel": {"u.0": 0.0},
        "y0rail": {"u.1": 0.0},
        "y0wheel": {"u.1": 0.0},
    }
    problem.set_bcs(Conditions([EssentialBC(k, regions[k], value) for k, value in held.items()]))
    problem.solve(status=status, save_results=False)
    if newton.status.condition:
        raise RuntimeError(f"not converged in {STEPS} steps")

    # Elastic forces without conditions: reactions at the far end, contact forces at the face.
    found = u().copy()
    u, v = (
        FieldVariable("u", "unknown", field),
        FieldVariable("v", "test", field, primary_var_name="u"),
    )
    free = Problem("elastic", equations=Equations([Equation("e", elastic(u, v))]))
    free.time_update()
    free.update_materials()
    u.set_data(found)
    forces = free.evaluate(
        "dw_lin_elastic.2.Whole(solid.D, v, u)",
        mode="weak",
        dw_mode="vector",
        solid=solid,
        v=v,
        u=u,
    ).reshape(-1, 3)[:, 2]
    corners = mesh["rail_corners"]
    a, b, c, d = points[corners].transpose(1, 0, 2)
    quarter = np.linalg.norm(np.cross(c - a, d - b), axis=1) / 8
    area = np.bincount(corners.ravel(), np.repeat(quarter, 4), minlength=len(points))
    face = mesh["rail_contact"]
    x, y = points[face, :2].T
    pressure = np.abs(forces[face]) / area[face]
    return {
        "unknowns": 3 * len(points),
        "force": 4 * abs(forces[mesh["rail_far"]].sum()),
        "pressure_max": pressure[np.argmin(np.hypot(x, y))],
        "x": x,
        "y": y,
        "pressure": pressure,
        "iterations": newton.status.n_iter,
    }
