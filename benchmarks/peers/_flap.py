"""The case of flap.toml for Kratos Multiphysics: meshes, settings and one run of its partitioned solver.

The numbers are those of the scene, which is read for them. Importing this module needs `pip install
KratosFSIApplication KratosConstitutiveLawsApplication KratosLinearSolversApplication gmsh`.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi
from pathlib import Path
from time import process_time
from typing import Any

import gmsh
import KratosMultiphysics as Kratos
import KratosMultiphysics.ConstitutiveLawsApplication as Laws
import KratosMultiphysics.FluidDynamicsApplication as Fluids
import KratosMultiphysics.LinearSolversApplication  # registers the direct solvers
import numpy as np
from KratosMultiphysics.FSIApplication.partitioned_fsi_base_solver import PartitionedFSIBaseSolver
from numpy.typing import NDArray

Array = NDArray[np.float64]

SCENE = Path(__file__).with_name("flap.toml")
LENGTH, HEIGHT = 4.0, 1.0


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


@dataclass(frozen=True)
class Outcome:
    """What one run gave: its series (t, u_x, u_y, f_x), and its seconds of the processor without imports."""

    series: Array
    nodes: int
    elements: int
    iterations: float
    cpu: float


@dataclass(frozen=True)
class Meshes:
    """Both meshes, whose nodes on the interface are the same, from the foot on the left to that on the right.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Of the fluid, the first of them on the interface.
    triangles : ndarray, shape (m, 3)
    wet : int
        Number of nodes on the interface.
    x, y : ndarray
        Coordinates of the solid's grid of nodes.
    """

    points: Array
    triangles: NDArray[np.int64]
    wet: int
    x: Array
    y: Array


def _pairs(length: float, size: Any, least: int) -> Array:
    """Coordinates from 0 to a length, with the wanted sizes, in pairs of equal intervals."""
    s = np.linspace(0.0, length, 2001)
    density = 1.0 / size(s)
    count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2.0 * np.diff(s))])
    pairs = max(least, round(count[-1] / 2.0))
    ends = np.interp(np.linspace(0.0, count[-1], pairs + 1), count, s)
    middles = (ends[1:] + ends[:-1]) / 2.0
    return np.sort(np.concatenate([ends, middles]))


@contextmanager
def _gmsh() -> Iterator[None]:
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        yield
    finally:
        gmsh.finalize()


def meshes(size: float, scene: Mapping[str, Any]) -> Meshes:
    """Triangles of the fluid, small at the flap, smaller at the singular corners of its end, and a grid of the solid.

    Parameters
    ----------
    size : float
        As in `Setting`.
    scene : mapping
    """
    x0, thickness, height = (float(scene["constants"][name]) for name in ("x0", "t0", "h0"))
    corner, wall, far, slope = size * thickness / 16.0, size * thickness / 4.0, size * 0.05, size * 0.13
    x = x0 + _pairs(thickness, lambda s: np.minimum(wall, corner + slope * np.minimum(s, thickness - s)), 1)
    y = _pairs(height, lambda s: np.minimum(wall, np.minimum(corner + slope * (height - s), 2 * corner + slope * s)), 2)
    path = [(x[0], v) for v in y] + [(u, y[-1]) for u in x[1:-1]] + [(x[-1], v) for v in y[::-1]]
    with _gmsh():
        geo, mesh = gmsh.model.geo, gmsh.model.mesh
        wet = [geo.addPoint(u, v, 0) for u, v in path]
        outer = [geo.addPoint(u, v, 0) for u, v in ((LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT), (0, 0))]
        loop = [*wet, *outer]
        lines = [geo.addLine(a, b) for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]
        geo.addPlaneSurface([geo.addCurveLoop(lines)])
        for line in lines[: len(wet) - 1]:
            geo.mesh.setTransfiniteCurve(line, 2)
        geo.synchronize()
        fields = []
        tips = [wet[len(y) - 1], wet[len(y) + len(x) - 2]]
        for kind, tags, least in (("PointsList", tips, corner), ("PointsList", wet, wall)):
            distance = mesh.field.add("Distance")
            mesh.field.setNumbers(distance, kind, tags)
            threshold = mesh.field.add("Threshold")
            numbers = {
                "InField": distance,
                "SizeMin": least,
                "SizeMax": far,
                "DistMin": 0.0,
                "DistMax": (far - least) / slope,
            }
            for name, value in numbers.items():
                mesh.field.setNumber(threshold, name, value)
            fields.append(threshold)
        both = mesh.field.add("Min")
        mesh.field.setNumbers(both, "FieldsList", fields)
        mesh.field.setAsBackgroundMesh(both)
        for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 6)
        mesh.generate(2)
        tags, coordinates, _ = mesh.getNodes()
        _, corners = mesh.getElementsByType(2)
    order = np.argsort(tags)  # the interface's points were made first and have the first numbers
    points = np.asarray(coordinates).reshape(-1, 3)[order, :2]
    triangles = np.searchsorted(np.asarray(tags)[order], np.asarray(corners)).reshape(-1, 3)
    assert np.allclose(points[: len(path)], path)
    return Meshes(points, triangles.astype(np.int64), len(path), x, y)


def _settings(given: Setting) -> dict[str, Any]:
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


class _Counted(PartitionedFSIBaseSolver):
    """The partitioned solver, which counts how often it solves for the solid: once a coupling iteration."""

    solved = 0

    def _SolveStructure(self) -> None:  # noqa: N802  Kratos' name
        self.solved += 1
        super()._SolveStructure()


def _lines(part: Any, nodes: list[int], properties: Any) -> None:
    part.AddNodes(nodes)
    for number, ends in enumerate(pairwise(nodes), 1):
        part.CreateNewCondition("LineCondition2D2N", number, list(ends), properties)


def _fill_fluid(part: Any, made: Meshes, scene: Mapping[str, Any]) -> None:
    for number, (u, v) in enumerate(made.points, 1):
        part.CreateNewNode(number, u, v, 0.0)
    properties = part.CreateNewProperties(1)
    properties.SetValue(Kratos.DENSITY, scene["fluid"]["density"])
    properties.SetValue(Kratos.DYNAMIC_VISCOSITY, scene["fluid"]["viscosity"])
    properties.SetValue(Kratos.CONSTITUTIVE_LAW, Fluids.Newtonian2DLaw())
    volume, interface = part.CreateSubModelPart("Volume"), part.CreateSubModelPart("Interface")
    volume.AddNodes(list(range(1, len(made.points) + 1)))
    for number, corners in enumerate((made.triangles + 1).tolist(), 1):
        volume.CreateNewElement("Element2D3N", number, corners, properties)
    _lines(interface, list(range(made.wet, 0, -1)), properties)


def _fill_solid(part: Any, made: Meshes, scene: Mapping[str, Any], quadratic: bool) -> NDArray[np.int64]:
    """Fill the solid's model part; the numbers of its nodes on their grid."""
    material = scene["solid"][0]
    number = np.arange(1, made.x.size * made.y.size + 1).reshape(made.x.size, made.y.size)
    for (i, j), name in np.ndenumerate(number):
        part.CreateNewNode(int(name), made.x[i], made.y[j], 0.0)
    properties = part.CreateNewProperties(1)
    properties.SetValue(Kratos.DENSITY, material["density"])
    properties.SetValue(Kratos.YOUNG_MODULUS, material["youngs_modulus"])
    properties.SetValue(Kratos.POISSON_RATIO, material["poissons_ratio"])
    properties.SetValue(Kratos.THICKNESS, 1.0)
    assert (material["model"], material["plane"]) == ("neo-hooke", "strain")
    properties.SetValue(Kratos.CONSTITUTIVE_LAW, Laws.HyperElasticPlaneStrain2DLaw())
    step = 2 if quadratic else 1
    around = [(0, 0), (step, 0), (step, step), (0, step)]
    around += [(1, 0), (2, 1), (1, 2), (0, 1), (1, 1)] if quadratic else []
    elements = 0
    for i in range(0, made.x.size - 1, step):
        for j in range(0, made.y.size - 1, step):
            elements += 1
            nodes = [int(number[i + a, j + b]) for a, b in around]
            part.CreateNewElement(f"TotalLagrangianElement2D{len(nodes)}N", elements, nodes, properties)
    path = [*number[0], *number[1:-1, -1], *number[-1, ::-1]]
    _lines(part.CreateSubModelPart("Interface"), [int(name) for name in path], properties)
    return number


