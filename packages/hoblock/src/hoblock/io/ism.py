"""HOHQMesh's ISM mesh files, which Trixi, FLUXO and HORSES3D read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hoblock.io.element_sides import UNNAMED, ElementSides, check_label, element_sides, neighbours
from hoblock.mesh import QuadMesh

__all__ = ["VERSIONS", "write_ism"]

VERSIONS = ("ISM", "ISM-MM", "ISM-V2")
"""Variants of the format: plain; with a material for each element; with the edges and their neighbours."""


def write_ism(
    path: str | Path, mesh: QuadMesh, *, version: str = "ISM-V2", boundaries: Sequence[str] | None = None
) -> None:
    """Write an ISM mesh file: corners, the sides' curves at Chebyshev–Gauss–Lobatto points, names of the boundary.

    The file holds the sides exactly (their polynomials are only resampled), and so the area of the mesh; it has no
    interior nodes. Programs rebuild the interior of an element by the transfinite map of its sides, see
    `hoblock.io.element_sides.transfinite_deviation`.

    Parameters
    ----------
    path : str or Path
        Usually ends in ``.mesh``.
    mesh : QuadMesh
        Of any order.
    version : {"ISM-V2", "ISM", "ISM-MM"}
        Trixi's UnstructuredMesh2D reads ISM-V2. ISM-MM names the material of each element: the first group of elements
        that holds it.
    boundaries : sequence of str, optional
        Groups of sides to name, the first one wins where several hold a side. Default: all. Boundary sides in no group
        are called ``unnamed``; sides between elements have no names.

    Raises
    ------
    MeshFileError
        If a boundary side has two names, or a name has spaces or more than 32 characters.
    ValueError
        If the version is unknown.
    OSError
        If the file cannot be written.

    References
    ----------
    https://trixi-framework.github.io/HOHQMesh/TheISMMeshFileFormats/;
    Kopriva, Implementing Spectral Methods for Partial Differential Equations, Springer 2009, Section 8.4.2.
    """
    if version not in VERSIONS:
        raise ValueError(f"write_ism: version is {version!r}; expected one of {', '.join(map(repr, VERSIONS))}.")
    sides = element_sides(mesh, boundaries)
    materials = _materials(mesh) if version == "ISM-MM" else None
    with Path(path).open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in _lines(sides, version, materials))


def _lines(sides: ElementSides, version: str, materials: NDArray[np.str_] | None) -> Iterator[str]:
    edges = _edges(sides)
    sizes = [len(sides.vertices), len(sides.corners), sides.order]
    if version != "ISM":
        yield version
        sizes.insert(1, len(edges))
    yield " ".join(map(str, sizes))
    yield from map(point, sides.vertices)
    if version == "ISM-V2":  # HOHQMesh counts the edges in ISM-MM files, but does not list them
        yield from (" ".join(map(str, edge)) for edge in edges.tolist())
    for k, corners in enumerate((sides.corners + 1).tolist()):
        yield " ".join(map(str, corners)) + ("" if materials is None else f" {materials[k]}")
        yield " ".join(map(str, sides.curved[k].astype(int)))
        yield from map(point, sides.curves[k, sides.curved[k]].reshape(-1, 2))
        yield " ".join(sides.labels[k])


def point(x: Iterable[float]) -> str:
    """Write the coordinates of a point of the plane in 17 digits, z = 0 behind them."""
    return " ".join(f"{value:.17g}" for value in x) + " 0.0"


def _edges(sides: ElementSides) -> NDArray[np.int64]:
    """Start, end, element to the left, to the right (0: none), their sides; the last negative if it runs backwards."""
    pairs, first, second = neighbours(sides.corners)
    inner = second[:, 0] >= 0
    # Sides 0 and 1 run counter-clockwise round their element, 2 and 3 clockwise.
    same = (first[:, 1] < 2) != (second[:, 1] < 2)
    right_side = np.where(inner, (second[:, 1] + 1) * np.where(same, 1, -1), 0)
    return np.column_stack([pairs + 1, first[:, 0] + 1, second[:, 0] + 1, first[:, 1] + 1, right_side])


def _materials(mesh: QuadMesh) -> NDArray[np.str_]:
    result = np.full(len(mesh.cells), UNNAMED, dtype="U32")
    for name, members in reversed(list(mesh.cell_groups.items())):
        check_label(name)
        result[members] = name
    return result
