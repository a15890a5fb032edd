"""The blocks as an elastic solid (the paper's Section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.errors import MoverError
from hoblock.movers._roles import VertexRoles

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["PseudoSolid"]


@dataclass(frozen=True, eq=False)
class PseudoSolid:
    """Free vertices follow as those of a linear elastic solid in plane strain, each block one bilinear element.

    The elements are the straight-sided blocks of the reference, Young's modulus of a block of area A is
    (A/A_min)^exponent. Everything is factored once; a move is a product with a dense matrix. It starts from the
    reference, never from the last state: one position of the driven vertices has one mesh, whatever came before.

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

    Attributes
    ----------
    free : ndarray of int
        Vertices that are placed, ascending.
    matrix : ndarray, shape (2 len(free), 2 len(driven))
        Displacement of the free vertices by displacement of the driven ones, x and y interleaved; read-only.

    Raises
    ------
    MoverError
        If a parameter is out of range, or the straight-sided blocks do not have positive area.
    """

    reference: BlockStructure
    driven: Index
    exponent: float = field(default=-1.0, kw_only=True)
    poissons_ratio: float = field(default=0.3, kw_only=True)
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
        roles = VertexRoles.of(self.reference, self.driven)
        matrix = _response(self.reference, roles, _youngs_modulus(self.reference, self.exponent), self.poissons_ratio)
        matrix.setflags(write=False)
        for name, value in (("driven", roles.driven), ("free", roles.free), ("matrix", matrix), ("_roles", roles)):
            object.__setattr__(self, name, value)

    @property
    def has_free_vertices(self) -> bool:
        """Whether there is a vertex to place; if not, a move only copies the driven positions."""
        return len(self.free) > 0

    def displacement(self, driven: Array) -> Array:
        """Displacement of the free vertices, (len(free), 2), by that of the driven ones, (len(driven), 2)."""
        return np.asarray((self.matrix @ driven.reshape(-1)).reshape(-1, 2))

    def move(self, current: Array, positions: Array) -> Array:
        """Return the vertices for a position of the driven ones; see `Mover.move`. ``current`` is ignored.

        Raises
        ------
        MoverError
            If a position is not finite.
        """
        positions = self._roles.checked(positions, "positions", self.driven)
        start = self.reference.vertices
        return self._roles.assembled(positions, start[self.free] + self.displacement(positions - start[self.driven]))


def _youngs_modulus(structure: BlockStructure, exponent: float) -> Array:
    """(A/A_min)^exponent of each straight-sided block, shape (b,)."""
    corners = structure.vertices[structure.topology.quads]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    worst = int(np.argmin(area))
    if not area[worst] > 0.0:
        raise MoverError(
            f"pseudo-solid: {structure.topology.block_name(worst)} has area {area[worst]:.3g} between the "
            "chords of its edges; expected a positive area. Split its curved edges."
        )
    return np.asarray((area / area[worst]) ** exponent)


def _response(structure: BlockStructure, roles: VertexRoles, youngs_modulus: Array, poissons_ratio: float) -> Array:
    """-K_ff⁻¹ K_fd, shape (2 len(free), 2 len(driven))."""
    if not roles.free.size or not roles.driven.size:
        return np.zeros((2 * len(roles.free), 2 * len(roles.driven)))
    from scipy.sparse.linalg import splu

    K, dofs = _stiffness(structure, youngs_modulus, poissons_ratio)
    free, driven = dofs[roles.free].ravel(), dofs[roles.driven].ravel()
    rows = K[free]
    return np.asarray(splu(rows[:, free].tocsc()).solve(-rows[:, driven].toarray()))


def _stiffness(structure: BlockStructure, youngs_modulus: Array, poissons_ratio: float) -> tuple[Any, Index]:
    """Sparse stiffness matrix of the blocks and the unknowns (n, 2) of each vertex."""
    from skfem import Basis, BilinearForm, DiscreteField, ElementQuad1, ElementVector, MeshQuad
    from skfem.helpers import ddot, sym_grad, trace

    lam = poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio))
    mu = 0.5 / (1.0 + poissons_ratio)

    def work(u: Any, v: Any, w: Any) -> Any:
        strain, virtual = sym_grad(u), sym_grad(v)
        return w.E * (lam * trace(strain) * trace(virtual) + 2.0 * mu * ddot(strain, virtual))

    mesh = MeshQuad(np.ascontiguousarray(structure.vertices.T), np.ascontiguousarray(structure.topology.quads.T))
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    E = np.broadcast_to(youngs_modulus[:, None], basis.dx.shape)
    return BilinearForm(work).assemble(basis, E=DiscreteField(E)).tocsr(), basis.nodal_dofs.T
