"""scikit-fem's quad mesh with curved elements of any order."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skfem.mesh import MeshQuad1

from hoblock.io.skfem_mapping import CurvedMapping
from hoblock.locate import Locator
from hoblock.mesh import QuadMesh

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["CurvedMeshQuad"]


@dataclass(repr=False)
class CurvedMeshQuad(MeshQuad1):  # type: ignore[misc]  # scikit-fem is untyped
    """Quads whose corners are a `skfem.MeshQuad1` and whose map is a polynomial of order p in each direction.

    Attributes
    ----------
    coordinates : ndarray, shape (e, (p + 1)², 2)
        GLL nodes of each element, lexicographic.
    order : int
    turns : ndarray, shape (e,)
        The corner of hoblock's element that is corner 0 here.
    """

    coordinates: Array = field(default_factory=lambda: np.zeros((0, 4, 2)))
    order: int = 1
    turns: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __post_init__(self) -> None:
        """Refuse corners that have left their elements, as scikit-fem's transformations would leave them."""
        super().__post_init__()
        n = self.order + 1
        corners = self.coordinates[:, [0, n - 1, n * n - 1, n * n - n]]
        if corners.shape[0] != self.t.shape[1] or not np.array_equal(
            corners, self.doflocs[:, self.t].transpose(2, 1, 0)
        ):
            raise ValueError(
                "the corners do not fit the curved elements; transform or cut the mesh in hoblock, then convert it."
            )

    @classmethod
    def from_nodes(cls, p: Array, t: Index, coordinates: Array, order: int, turns: Index) -> CurvedMeshQuad:
        """Make a mesh of corners p (2, v), elements t (4, e) and the nodes of the elements."""
        return cls(np.ascontiguousarray(p), np.ascontiguousarray(t), coordinates=coordinates, order=order, turns=turns)

    def named(self, boundaries: dict[str, Any], subdomains: dict[str, Any]) -> CurvedMeshQuad:
        """Return the mesh with names of facets and of elements."""
        names: dict[str, Any] = {"_boundaries": boundaries, "_subdomains": subdomains}
        return replace(self, **names)

    def _mapping(self) -> CurvedMapping:
        if not hasattr(self, "_cached_mapping"):
            self._cached_mapping = CurvedMapping(self, self.coordinates, self.order)
        return self._cached_mapping

    def element_finder(self, mapping: Any = None) -> Any:
        """Return a function that finds the curved elements of places (x, y), the lowest number on common sides.

        Its error is a ValueError that names a place outside the mesh.
        """
        cells = np.arange(self.coordinates.shape[0] * self.coordinates.shape[1]).reshape(len(self.coordinates), -1)
        locator = Locator(QuadMesh(self.coordinates.reshape(-1, 2), cells, self.order, {}, {}))

        def finder(*x: Array) -> NDArray[np.int32]:
            places = np.stack([np.ravel(part) for part in x], axis=-1)
            found = locator.find(places)
            if not found.found.all():
                raise ValueError(f"place {tuple(places[~found.found][0].tolist())} is outside the mesh.")
            return found.elements.astype(np.int32)

        return finder

    def _uniform(self) -> Any:
        raise NotImplementedError(
            "curved elements cannot be refined here: generate the mesh with more elements, then convert it again."
        )
