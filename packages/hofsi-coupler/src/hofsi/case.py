"""Plain data: what a scene asks to be simulated.

A `Case` holds the mesh description, the materials with their boundary conditions, and the settings. It reads no file
and computes nothing; `hofsi.io.scene` makes it from a scene file. All values are in the scene's own consistent units.
``place`` says where in the scene an object was written, for error messages.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from hoblock.expressions import Expression
    from hoblock.scene import MeshScene

__all__ = [
    "AngleOptimisationSettings",
    "Case",
    "CouplingSettings",
    "Displacement",
    "DoNothing",
    "Fluid",
    "FluidCondition",
    "Force",
    "Free",
    "LinearSettings",
    "Motion",
    "MoverSettings",
    "NoSlip",
    "NonlinearSettings",
    "OutputSettings",
    "Point",
    "Pressure",
    "PressureDifference",
    "Probe",
    "PseudoSolidSettings",
    "Quantity",
    "Roller",
    "Slip",
    "Solid",
    "SolidCondition",
    "Steady",
    "TimeSettings",
    "Traction",
    "Unsteady",
    "VectorExpression",
    "Velocity",
]

VectorExpression: TypeAlias = "tuple[Expression, Expression]"


@dataclass(frozen=True)
class Velocity:
    """Given fluid velocity, by component.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y, t, or None
        None leaves the component free; at least one is given.
    traction_x, traction_y : Expression of x, y, t, or None
        Component of σ·n where the velocity component is free; None means 0.
    place : str
    """

    on: tuple[str, ...]
    x: Expression | None
    y: Expression | None
    traction_x: Expression | None = None
    traction_y: Expression | None = None
    place: str = ""


@dataclass(frozen=True)
class NoSlip:
    """The fluid has the velocity of the wall: zero, or that of a moving boundary."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Slip:
    """u·n = w·n with the mesh velocity w, and no tangential traction."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Traction:
    """Given traction.

    Of a fluid: σ·n. Of a solid: force per unit reference length, of fixed direction.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y, t
    place : str
    """

    on: tuple[str, ...]
    x: Expression
    y: Expression
    place: str = ""


@dataclass(frozen=True)
class Pressure:
    """Given pressure: the traction -p n.

    Of a fluid: σ·n = -p n. Of a solid: a follower load, per unit current length along the current normal.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    value : Expression of x, y, t
    place : str
    """

    on: tuple[str, ...]
    value: Expression
    place: str = ""


@dataclass(frozen=True)
class DoNothing:
    """μ ∂u/∂n - p n = 0."""

    on: tuple[str, ...]
    place: str = ""


FluidCondition: TypeAlias = Velocity | NoSlip | Slip | Traction | Pressure | DoNothing


@dataclass(frozen=True)
class Displacement:
    """Given displacement of a solid, by component; ``fixed`` in a scene is 0 in both.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y (reference), t, or None
        None leaves the component free, without traction; at least one is given.
    place : str
    """

    on: tuple[str, ...]
    x: Expression | None
    y: Expression | None
    place: str = ""


@dataclass(frozen=True)
class Roller:
    """d·n = 0 with the reference normal n, and no tangential traction."""

    on: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True)
class Free:
    """Nothing acts on the solid's edges."""

    on: tuple[str, ...]
    place: str = ""


SolidCondition: TypeAlias = Displacement | Roller | Traction | Pressure | Free


@dataclass(frozen=True)
class Fluid:
    """An incompressible Newtonian fluid.

    Attributes
    ----------
    density : float
        Positive.
    viscosity : float
        Dynamic, positive.
    blocks : tuple of str
        Block groups of the mesh.
    boundaries : tuple of FluidCondition
        Exactly one for each outer edge that is not shared with a solid.
    model : {"navier-stokes", "stokes"}
    convection : {"auto", "newton", "picard", "extrapolated"}
        "auto" leaves the choice to the solver.
    body_force : pair of Expression of x, y, t, or None
        Per unit volume, gravity included; None is zero.
    initial_velocity : pair of Expression of x, y, or None
        None is zero.
    place : str
    """

    density: float
    viscosity: float
    blocks: tuple[str, ...]
    boundaries: tuple[FluidCondition, ...]
    model: Literal["navier-stokes", "stokes"] = "navier-stokes"
    convection: Literal["auto", "newton", "picard", "extrapolated"] = "auto"
    body_force: VectorExpression | None = None
    initial_velocity: VectorExpression | None = None
    place: str = "fluid"

    def extrapolates(self, coupling: CouplingSettings | None) -> bool:
        """Whether a time step extrapolates the convecting velocity, so that its equations are linear.

        Parameters
        ----------
        coupling : CouplingSettings or None
            None without coupling. If every coupling iteration has a mesh of its own, "auto" iterates on convection too.
        """
        if self.convection == "auto":
            return coupling is None or coupling.geometry == "extrapolated"
        return self.convection == "extrapolated"


