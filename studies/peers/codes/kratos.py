"""Kratos Multiphysics: finite elements with a mortar method (pip; BSD-4-Clause)."""

import json
from pathlib import Path

import numpy as np

TITLE = "Kratos"
METHOD = "finite elements"
SETTINGS = """Linear hexahedra have `ALMContactFrictionless`, a dual mortar method with condensed
multipliers. AMG with ILU(0) and GMRES solve to 1e-8, the contact to 1e-6. `move_mesh_flag` is on,
because without it most nodes never touch. The pressure is the augmented one at the node."""
PIP = (
    "KratosMultiphysics==10.4.4",
    "KratosStructuralMechanicsApplication==10.4.4",
    "KratosContactStructuralMechanicsApplication==10.4.4",
    "KratosConstitutiveLawsApplication==10.4.4",
    "KratosLinearSolversApplication==10.4.4",
    "numpy",
    "scipy",
)
DEBIAN = ()
MODULES = ("KratosMultiphysics.ContactStructuralMechanicsApplication",)
RUNS = {f"{size} mm": {"mesh": ["hexahedron", size]} for size in (1.0, 0.7, 0.5)}
NEAR = {"rail": 9.0, "wheel": 11.7}  # mm around the centre where contact is looked for
STEPS = 50


def solve(case, mesh):
    """Model file, settings, one static step, and the rail's nodes. RuntimeError: no convergence."""
    import KratosMultiphysics as Core
    from KratosMultiphysics import ContactStructuralMechanicsApplication as Contact
    from KratosMultiphysics.ContactStructuralMechanicsApplication import (
        auxiliary_methods_solvers as auxiliary,
    )
    from KratosMultiphysics.StructuralMechanicsApplication import (
        structural_mechanics_analysis as analysis,
    )

    pairing = _write_model(mesh)
    Path("steel.json").write_text(json.dumps(_steel(case)))
    create = auxiliary.AuxiliaryCreateLinearSolver

    def without_direct_settings(part, settings, contact, linear, solver):
        """10.4.4: amgcl adds a key that the condensing solver refuses."""
        if linear.Has("direct_settings"):
            linear.RemoveValue("direct_settings")
        return create(part, settings, contact, linear, solver)

    auxiliary.AuxiliaryCreateLinearSolver = without_direct_settings
    Core.Logger.GetDefaultOutput().SetSeverity(Core.Logger.Severity.WARNING)
    model = Core.Model()
    stages = analysis.StructuralMechanicsAnalysis(
        model, Core.Parameters(json.dumps(_settings(case)))
    )
    stages.Initialize()
    stages.RunSolutionLoop()
    part = model["Structure"]
    count = part.ProcessInfo[Core.NL_ITERATION_NUMBER]
    if count >= STEPS:
        raise RuntimeError(f"not converged in {STEPS} steps")

    def pressure(number):
        node = part.GetNode(int(number) + 1)
        value = Contact.AUGMENTED_NORMAL_CONTACT_PRESSURE
        return -node.GetValue(value) if node.Is(Core.ACTIVE) else 0.0

    nodes = np.unique(pairing["rail"])
    x, y = mesh["rail_points"][nodes, :2].T
    pressures = np.array([pressure(node) for node in nodes])
    return {
        "unknowns": 3 * (len(mesh["rail_points"]) + len(mesh["wheel_points"])),
        "force": 4
        * abs(
            sum(
                part.GetNode(int(node) + 1).GetSolutionStepValue(Core.REACTION_Z)
                for node in mesh["rail_far"]
            )
        ),
        "pressure_max": pressures[np.argmin(np.hypot(x, y))],
        "x": x,
        "y": y,
        "pressure": pressures,
        "iterations": count,
    }


