"""How far the interface may end from where the fluid's mesh was made for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hofsi.errors import CouplingError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["InterfaceGap"]

_PART = 0.5  # of an element beside the interface


class InterfaceGap:
    """Refuses steps whose interface ends far from the mesh.

    With extrapolated geometry the mesh stands where the interface was predicted to be. The gap is of third order in the
    step and usually a small part of its increment. If it is as large as the elements beside the interface, by the root
    of their area, the flow that was found is that around another body.

    Parameters
    ----------
    mesh : QuadMesh
        Of the fluid.
    nodes : ndarray, shape (k,)
        Of the interface.
    """

    def __init__(self, mesh: QuadMesh, nodes: Index) -> None:
        x, y = np.moveaxis(mesh.points[mesh.corners], 2, 0)
        area = 0.5 * np.abs(np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1))
        size = np.full(len(mesh.points), np.inf)
        np.minimum.at(size, mesh.cells, np.sqrt(area)[:, None])
        self._size, self._points = size[nodes], mesh.points[nodes]

    def check(self, gap: Array, where: str) -> None:
        """Raise an error if a gap (k, 2) between displacement and prediction is too large.

        Raises
        ------
        CouplingError
        """
        distance = np.linalg.norm(gap, axis=1)
        if not (distance > _PART * self._size).any():
            return
        worst = int(np.argmax(distance / self._size))
        x, y = self._points[worst]
        raise CouplingError(
            f"the interface ends {distance[worst]:.3g} from where it was predicted and the mesh was made, at the point "
            f"that was at ({x:.6g}, {y:.6g}); expected less than half of the elements' size there, the root of "
            f"their area, {self._size[worst]:.3g}. Take smaller time steps, let loads begin less suddenly, or set "
            'coupling.geometry = "implicit".',
            "geometry",
            where,
        )
