"""A quarter annulus with graded elements, curved by Gmsh and by hoblock: which elements are valid?

Gmsh makes a straight-sided transfinite mesh and bends its outer sides (`setOrder`); the lines inside stay straight, and
thin elements at a curved wall are run over. hoblock's interior lines come from the transfinite map at every order.

    python benchmarks/peers/gmsh_annulus.py --picture docs/images/annulus_gmsh.png
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import gmsh
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from _result import Result, parser, report
from hoblock import Arc, BlockStructure, Exponential, QuadMesh, generate, scaled_jacobian
from hoblock.io.mesh_file import read_mesh, write_mesh
from hoblock.quality import certify

RADII = (1.0, 1.6)
RADIAL, AROUND = 8, 2


@contextmanager
def session() -> Iterator[None]:
    """Gmsh, silent, for as long as it is needed."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield
    finally:
        gmsh.finalize()


def by_gmsh(order: int, progression: float) -> tuple[QuadMesh, np.ndarray]:
    """The mesh, and Gmsh's own minimum scaled Jacobian of each element."""
    with session():
        geo = gmsh.model.geo
        center = geo.addPoint(0, 0, 0)
        places = [(RADII[0], 0), (RADII[1], 0), (0, RADII[1]), (0, RADII[0])]
        a, b, c, d = (geo.addPoint(x, y, 0) for x, y in places)
        sides = [
            geo.addLine(a, b),
            geo.addCircleArc(b, center, c),
            geo.addLine(d, c),
            geo.addCircleArc(a, center, d),
        ]
        surface = geo.addPlaneSurface([geo.addCurveLoop([sides[0], sides[1], -sides[2], -sides[3]])])
        for side in sides[::2]:
            geo.mesh.setTransfiniteCurve(side, RADIAL + 1, "Progression", progression)
        for side in sides[1::2]:
            geo.mesh.setTransfiniteCurve(side, AROUND + 1)
        geo.mesh.setTransfiniteSurface(surface, cornerTags=[a, b, c, d])
        geo.mesh.setRecombine(2, surface)
        geo.synchronize()
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        with tempfile.TemporaryDirectory() as folder:
            file = str(Path(folder) / "gmsh.msh")
            gmsh.write(file)
            return read_mesh(file), _their_quality(order)


def by_hoblock(order: int, progression: float) -> tuple[QuadMesh, np.ndarray]:
    """The same, with the elements' sizes growing by the same ratio."""
    vertices = {"a": (RADII[0], 0), "b": (RADII[1], 0), "c": (0, RADII[1]), "d": (0, RADII[0])}
    growth = Exponential(RADIAL * float(np.log(progression)))
    structure = BlockStructure.build(
        vertices,
        [("a", "b", "c", "d")],
        counts={("a", "b"): RADIAL, ("b", "c"): AROUND},
        curves={
            (first, second): Arc.from_center((0, 0), vertices[first], vertices[second])
            for first, second in (("b", "c"), ("a", "d"))
        },
        gradings={("a", "b"): growth, ("d", "c"): growth},
    )
    mesh = generate(structure, order)
    with session(), tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "hoblock.msh"
        write_mesh(file, mesh)
        gmsh.open(str(file))
        return mesh, _their_quality(order)


def _their_quality(order: int) -> np.ndarray:
    tags, _ = gmsh.model.mesh.getElementsByType(gmsh.model.mesh.getElementType("quadrangle", order))
    return np.array(gmsh.model.mesh.getElementQualities(tags, "minSJ"))


def draw(meshes: Sequence[tuple[str, QuadMesh]], path: Path) -> None:
    """Draw meshes side by side, invalid elements red."""
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    from hoblock.plot import element_outlines

    figure = Figure(figsize=(5.0 * len(meshes), 5.0), layout="constrained")
    for axes, (title, mesh) in zip(figure.subplots(1, len(meshes), sharey=True), meshes, strict=True):
        invalid = scaled_jacobian(mesh) <= 0.0
        colours = np.where(invalid, "#e00000", "#dce9f5")
        outlines = element_outlines(mesh, 60)
        order = np.argsort(invalid)  # red on top
        axes.add_collection(
            PolyCollection(outlines[order], facecolors=list(colours[order]), edgecolors="black", linewidths=0.6)
        )
        axes.set(xlim=(-0.05, 1.65), ylim=(-0.05, 1.65), aspect="equal", title=title)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)


def main(argv: Sequence[str] | None = None) -> Result:
    options = parser(__doc__)
    options.add_argument("--orders", type=int, nargs="+", default=[2, 4])
    options.add_argument("--progression", type=float, default=1.3, help="ratio of neighbouring radial sizes")
    options.add_argument("--picture", type=Path, metavar="FILE", help="draw the last order side by side")
    chosen = options.parse_args(argv)
    rows, pictures = [], []
    for order in chosen.orders:
        pictures = []
        for program, make in (("gmsh", by_gmsh), ("hoblock", by_hoblock)):
            mesh, theirs = make(order, chosen.progression)
            certificate = certify(mesh)
            invalid = certificate.counts["invalid"]
            rows.append(
                {
                    "order": order,
                    "program": program,
                    "elements": len(mesh.cells),
                    "invalid": invalid,
                    "verdict": certificate.verdict,
                    "scaled Jacobian": float(scaled_jacobian(mesh).min()),
                    "Gmsh's minSJ": float(theirs.min()),
                }
            )
            pictures.append((f"{program}, order {order}: {invalid} of {len(mesh.cells)} elements invalid", mesh))
    if chosen.picture:
        draw(pictures, chosen.picture)
    return report(Result("gmsh_annulus", {"progression": chosen.progression}, rows), chosen.json)


if __name__ == "__main__":
    main()
