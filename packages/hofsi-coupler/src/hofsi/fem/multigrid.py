"""Geometric multigrid for velocity and pressure together, on nested meshes of the same structure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from hoblock.numbering import side_nodes
from hofsi.fem.condensation import CondensedSystem
from hofsi.fem.condensed_factor import CondensedFactor
from hofsi.fem.constraints import NodeConstraints
from hofsi.fem.element import boundary_first
from hofsi.fem.element_matrices import ElementMatrices
from hofsi.fem.nesting import Nesting, nested
from hofsi.fem.spaces import TaylorHood
from hofsi.fem.transfer import Transfer, coarse_constraints
from hofsi.linear.patches import PatchSmoother

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Single = NDArray[np.float32]

__all__ = ["GridCycle", "GridLevel", "grid_levels"]

_DIRECT = 100_000
_GAIN = 0.7  # a coarser level must not have a larger part of the unknowns


@dataclass(frozen=True, eq=False)
class GridLevel:
    """One of the nested meshes.

    Attributes
    ----------
    system : CondensedSystem
    transfer : Transfer or None
        To the next coarser mesh; None on the coarsest, whose matrix is factorised.
    patches : csr_matrix, shape (e, unknowns)
        Unknowns on the boundary of each element.
    share : ndarray, shape (unknowns,)
        One over the number of elements that have an unknown.
    """

    system: CondensedSystem
    transfer: Transfer | None
    patches: sp.csr_matrix
    share: Array


def grid_levels(
    space: TaylorHood, constraints: NodeConstraints, pinned: tuple[int, ...], places: Array, lengths: Array
) -> tuple[GridLevel, ...]:
    """Make coarser and coarser meshes until the matrix is small enough to be factorised.

    Parameters
    ----------
    space : TaylorHood
    constraints : NodeConstraints
        Of the velocity.
    pinned : tuple of int
        Pressure unknowns at vertices that are held fixed, numbered as in the space.
    places : ndarray, shape (e, 2)
        Where the elements are.
    lengths : ndarray, shape (e, 2)
        Of the elements along ξ and η.

    Returns
    -------
    tuple of GridLevel
        The finest first. There is one only if the mesh has no line of element sides that could be left out.
    """
    levels: list[GridLevel] = []
    while True:
        system = CondensedSystem(space.dofs, space.boundary, space.size, constraints, pinned, places)
        size = len(system.unknowns)
        vertices = np.unique(space.corners)
        held = vertices[np.array(pinned, dtype=np.int64) - 2 * space.velocity_count]
        small = size <= _DIRECT and levels
        nesting = (
            None if small else nested(space.corners, np.concatenate([held, _changes(space, constraints)]), lengths)
        )
        transfer = None
        if nesting is not None:
            transfer = Transfer(space, TaylorHood.on_quads(nesting.corners, space.order), nesting)
            coarser = coarse_constraints(transfer, constraints)
            if np.count_nonzero(~coarser.fixed) > _GAIN * np.count_nonzero(~constraints.fixed):
                transfer = None
        levels.append(GridLevel(system, transfer, *_patches(system)))
        if transfer is None or nesting is None:
            return tuple(levels)
        space, constraints = transfer.coarse, coarser
        number = np.searchsorted(np.unique(nesting.corners), held)
        pinned = tuple((2 * space.velocity_count + number).tolist())
        count = np.bincount(nesting.parent)
        sums = [np.bincount(nesting.parent, weights=places[:, axis]) for axis in range(2)]
        places = np.stack(sums, axis=-1) / count[:, None]
        lengths = _summed(lengths, nesting)


def _summed(lengths: Array, nesting: Nesting) -> Array:
    """Lengths (c, 2) of coarse elements from those of their parts."""
    own = np.where((nesting.turn % 2 == 1)[:, None], lengths[:, ::-1], lengths)  # as the parent counts directions
    result = np.zeros((len(nesting.corners), 2))
    for axis in range(2):  # the mean across, the sum along
        beside = nesting.part[:, 1 - axis] == 0
        np.add.at(result[:, axis], nesting.parent, np.where(beside, 1.0, 0.5) * own[:, axis])
    return result


def _patches(system: CondensedSystem) -> tuple[sp.csr_matrix, Array]:
    """Unknowns on the boundary of each element, and one over how many elements have each."""
    size = len(system.unknowns)
    rows, columns = np.nonzero(system.skeleton >= 0)
    numbers = system.skeleton[rows, columns]
    starts = np.searchsorted(rows, np.arange(len(system.skeleton) + 1))
    patches = sp.csr_matrix((np.ones(len(rows), dtype=np.int8), numbers, starts), shape=(len(system.skeleton), size))
    return patches, 1.0 / np.maximum(np.bincount(numbers, minlength=size), 1)


def _changes(space: TaylorHood, constraints: NodeConstraints) -> Index:
    """Boundary vertices at which the constraints of the velocity change."""
    corners = space.corners
    start, stop = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    keys = np.minimum(start, stop) * (int(corners.max()) + 1) + np.maximum(start, stop)
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    element, side = divmod(first[counts == 1], 4)
    local = np.argsort(boundary_first(space.order)[0])[side_nodes(space.order)[:, 1]]
    inner = space.velocity_cells[element, local[side]]
    kind = constraints.fixed[inner] @ np.array([1, 2]) + 4 * np.isin(inner, constraints.rotated)
    ends = np.concatenate([corners[element, side], corners[element, (side + 1) % 4]])
    low, high = np.full(int(corners.max()) + 1, 9), np.full(int(corners.max()) + 1, -1)
    np.minimum.at(low, ends, np.tile(kind, 2))
    np.maximum.at(high, ends, np.tile(kind, 2))
    return np.flatnonzero(high > low)


class GridCycle:
    """One V-cycle from zero for the condensed matrix, an approximate inverse.

    On every level the unknowns on the boundary of one element after the other, velocity and pressure, are solved for
    together: forward before, backward after the correction by the next coarser mesh. Its element matrices are those of
    Galerkin, its inner unknowns are eliminated as on the finest mesh. Sweeps are in single precision.

    Parameters
    ----------
    levels : sequence of GridLevel
        This one first; at least two.
    A : ndarray, shape (e, k, k), or callable
        Element matrices, or what makes them.
    S : ndarray, shape (e, b, b)
        The same after condensation.

    Raises
    ------
    LinearSolverError
        If the matrix of the coarsest mesh is singular.
    MissingExtraError
        If pyamg is not installed.

    References
    ----------
    Vanka, J. Comput. Phys. 65 (1986) 138–158, doi:10.1016/0021-9991(86)90008-2.
    John, Tobiska, Int. J. Numer. Meth. Fluids 33 (2000) 453–473,
    doi:10.1002/1097-0363(20000630)33:4<453::AID-FLD15>3.0.CO;2-0.
    """

    def __init__(self, levels: tuple[GridLevel, ...], A: ElementMatrices, S: Array) -> None:
        level = levels[0]
        assert level.transfer is not None
        self._system, self._transfer, self._share = level.system, level.transfer, level.share
        self._smoother = PatchSmoother(level.system.pattern.rows(S), level.patches, precision=np.float32, pseudo=True)
        self._coarse = _factor(levels[1:], level.transfer.matrices(A))

    def solve(self, b: Array, /) -> Array:
        """Return the result of one cycle for S x = b."""
        size = float(np.abs(b).max(initial=0.0))
        if size == 0.0:
            return np.zeros(len(b))
        right, x = (b / size).astype(np.float32), np.zeros(len(b), dtype=np.float32)
        self._smoother.sweep(x, right)
        x += self._correction(self._smoother.residual(x, right))
        self._smoother.sweep(x, right, backward=True)
        return size * x.astype(np.float64)

    def _correction(self, r: Single) -> Single:
        """What the coarser mesh finds for a residual."""
        system, transfer = self._system, self._transfer
        shared = system.rotate_back(np.append(r * self._share, 0.0)[system.skeleton])
        found = self._coarse.solve(transfer.restrict(shared))
        values = system.rotate(transfer.prolong(found[transfer.coarse.dofs]))
        result = np.zeros(len(r) + 1, dtype=np.float32)
        result[system.skeleton] = values  # number -1 is the last, which is cut off
        return result[:-1]


def _factor(levels: tuple[GridLevel, ...], A: Array) -> CondensedFactor:
    """What solves on the first of some levels: with LU on the coarsest, by a cycle on others."""
    system = levels[0].system
    if levels[0].transfer is None:
        return system.factorise(A)
    condensed = system.condensed(A)
    return CondensedFactor(system, condensed, GridCycle(levels, A, condensed.S))
