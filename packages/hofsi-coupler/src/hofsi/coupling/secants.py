"""Secants of the coupling's residual within a step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

__all__ = ["Secants"]


class Secants:
    """Differences of successive residuals and of successive images d̃ in the step at hand, newest first, filtered (QR2).

    Parameters
    ----------
    filter : float
        A column whose part orthogonal to the newer ones is below this fraction of it is dropped for good.

    Attributes
    ----------
    columns : list of (ndarray, ndarray), shape (k,) each
        Differences v of residuals and w of images, scaled to ‖v‖ = 1.
    dropped : int
        Columns dropped so far, in all steps.

    References
    ----------
    Haelterman, Bogaers, Scheufele, Uekermann, Mehl, Comput. Struct. 171 (2016) 9–17 (QR2),
    doi:10.1016/j.compstruc.2016.04.001.
    """

    def __init__(self, filter: float) -> None:
        self._filter = filter
        self._last: tuple[Array, Array] | None = None
        self.columns: list[tuple[Array, Array]] = []
        self.dropped = 0

    @property
    def residuals(self) -> Array:
        """V: the differences v side by side, shape (k, m)."""
        return np.stack([v for v, _ in self.columns], axis=1)

    def begin_step(self) -> None:
        """Start without columns."""
        self.columns, self._last = [], None

    def add(self, residual: Array, image: Array) -> None:
        """Add the column of an iteration, and drop those that newer ones make superfluous."""
        last, self._last = self._last, (residual.copy(), image.copy())
        if last is None:
            return
        v, w = residual - last[0], image - last[1]
        length = np.linalg.norm(v)
        if length == 0.0:
            return
        self.columns.insert(0, (v / length, w / length))
        keep = self._independent(np.stack([v for v, _ in self.columns], axis=1))
        self.columns = [column for column, stays in zip(self.columns, keep, strict=True) if stays]
        self.dropped += int((~keep).sum())

    def _independent(self, V: Array) -> NDArray[np.bool_]:
        """Columns that are independent enough of newer ones; at most as many as there are rows."""
        keep: NDArray[np.bool_] = np.arange(V.shape[1]) < V.shape[0]
        while True:
            kept = np.flatnonzero(keep)
            weak = kept[np.abs(np.diag(np.linalg.qr(V[:, kept], mode="r"))) < self._filter]
            if not weak.size:
                return keep
            keep[weak[0]] = False  # the newest of them; those behind it may stand without it
