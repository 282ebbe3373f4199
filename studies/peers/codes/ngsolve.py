"""NGSolve: curved finite elements of any order (pip; LGPL-2.1)."""

import numpy as np

TITLE = "NGSolve"
METHOD = "finite elements"
SETTINGS = """Its own mesher makes curved tetrahedra of order 2 and 3. `ContactBoundary` has the
energy of a penalty of 5 E order^2 / size. Newton's method with sparse Cholesky starts from the
wheel moved down as one body. The pressure is -sigma_zz at points of the rail's surface."""
PIP = ("ngsolve==6.2.2608", "numpy", "scipy")
DEBIAN = ()
MODULES = ("ngsolve",)
RUNS = {
    f"order {order}, {size} mm": {"order": order, "size": size}
    for order, size in ((2, 1.0), (2, 0.7), (2, 0.5), (3, 1.4), (3, 1.0))
}
WIDTH, DEPTH = 40.0, 60.0  # mm, as the blocks of the other codes
FINE = (5.4, 4.4)  # mm of the face that have the given size
PENALTY, STEPS, TOLERANCE = 5.0, 40, 1e-9


def solve(case, mesh, order, size):
    """Mesh, Newton's method, and values at points. RuntimeError: no convergence."""
    import ngsolve as ng

    ng.SetNumThreads(1)
    body = _mesh(case, size)
    body.Curve(order)
    space = ng.VectorH1(
        body, order=order, dirichlet="railfar|wheelfar", dirichletx="x0", dirichlety="y0"
    )
    u = space.TrialFunction()
    young, nu = case["young"], case["poisson"]
    mu, lame = young / 2 / (1 + nu), young * nu / (1 + nu) / (1 - 2 * nu)

    def strain(w):
        return 0.5 * (ng.Grad(w) + ng.Grad(w).trans)

    def stress(w):
        return 2 * mu * strain(w) + lame * ng.Trace(strain(w)) * ng.Id(3)

    energy = ng.BilinearForm(space, symmetric=True)
    energy += ng.Variation(0.5 * ng.InnerProduct(stress(u), strain(u)) * ng.dx)
    contact = ng.ContactBoundary(body.Boundaries("railcontact"), body.Boundaries("wheelcontact"))
    place = ng.CF((ng.x, ng.y, ng.z))
    overlap = (place + u - place.Other() - u.Other()) * contact.normal
    factor = PENALTY * young * order**2 / size
    contact.AddEnergy(ng.IfPos(overlap, 0.5 * factor * overlap * overlap, 0))
    found = ng.GridFunction(space)
    found.Set(ng.CF((0, 0, -case["travel"])), definedon=body.Materials("wheel"))
    residual, step = found.vec.CreateVector(), found.vec.CreateVector()
    first, count = None, 0
    for _ in range(STEPS):
        contact.Update(found, energy, 2 * order + 2, 3 * size)
        energy.Apply(found.vec, residual)
        energy.AssembleLinearization(found.vec)
        step.data = energy.mat.Inverse(space.FreeDofs(), "sparsecholesky") * residual
        found.vec.data -= step
        decrement = abs(ng.InnerProduct(step, residual)) ** 0.5
        first = first or decrement
        count += 1
        if decrement < TOLERANCE * first:
            break
    else:
        raise RuntimeError(f"not converged in {STEPS} steps: {decrement / first:.1e}")

    contact.Update(found, energy, 2 * order + 2, 3 * size)
    energy.Apply(found.vec, residual)
    one = ng.GridFunction(space)
    one.Set(ng.CF((0, 0, 1)), definedon=body.Boundaries("railfar"))
    at = stress(found)
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 4.2, 25), np.linspace(0, 3.4, 25)))
    inside = (x / 4.3) ** 2 + (y / 3.45) ** 2 < 0.93
    x, y = x[inside], y[inside]
    z = np.sqrt(case["rail_radius"] ** 2 - y**2) - case["rail_radius"]
    pressure = [-at(body(*map(float, point)))[8] for point in zip(x, y, z - 1e-9, strict=True)]
    axis = [np.reshape(at(body(1e-6, 1e-6, -depth)), (3, 3)) for depth in np.linspace(0.5, 4, 60)]
    return {
        "unknowns": space.ndof,
        "force": 4 * abs(ng.InnerProduct(one.vec, residual)),
        "pressure_max": -at(body(1e-7, 1e-7, -1e-9))[8],
        "x": x,
        "y": y,
        "pressure": pressure,
        "tau_max": max(np.ptp(np.linalg.eigvalsh(each)) / 2 for each in axis),
        "iterations": count,
    }


def _mesh(case, size):
    """Boxes cut by cylinders; the face has the given size around the patch."""
    from netgen.occ import Box, Compound, Cylinder, OCCGeometry, X, Y
    from ngsolve import Mesh

    rail_radius, wheel_radius = case["rail_radius"], case["wheel_radius"]
    rail = Box((0, 0, -DEPTH), (WIDTH, WIDTH, 0)) * Cylinder(
        (-1, 0, -rail_radius), X, r=rail_radius, h=WIDTH + 2
    )
    wheel = Box((0, 0, 0), (WIDTH, WIDTH, DEPTH)) * Cylinder(
        (0, -1, wheel_radius), Y, r=wheel_radius, h=WIDTH + 2
    )
    for solid, name in ((rail, "rail"), (wheel, "wheel")):
        solid.solids.name = name
        for face in solid.faces:
            x, y, z = face.center
            if abs(x) < 1e-6 or abs(y) < 1e-6:
                face.name = "x0" if abs(x) < 1e-6 else "y0"
            elif abs(abs(z) - DEPTH) < 1e-6:
                face.name = f"{name}far"
            else:
                face.name = "free" if max(x, y) > WIDTH - 1e-6 else f"{name}contact"
    x, y = (grid.ravel() for grid in np.meshgrid(*(np.arange(0, end, size / 1.5) for end in FINE)))
    inside = (x / FINE[0]) ** 2 + (y / FINE[1]) ** 2 < 1
    with open("sizes.msz", "w") as file:
        file.write(f"{2 * inside.sum()}\n")
        for a, b in zip(x[inside], y[inside], strict=True):
            for z in (-(b**2) / 2 / rail_radius, a**2 / 2 / wheel_radius):
                file.write(f"{a} {b} {z} {size}\n")
        file.write("0\n")
    geometry = OCCGeometry(Compound([rail, wheel]))
    return Mesh(geometry.GenerateMesh(maxh=15, grading=0.3, meshsizefilename="sizes.msz"))
