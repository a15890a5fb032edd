"""Whether supports hold solids at rest: no motion without deformation may be left free."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from hoblock import QuadMesh
from hofsi import case
from hofsi.errors import CaseError
from hofsi.fem.constraints import DirectedNodes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["check_held", "free_motion"]

_FREE = 1e-4  # of the stiffest motion: rollers on a circle of coarse elements resist a turn by their error of shape


def check_held(
    mesh: QuadMesh, solids: Sequence[case.Solid], cells: Sequence[Index], entries: Sequence[DirectedNodes]
) -> None:
    """Check that every part of the solids is held against translation and rotation.

    Parts that share nodes hold each other.

    Parameters
    ----------
    mesh : QuadMesh
    solids : sequence of Solid
    cells : sequence of ndarray
        Elements of each solid.
    entries : sequence of DirectedNodes
        Supports.

    Raises
    ------
    CaseError
        If a part can move without deforming: its displacement at rest is not determined.
    """
    count, per_cell = mesh.cells.shape
    ones, rows = np.ones(mesh.cells.size), np.repeat(np.arange(count), per_cell)
    touching = sp.csr_matrix((ones, (rows, mesh.cells.ravel())), shape=(count, len(mesh.points)))
    _, part_of = connected_components(touching @ touching.T, directed=False)
    for part in np.unique(part_of):
        own = np.unique(mesh.cells[part_of == part])
        inside = [np.isin(entry.nodes, own) for entry in entries]
        nodes = np.concatenate(
            [np.zeros(0, dtype=np.int64), *(e.nodes[k] for e, k in zip(entries, inside, strict=True))]
        )
        normals = np.concatenate([np.zeros((0, 2)), *(e.directions[k] for e, k in zip(entries, inside, strict=True))])
        motion = free_motion(mesh.points[nodes], normals)
        if motion is not None:
            solid = next(solid for solid, k in zip(solids, cells, strict=True) if (part_of[k] == part).any())
            raise CaseError(
                f"solid {solid.name!r} is not held: it can {motion} without deforming, and its steady displacement "
                'is not determined. Add a [[solid.boundary]] with type = "fixed", "displacement" or "roller"',
                f"{solid.place}.boundary",
            )


def free_motion(points: Array, normals: Array) -> str | None:
    """Describe a rigid motion that supports n·d = 0 at some points leave free; None if there is none.

    Parameters
    ----------
    points, normals : ndarray, shape (k, 2)
    """
    if not len(points):
        return "move anywhere"
    centre = points.mean(axis=0)
    x, y = (points - centre).T
    size = float(np.sqrt(np.mean(x**2 + y**2)))
    rows = np.column_stack([normals, (normals[:, 1] * x - normals[:, 0] * y) / size])
    stiffness, motions = np.linalg.eigh(rows.T @ rows)
    if stiffness[0] > _FREE**2 * stiffness[-1]:
        return None
    a, b, turn = motions[:, 0]
    if abs(turn) < _FREE * np.hypot(a, b):
        a, b = np.round([a, b], 12) + 0.0  # not -1e-17
        return f"move along ({a:.3g}, {b:.3g})"
    at = np.round(centre + size * np.array([-b, a]) / turn, 12) + 0.0
    return f"turn about ({at[0]:.3g}, {at[1]:.3g})"
