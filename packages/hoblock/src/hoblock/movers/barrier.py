"""Block vertices where an energy with a barrier against turned corners is smallest."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._block_energy import BlockEnergy, BoundEnergy, LengthEnergy
from hoblock.movers._corner_energies import AngleEnergy, CornerEnergy, DistortionEnergy
from hoblock.movers._corners import block_corners, edge_vectors
from hoblock.movers._driven_tangents import check_tangents, driven_tangents, turned_tangents
from hoblock.movers._linear_response import linear_response
from hoblock.movers._newton import Minimum, minimise, untangle
from hoblock.movers._roles import VertexRoles
from hoblock.movers.sliding import Sliding

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["BarrierEnergy", "BarrierPlacement"]

_TOLERANCE = 1e-9
_ITERATIONS = 200


@dataclass(frozen=True, eq=False)
class BarrierPlacement:
    """Where a barrier energy is smallest.

    Attributes
    ----------
    vertices : ndarray, shape (n, 2)
    iterations : int
        Newton steps.
    smallest_corner : float
        Smallest cross product of the edges at a corner, relative to its value in the reference.
    strict : bool
        Whether the energy has a strict minimum there. If not it is a saddle: a neighbouring position of the driven
        vertices may have its mesh elsewhere.
    """

    vertices: Array
    iterations: int
    smallest_corner: float
    strict: bool


@dataclass(frozen=True, eq=False)
class BarrierEnergy:
    """Free vertices go where the blocks are least distorted; no block corner can close to 0° or open to 180°.

    At each corner of a block let e and f be the vectors along its edges, e₀ and f₀ those of the reference, and
    J = [e f][e₀ f₀]⁻¹. The mover minimises the mean, over all corners that a movable vertex touches, of

    * ``"bar"``: E + κ E², E = |J|²/(2 det J) - 1 + (λ/2)(det J + 1/det J - 2), zero in the reference, with κ =
      ``emphasis`` and λ = ``size_weight``;
    * ``"ang"``: sin²α₀/sin²α, α the corner's angle, plus ``length_weight`` times the mean over edges of
      ((l/l₀)² + (l₀/l)² - 2)/2: better angles. The reference is not its minimiser: the blocks relax in the first move.

    On driven edges, and on curved ones, e is the unit end tangent times the chord's length. Newton's method converges
    to round-off: the result depends on the position of what is driven, not on how it was reached, as long as the
    minimiser is unique. From a start with turned corners it first untangles them.

    Parameters
    ----------
    reference : BlockStructure
        The blocks that move (the fluid's alone).
    driven : ndarray of int
        Vertices whose positions are prescribed, ascending, on the boundary or inside.
    edges : ndarray of int, optional
        Driven edges, whose end tangents `move` takes; by default the boundary edges between driven vertices.
    tangents : ndarray, shape (len(edges), 2, 2), optional
        Their unit end tangents in the reference, in the direction of the edges; by default from the edges' curves.
    sliding : ndarray of int, optional
        Boundary vertices that slide along their part of the boundary, ascending.
    energy : {"bar", "ang"}
    size_weight, emphasis, length_weight : float
        λ, κ and the weight of the lengths.
    warm : bool
        Whether a move starts from the last state instead of the reference: fewer iterations, and at extreme positions
        the branch that the last state is on.

    Attributes
    ----------
    free : ndarray of int
        Vertices inside that are placed, ascending.

    Raises
    ------
    MoverError
        If a parameter is out of range, or a corner of the reference is not between 0° and 180°.
    """

    reference: BlockStructure
    driven: Index
    edges: Index | None = field(default=None, kw_only=True)
    tangents: Array | None = field(default=None, kw_only=True)
    sliding: Index | None = field(default=None, kw_only=True)
    energy: Literal["bar", "ang"] = field(default="bar", kw_only=True)
    size_weight: float = field(default=1.0, kw_only=True)
    emphasis: float = field(default=1.0, kw_only=True)
    length_weight: float = field(default=0.1, kw_only=True)
    warm: bool = field(default=True, kw_only=True)
    free: Index = field(init=False)
    _edges: Index = field(init=False, repr=False)
    _tangents: Array = field(init=False, repr=False)
    _block: BlockEnergy = field(init=False, repr=False)
    _response: Array = field(init=False, repr=False)
    _length: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._check()
        structure = self.reference
        roles = VertexRoles.of(structure, self.driven, self.sliding)
        edges, tangents = driven_tangents(structure, roles, self.edges, self.tangents)
        corners = block_corners(structure, roles.movable, edges, tangents)
        start = corners.vectors(structure.vertices, tangents, structure.vertices)
        cross = start[0] * start[3] - start[1] * start[2]
        if not (cross > 0.0).all():
            k = int(np.argmin(cross))
            raise MoverError(
                f"barrier: the corner at vertex '{roles.names[corners.vertices[k, 0]]}' of "
                f"{structure.topology.block_name(int(corners.blocks[k]))} is not between 0° and 180° in the reference; "
                "expected blocks whose edges leave their vertices in such angles. Move the vertex, or split the block."
            )
        energy: CornerEnergy
        lengths = None
        if self.energy == "bar":
            energy = DistortionEnergy(start, self.size_weight, self.emphasis)
        else:
            energy = AngleEnergy(start)
            around = edge_vectors(structure, roles.movable)
            squares = (around.vectors(structure.vertices) ** 2).sum(axis=0)
            lengths = LengthEnergy(around, squares, self.length_weight) if len(squares) else None
        block = BlockEnergy(roles, corners, energy, lengths)
        for name, value in (
            ("driven", roles.driven),
            ("free", roles.free),
            ("_edges", edges),
            ("_tangents", tangents),
            ("_block", block),
            ("_response", linear_response(structure, roles)),
            ("_length", float(np.ptp(structure.vertices, axis=0).max())),
        ):
            object.__setattr__(self, name, value)

    @property
    def has_free_vertices(self) -> bool:
        """Whether there is a vertex to place; if not, a move only copies the driven positions."""
        return self._block.size > 0

    @property
    def depends_on_state(self) -> bool:
        """Whether a move depends on the last state: no, but where the minimiser is not unique."""
        return False

    @property
    def paths(self) -> Sliding:
        """The sliding vertices with their paths."""
        return self._block.roles.sliding

    @property
    def tangent_edges(self) -> Index:
        """Edges whose end tangents a move takes into account."""
        return self._edges

    def move(self, current: Array, positions: Array, tangents: Array | None = None) -> Array:
        """Return the vertices for a position of the driven ones; see `Mover.move` and `place`."""
        return self.place(current, positions, tangents).vertices

    def place(self, current: Array, positions: Array, tangents: Array | None = None) -> BarrierPlacement:
        """Place the free and the sliding vertices.

        Parameters
        ----------
        current : ndarray, shape (n, 2)
            Vertices of the last state, a start.
        positions : ndarray, shape (len(driven), 2)
        tangents : ndarray, shape (len(edges), 2, 2), optional
            Unit end tangents of the driven edges; without them they turn with the edges' chords.

        Raises
        ------
        MoverError
            If an argument is not finite, or no position of the vertices makes all corners of blocks valid.
        """
        block, roles = self._block, self._block.roles
        current = roles.checked(current, "current", np.arange(len(roles.reference)))
        positions = roles.checked(positions, "positions", self.driven)
        if tangents is not None:
            tangents = np.asarray(tangents, dtype=float)
            check_tangents(tangents, self._edges, self.reference.topology)
        if not block.size:
            return BarrierPlacement(roles.assembled(positions, np.zeros((0, 2))), 0, np.inf, True)
        bound = block.bound(positions, tangents)
        total, found = 0, None
        for state in [current, roles.reference] if self.warm else [roles.reference]:
            found = self._minimum(bound, state, positions)
            total += found.iterations
            if found.converged:
                break
        assert found is not None
        if not found.converged:
            raise MoverError(self._failure(bound, found.y))
        smallest = bound.value(found.y, 0.0)[1]
        return BarrierPlacement(block.vertices(positions, found.y), total, smallest, found.strict)

    def velocity(
        self,
        vertices: Array,
        driven_velocity: Array,
        tangents: Array | None = None,
        tangent_velocity: Array | None = None,
    ) -> Array:
        """Exact velocity of all vertices at a state that `move` returned.

        With K the Hessian of the energy, ẏ = -K⁻¹ ∂g/∂b ḃ, b the positions of the driven vertices and the end tangents
        of the driven edges.

        Parameters
        ----------
        vertices : ndarray, shape (n, 2)
        driven_velocity : ndarray, shape (len(driven), 2)
        tangents, tangent_velocity : ndarray, shape (len(edges), 2, 2), optional
            End tangents of the driven edges and their time derivatives; by default they turn with the chords.

        Returns
        -------
        ndarray, shape (n, 2)

        Raises
        ------
        MoverError
            If the energy has no strict minimum at the state.
        """
        roles, block = self._block.roles, self._block
        vertices = roles.checked(vertices, "vertices", np.arange(len(roles.reference)))
        motion = roles.checked(driven_velocity, "driven_velocity", self.driven)
        result = np.zeros_like(vertices)
        result[self.driven] = motion
        if not block.size:
            return result
        if tangents is None or tangent_velocity is None:
            tangents, tangent_velocity = turned_tangents(self.reference, self._edges, self._tangents, vertices, result)
        bound, y = block.bound(vertices[self.driven], tangents), block.unknowns(vertices)
        change = block.corners.velocities(vertices, result, tangents, tangent_velocity)
        lengths = None if block.lengths is None else block.lengths.edges.vectors(result)
        rate = bound.response(y, change, lengths)
        if rate is None:
            raise MoverError(
                "barrier: the energy has no strict minimum at the given vertices; expected vertices that move returned."
            )
        split = 2 * len(self.free)
        result[self.free] = rate[:split].reshape(-1, 2)
        along = roles.sliding.derivatives(y[split:])[0]
        result[roles.sliding.vertices] = rate[split:, None] * along
        return result

    def _minimum(self, bound: BoundEnergy, state: Array, positions: Array) -> Minimum:
        """Minimise from a state, with its vertices moved as the reference's would first, if that is better."""
        here = self._block.unknowns(state)
        ahead = here + self._response @ (positions - state[self.driven]).reshape(-1)
        options = {"length": self._length, "tolerance": _TOLERANCE}
        y, spent = next((y for y in (ahead, here) if bound.value(y, 0.0)[1] > 0.0), None), 0
        if y is None:
            free = untangle(bound, ahead, **options)
            if not free.converged:
                return free
            y, spent = free.y, free.iterations
        found = minimise(bound, y, 0.0, iterations=_ITERATIONS, **options)
        return replace(found, iterations=spent + found.iterations)

    def _failure(self, bound: BoundEnergy, y: Array) -> str:
        """Message of a failed move, with the corner that is worst where it ended."""
        corners, roles = self._block.corners, self._block.roles
        z = bound.corner_vectors(y)
        d = z[0] * z[3] - z[1] * z[2]
        k = int(np.argmin(d))
        angle = np.degrees(np.arctan2(d[k], z[0, k] * z[2, k] + z[1, k] * z[3, k]))
        turned = int((d <= 0.0).sum())
        state = f"{turned} corners of blocks are turned over" if turned else "Newton's method does not converge"
        block = self.reference.topology.block_name(int(corners.blocks[k]))
        vertex = roles.names[corners.vertices[k, 0]]
        return (
            f"barrier: found no valid place for the {len(roles.movable)} vertices: {state}, the worst at vertex "
            f"'{vertex}' of {block}, {angle:.3g}°. Check that the driven edges cross neither each other nor a wall;"
            " else move in smaller steps, let vertices slide, or use more blocks around the body."
        )

    def _check(self) -> None:
        """Raise for a parameter that is out of range."""
        checks: tuple[tuple[str, object, bool, str], ...] = (
            ("energy", self.energy, self.energy in ("bar", "ang"), "'bar' or 'ang'"),
            ("size_weight", self.size_weight, 0.0 <= self.size_weight < np.inf, "a number >= 0"),
            ("emphasis", self.emphasis, 0.0 <= self.emphasis < np.inf, "a number >= 0"),
            ("length_weight", self.length_weight, 0.0 < self.length_weight < np.inf, "a positive number"),
        )
        for name, value, good, expected in checks:
            if not good:
                raise MoverError(f"barrier: {name} is {value!r}; expected {expected}.")
