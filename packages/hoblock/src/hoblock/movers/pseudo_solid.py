"""The blocks as an elastic solid (the paper's Section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._roles import VertexRoles
from hoblock.movers._unknowns import chain_rule
from hoblock.movers.sliding import Sliding
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["PseudoSolid"]


@dataclass(frozen=True, eq=False)
class PseudoSolid:
    """Free vertices follow as those of a linear elastic solid in plane strain, each block one bilinear element.

    The elements are the straight-sided blocks of the reference, Young's modulus of a block of area A is
    (A/A_min)^exponent. Everything is factored once; a move is a product with a dense matrix. It starts from the
    reference, never from the last state: one position of the driven vertices has one mesh, whatever came before.

    With ``incremental`` the solid is made anew of the blocks of the last state in every move, and the increment of the
    driven vertices applied to it. That reaches further, but the mesh depends on the way: it drifts.

    Parameters
    ----------
    reference : BlockStructure
        The blocks that move (the fluid's alone).
    driven : ndarray of int
        Vertices whose positions are prescribed, ascending, on the boundary or inside. Other boundary vertices stay.
    exponent : float
        Exponent m of the stiffness. The paper prints m in [1, 3], which makes small blocks soft. A negative one makes
        them stiff, which is never worse in our tests and often reaches further: -1, or -2 on O-grids.
    poissons_ratio : float
        In (-1, 0.5).
    sliding : ndarray of int, optional
        Boundary vertices that slide along their part of the boundary, ascending: the solid is held there in the normal
        direction alone. On a curved boundary they go as far along it as along its tangent.
    incremental : bool

    Attributes
    ----------
    free : ndarray of int
        Vertices inside that are placed, ascending.
    matrix : ndarray, shape (2 len(free) + len(sliding), 2 len(driven))
        Displacement of the free vertices, x and y interleaved, and of the sliding ones along their paths, by
        displacement of the driven ones, x and y interleaved; read-only. In the reference.

    Raises
    ------
    MoverError
        If a parameter is out of range, or the straight-sided blocks do not have positive area.
    """

    reference: BlockStructure
    driven: Index
    exponent: float = field(default=-1.0, kw_only=True)
    poissons_ratio: float = field(default=0.3, kw_only=True)
    sliding: Index | None = field(default=None, kw_only=True)
    incremental: bool = field(default=False, kw_only=True)
    free: Index = field(init=False)
    matrix: Array = field(init=False, repr=False)
    _roles: VertexRoles = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not -1.0 < self.poissons_ratio < 0.5:
            raise MoverError(
                f"pseudo-solid: poissons_ratio is {self.poissons_ratio:g}; expected one in (-1, 0.5). "
                "Plane strain is singular at 0.5; try 0.3."
            )
        if not np.isfinite(self.exponent):
            raise MoverError(f"pseudo-solid: exponent is {self.exponent:g}; expected a finite number, for example -1.")
        roles = VertexRoles.of(self.reference, self.driven, self.sliding)
        matrix = self._matrix(roles, self.reference.vertices, roles.sliding.start)
        matrix.setflags(write=False)
        for name, value in (("driven", roles.driven), ("free", roles.free), ("matrix", matrix), ("_roles", roles)):
            object.__setattr__(self, name, value)

    @property
    def has_free_vertices(self) -> bool:
        """Whether there is a vertex to place; if not, a move only copies the driven positions."""
        return len(self._roles.movable) > 0

    @property
    def depends_on_state(self) -> bool:
        """Whether a move depends on the last state."""
        return self.incremental

    @property
    def paths(self) -> Sliding:
        """The sliding vertices with their paths."""
        return self._roles.sliding

    @property
    def tangent_edges(self) -> Index:
        """Edges whose end tangents a move takes into account: none."""
        return np.zeros(0, dtype=np.int64)

    def response(self, driven: Array) -> tuple[Array, Array]:
        """Displacements in the reference by those of the driven vertices, (len(driven), 2).

        Returns
        -------
        free : ndarray, shape (len(free), 2)
        sliding : ndarray, shape (len(sliding),)
            Along the paths.
        """
        return _parts(self.matrix @ driven.reshape(-1), len(self.free))

    def move(self, current: Array, positions: Array, tangents: Array | None = None) -> Array:
        """Return the vertices for a position of the driven ones; see `Mover.move`.

        ``tangents`` are ignored, and so is ``current`` unless the mover is incremental.

        Raises
        ------
        MoverError
            If a position is not finite, or a block of the last state has no positive area.
        """
        roles = self._roles
        positions = roles.checked(positions, "positions", self.driven)
        start, along, matrix = self.reference.vertices, roles.sliding.start, self.matrix
        if self.incremental:
            start = roles.checked(current, "current", np.arange(len(roles.reference)))
            along = roles.sliding.coordinates(start[roles.sliding.vertices])
            matrix = self._matrix(roles, start, along)
        free, slid = _parts(matrix @ (positions - start[self.driven]).reshape(-1), len(self.free))
        return roles.assembled(positions, start[self.free] + free, along + slid)

    def _matrix(self, roles: VertexRoles, vertices: Array, along: Array) -> Array:
        """The matrix for given positions of all vertices."""
        quads = self.reference.topology.quads
        modulus = _youngs_modulus(self.reference.topology, vertices, self.exponent)
        return _response(vertices, quads, roles, modulus, self.poissons_ratio, roles.sliding.derivatives(along)[0])


def _parts(motion: Array, free: int) -> tuple[Array, Array]:
    return motion[: 2 * free].reshape(-1, 2), motion[2 * free :]


def _youngs_modulus(topology: BlockTopology, vertices: Array, exponent: float) -> Array:
    """(A/A_min)^exponent of each straight-sided block, shape (b,)."""
    corners = vertices[topology.quads]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    worst = int(np.argmin(area))
    if not area[worst] > 0.0:
        raise MoverError(
            f"pseudo-solid: {topology.block_name(worst)} has area {area[worst]:.3g} between the "
            "chords of its edges; expected a positive area. Split its curved edges."
        )
    return np.asarray((area / area[worst]) ** exponent)


def _response(
    vertices: Array, quads: Index, roles: VertexRoles, youngs_modulus: Array, poissons_ratio: float, tangents: Array
) -> Array:
    """Motion of the free and the sliding vertices by that of the driven ones; see `PseudoSolid.matrix`."""
    from scipy.sparse.linalg import splu

    count = 2 * len(roles.free) + len(roles.sliding.vertices)
    if not count or not roles.driven.size:
        return np.zeros((count, 2 * len(roles.driven)))
    K, dofs = _stiffness(vertices, quads, youngs_modulus, poissons_ratio)
    movable = roles.movable
    free, sliding = np.searchsorted(movable, roles.free), np.searchsorted(movable, roles.sliding.vertices)
    T = chain_rule(free, sliding, tangents, len(movable))
    rows = T.T @ K[dofs[movable].ravel()]
    inner, outer = (rows[:, dofs[movable].ravel()] @ T).tocsc(), rows[:, dofs[roles.driven].ravel()]
    return np.asarray(splu(inner).solve(-outer.toarray()))


def _stiffness(vertices: Array, quads: Index, youngs_modulus: Array, poissons_ratio: float) -> tuple[Any, Index]:
    """Sparse stiffness matrix of the blocks and the unknowns (n, 2) of each vertex."""
    from skfem import Basis, BilinearForm, DiscreteField, ElementQuad1, ElementVector, MeshQuad
    from skfem.helpers import ddot, sym_grad, trace

    lam = poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio))
    mu = 0.5 / (1.0 + poissons_ratio)

    def work(u: Any, v: Any, w: Any) -> Any:
        strain, virtual = sym_grad(u), sym_grad(v)
        return w.E * (lam * trace(strain) * trace(virtual) + 2.0 * mu * ddot(strain, virtual))

    mesh = MeshQuad(np.ascontiguousarray(vertices.T), np.ascontiguousarray(quads.T))
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    E = np.broadcast_to(youngs_modulus[:, None], basis.dx.shape)
    return BilinearForm(work).assemble(basis, E=DiscreteField(E)).tocsr(), basis.nodal_dofs.T