def inflow(y: Array) -> Array:
    """Velocity at the inlet's nodes when the flow has set in.

    Straight pieces between points of a parabola carry less, 2 % with seven of them; the profile is scaled to make that
    good.
    """
    profile = 6.0 * y * (1.0 - y)
    order = np.argsort(y)
    return profile / np.trapezoid(profile[order], y[order])


def growth(t: float) -> float:
    """How much of the inflow has set in."""
    return (1.0 - cos(pi * t)) / 2.0 if t < 1.0 else 1.0


def _hold(part: Any, nodes: NDArray[np.bool_], variables: tuple[Any, ...]) -> None:
    for k in np.flatnonzero(nodes):
        node = part.Nodes[int(k) + 1]
        for variable in variables:
            node.Fix(variable)


def run(given: Setting, end: float | None = None) -> Outcome:
    """One run from nothing to its last step.

    Parameters
    ----------
    given : Setting
    end : float, optional
        By default that of the scene.

    Raises
    ------
    RuntimeError
        If the coupling of a step does not converge.
    """
    used = process_time()
    scene = tomllib.loads(SCENE.read_text(encoding="utf-8"))
    steps = round((end or scene["time"]["end"]) / given.dt)
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    Kratos.ParallelUtilities.SetNumThreads(given.threads)
    made = meshes(given.size, scene)
    model = Kratos.Model()
    solver = _Counted(model, Kratos.Parameters(json.dumps(_settings(given))))
    solver.AddVariables()
    fluid, solid = model["Fluid"], model["Structure"]
    _fill_fluid(fluid, made, scene)
    number = _fill_solid(solid, made, scene, given.quadratic)
    for part in (fluid, solid):
        part.ProcessInfo[Kratos.DELTA_TIME] = given.dt
    solver.ImportModelPart()
    solver.PrepareModelPart()
    solver.AddDofs()
    x, y = made.points.T
    inlet, outlet = np.isclose(x, 0.0), np.isclose(x, LENGTH)
    floor = np.isclose(y, 0.0) | np.isclose(y, HEIGHT)
    _hold(fluid, inlet | floor, (Kratos.VELOCITY_X, Kratos.VELOCITY_Y))
    _hold(fluid, inlet | floor | outlet, (Kratos.MESH_DISPLACEMENT_X, Kratos.MESH_DISPLACEMENT_Y))
    for name in number[:, 0]:
        solid.Nodes[int(name)].Fix(Kratos.DISPLACEMENT_X)
        solid.Nodes[int(name)].Fix(Kratos.DISPLACEMENT_Y)
    solver.Initialize()
    for part in (fluid, solid):
        part.ProcessInfo[Kratos.STEP] = 0
        part.ProcessInfo[Kratos.TIME] = 0.0
    driven = [(fluid.Nodes[int(k) + 1], float(u)) for k, u in zip(np.flatnonzero(inlet), inflow(y[inlet]), strict=True)]
    wet = [fluid.Nodes[k] for k in range(1, made.wet + 1)]
    tip = solid.Nodes[int(number[made.x.size // 2, -1])]
    t, series = 0.0, []
    for _ in range(steps):
        t = solver.AdvanceInTime(t)
        for node, speed in driven:
            node.SetSolutionStepValue(Kratos.VELOCITY_X, growth(t) * speed)
        solver.InitializeSolutionStep()
        solver.Predict()
        if not solver.SolveSolutionStep():
            raise RuntimeError(f"Kratos: the coupling did not converge at t = {t:g} with {given}")
        solver.FinalizeSolutionStep()
        u = tip.GetSolutionStepValue(Kratos.DISPLACEMENT)
        force = -sum(node.GetSolutionStepValue(Kratos.REACTION_X) for node in wet)
        series.append((t, u[0], u[1], force))
    cpu = process_time() - used
    elements = fluid.NumberOfElements() + solid.NumberOfElements()
    return Outcome(np.array(series), len(made.points), elements, solver.solved / steps, cpu)
