"""Abaqus mesh files with HOHQMesh's curves and names in comments, as Trixi's P4estMesh reads them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from hoblock.io.element_sides import ElementSides, element_sides
from hoblock.io.ism import point
from hoblock.mesh import QuadMesh

__all__ = ["write_abaqus"]


def write_abaqus(path: str | Path, mesh: QuadMesh, *, boundaries: Sequence[str] | None = None) -> None:
    """Write corners and elements of type CPS4, then the sides' curves and names in comments.

    Any reader of Abaqus files gets the straight-sided mesh of the corners. Trixi's P4estMesh also reads the comments:
    curves of order p at Chebyshev–Gauss–Lobatto points, exactly those of the mesh, and the names of the boundary; it
    rebuilds interiors by the transfinite map of the sides, see `hoblock.io.element_sides.transfinite_deviation`.

    Parameters
    ----------
    path : str or Path
        Usually ends in ``.inp``.
    mesh : QuadMesh
        Of any order.
    boundaries : sequence of str, optional
        As for `hoblock.io.ism.write_ism`.

    Raises
    ------
    MeshFileError
        If a boundary side has two names, or a name has spaces or more than 32 characters.
    OSError
        If the file cannot be written.

    References
    ----------
    https://trixi-framework.github.io/HOHQMesh/TheISMMeshFileFormats/ and
    https://trixi-framework.github.io/Trixi.jl/stable/meshes/p4est_mesh/.
    """
    sides = element_sides(mesh, boundaries)
    with Path(path).open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in _lines(sides))


def _lines(sides: ElementSides) -> Iterator[str]:
    yield "*Heading"
    yield " File created by HOHQMesh"  # by this very line Trixi knows that curves follow
    yield "*NODE"
    for number, (x, y) in enumerate(sides.vertices.tolist(), start=1):
        yield f"{number}, {x:.17g}, {y:.17g}, 0.0"
    yield "*ELEMENT, type=CPS4, ELSET=Surface1"
    corners = (sides.corners + 1).tolist()
    for number, quad in enumerate(corners, start=1):
        yield f"{number}, {', '.join(map(str, quad))}"
    yield "** ***** HOHQMesh boundary information ***** **"
    yield f"** mesh polynomial degree = {sides.order}"
    for k, quad in enumerate(corners):
        yield f"**  {' '.join(map(str, quad))}"
        yield f"**  {' '.join(map(str, sides.curved[k].astype(int)))}"
        yield from (f"**  {point(x)}" for x in sides.curves[k, sides.curved[k]].reshape(-1, 2))
    for labels in sides.labels[:, [3, 1, 0, 2]]:  # p4est's order: -x, +x, -y, +y
        yield f"**  {' '.join(labels)}"
