"""The blocks' angles, optimised vertex by vertex (the paper's Section 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._roles import VertexRoles
from hoblock.movers._vertex_patches import VertexPatches, vertex_patches
from hoblock.movers.pseudo_solid import PseudoSolid
from hoblock.movers.sliding import Sliding

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.int64]

__all__ = ["AngleOptimisation"]


@dataclass(frozen=True, eq=False)
class AngleOptimisation:
    """Free vertices are placed one after the other so that the angles of the blocks around them stay good.

    At a vertex x, h collects the errors |α - D|^power of all angles of its blocks but the one opposite x in each, and a
    penalty C (|x - a|² - limit²)² for each edge to a neighbour a outside its length limits. Gauss–Newton steps

        x ← P(x - (JᵀJ + damping·trace(JᵀJ) I)⁻¹ Jᵀh),    J = ∂h/∂x

    reduce |h|², where P moves a point back to a circle about its start. The paper prints J h instead of Jᵀh in the
    step, which has no meaning for a J that is not square. The angles lie in (-90°, 270°], so that a corner just turned
    over has a small negative angle.

    The defaults are not the paper's: they damp the step, repeat it in several sweeps, start from a pseudo-solid
    increment and keep the *reference* angles. Use `as_published` for the paper's form. The last valid state of a mesh
    of order 4, moved in 60 equal steps over a test's range, is

    ==============================================  ========  ============  ==============
    test                                            defaults  as published  `PseudoSolid`
    ==============================================  ========  ============  ==============
    plate 1 × 0.02 in a box: translation, gap 0.99      0.97          0.63            0.84
    the same: rotation                                   66°           51°             48°
    the same: bending to an arc                         193°          162°            135°
    Wall–Ramm flap: slope (benchmark 0.167)             0.60          0.26            0.28
    ==============================================  ========  ============  ==============

    The result depends on how it was reached: after 50 cycles of the benchmark's tip motion (±1.3 for a flap of
    length 4, 60 steps a cycle) a vertex is 0.27 away from where it began, as published 1.5; a `PseudoSolid` returns to
    round-off. Shorter steps drift less. With ``ideal="right"`` the reference is not at rest: the mesh relaxes during
    the first moves.

    Parameters
    ----------
    reference : BlockStructure
        The blocks that move (the fluid's alone).
    driven : ndarray of int
        Vertices whose positions are prescribed, ascending, on the boundary or inside. Other boundary vertices stay.
    power : int
        Exponent n of the angle errors: even, as the paper asks, or 1. With n >= 2 the squares of the errors are squared
        once more: the Hessian vanishes where the angles are good, and the vertices jerk however short the steps; 1
        moves them more smoothly.
    sweeps : int
        Gauss–Seidel sweeps over the free vertices in a move. Vertices without a common block are placed together.
    iterations : int
        Steps at a vertex in a sweep.
    lower, upper : float
        Limits of the lengths of the edges at a free vertex, as fractions of the reference lengths. No ``upper`` by
        default; a lower limit is required, since angles alone let edges shrink to nothing.
    penalty : float
        C times the fourth power of the edge's reference length, in squared radians for power 2.
    radius : float
        Largest distance of a free vertex from its start in a move (its place in the last state, or where the predictor
        puts it), as a fraction of the shortest reference edge at the vertex.
    projection : {"every", "end"}
        Whether P is applied in every step or once at the end.
    damping : float
        0 is plain Gauss–Newton.
    predictor : bool
        Start from the last state plus the increment of a `PseudoSolid` with its default stiffness.
    ideal : {"reference", "right"}
        The angle D. "reference": the angle between the chords of the reference. "right": 90° at regular vertices, the
        reference angle at others. A vertex is regular if the mean reference angle of its blocks is within 15° of 90°:
        four blocks inside, two at a straight wall, one in a corner, three around a re-entrant corner.
    sliding : ndarray of int, optional
        Boundary vertices that slide along their part of the boundary, ascending: their steps follow its tangent.

    Attributes
    ----------
    free : ndarray of int
        Vertices inside that are placed, ascending.

    Raises
    ------
    MoverError
        If a parameter is out of range.
    """

    reference: BlockStructure
    driven: Index
    power: int = field(default=2, kw_only=True)
    sweeps: int = field(default=5, kw_only=True)
    iterations: int = field(default=1, kw_only=True)
    lower: float = field(default=0.5, kw_only=True)
    upper: float | None = field(default=None, kw_only=True)
    penalty: float = field(default=10.0, kw_only=True)
    radius: float = field(default=0.2, kw_only=True)
    projection: Literal["every", "end"] = field(default="every", kw_only=True)
    damping: float = field(default=0.3, kw_only=True)
    predictor: bool = field(default=True, kw_only=True)
    ideal: Literal["reference", "right"] = field(default="reference", kw_only=True)
    sliding: Index | None = field(default=None, kw_only=True)
    free: Index = field(init=False)
    _roles: VertexRoles = field(init=False, repr=False)
    _patches: tuple[VertexPatches, ...] = field(init=False, repr=False)
    _limits: Array = field(init=False, repr=False)
    _solid: PseudoSolid | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._check()
        roles = VertexRoles.of(self.reference, self.driven, self.sliding)
        solid = PseudoSolid(self.reference, roles.driven, sliding=self.sliding) if self.predictor else None
        limits = self.radius * _shortest_edges(self.reference)
        patches = vertex_patches(self.reference, roles.movable, _ideal_angles(self.reference, self.ideal))
        for name, value in (
            ("driven", roles.driven),
            ("free", roles.free),
            ("_roles", roles),
            ("_patches", patches),
            ("_limits", limits),
            ("_solid", solid),
        ):
            object.__setattr__(self, name, value)

    @staticmethod
    def as_published(
        reference: BlockStructure,
        driven: Index,
        *,
        power: int = 2,
        sweeps: int = 1,
        iterations: int = 5,
        lower: float = 0.5,
        upper: float | None = None,
        penalty: float = 10.0,
        radius: float = 0.2,
        projection: Literal["every", "end"] = "every",
        sliding: Index | None = None,
    ) -> AngleOptimisation:
        """Return the mover in the paper's form: undamped, from the last state, 90° wherever it is possible.

        The paper gives no numbers for the parameters listed here; see the class for their meaning.
        """
        return AngleOptimisation(
            reference,
            driven,
            power=power,
            sweeps=sweeps,
            iterations=iterations,
            lower=lower,
            upper=upper,
            penalty=penalty,
            radius=radius,
            projection=projection,
            damping=0.0,
            predictor=False,
            ideal="right",
            sliding=sliding,
        )

    @property
    def has_free_vertices(self) -> bool:
        """Whether there is a vertex to place; if not, a move only copies the driven positions."""
        return len(self._roles.movable) > 0

    @property
    def depends_on_state(self) -> bool:
        """Whether a move depends on the last state."""
        return True

    @property
    def paths(self) -> Sliding:
        """The sliding vertices with their paths."""
        return self._roles.sliding

    @property
    def tangent_edges(self) -> Index:
        """Edges whose end tangents a move takes into account: none."""
        return np.zeros(0, dtype=np.int64)

    def move(self, current: Array, positions: Array, tangents: Array | None = None) -> Array:
        """Return the vertices for a position of the driven ones; see `Mover.move`. ``tangents`` are ignored.

        Raises
        ------
        MoverError
            If a position is not finite, or vertices that coincide leave a vertex without an angle.
        """
        roles = self._roles
        current = roles.checked(current, "current", np.arange(len(roles.reference)))
        positions = roles.checked(positions, "positions", self.driven)
        start, along = current[self.free], roles.sliding.coordinates(current[roles.sliding.vertices])
        if self._solid is not None:
            free, slid = self._solid.response(positions - current[self.driven])
            start, along = start + free, along + slid
        vertices = roles.assembled(positions, start, along)
        points = vertices.view(np.complex128)[:, 0]
        self._optimise(points)
        return vertices

    def _optimise(self, points: Complex) -> None:
        """Move the free and sliding vertices in place: Gauss-Seidel sweeps of local steps."""
        origin = points.copy()
        every = self.projection == "every"
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(self.sweeps):
                for patch in self._patches:
                    for _ in range(self.iterations):
                        self._step(points, patch, origin if every else None)
        if not every:
            some = self._roles.movable
            points[some] = _projected(points[some], origin[some], self._limits[some])
            self._return_to_paths(points, some)

    def _step(self, points: Complex, patch: VertexPatches, origin: Complex | None) -> None:
        equations = patch.normal_equations(points, self.power, self.lower, self.upper, self.penalty)
        vertices = patch.vertices
        step = equations.step(self.damping)
        slides = np.isin(vertices, self._roles.sliding.vertices)
        if slides.any():
            step[slides] = equations.step_along(self._tangents(points)[vertices], self.damping)[slides]
        placed = points[vertices] - step
        if origin is not None:
            placed = _projected(placed, origin[vertices], self._limits[vertices])
        finite = np.isfinite(placed)
        if not finite.all():
            vertex = int(vertices[np.argmin(finite)])
            x = points[vertex]
            raise MoverError(
                f"angle optimisation: vertex '{self._roles.names[vertex]}' at ({x.real:g}, {x.imag:g}) has no finite "
                "step; expected neighbours at a distance. Vertices of its blocks coincide: move in smaller steps."
            )
        points[vertices] = placed
        if slides.any():
            self._return_to_paths(points, vertices)

    def _tangents(self, points: Complex) -> Complex:
        """Unit tangents of the paths at the sliding vertices; zero at all others."""
        sliding, result = self._roles.sliding, np.zeros_like(points)
        s = sliding.coordinates(_pairs(points[sliding.vertices]))
        t = sliding.derivatives(s)[0]
        result[sliding.vertices] = t[:, 0] + 1j * t[:, 1]
        return result

    def _return_to_paths(self, points: Complex, vertices: Index) -> None:
        """Put sliding vertices on their paths again: a step along the tangent leaves a curved one."""
        sliding = self._roles.sliding
        some = np.isin(sliding.vertices, vertices)
        back = sliding.positions(sliding.coordinates(_pairs(points[sliding.vertices])))
        points[sliding.vertices[some]] = back[some, 0] + 1j * back[some, 1]

    def _check(self) -> None:
        """Raise for a parameter that is out of range."""
        upper = np.inf if self.upper is None else self.upper
        checks: tuple[tuple[str, object, bool, str], ...] = (
            ("power", self.power, self.power == 1 or (self.power >= 2 and self.power % 2 == 0), "1 or an even integer"),
            ("sweeps", self.sweeps, self.sweeps >= 1, "an integer >= 1"),
            ("iterations", self.iterations, self.iterations >= 1, "an integer >= 1"),
            ("lower", self.lower, 0.0 < self.lower <= 1.0, "a fraction of the reference length in (0, 1]"),
            ("upper", self.upper, upper >= 1.0, "None or a multiple >= 1 of the reference length"),
            ("penalty", self.penalty, 0.0 <= self.penalty < np.inf, "a number >= 0"),
            ("radius", self.radius, self.radius > 0.0, "a positive fraction of the shortest edge"),
            ("damping", self.damping, 0.0 <= self.damping < np.inf, "a number >= 0"),
            ("projection", self.projection, self.projection in ("every", "end"), "'every' or 'end'"),
            ("ideal", self.ideal, self.ideal in ("reference", "right"), "'reference' or 'right'"),
        )
        for name, value, good, expected in checks:
            if not good:
                raise MoverError(f"angle optimisation: {name} is {value!r}; expected {expected}.")


def _pairs(points: Complex) -> Array:
    """Complex points as (k, 2)."""
    return np.stack([points.real, points.imag], axis=-1)


def _projected(points: Complex, center: Complex, radius: Array) -> Complex:
    """Points outside the circles moved to them."""
    offset = points - center
    distance = np.abs(offset)
    return np.where(distance > radius, center + offset * (radius / np.maximum(distance, radius)), points)


def _shortest_edges(structure: BlockStructure) -> Array:
    """Length of the shortest block edge at each vertex, shape (n,)."""
    edges, vertices = structure.topology.edges, structure.vertices
    length = np.hypot(*(vertices[edges[:, 1]] - vertices[edges[:, 0]]).T)
    shortest = np.full(len(vertices), np.inf)
    for k in range(2):
        np.minimum.at(shortest, edges[:, k], length)
    return shortest


def _ideal_angles(structure: BlockStructure, ideal: str) -> Array:
    """Angle D of each block corner, shape (b, 4), in radians."""
    topology = structure.topology
    corners = structure.vertices[topology.quads].copy().view(np.complex128)[..., 0]
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    angles = np.angle(before * after.conj())
    if ideal == "reference":
        return angles
    blocks = np.bincount(topology.quads.ravel())
    mean = np.bincount(topology.quads.ravel(), weights=angles.ravel()) / blocks
    regular = np.abs(mean - 0.5 * np.pi) < np.radians(15.0)
    return np.where(regular[topology.quads], 0.5 * np.pi, angles)
