"""Interface quasi-Newton with a multi-vector inverse Jacobian (IMVJ), in factors of low rank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hofsi.coupling.secants import Secants

Array = NDArray[np.float64]

__all__ = ["JacobianMemory", "MultiVector"]

_CARE = 0.1  # what a failure leaves of the first relaxation factor


@dataclass(frozen=True, eq=False)
class JacobianMemory:
    """The inverse Jacobian of the step before, in factors.

    Attributes
    ----------
    left : ndarray, shape (k, m), or None
        A; None if there is none.
    right : ndarray, shape (m, k), or None
        B.
    steps : int
        Since the last compression.
    dropped : int
        Secants dropped so far.
    """

    left: Array | None
    right: Array | None
    steps: int
    dropped: int


class MultiVector:
    """IMVJ: the inverse Jacobian of the step before, corrected by the secants of the step at hand.

    J maps differences of residuals to differences of images d̃. Of all matrices that fulfil the secants of the step,
    J V = W, the one next to the J⁰ of the step before in the Frobenius norm is taken,

        J = J⁰ + (W - J⁰ V) V⁺,

    and the next iterate is d̃ - J r. No matrix of the interface's size is formed: J is A B with the columns W - J⁰ V of
    all steps side by side in A and the rows of V⁺ in B, one of each a secant. After ``restart`` steps the product is
    replaced by its singular value decomposition without the singular values below ``filter`` times the largest (RS-SVD
    in the second reference), so that memory and time a step stay bounded.

    Parameters
    ----------
    restart : int
        Steps after which J is compressed; 0 to forget it after every step.
    filter : float
        Of the secants, see `Secants`, and of the singular values.
    relaxation : float
        Factor of the residual while there are no secants; a tenth of it after each failure until a step converges: a
        first iterate that is far off can be more than the solid bears.

    References
    ----------
    Bogaers, Kok, Reddy, Franz, Comput. Methods Appl. Mech. Eng. 279 (2014) 40–61, doi:10.1016/j.cma.2013.11.007;
    Scheufele & Mehl, SIAM J. Sci. Comput. 39 (2017) S404–S433, doi:10.1137/16M1064945;
    Spenke, Hosters, Behr, Comput. Methods Appl. Mech. Eng. 361 (2020) 112824, doi:10.1016/j.cma.2020.112824.
    """

    def __init__(self, restart: int, filter: float, relaxation: float) -> None:
        self._restart, self._filter, self._relaxation = restart, filter, relaxation
        self._secants = Secants(filter)
        self._care = 1.0  # factor of the relaxation: smaller after failures
        self._left: Array | None = None  # A, shape (k, m)
        self._right: Array | None = None  # B, shape (m, k)
        self._steps = 0  # since the last compression

    @property
    def rank(self) -> int:
        """Columns of the factors that are kept from step to step."""
        return 0 if self._left is None else self._left.shape[1]

    def begin_step(self) -> None:
        """Start a step without secants of its own."""
        self._secants.begin_step()

    def next(self, d: Array, residual: Array) -> Array:
        """Return the next iterate after ``d`` with the residual d̃ - d."""
        image = d + residual
        self._secants.add(residual, image)
        if self._left is None and not self._secants.columns:
            return d + self._care * self._relaxation * residual
        change = self._kept(residual)
        if self._secants.columns:
            left, right = self._update()
            c = right @ residual
            change = change + left @ c
            if self._care < 1.0:  # nothing is kept then
                change = change + (1.0 - self._care) * (residual - self._secants.residuals @ c)
        return np.asarray(image - change)

    def _kept(self, v: Array) -> Array:
        """J⁰ v, v of shape (k,) or (k, m)."""
        if self._left is None or self._right is None:
            return np.zeros_like(v)
        return np.asarray(self._left @ (self._right @ v))

    def _update(self) -> tuple[Array, Array]:
        """Factors W - J⁰ V and V⁺ of the step at hand."""
        V, W = (np.stack(part, axis=1) for part in zip(*self._secants.columns, strict=True))
        return W - self._kept(V), np.linalg.pinv(V)

    def end_step(self) -> None:
        """Add the step's update to what is kept, and compress that from time to time."""
        self._care = 1.0
        if self._secants.columns and self._restart:
            left, right = self._update()
            if self._left is not None and self._right is not None:
                left, right = np.hstack([self._left, left]), np.vstack([self._right, right])
            self._left, self._right = left, right
            self._steps += 1
            if self._steps >= self._restart:
                self._compress()
        self._secants.begin_step()

    def _compress(self) -> None:
        """Replace the product by its truncated singular value decomposition."""
        assert self._left is not None
        assert self._right is not None
        Q_left, R_left = np.linalg.qr(self._left)
        Q_right, R_right = np.linalg.qr(self._right.T)
        U, singular, V_transposed = np.linalg.svd(R_left @ R_right.T)
        keep = singular > self._filter * singular[0]
        self._left, self._right = Q_left @ (U[:, keep] * singular[keep]), V_transposed[keep] @ Q_right.T
        self._steps = 0

    def forget(self) -> None:
        """Drop the Jacobian and all secants."""
        self._care *= _CARE
        self._left = self._right = None
        self._steps = 0
        self._secants.begin_step()

    def memory(self) -> JacobianMemory:
        """The Jacobian of the step before."""
        return JacobianMemory(self._left, self._right, self._steps, self._secants.dropped)

    def recall(self, memory: object) -> None:
        """Go on with a Jacobian."""
        self._left = self._right = None
        self._steps, self._care = 0, 1.0
        self._secants.begin_step()
        if isinstance(memory, JacobianMemory) and self._restart:
            self._left, self._right, self._steps = memory.left, memory.right, memory.steps
            self._secants.dropped = memory.dropped
