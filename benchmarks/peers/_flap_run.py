"""The case of flap.toml for Kratos Multiphysics: one run of its partitioned solver.

The numbers are those of the scene, which is read for them. Importing this module needs `pip install
KratosFSIApplication KratosConstitutiveLawsApplication KratosLinearSolversApplication gmsh`.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi
from pathlib import Path
from time import process_time
from typing import Any

import KratosMultiphysics as Kratos
import KratosMultiphysics.ConstitutiveLawsApplication as Laws
import KratosMultiphysics.FluidDynamicsApplication as Fluids
import KratosMultiphysics.LinearSolversApplication  # registers the direct solvers
import numpy as np
from _flap_mesh import HEIGHT, LENGTH, Meshes, meshes
from _flap_settings import Setting, settings
from KratosMultiphysics.FSIApplication.partitioned_fsi_base_solver import PartitionedFSIBaseSolver
from numpy.typing import NDArray

Array = NDArray[np.float64]

SCENE = Path(__file__).with_name("flap.toml")


@dataclass(frozen=True)
class Outcome:
    """What one run gave: its series (t, u_x, u_y, f_x), and its seconds of the processor without imports."""

    series: Array
    nodes: int
    elements: int
    iterations: float
    cpu: float


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
    solver = _Counted(model, Kratos.Parameters(json.dumps(settings(given))))
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
