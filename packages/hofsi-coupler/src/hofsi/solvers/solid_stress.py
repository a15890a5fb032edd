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
        parameters = np.empty((4, len(mesh.cells), 1))
        for solid in solids:
            cells = np.concatenate([mesh.cell_groups[name] for name in solid.blocks])
            stress = solid.plane == "stress"
            lame, mu = kernel.plane_lame_parameters(solid.youngs_modulus, solid.poissons_ratio, stress=stress)
            across = 0.0 if stress else lame / (2.0 * (lame + mu))  # S_zz/(S_xx + S_yy)
            following = 0.0 if solid.model == "linear" else 1.0
            parameters[:, cells] = np.array([lame, mu, following, across])[:, None, None]
        self._lame_lambda, self._lame_mu, self._m, self._across = parameters

    def cauchy(self, displacement: Array) -> Array:
        """Cauchy stress F S Fᵀ/det F at the nodes.

        Parameters
        ----------
        displacement : ndarray, shape (n, 2)

        Returns
        -------
        ndarray, shape (n, 4)
            xx, yy, zz, xy. That of linear solids is the stress of their law; in plane stress it is referred to the
            undeformed thickness.
        """
        mesh = self._mesh
        H = kernel.displacement_gradient(displacement[mesh.cells], self._table.dN, self._J_inv)
        S = kernel.stress(H, self._lame_lambda, self._lame_mu, self._m)
        F = kernel.deformation_gradient(H, self._m)
        det_F = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
        tensor = np.stack([S[..., [0, 2]], S[..., [2, 1]]], axis=-2)
        pushed = F @ tensor @ F.swapaxes(-1, -2)
        across = self._across * (S[..., 0] + S[..., 1])
        sigma = np.stack([pushed[..., 0, 0], pushed[..., 1, 1], across, pushed[..., 0, 1]], axis=-1) / det_F[..., None]
        result = np.zeros((len(mesh.points), 4))
        np.add.at(result, mesh.cells, sigma)
        return result * self._share[:, None]


def von_mises(sigma: Array) -> Array:
    """Equivalent stress of von Mises, shape (...), of stresses (..., 4): xx, yy, zz, xy."""
    xx, yy, zz, xy = np.moveaxis(sigma, -1, 0)
    return np.asarray(np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2))