@dataclass(frozen=True)
class Solid:
    """An elastic solid.

    Attributes
    ----------
    name : str
        Unique among the solids.
    density, youngs_modulus : float
        Positive.
    poissons_ratio : float
        In (-1, 0.5).
    blocks : tuple of str
        Block groups of the mesh.
    boundaries : tuple of SolidCondition
        Exactly one for each dry outer edge; on edges shared with the fluid at most one traction or pressure.
    model : {"st-venant-kirchhoff", "linear"}
    plane : {"strain", "stress"}
    body_force : pair of Expression of x, y (reference), t, or None
        Per unit reference volume, gravity included; None is zero.
    initial_displacement, initial_velocity : pair of Expression of x, y (reference), or None
        None is zero.
    place : str
    """

    name: str
    density: float
    youngs_modulus: float
    poissons_ratio: float
    blocks: tuple[str, ...]
    boundaries: tuple[SolidCondition, ...]
    model: Literal["st-venant-kirchhoff", "linear"] = "st-venant-kirchhoff"
    plane: Literal["strain", "stress"] = "strain"
    body_force: VectorExpression | None = None
    initial_displacement: VectorExpression | None = None
    initial_velocity: VectorExpression | None = None
    place: str = "solid[0]"


@dataclass(frozen=True)
class Motion:
    """Outer edges of the fluid that move as given.

    Attributes
    ----------
    on : tuple of str
        Names of the mesh's edges.
    x, y : Expression of x, y (reference), t
        Displacement.
    place : str
    """

    on: tuple[str, ...]
    x: Expression
    y: Expression
    place: str = ""


@dataclass(frozen=True)
class PseudoSolidSettings:
    """Block vertices follow as those of an elastic solid.

    Attributes
    ----------
    exponent : float
        Of the blocks' stiffness, E = (A/A_min)^exponent.
    poissons_ratio : float
        In (-1, 0.5).
    """

    exponent: float = -1.0
    poissons_ratio: float = 0.3


@dataclass(frozen=True)
class AngleOptimisationSettings:
    """Block vertices are placed for the best angles, one after the other.

    Attributes
    ----------
    power : int
        Even; of the angles' errors.
    sweeps : int
        Over all vertices, a step.
    iterations : int
        Gauss–Newton steps a vertex and sweep.
    lower, upper : float
        Limits of edge lengths as fractions of the initial ones; None for no upper limit.
    penalty : float
        C of the length penalty, per length⁴.
    radius : float
        Largest motion of a vertex in a step, as a fraction of the shortest edge at it.
    projection : {"every", "end"}
        Whether the radius limits every iteration or the end of a step.
    damping : float
        Of the Gauss–Newton matrix, as a fraction of its trace; not negative.
    predictor : bool
        Whether a pseudo-solid places the vertices before they are optimised.
    ideal : {"reference", "right"}
        The angles aimed at: those of the reference position, or 90° at regular vertices.
    """

    power: int = 2
    sweeps: int = 5
    iterations: int = 1
    lower: float = 0.5
    upper: float | None = None
    penalty: float = 10.0
    radius: float = 0.2
    projection: Literal["every", "end"] = "every"
    damping: float = 0.3
    predictor: bool = True
    ideal: Literal["reference", "right"] = "reference"

    @staticmethod
    def as_published() -> AngleOptimisationSettings:
        """Return the paper's form: undamped, one sweep, no predictor, right angles."""
        return AngleOptimisationSettings(sweeps=1, iterations=5, damping=0.0, predictor=False, ideal="right")


MoverSettings: TypeAlias = PseudoSolidSettings | AngleOptimisationSettings


