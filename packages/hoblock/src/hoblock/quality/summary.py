"""Quality of a mesh in a few numbers, and element by element for files and drawings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality.certificate import STATUS_NAMES, Certificate, certify
from hoblock.quality.measures import (
    aspect_ratio,
    element_areas,
    equiangular_skewness,
    jacobian_ratio,
    scaled_jacobian,
)
from hoblock.quality.neighbours import size_jump
from hoblock.reference import gauss_lobatto, tensor_basis

Array = NDArray[np.float64]

__all__ = [
    "Histogram",
    "MeasureSummary",
    "QualitySummary",
    "WorstElement",
    "histogram",
    "per_element",
    "quality_summary",
]

_TENTHS = tuple(round(0.1 * k, 1) for k in range(11))
_EDGES: dict[str, tuple[float, ...]] = {
    "scaled_jacobian": (-1.0, *_TENTHS),
    "jacobian_ratio": (-1.0, *_TENTHS),
    "skewness": (*_TENTHS, 2.0),
    "aspect_ratio": (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0, 10000.0),
    "size_jump": (1.0, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0),
}


@dataclass(frozen=True)
class Histogram:
    """How many values lie in each of some intervals.

    Attributes
    ----------
    edges : tuple of float
        Ends of the intervals, ascending, one more than intervals.
    counts : tuple of int
        Number of values from an edge up to the next; those outside belong to the first or the last interval.
    """

    edges: tuple[float, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True)
class MeasureSummary:
    """Smallest, mean and largest value of a measure over the elements, and its histogram.

    NaN, which stands for elements with nodes that are not finite, is left out; all three are NaN if nothing remains.
    """

    min: float
    mean: float
    max: float
    histogram: Histogram


@dataclass(frozen=True)
class WorstElement:
    """One of the worst elements.

    Attributes
    ----------
    element : int
    status : str
        "valid", "undecided" or "invalid".
    scaled_jacobian : float
    det_j_bound : float
        Certified lower bound of its det J.
    x, y : float
        Its middle (ξ = η = 0).
    """

    element: int
    status: str
    scaled_jacobian: float
    det_j_bound: float
    x: float
    y: float


@dataclass(frozen=True)
class QualitySummary:
    """Quality of a mesh in a few numbers.

    Attributes
    ----------
    valid : bool
        Whether det J > 0 is proven for every element.
    verdict : str
        "valid", "undecided" or "invalid" (see `hoblock.quality.Certificate`).
    status_counts : dict of str to int
        Number of elements of each status.
    min_det_j_bound : float
        Certified lower bound of det J of the mesh.
    cells, points, order : int
        Number of elements and of nodes, order of the elements.
    area : float
        Exact area of the mesh.
    scaled_jacobian, jacobian_ratio, skewness, aspect_ratio, size_jump : MeasureSummary
        Of the measures of that name in `hoblock.quality`; skewness is `equiangular_skewness`.
    worst_elements : tuple of WorstElement
        Invalid ones first, then undecided ones, then by ascending scaled Jacobian.
    """

    valid: bool
    verdict: str
    status_counts: dict[str, int]
    min_det_j_bound: float
    cells: int
    points: int
    order: int
    area: float
    scaled_jacobian: MeasureSummary
    jacobian_ratio: MeasureSummary
    skewness: MeasureSummary
    aspect_ratio: MeasureSummary
    size_jump: MeasureSummary
    worst_elements: tuple[WorstElement, ...]


def histogram(values: Array, edges: Sequence[float] | Array) -> Histogram:
    """Count the values between edges.

    Parameters
    ----------
    values : ndarray
        Those below the first or above the last edge are counted in the first or last interval, NaN nowhere.
    edges : sequence of float
        Strictly ascending, at least two.

    Raises
    ------
    ValueError
        If the edges are fewer or not ascending.
    """
    ends = np.asarray(edges, dtype=float)
    if ends.ndim != 1 or len(ends) < 2 or not (np.diff(ends) > 0.0).all():
        raise ValueError(f"histogram: edges are {ends.tolist()}; expected at least two, strictly ascending.")
    flat = np.asarray(values, dtype=float).ravel()
    flat = flat[~np.isnan(flat)]
    places = np.searchsorted(ends[1:-1], flat, side="right")
    counts = np.bincount(places, minlength=len(ends) - 1)
    return Histogram(tuple(ends.tolist()), tuple(counts.tolist()))


def _summary(values: Array, edges: tuple[float, ...]) -> MeasureSummary:
    known = values[~np.isnan(values)]
    if not known.size:
        return MeasureSummary(np.nan, np.nan, np.nan, histogram(known, edges))
    return MeasureSummary(float(known.min()), float(known.mean()), float(known.max()), histogram(known, edges))


def per_element(mesh: QuadMesh, certificate: Certificate | None = None) -> dict[str, Array]:
    """All measures element by element, each of shape (e,), for files and drawings.

    Parameters
    ----------
    mesh : QuadMesh
    certificate : Certificate, optional
        Of the mesh, if there is one already.

    Returns
    -------
    dict of str to ndarray
        ``status`` (0 valid, 1 undecided, 2 invalid), ``det_j_bound``, ``scaled_jacobian``, ``jacobian_ratio``,
        ``skewness``, ``aspect_ratio``, ``size_jump`` and ``area``.
    """
    proof = certify(mesh) if certificate is None else certificate
    return {
        "status": proof.status.astype(float),
        "det_j_bound": proof.lower,
        "scaled_jacobian": scaled_jacobian(mesh),
        "jacobian_ratio": jacobian_ratio(mesh),
        "skewness": equiangular_skewness(mesh),
        "aspect_ratio": aspect_ratio(mesh),
        "size_jump": size_jump(mesh),
        "area": element_areas(mesh),
    }


def quality_summary(mesh: QuadMesh, *, worst: int = 5, certificate: Certificate | None = None) -> QualitySummary:
    """Summarise the quality of a mesh.

    Parameters
    ----------
    mesh : QuadMesh
        At least one element.
    worst : int
        How many of the worst elements to list.
    certificate : Certificate, optional
        Of the mesh, if there is one already.

    Raises
    ------
    ValueError
        If the mesh has no elements.
    """
    if not len(mesh.cells):
        raise ValueError("quality_summary: the mesh has no elements.")
    proof = certify(mesh) if certificate is None else certificate
    fields = per_element(mesh, proof)
    return QualitySummary(
        valid=proof.valid,
        verdict=proof.verdict,
        status_counts=proof.counts,
        min_det_j_bound=proof.min_det_J,
        cells=len(mesh.cells),
        points=len(mesh.points),
        order=mesh.order,
        area=float(fields["area"].sum()),
        worst_elements=_worst(mesh, proof, fields["scaled_jacobian"], worst),
        **{name: _summary(fields[name], edges) for name, edges in _EDGES.items()},
    )


def _worst(mesh: QuadMesh, proof: Certificate, quality: Array, count: int) -> tuple[WorstElement, ...]:
    ranking = np.where(np.isnan(quality), -np.inf, quality)
    sequence = np.lexsort((ranking, -proof.status.astype(int)))[:count]
    middles = tensor_basis(gauss_lobatto(mesh.order), np.zeros((1, 2)))[0] @ mesh.points[mesh.cells[sequence]]
    return tuple(
        WorstElement(
            int(element),
            STATUS_NAMES[proof.status[element]],
            float(quality[element]),
            float(proof.lower[element]),
            float(x),
            float(y),
        )
        for element, (x, y) in zip(sequence, middles, strict=True)
    )
