"""Block structures moved as a whole: translated, rotated, scaled, mirrored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hoblock.blocks import BlockStructure
from hoblock.curves import Curve, Displaced, Reversed, reverse
from hoblock.curves import transformed as transformed_curve
from hoblock.errors import TopologyError
from hoblock.topology import BlockTopology

Array = NDArray[np.float64]
Point = Sequence[float] | Array

__all__ = ["mirrored", "rotated", "scaled", "transformed", "translated"]


def translated(structure: BlockStructure, offset: Point) -> BlockStructure:
    """Return the structure moved by an offset (x, y); curves follow.

    Raises
    ------
    TopologyError
        If the offset is no pair of finite numbers.
    """
    return transformed(structure, np.eye(2), _numbers(offset, (2,), "translated: offset"))


def rotated(structure: BlockStructure, angle: float, about: Point = (0.0, 0.0)) -> BlockStructure:
    """Return the structure rotated counter-clockwise by an angle in radians; curves follow.

    Raises
    ------
    TopologyError
        If the angle is not finite, or the centre no pair of finite numbers.
    """
    angle = float(_numbers(angle, (), "rotated: angle"))
    cosine, sine = np.cos(angle), np.sin(angle)
    return _about(structure, np.array([[cosine, -sine], [sine, cosine]]), _numbers(about, (2,), "rotated: about"))


def scaled(structure: BlockStructure, factor: float | Point, about: Point = (0.0, 0.0)) -> BlockStructure:
    """Return the structure scaled by a factor, or by one in x and one in y; curves follow.

    Gradings that prescribe lengths keep them as they are: a first height of 1e-4 remains 1e-4.

    Raises
    ------
    TopologyError
        If a factor is zero or not finite, or the centre no pair of finite numbers.
    """
    factors = np.array(np.broadcast_to(factor, (2,))) if np.ndim(factor) == 0 else factor
    matrix = np.diag(_numbers(factors, (2,), "scaled: factor"))
    return _about(structure, matrix, _numbers(about, (2,), "scaled: about"))


def mirrored(structure: BlockStructure, point: Point = (0.0, 0.0), direction: Point = (0.0, 1.0)) -> BlockStructure:
    """Return the mirror image of a structure; curves follow, blocks are counter-clockwise again.

    Parameters
    ----------
    structure : BlockStructure
    point, direction : (x, y)
        The mirror: a line through the point along the direction.

    Raises
    ------
    TopologyError
        If they are no pairs of finite numbers, or the direction is zero.
    """
    along = _numbers(direction, (2,), "mirrored: direction")
    length = float(np.hypot(*along))
    if length == 0.0:
        raise TopologyError("mirrored: direction is (0, 0); expected the direction of the mirror's line.")
    along = along / length
    return _about(structure, 2.0 * np.outer(along, along) - np.eye(2), _numbers(point, (2,), "mirrored: point"))


def transformed(structure: BlockStructure, matrix: Array, offset: Point = (0.0, 0.0)) -> BlockStructure:
    """Return the structure under the affine map x ↦ matrix x + offset; curves follow.

    Arcs remain arcs where the map keeps angles. Topology, and with it the numbering of meshes, is shared unless the map
    is a reflection, after which blocks are turned to be counter-clockwise again.

    Parameters
    ----------
    structure : BlockStructure
    matrix : ndarray, shape (2, 2)
    offset : (x, y)

    Raises
    ------
    TopologyError
        If the matrix is singular or anything is not finite.
    """
    matrix, shift = _numbers(matrix, (2, 2), "transformed: matrix"), _numbers(offset, (2,), "transformed: offset")
    determinant = float(np.linalg.det(matrix))
    if abs(determinant) <= 1e-14 * float(np.sum(matrix * matrix)):
        raise TopologyError(f"transformed: the matrix {matrix.tolist()} is singular; blocks would have no area.")
    known: dict[int, Curve] = {}  # a curve shared by edges remains shared
    curves: Mapping[int, Curve] = {
        edge: known.setdefault(id(curve), _transformed_curve(curve, matrix, shift))
        for edge, curve in structure.curves.items()
    }
    topology = structure.topology if determinant > 0.0 else _turned(structure.topology)
    return BlockStructure(topology, structure.vertices @ matrix.T + shift, curves, structure.gradings)


def _about(structure: BlockStructure, matrix: Array, center: Array) -> BlockStructure:
    return transformed(structure, matrix, center - matrix @ center)


def _turned(topology: BlockTopology) -> BlockTopology:
    """Blocks walked the other way round from the same first vertex: u and v exchange their roles."""
    return replace(topology, quads=topology.quads[:, [0, 3, 2, 1]], block_edges=topology.block_edges[:, [3, 2, 1, 0]])


def _transformed_curve(curve: Curve, matrix: Array, offset: Array) -> Curve:
    """Return the curve under an affine map; what vertices slide on or have displaced remains that."""
    match curve:
        case Reversed():
            return reverse(_transformed_curve(curve.curve, matrix, offset))
        case Displaced():
            first, second = (matrix @ np.array(end) for end in (curve.first, curve.second))
            inner = _transformed_curve(curve.curve, matrix, offset)
            return Displaced(inner, (float(first[0]), float(first[1])), (float(second[0]), float(second[1])))
    return transformed_curve(curve, matrix, offset)


def _numbers(value: object, shape: tuple[int, ...], place: str) -> Array:
    try:
        numbers = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise TopologyError(f"{place} is {value!r}; expected finite numbers of shape {shape}.") from error
    if numbers.shape != shape or not np.isfinite(numbers).all():
        raise TopologyError(f"{place} is {value!r}; expected finite numbers of shape {shape}.")
    return numbers
