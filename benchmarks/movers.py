"""How far the block movers carry a thin plate in a box, and what a move costs.

The plate, 1 × 0.02, is centred in [-1, 1]² (Stein, Tezduyar, Benney, J. Appl. Mech. 70 (2003) 58–63) and meshed by
lines through the whole box; the outer vertices stay. Its position rises in equal steps until the first mesh whose
certified bound of det J is not positive.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from _result import Result, fastest, parser, report
from numpy.typing import NDArray

from hoblock import BlockStructure, NodalCurve, generate, regenerate
from hoblock.layout import layout
from hoblock.movers import AngleOptimisation, Mover, PseudoSolid
from hoblock.quality import invalid_elements

Array = NDArray[np.float64]
Motion = Callable[[Array, float], Array]

X = (-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0)
Y = (-1.0, -0.4, -0.01, 0.01, 0.4, 1.0)


def translated(points: Array, s: float) -> Array:
    return points + np.array([0.0, s])


def rotated(points: Array, degrees: float) -> Array:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s], [-s, c]])


def bent(points: Array, degrees: float) -> Array:
    """Bend to an arc without stretching the middle line, whose centre of gravity stays."""
    if degrees == 0.0:
        return points
    a = np.radians(degrees)
    R = 1.0 / a
    x, y = points.T
    down = R - R * np.sin(a / 2.0) / (a / 2.0)
    return np.stack([(R - y) * np.sin(a * x), R - (R - y) * np.cos(a * x) - down], axis=-1)


MOTIONS: dict[str, tuple[Motion, float]] = {
    "T3a translation": (translated, 0.99),
    "T3b rotation": (rotated, 180.0),
    "T3c bending": (bent, 270.0),
}
MOVERS: dict[str, Callable[[BlockStructure, NDArray[np.int64]], Mover]] = {
    "pseudo-solid, exponent -1": lambda blocks, driven: PseudoSolid(blocks, driven, exponent=-1.0),
    "pseudo-solid, exponent +1": lambda blocks, driven: PseudoSolid(blocks, driven, exponent=1.0),
    "angles, robust": AngleOptimisation,
    "angles, published": AngleOptimisation.as_published,
}


@dataclass(frozen=True)
class Plate:
    """The blocks around the plate, its edges and the vertices on it."""

    structure: BlockStructure
    edges: NDArray[np.int64]
    driven: NDArray[np.int64]

    @staticmethod
    def build(count: int) -> Plate:
        inside = [
            (i, j) for j in range(len(Y) - 1) for i in range(len(X) - 1) if not (Y[j] == -0.01 and -0.5 <= X[i] < 0.5)
        ]
        names = sorted({(i + k, j + m) for i, j in inside for k in (0, 1) for m in (0, 1)})
        number = {name: k for k, name in enumerate(names)}
        quads = [[number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]] for i, j in inside]
        structure = BlockStructure.build(np.array([(X[i], Y[j]) for i, j in names]), quads, counts=count)
        topology = structure.topology
        outer = np.flatnonzero(topology.blocks_per_edge == 1)
        near = np.abs(structure.vertices[topology.edges[outer]]).max(axis=(1, 2)) < 0.6
        return Plate(structure, outer[near], np.unique(topology.edges[outer[near]]))


def reach(plate: Plate, mover: Mover, motion: Motion, end: float, steps: int, order: int) -> float:
    """Last position with a certified mesh."""
    mesh = generate(plate.structure, order)
    plan = layout(plate.structure, order)
    nodes = {int(edge): mesh.points[plan.nodes_of_edge(int(edge))] for edge in plate.edges}
    vertices, last = plate.structure.vertices, 0.0
    for s in np.linspace(0.0, end, steps + 1)[1:]:
        vertices = mover.move(vertices, motion(plate.structure.vertices[plate.driven], s))
        curves = {edge: NodalCurve(motion(points, s), order) for edge, points in nodes.items()}
        mesh = regenerate(mesh, plate.structure.moved(vertices, curves))
        if invalid_elements(mesh):
            break
        last = float(s)
    return last


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--steps", type=int, default=60, help="steps over a motion (default: %(default)s)")
    options.add_argument("--order", type=int, default=4)
    options.add_argument("--elements", type=int, default=4, help="on each block edge (default: %(default)s)")
    options.add_argument("--repeats", type=int, default=50)
    chosen = options.parse_args(argv)
    plate = Plate.build(chosen.elements)
    rows = []
    for name, make in MOVERS.items():
        mover = make(plate.structure, plate.driven)
        start = plate.structure.vertices
        small = translated(start[plate.driven], 0.01)
        setup = fastest(lambda make=make: make(plate.structure, plate.driven), 3)
        move = fastest(lambda mover=mover, start=start, small=small: mover.move(start, small), chosen.repeats)
        row: dict[str, object] = {"mover": name, "set-up ms": setup * 1e3, "move ms": move * 1e3}
        for title, (motion, end) in MOTIONS.items():
            row[f"{title} (of {end:g})"] = reach(plate, mover, motion, end, chosen.steps, chosen.order)
        rows.append(row)
    settings = {name: getattr(chosen, name) for name in ("steps", "order", "elements", "repeats")}
    return report(Result("movers", settings, rows), chosen.json)


if __name__ == "__main__":
    main()
