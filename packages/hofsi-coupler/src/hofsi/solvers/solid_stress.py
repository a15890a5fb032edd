"""Stress in elastic solids at the nodes of their mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_gradient
from hofsi import case
from hofsi.fem.element import ElementTable
from hofsi.fem.geometry import element_geometry
from hofsi.kernels import elasticity as kernel
from hofsi.solvers.solid_laws import SolidLaws

Array = NDArray[np.float64]

__all__ = ["SolidStress", "von_mises"]


class SolidStress:
    """Cauchy stress of displacements, averaged where elements meet, two solids included.

    Parameters
    ----------
    mesh : QuadMesh
        Undeformed; solid blocks only.
    solids : sequence of Solid
    """

    def __init__(self, mesh: QuadMesh, solids: Sequence[case.Solid]) -> None:
        self._mesh = mesh
        nodes = gauss_lobatto(mesh.order)
        grid = np.stack(np.meshgrid(nodes, nodes, indexing="xy"), axis=-1).reshape(-1, 2)
        self._table = ElementTable(
            mesh.order, grid, np.ones(len(grid)), tensor_basis(nodes, grid), tensor_gradient(nodes, grid)
        )
        self._J_inv = element_geometry(mesh.coordinates, self._table).J_inv
        self._share = 1.0 / np.bincount(mesh.cells.ravel(), minlength=len(mesh.points))
        cells = [np.unique(np.concatenate([mesh.cell_groups[name] for name in solid.blocks])) for solid in solids]
        self._laws = SolidLaws(len(mesh.cells), solids, cells)

    def cauchy(self, displacement: Array) -> Array:
        """Cauchy stress F S Fᵀ/J at the nodes.

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)

        Returns
        -------
        ndarray, shape (n, 4)
            xx, yy, zz, xy. That of linear solids is the stress of their law; in plane stress that of St.
            Venant–Kirchhoff solids is referred to the undeformed thickness, that of neo-Hookean ones to their own.
        """
        mesh = self._mesh
        H = kernel.displacement_gradient(displacement[mesh.cells], self._table.dN, self._J_inv)
        S = self._laws.stress(H)
        F = kernel.deformation_gradient(H, self._laws.m)
        across, thickness = self._laws.out_of_plane(H, S)
        J = thickness * (F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0])
        tensor = np.stack([S[..., [0, 2]], S[..., [2, 1]]], axis=-2)
        pushed = F @ tensor @ F.swapaxes(-1, -2)
        sigma = np.stack([pushed[..., 0, 0], pushed[..., 1, 1], across, pushed[..., 0, 1]], axis=-1) / J[..., None]
        result = np.zeros((len(mesh.points), 4))
        np.add.at(result, mesh.cells, sigma)
        return result * self._share[:, None]


def von_mises(sigma: Array) -> Array:
    """Equivalent stress of von Mises, shape (...), of stresses (..., 4): xx, yy, zz, xy."""
    xx, yy, zz, xy = np.moveaxis(sigma, -1, 0)
    return np.asarray(np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2))