def _write_model(mesh):
    """model.mdpa; returns the corners of the faces that may touch, by body."""
    first = {"rail": 1, "wheel": 1 + len(mesh["rail_points"])}
    points = np.concatenate([mesh["rail_points"], mesh["wheel_points"]])
    cells = np.concatenate([mesh[f"{body}_cells"] + at for body, at in first.items()])
    pairing = {}
    for body in first:
        corners = mesh[f"{body}_corners"]
        middle = mesh[f"{body}_points"][corners].mean(axis=1)
        pairing[body] = corners[np.hypot(*middle[:, :2].T) < NEAR[body]]
    with open("model.mdpa", "w") as file:
        file.write("Begin Properties 0\nEnd Properties\nBegin Properties 1\nEnd Properties\n")
        file.write("Begin Nodes\n")
        file.writelines(
            f"{i} {x:.12g} {y:.12g} {z:.12g}\n" for i, (x, y, z) in enumerate(points, 1)
        )
        file.write("End Nodes\nBegin Elements SmallDisplacementElement3D8N\n")
        file.writelines(f"{i} 1 {' '.join(map(str, cell))}\n" for i, cell in enumerate(cells, 1))
        file.write("End Elements\nBegin Conditions SurfaceCondition3D4N\n")
        condition, owned = 0, {}
        for body, corners in pairing.items():
            owned[body] = range(condition + 1, condition + 1 + len(corners))
            for condition, face in zip(owned[body], corners + first[body], strict=True):
                file.write(f"{condition} 0 {' '.join(map(str, face))}\n")
        file.write("End Conditions\n")
        _part(file, "all", range(1, len(points) + 1), range(1, len(cells) + 1), ())
        for body, at in first.items():
            for name in ("x0", "y0", "far"):
                _part(file, f"{body}_{name}", mesh[f"{body}_{name}"] + at, (), ())
            _part(file, f"{body}_contact", np.unique(pairing[body]) + at, (), owned[body])
    return pairing


def _part(file, name, nodes, elements, conditions) -> None:
    file.write(f"Begin SubModelPart {name}\n")
    for kind, numbers in (("Nodes", nodes), ("Elements", elements), ("Conditions", conditions)):
        listed = "".join(f"{number}\n" for number in numbers)
        file.write(f"Begin SubModelPart{kind}\n{listed}End SubModelPart{kind}\n")
    file.write("End SubModelPart\n")


def _steel(case):
    variables = {"YOUNG_MODULUS": case["young"], "POISSON_RATIO": case["poisson"]}
    law = {"constitutive_law": {"name": "LinearElastic3DLaw"}, "Variables": variables, "Tables": {}}
    part = {"model_part_name": "Structure.all", "properties_id": 1, "Material": law}
    return {"properties": [part]}


def _settings(case):
    def held(part, x=None, y=None, z=None):
        values = [x, y, z]
        return {
            "python_module": "assign_vector_variable_process",
            "kratos_module": "KratosMultiphysics",
            "Parameters": {
                "model_part_name": f"Structure.{part}",
                "variable_name": "DISPLACEMENT",
                "constrained": [value is not None for value in values],
                "value": values,
                "interval": [0.0, "End"],
            },
        }

    linear = {
        "solver_type": "amgcl",
        "smoother_type": "ilu0",
        "krylov_type": "gmres",
        "coarsening_type": "aggregation",
        "max_iteration": 500,
        "tolerance": 1e-8,
        "gmres_krylov_space_dimension": 100,
        "scaling": False,
        "block_size": 1,
        "use_block_matrices_if_possible": True,
    }
    solver = {
        "model_part_name": "Structure",
        "domain_size": 3,
        "echo_level": 0,
        "solver_type": "Static",
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "mdpa", "input_filename": "model"},
        "material_import_settings": {"materials_filename": "steel.json"},
        "time_stepping": {"time_step": 1.0 + 1e-9},
        "contact_settings": {
            "mortar_type": "ALMContactFrictionless",
            "use_mixed_ulm_solver": True,
            "silent_strategy": True,
        },
        "compute_reactions": True,
        "move_mesh_flag": True,
        "clear_storage": True,
        "reform_dofs_at_each_step": True,
        "convergence_criterion": "contact_residual_criterion",
        "residual_relative_tolerance": 1e-6,
        "residual_absolute_tolerance": 1e-9,
        "max_iteration": STEPS,
        "linear_solver_settings": linear,
        "rotation_dofs": False,
        "volumetric_strain_dofs": False,
    }
    contact = {
        "python_module": "alm_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "Parameters": {
            "model_part_name": "Structure",
            "contact_model_part": {"0": ["rail_contact", "wheel_contact"]},
            "assume_master_slave": {"0": ["rail_contact"]},  # the name of the SLAVE side
            "contact_type": "Frictionless",
        },
    }
    return {
        "problem_data": {
            "problem_name": "hertz",
            "parallel_type": "OpenMP",
            "start_time": 0.0,
            "end_time": 1.0,
            "echo_level": 0,
        },
        "solver_settings": solver,
        "processes": {
            "constraints_process_list": [
                held("rail_far", 0.0, 0.0, 0.0),
                held("rail_x0", x=0.0),
                held("rail_y0", y=0.0),
                held("wheel_x0", x=0.0),
                held("wheel_y0", y=0.0),
                held("wheel_far", 0.0, 0.0, -case["travel"]),
            ],
            "contact_process_list": [contact],
        },
    }
