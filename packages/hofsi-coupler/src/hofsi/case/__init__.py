"""Plain data: what a scene asks to be simulated.

A `Case` holds the mesh description, the materials with their boundary conditions, and the settings. It reads no file
and computes nothing; `hofsi.io.scene` makes it from a scene file. All values are in the scene's own consistent units.
``place`` says where in the scene an object was written, for error messages.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hofsi.case.conditions import (
    Displacement,
    DoNothing,
    FluidCondition,
    Free,
    NoSlip,
    Periodic,
    Pressure,
    Roller,
    Slip,
    SolidCondition,
    Traction,
    Velocity,
)
from hofsi.case.materials import (
    Convection,
    ConvectionForm,
    Fluid,
    Motion,
    Solid,
    VectorExpression,
)
from hofsi.case.movers import (
    AngleOptimisationSettings,
    BarrierSettings,
    MotionSettings,
    MoverSettings,
    PseudoSolidSettings,
    RuleSettings,
    RuleVertex,
)
from hofsi.case.quantities import (
    FlowBalance,
    FlowRate,
    FluidIntegral,
    Force,
    IntegralName,
    MeanPressure,
    Moment,
    Point,
    PressureDifference,
    Probe,
    Quantity,
    ScalarQuantity,
    SolidIntegral,
    SolidIntegralName,
    TimeFunction,
)
from hofsi.case.settings import (
    CouplingSettings,
    LinearSettings,
    NonlinearSettings,
    OutputSettings,
    SolidScheme,
    Steady,
    TimeSettings,
    Unsteady,
)

if TYPE_CHECKING:
    from hoblock.scene import MeshScene

__all__ = [
    "AngleOptimisationSettings",
    "BarrierSettings",
    "Case",
    "Convection",
    "ConvectionForm",
    "CouplingSettings",
    "Displacement",
    "DoNothing",
    "FlowBalance",
    "FlowRate",
    "Fluid",
    "FluidCondition",
    "FluidIntegral",
    "Force",
    "Free",
    "IntegralName",
    "LinearSettings",
    "MeanPressure",
    "Moment",
    "Motion",
    "MotionSettings",
    "MoverSettings",
    "NoSlip",
    "NonlinearSettings",
    "OutputSettings",
    "Periodic",
    "Point",
    "Pressure",
    "PressureDifference",
    "Probe",
    "PseudoSolidSettings",
    "Quantity",
    "Roller",
    "RuleSettings",
    "RuleVertex",
    "ScalarQuantity",
    "Slip",
    "Solid",
    "SolidCondition",
    "SolidIntegral",
    "SolidIntegralName",
    "SolidScheme",
    "Steady",
    "TimeFunction",
    "TimeSettings",
    "Traction",
    "Unsteady",
    "VectorExpression",
    "Velocity",
]


@dataclass(frozen=True)
class Case:
    """Everything a simulation needs to know.

    Attributes
    ----------
    title, file : str
        One line for people; where the case comes from.
    mesh : hoblock.scene.MeshScene
    fluid : Fluid or None
    solids : tuple of Solid
        At least a fluid or one solid.
    motions : tuple of Motion
    mover, time, scheme, coupling, nonlinear, linear, output
        Settings.
    quantities : tuple of Quantity
        In the order of the scene; names are unique.
    tables : tuple of str
        The top-level tables that the scene has, so that a plan can say which of them are skipped.
    """

    title: str
    file: str
    mesh: MeshScene
    fluid: Fluid | None
    solids: tuple[Solid, ...]
    time: TimeSettings
    motions: tuple[Motion, ...] = ()
    mover: MoverSettings = field(default_factory=BarrierSettings)
    scheme: SolidScheme = field(default_factory=SolidScheme)
    coupling: CouplingSettings = field(default_factory=CouplingSettings)
    nonlinear: NonlinearSettings = field(default_factory=NonlinearSettings)
    linear: LinearSettings = field(default_factory=LinearSettings)
    output: OutputSettings = field(default_factory=OutputSettings)
    quantities: tuple[Quantity, ...] = ()
    tables: tuple[str, ...] = ()
