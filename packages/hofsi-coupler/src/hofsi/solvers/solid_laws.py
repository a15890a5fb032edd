"""Constitutive laws of the solids on one mesh: which elements obey which, and their integrals together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hofsi import case
from hofsi.kernels import elasticity, neo_hooke

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Cells: TypeAlias = "slice | Index"

__all__ = ["SolidLaws"]


class _Law(Protocol):
    """A law on some elements; H are displacement gradients (e, q, 2, 2), S stresses (e, q, 3)."""

    def stress(self, H: Array) -> Array: ...

    def energy(self, H: Array) -> Array: ...

    def mean_stress(self, H: Array, start: Array) -> Array: ...

    def linearised_stress(self, H: Array, S: Array, increment: Array, new: Array, used: Array) -> Array: ...

    def out_of_plane(self, H: Array, S: Array) -> tuple[Array, Array]: ...

    def stiffness(self, H: Array, S: Array, products: tuple[Array, Array], J_inv: Array, weights: Array) -> Array: ...

    def part(self, cells: slice) -> _Law: ...


@dataclass(frozen=True, eq=False)
class _Hooke:
    """Linear and St. Venant–Kirchhoff solids.

    Attributes
    ----------
    lame_lambda, lame_mu, m : ndarray, shape (e, 1)
        λ is that of the plane problem.
    across : ndarray, shape (e, 1)
        S_zz/(S_xx + S_yy).
    """

    lame_lambda: Array
    lame_mu: Array
    m: Array
    across: Array

    def stress(self, H: Array) -> Array:
        return elasticity.stress(H, self.lame_lambda, self.lame_mu, self.m)

    def energy(self, H: Array) -> Array:
        return elasticity.energy_density(H, self.stress(H), self.m)

    def mean_stress(self, H: Array, start: Array) -> Array:
        return self.stress(H) + elasticity.quadratic_stress(H - start, self.lame_lambda, self.lame_mu, self.m)

    def linearised_stress(self, H: Array, S: Array, increment: Array, new: Array, used: Array) -> Array:
        return new - elasticity.quadratic_stress(increment, self.lame_lambda, self.lame_mu, self.m)

    def out_of_plane(self, H: Array, S: Array) -> tuple[Array, Array]:
        return self.across * (S[..., 0] + S[..., 1]), np.ones(S.shape[:-1])

    def stiffness(self, H: Array, S: Array, products: tuple[Array, Array], J_inv: Array, weights: Array) -> Array:
        F = elasticity.deformation_gradient(H, self.m)
        return elasticity.stiffness(F, S, self.lame_lambda, self.lame_mu, self.m, products, J_inv, weights)

    def part(self, cells: slice) -> _Hooke:
        return _Hooke(self.lame_lambda[cells], self.lame_mu[cells], self.m[cells], self.across[cells])


@dataclass(frozen=True, eq=False)
class _NeoHooke:
    """Neo-Hookean solids in one of the plane cases.

    Attributes
    ----------
    lame_lambda, lame_mu : ndarray, shape (e, 1)
        Of the three-dimensional body.
    plane_stress : bool
    """

    lame_lambda: Array
    lame_mu: Array
    plane_stress: bool

    def stress(self, H: Array) -> Array:
        return neo_hooke.stress(H, self.lame_lambda, self.lame_mu, plane_stress=self.plane_stress)

    def energy(self, H: Array) -> Array:
        return neo_hooke.energy_density(H, self.lame_lambda, self.lame_mu, plane_stress=self.plane_stress)

    def mean_stress(self, H: Array, start: Array) -> Array:
        return neo_hooke.mean_stress(H, start, self.lame_lambda, self.lame_mu, plane_stress=self.plane_stress)

    def linearised_stress(self, H: Array, S: Array, increment: Array, new: Array, used: Array) -> Array:
        parameters = self.lame_lambda, self.lame_mu
        return neo_hooke.linearised_stress(H, S, increment, used, *parameters, plane_stress=self.plane_stress)

    def out_of_plane(self, H: Array, S: Array) -> tuple[Array, Array]:
        return neo_hooke.out_of_plane(H, self.lame_lambda, self.lame_mu, plane_stress=self.plane_stress)

    def stiffness(self, H: Array, S: Array, products: tuple[Array, Array], J_inv: Array, weights: Array) -> Array:
        parameters = self.lame_lambda, self.lame_mu
        return neo_hooke.stiffness(H, S, *parameters, products, J_inv, weights, plane_stress=self.plane_stress)

    def part(self, cells: slice) -> _NeoHooke:
        return _NeoHooke(self.lame_lambda[cells], self.lame_mu[cells], self.plane_stress)


class SolidLaws:
    """The laws of all elements of a mesh.

    Parameters
    ----------
    count : int
        Of elements.
    solids : sequence of Solid
    cells : sequence of ndarray
        Elements of each solid.

    Attributes
    ----------
    m : ndarray, shape (e, 1)
        0 for linear solids, 1 for the others.
    plane_modulus : ndarray, shape (e, 1)
        λ + 2 μ of the plane problem at small strains.
    """

    def __init__(self, count: int, solids: Sequence[case.Solid], cells: Sequence[Index]) -> None:
        self.m, self.plane_modulus = np.empty((2, count, 1))
        values = np.empty((4, count, 1))
        kinds: dict[str, list[Index]] = {}
        for solid, own in zip(solids, cells, strict=True):
            modulus, ratio, plane_stress = solid.youngs_modulus, solid.poissons_ratio, solid.plane == "stress"
            lame, mu = elasticity.plane_lame_parameters(modulus, ratio, stress=plane_stress)
            self.m[own] = 0.0 if solid.model == "linear" else 1.0
            self.plane_modulus[own] = lame + 2.0 * mu
            kind = "hooke"
            if solid.model == "neo-hooke":
                kind = solid.plane
                lame = elasticity.plane_lame_parameters(modulus, ratio, stress=False)[0]
            across = 0.0 if plane_stress else lame / (2.0 * (lame + mu))
            values[:3, own] = np.array([lame, mu, across])[:, None, None]
            kinds.setdefault(kind, []).append(own)
        values[3] = self.m
        self._groups: list[tuple[Cells, _Law]] = []
        self._owner, self._position = np.empty((2, count), dtype=np.int64)
        for number, (kind, members) in enumerate(kinds.items()):
            numbers = np.sort(np.concatenate(members))
            self._owner[numbers], self._position[numbers] = number, np.arange(len(numbers))
            group = slice(None) if len(kinds) == 1 else _as_slice(numbers)
            lame_lambda, lame_mu, across_ratio, m = values[:, group]
            law = (
                _Hooke(lame_lambda, lame_mu, m, across_ratio)
                if kind == "hooke"
                else _NeoHooke(lame_lambda, lame_mu, kind == "stress")
            )
            self._groups.append((group, law))

    def of_element(self, element: int) -> _Law:
        """The law of one element alone."""
        _, law = self._groups[int(self._owner[element])]
        position = int(self._position[element])
        return law.part(slice(position, position + 1))

    def stress(self, H: Array) -> Array:
        """Second Piola–Kirchhoff stress of a displacement gradient (e, q, 2, 2), shape (e, q, 3)."""
        return self._symmetric(lambda law, own: law.stress(_of(H, own)), H)

    def energy(self, H: Array) -> Array:
        """Energy per undeformed volume of a displacement gradient (e, q, 2, 2), shape (e, q)."""
        W = np.empty(H.shape[:2])
        for own, law in self._groups:
            W[own] = law.energy(_of(H, own))
        return W

    def mean_stress(self, H: Array, start: Array) -> Array:
        """Stress of a midpoint step that keeps the energy, shape (e, q, 3).

        Parameters
        ----------
        H, start : ndarray, shape (e, q, 2, 2)
            In the middle of the step, and at its start.
        """
        return self._symmetric(lambda law, own: law.mean_stress(_of(H, own), _of(start, own)), H)

    def linearised_stress(self, H: Array, S: Array, increment: Array, new: Array, used: Array) -> Array:
        """Stress after an increment of H, linearised in it, shape (e, q, 3).

        Parameters
        ----------
        H, S : ndarray
            Gradient and stress before.
        increment : ndarray, shape (e, q, 2, 2)
            Of the gradient.
        new : ndarray, shape (e, q, 3)
            The stress after it.
        used : ndarray, shape (e, q, 3)
            That of the stiffness which gave the increment.
        """

        def of(law: _Law, own: Cells) -> Array:
            return law.linearised_stress(_of(H, own), S[own], _of(increment, own), new[own], used[own])

        return self._symmetric(of, H)

    def stiffness(self, H: Array, S: Array, products: tuple[Array, Array], J_inv: Array, weights: Array) -> Array:
        """Derivative of the internal forces, shape (e, 2 i, 2 j), if S is the stress of H.

        S enters the geometric stiffness, and what depends on the pressure otherwise.
        """

        def of(law: _Law, own: Cells) -> Array:
            return law.stiffness(_of(H, own), S[own], products, _of(J_inv, own), weights[own])

        if len(self._groups) == 1:
            return of(self._groups[0][1], slice(None))
        size = 2 * round(products[0].shape[1] ** 0.5)
        K = np.empty((len(H), size, size))
        for own, law in self._groups:
            K[own] = of(law, own)
        return K

    def out_of_plane(self, H: Array, S: Array) -> tuple[Array, Array]:
        """J σ_zz, and the thickness ratio where its change counts, each of shape (e, q)."""
        stress, thickness = np.empty((2, *S.shape[:-1]))
        for own, law in self._groups:
            stress[own], thickness[own] = law.out_of_plane(_of(H, own), S[own])
        return stress, thickness

    def _symmetric(self, of: Callable[[_Law, Cells], Array], H: Array) -> Array:
        if len(self._groups) == 1:
            return of(self._groups[0][1], slice(None))
        S = np.empty((3, *H.shape[:2]))
        for own, law in self._groups:
            S[:, own] = np.moveaxis(of(law, own), 2, 0)
        return np.moveaxis(S, 0, 2)


def _of(tensor: Array, own: Cells) -> Array:
    """Some elements of a tensor field (e, q, 2, 2), its components outermost in memory still."""
    if isinstance(own, slice):
        return tensor[own]
    return np.moveaxis(np.moveaxis(tensor, (2, 3), (0, 1))[:, :, own], (0, 1), (2, 3))


def _as_slice(cells: Index) -> Cells:
    first, last = int(cells[0]), int(cells[-1])
    return slice(first, last + 1) if last - first + 1 == len(cells) else cells
