"""GetFEM: finite elements with Nitsche's method (Debian; LGPL-3.0 or later)."""

import numpy as np

TITLE = "GetFEM"
METHOD = "finite elements"
SETTINGS = """The cells are quadratic curved tetrahedra. The brick of biased Nitsche's method with
raytracing has the parameter E / size. MUMPS solves. Newton's method starts from the wheel moved
down as one body, and ends at a residual of 2e-7. The pressure is -sigma_zz, the mean over the cells
at a node."""
PIP = ()
DEBIAN = ("python3-getfem",)
MODULES = ("getfem",)
RUNS = {f"{size} mm": {"mesh": ["tetrahedron", size], "size": size} for size in (1.0, 0.7, 0.5)}
NEAR = {"rail": 8.0, "wheel": 11.2}  # mm around the centre where contact is looked for
CONTACT, X0, Y0, FAR = 1, 2, 3, 4
STEPS = 60


def solve(case, mesh, size):
    """Bricks, Newton's method, reactions and stresses. RuntimeError: no convergence."""
    import getfem as gf

    gf.util_trace_level(0)
    young, nu = case["young"], case["poisson"]
    model = gf.Model("real")
    data = {
        "lam": [young * nu / (1 + nu) / (1 - 2 * nu)],
        "mu": [young / 2 / (1 + nu)],
        "r": [young / size],
        "Hx": np.diag([1.0, 0, 0]),
        "Hy": np.diag([0, 1.0, 0]),
        "zero": [0.0, 0, 0],
        "down": [0.0, 0, -case["travel"]],
    }
    for name, value in data.items():
        model.add_initialized_data(name, value)
    bodies = {"rail": ("u1", "zero"), "wheel": ("u2", "down")}
    meshes, fields, rules = {}, {}, {}
    for body, (u, end) in bodies.items():
        made = meshes[body] = _mesh(gf, mesh, body)
        fields[body] = gf.MeshFem(made, 3)
        rules[body] = gf.MeshIm(made, gf.Integ("IM_TETRAHEDRON(5)"))
        fields[body].set_fem(gf.Fem("FEM_PK(3,2)"))
        model.add_fem_variable(u, fields[body])
        model.add_isotropic_linearized_elasticity_brick(rules[body], u, "lam", "mu")
        for along, plane in (("Hx", X0), ("Hy", Y0)):
            model.add_generalized_Dirichlet_condition_with_penalization(
                rules[body], u, 1e9, plane, "zero", along
            )
        model.add_Dirichlet_condition_with_simplification(u, FAR, end)
    brick = model.add_Nitsche_large_sliding_contact_brick_raytracing(False, "r", 1.0)
    stress = "((lam*Div_u1)*Id(3)+mu*(Grad_u1+Grad_u1'))*Normal"
    model.add_slave_contact_boundary_to_biased_Nitsche_large_sliding_contact_brick(
        brick, rules["rail"], CONTACT, "u1", stress
    )
    model.add_master_contact_boundary_to_biased_Nitsche_large_sliding_contact_brick(
        brick, rules["wheel"], CONTACT, "u2"
    )
    start = model.variable("u2") * 0
    start[2::3] = -case["travel"]
    model.set_variable("u2", start)
    count, converged = model.solve("max_res", 2e-7, "max_iter", STEPS, "lsolver", "mumps")
    if not converged:
        raise RuntimeError(f"not converged in {STEPS} steps")

    internal = gf.asm_generic(
        rules["rail"], 1, "lam*Div_u1*Div_Test_u1 + mu*(Grad_u1+Grad_u1'):Grad_Test_u1", -1, model
    )
    first, number = model.interval_of_variable("u1")
    far = np.abs(np.abs(fields["rail"].basic_dof_nodes()[2]) - 60) < 1e-6
    down = np.arange(number) % 3 == 2
    linear = gf.MeshFem(meshes["rail"], 1)
    linear.set_fem(gf.Fem("FEM_PK_DISCONTINUOUS(3,1)"))
    sigma = model.local_projection(rules["rail"], "lam*Div_u1+2*mu*Grad_u1(3,3)", linear)
    places = linear.basic_dof_nodes()
    arc = np.sqrt(case["rail_radius"] ** 2 - places[1] ** 2) - case["rail_radius"]
    on = np.abs(places[2] - arc) < 1e-6
    nodes, inverse = np.unique(np.round(places[:2, on].T, 6), axis=0, return_inverse=True)
    pressure = -np.bincount(inverse.ravel(), sigma[on]) / np.bincount(inverse.ravel())
    return {
        "unknowns": sum(field.nbdof() for field in fields.values()),
        "force": 4 * abs(internal[first : first + number][far & down].sum()),
        "pressure_max": pressure[np.argmin(np.hypot(*nodes.T))],
        "x": nodes[:, 0],
        "y": nodes[:, 1],
        "pressure": pressure,
        "iterations": count,
    }


def _mesh(gf, mesh, body):
    """A body with its faces in regions."""
    made = gf.Mesh("empty", 3)
    order = [0, 4, 1, 6, 5, 2, 7, 8, 9, 3]  # of GetFEM's quadratic tetrahedra
    cells = mesh[f"{body}_points"][mesh[f"{body}_cells"][:, order]]
    made.add_convex(gf.GeoTrans("GT_PK(3,2)"), np.asfortranarray(cells.transpose(2, 1, 0)))
    faces, places = made.outer_faces(), made.pts()
    regions = {CONTACT: [], X0: [], Y0: [], FAR: []}
    for face in faces.T:
        x, y, z = places[:, made.pid_in_faces(face.reshape(2, 1))]
        if (np.abs(x) < 1e-6).all():
            regions[X0].append(face)
        elif (np.abs(y) < 1e-6).all():
            regions[Y0].append(face)
        elif (np.abs(np.abs(z) - 60) < 1e-6).all():
            regions[FAR].append(face)
        elif (np.abs(z) < 6).all() and np.hypot(x.mean(), y.mean()) < NEAR[body]:
            regions[CONTACT].append(face)
    for number, found in regions.items():
        made.set_region(number, np.array(found).T)
    return made
