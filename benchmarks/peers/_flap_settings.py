"""Settings of Kratos Multiphysics for the case of flap.toml, in the words of its partitioned solver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Setting:
    """What an expert would vary.

    Attributes
    ----------
    size : float
        Of all elements; 1 is a mesh with 2888 nodes and five solid elements across the flap.
    dt : float
    element : {"weakly_compressible", "vms", "qsvms"}
        Of the fluid: linear triangles with different stabilisations.
    scheme : {"bdf2", "bossak"}
        Of fluid, solid and mesh velocity.
    accelerator : str
        "MVQN", "IBQN_MVQN", "MVQN_recursive" or "Relaxation".
    mover : {"structural_similarity", "laplacian"}
    linear : {"amgcl", "sparse_lu"}
        Linear solver of the fluid; that of the mesh is conjugate gradients with AMG, that of the solid LU.
    tolerance : float
        Of the coupling: root of the mean square of the interface's residual, a displacement.
    newton : float
        Relative tolerance of velocity and pressure in the fluid's Newton iterations.
    quadratic : bool
        Solid elements with nine nodes instead of four.
    threads : int
    """

    size: float
    dt: float
    element: str = "weakly_compressible"
    scheme: str = "bdf2"
    accelerator: str = "MVQN"
    mover: str = "structural_similarity"
    linear: str = "amgcl"
    tolerance: float = 1e-6
    newton: float = 1e-3
    quadratic: bool = True
    threads: int = 1


def settings(given: Setting) -> dict[str, Any]:
    """Parameters of the partitioned solver."""
    direct = {"solver_type": "LinearSolversApplication.sparse_lu"}
    amg = {"solver_type": "amgcl", "smoother_type": "ilu0", "tolerance": 1e-7, "max_iteration": 200, "verbosity": 0}
    krylov = {"krylov_type": "gmres", "gmres_krylov_space_dimension": 100, "block_size": 3, "coarse_enough": 500}
    here = {"model_import_settings": {"input_type": "use_input_model_part"}, "domain_size": 2, "echo_level": 0}
    taken = {"material_import_settings": {"materials_filename": ""}, **here}
    tau = {"weakly_compressible": 1.0, "vms": 0.01, "qsvms": 0.0}[given.element]
    tolerances = {
        f"{kind}_{field}_tolerance": given.newton * (1.0 if kind == "relative" else 1e-2)
        for kind in ("relative", "absolute")
        for field in ("velocity", "pressure")
    }
    return {
        "solver_type": "partitioned",
        "coupling_scheme": "dirichlet_neumann",
        "structure_solver_settings": {
            **taken,
            "solver_type": "dynamic",
            "model_part_name": "Structure",
            "time_integration_method": "implicit",
            "scheme_type": given.scheme,
            "buffer_size": 3,
            "time_stepping": {"time_step": given.dt},
            "residual_relative_tolerance": 1e-7,
            "residual_absolute_tolerance": 1e-9,
            "max_iteration": 20,
            "linear_solver_settings": direct,
            "multi_point_constraints_used": False,
        },
        "fluid_solver_settings": {
            **taken,
            **tolerances,
            "solver_type": "monolithic",
            "model_part_name": "Fluid",
            "formulation": {"element_type": given.element, "dynamic_tau": tau},
            "time_scheme": given.scheme,
            "compute_reactions": True,
            "reform_dofs_at_each_step": False,
            "linear_solver_settings": amg | krylov if given.linear == "amgcl" else direct,
            "volume_model_part_name": "Fluid.Volume",
            "skin_parts": ["Fluid.Interface"],
            "time_stepping": {"automatic_time_step": False, "time_step": given.dt},
        },
        "mesh_solver_settings": {
            **here,
            "solver_type": given.mover,
            "model_part_name": "Fluid",
            "linear_solver_settings": amg | {"krylov_type": "cg", "block_size": 2 if "struct" in given.mover else 1},
            "mesh_velocity_calculation": {"time_scheme": given.scheme}
            | ({"alpha_m": -0.3} if given.scheme == "bossak" else {}),
        },
        "coupling_settings": {
            "coupling_strategy_settings": {"solver_type": given.accelerator, "w_0": 0.5},
            "mapper_settings": [
                {
                    "fluid_interface_submodelpart_name": "Fluid.Interface",
                    "structure_interface_submodelpart_name": "Structure.Interface",
                    "mapper_face": "unique",
                }
            ],
            "nl_max_it": 40,
            "nl_tol": given.tolerance,
            "fluid_interfaces_list": ["Fluid.Interface"],
            "structure_interfaces_list": ["Structure.Interface"],
        },
    }
