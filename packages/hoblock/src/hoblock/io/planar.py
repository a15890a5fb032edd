"""Points of files in the plane."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.errors import MeshFileError

Array = NDArray[np.float64]

__all__ = ["planar"]


def planar(path: str | Path, points: Array) -> Array:
    """Return x and y of points (n, 2) or (n, 3) whose z is the same everywhere.

    Raises
    ------
    MeshFileError
        If it is not.
    """
    points = np.asarray(points, dtype=float)
    if points.shape[1] == 3 and len(points):
        low, high = float(points[:, 2].min()), float(points[:, 2].max())
        size = float(np.ptp(points[:, :2], axis=0).max())
        if not high - low <= 1e-9 * size:
            raise MeshFileError(
                f"{path}: z runs from {low:g} to {high:g}; expected a plane mesh, z the same everywhere. Save the face "
                "alone, or turn it into the x-y plane."
            )
    return np.array(points[:, :2])
