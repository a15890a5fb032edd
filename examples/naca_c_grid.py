"""A C-grid around an airfoil, certified, written for Gmsh and ParaView.

python examples/naca_c_grid.py --digits 2412 --angle 4 --order 4 -o results/naca
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import hoblock
from hoblock.io.mesh_file import write_mesh
from hoblock.plot import plot_mesh
from hoblock.quality import certify
from hoblock.templates import naca_c_grid

VIEWS = {
    "grid": None,
    "airfoil": (-0.4, 1.4, -0.5, 0.5),
    "nose": (-0.03, 0.06, -0.03, 0.03),
    "trailing_edge": (0.95, 1.05, -0.03, 0.03),
}
"""Parts of the plane that are drawn, in chords."""


def main(argv: Sequence[str] | None = None) -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--digits", default="2412", help="the NACA four-digit airfoil (default: %(default)s)")
    parser.add_argument("--angle", type=float, default=4.0, help="angle of attack in degrees (default: %(default)s)")
    parser.add_argument("--first-height", type=float, default=1e-4, help="of the elements on the airfoil, in chords")
    parser.add_argument("--order", type=int, default=4, help="order of the elements (default: %(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("results/naca"), help="folder of the files")
    arguments = parser.parse_args(argv)

    structure = naca_c_grid(
        digits=arguments.digits, angle_of_attack=arguments.angle, first_height=arguments.first_height
    )
    mesh = hoblock.generate(structure, arguments.order)
    quality = hoblock.scaled_jacobian(mesh)
    print(f"NACA {arguments.digits}: {len(mesh.cells)} elements, {len(mesh.points)} nodes, {certify(mesh).verdict}")
    print(f"scaled Jacobian: min {quality.min():.3f}, mean {quality.mean():.3f}")

    arguments.output.mkdir(parents=True, exist_ok=True)
    for suffix in ("msh", "vtu"):
        write_mesh(arguments.output / f"naca{arguments.digits}.{suffix}", mesh)
    for name, zoom in VIEWS.items():
        plot_mesh(mesh, arguments.output / f"{name}.png", structure=structure, zoom=zoom)


if __name__ == "__main__":
    main()