@dataclass(frozen=True)
class Steady:
    """No time: the state at rest is sought; expressions do not depend on t."""


@dataclass(frozen=True)
class Unsteady:
    """Equal time steps.

    Attributes
    ----------
    dt : float
        Positive.
    start, end : float
        ``end = start + steps dt``.
    steps : int
        At least 1.
    """

    dt: float
    start: float
    end: float
    steps: int


TimeSettings: TypeAlias = Steady | Unsteady


@dataclass(frozen=True)
class CouplingSettings:
    """How fluid and solid are brought to agree in every step.

    Attributes
    ----------
    acceleration : {"iqn-ils", "aitken", "constant"}
    geometry : {"extrapolated", "implicit"}
        "implicit" makes a new mesh in every coupling iteration.
    predictor : int
        Order of extrapolation of the interface displacement, 0 to 3.
    tolerance : float
        Of displacement and force, relative to the step's increment.
    max_iterations : int
    reuse : int
        Steps whose secants IQN-ILS keeps.
    filter : float
        Of the QR decomposition of the secants; 0 keeps all of them.
    relaxation : float
        First relaxation factor, in (0, 1].
    """

    acceleration: Literal["iqn-ils", "aitken", "constant"] = "iqn-ils"
    geometry: Literal["extrapolated", "implicit"] = "extrapolated"
    predictor: int = 2
    tolerance: float = 1e-6
    max_iterations: int = 50
    reuse: int = 10
    filter: float = 1e-3
    relaxation: float = 0.5


@dataclass(frozen=True)
class NonlinearSettings:
    """Newton's method: relative tolerance of the residual, largest number of iterations."""

    tolerance: float = 1e-10
    max_iterations: int = 25


@dataclass(frozen=True)
class LinearSettings:
    """The linear solver; its relative tolerance is for "amg" only."""

    solver: Literal["direct", "amg"] = "direct"
    tolerance: float = 1e-10


@dataclass(frozen=True)
class OutputSettings:
    """What is written besides the quantities.

    Attributes
    ----------
    fields, plots : bool
    every : int
        Steps between field files; the last step is always written.
    period_of : str or None
        The quantity whose period defines means, amplitudes and frequencies.
    """

    fields: bool = True
    every: int = 10
    plots: bool = True
    period_of: str | None = None


@dataclass(frozen=True)
class Point:
    """A place in the undeformed mesh, and the vertex it was named by, if any."""

    x: float
    y: float
    vertex: str | None = None


@dataclass(frozen=True)
class Probe:
    """A field at a point: a material point of a solid, a place fixed in space in a fluid.

    Attributes
    ----------
    name : str
    field : {"displacement", "velocity", "pressure"}
    component : {"x", "y", "magnitude"} or None
        None for pressure.
    at : Point
    of : {"fluid", "solid"}
    place : str
    """

    name: str
    field: Literal["displacement", "velocity", "pressure"]
    component: Literal["x", "y", "magnitude"] | None
    at: Point
    of: Literal["fluid", "solid"]
    place: str = ""


@dataclass(frozen=True)
class Force:
    """The force of the fluid on named edges, or that of solids on their surroundings at dry ones, times a factor.

    Attributes
    ----------
    name : str
    on : tuple of str
        Names of the mesh's edges: outer ones of the fluid or shared with a solid, or outer ones of solids.
    component : {"x", "y"}
    factor : float
    place : str
    """

    name: str
    on: tuple[str, ...]
    component: Literal["x", "y"]
    factor: float = 1.0
    place: str = ""


@dataclass(frozen=True)
class PressureDifference:
    """Fluid pressure at ``start`` minus that at ``end``; ``from`` and ``to`` in a scene."""

    name: str
    start: Point
    end: Point
    place: str = ""


Quantity: TypeAlias = Probe | Force | PressureDifference


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
    mover, time, coupling, nonlinear, linear, output
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
    mover: MoverSettings = field(default_factory=PseudoSolidSettings)
    coupling: CouplingSettings = field(default_factory=CouplingSettings)
    nonlinear: NonlinearSettings = field(default_factory=NonlinearSettings)
    linear: LinearSettings = field(default_factory=LinearSettings)
    output: OutputSettings = field(default_factory=OutputSettings)
    quantities: tuple[Quantity, ...] = ()
    tables: tuple[str, ...] = ()
