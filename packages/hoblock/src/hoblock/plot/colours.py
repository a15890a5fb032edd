"""What the colours of a drawing show: measures of quality, validity, groups."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hoblock.mesh import QuadMesh
from hoblock.quality import (
    INVALID as IS_INVALID,
)
from hoblock.quality import (
    UNDECIDED as IS_UNDECIDED,
)
from hoblock.quality import (
    aspect_ratio,
    bad_elements,
    certify,
    equiangular_skewness,
    jacobian_ratio,
    scaled_jacobian,
    size_jump,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = [
    "EDGE_COLOURS",
    "GROUP_COLOURS",
    "INVALID",
    "MEASURES",
    "UNDECIDED",
    "Measure",
    "Verdicts",
    "group_colours",
    "verdicts",
]


@dataclass(frozen=True)
class Measure:
    """A measure of quality in a drawing.

    Attributes
    ----------
    values : function
        Of a mesh, one number an element.
    label : str
    colours : str
        matplotlib's colour map; dark is bad.
    limits : (float, float), optional
        Of the colours; without, the data's own.
    logarithmic : bool
        Whether the colours follow the logarithm.
    """

    values: Callable[[QuadMesh], Array]
    label: str
    colours: str
    limits: tuple[float, float] | None
    logarithmic: bool = False


MEASURES: dict[str, Measure] = {
    "aspect_ratio": Measure(aspect_ratio, "aspect ratio", "viridis_r", None, logarithmic=True),
    "jacobian_ratio": Measure(jacobian_ratio, "Jacobian ratio", "viridis", (0.0, 1.0)),
    "scaled_jacobian": Measure(scaled_jacobian, "scaled Jacobian", "viridis", (0.0, 1.0)),
    "skewness": Measure(equiangular_skewness, "equiangular skewness", "viridis_r", (0.0, 1.0)),
    "size_jump": Measure(size_jump, "size jump to a neighbour", "viridis_r", None, logarithmic=True),
}
"""Measures that can colour the elements, by name."""

GROUP_COLOURS = ("#dce9f5", "#f8dfc6", "#ddf0da", "#eadcf2", "#f7f3c4", "#e4e4e4")
EDGE_COLOURS = (
    "#1f77b4",
    "#d95f02",
    "#1b9e77",
    "#7b3294",
    "#a6761d",
    "#e7298a",
    "#17becf",
    "#666666",
    "#66a61e",
    "#08306b",
)
INVALID = "#e00000"
UNDECIDED = "#ff9900"

_MARKED = 12  # places of bad elements that get a ring, so that small ones are found


@dataclass(frozen=True, eq=False)
class Verdicts:
    """Elements that are not certified.

    Attributes
    ----------
    invalid, undecided : ndarray of int
        Elements whose det J is not positive somewhere; elements of which neither could be proven.
    worst : ndarray, shape (k, 2)
        Where the worst of them are worst.
    """

    invalid: Index
    undecided: Index
    worst: Array

    def describe(self) -> str:
        """Return the counts in words, empty if every element is valid."""
        parts = []
        if self.invalid.size:
            parts.append(f"{len(self.invalid)} invalid (red)")
        if self.undecided.size:
            parts.append(f"{len(self.undecided)} undecided (orange)")
        return ", ".join(parts)


def verdicts(mesh: QuadMesh) -> Verdicts:
    """Find the elements that are not certified, and where the worst of them are worst."""
    proof = certify(mesh)
    worst = bad_elements(mesh, proof, proof.doubtful[:_MARKED])
    places = np.array([(bad.x, bad.y) for bad in worst]).reshape(-1, 2)
    return Verdicts(
        np.flatnonzero(proof.status == IS_INVALID),
        np.flatnonzero(proof.status == IS_UNDECIDED),
        places[np.isfinite(places).all(axis=1)],
    )


def group_colours(mesh: QuadMesh) -> list[str]:
    """Return the colour of the group of each element, white for those in none; later groups cover earlier ones."""
    colours = ["#ffffff"] * len(mesh.cells)
    for k, members in enumerate(mesh.cell_groups.values()):
        for element in members:
            colours[element] = GROUP_COLOURS[k % len(GROUP_COLOURS)]
    return colours
