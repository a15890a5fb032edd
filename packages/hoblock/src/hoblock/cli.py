"""The command ``hoblock``: check a scene's mesh, write it to a file, draw it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from hoblock.blocks import BlockStructure
from hoblock.build import build_structure
from hoblock.errors import HoblockError, SceneError
from hoblock.generate import generate, raise_if_invalid
from hoblock.io.mesh_file import write_mesh
from hoblock.io.scene import load_mesh_scene
from hoblock.io.toml import repeat_option
from hoblock.mesh import QuadMesh
from hoblock.plot import plot_mesh
from hoblock.quality import equiangular_skewness, jacobian_ratio, minimum_det_jacobian, scaled_jacobian
from hoblock.scene import MeshScene

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; default those of the process.

    Returns
    -------
    int
        0, or 2 if the scene, its mesh or a file is bad; then one message is on standard error.
    """
    arguments = _parser().parse_args(repeat_option(sys.argv[1:] if argv is None else argv))
    try:
        _run(arguments)
    except SceneError as error:
        return _fail(str(error) if error.file else f"{arguments.scene}: {error}")
    except HoblockError as error:
        return _fail(f"{arguments.scene}: {error}")
    except OSError as error:
        return _fail(f"{error.filename or arguments.scene}: {error.strerror or error}")
    return 0


def _fail(message: str) -> int:
    print(f"hoblock: {message}", file=sys.stderr)
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="hoblock", description="High-order block-structured quad meshes.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("scene", metavar="SCENE", help="scene file (.toml); its [mesh] part is used")
    common.add_argument("--order", type=int, metavar="P", help="order of the elements, instead of the scene's")
    common.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        dest="overrides",
        help="change a value of the scene, for example --set mesh.elements=2; more may follow",
    )

    commands.add_parser("check", parents=[common], help="make the mesh and report its size and quality")
    mesh = commands.add_parser("mesh", parents=[common], help="make the mesh and write it to a file")
    mesh.add_argument("-o", "--output", required=True, metavar="FILE", help=".msh (Gmsh 2.2), .vtu or .npz")
    plot = commands.add_parser("plot", parents=[common], help="draw the mesh; an invalid one too, bad elements red")
    plot.add_argument("-o", "--output", required=True, metavar="FILE", help=".png, .svg or .pdf")
    plot.add_argument(
        "--color",
        choices=["scaled_jacobian", "jacobian_ratio", "skewness", "groups"],
        default="scaled_jacobian",
        help="what the colours show (default: %(default)s)",
    )
    plot.add_argument("--names", action="store_true", help="write the names of the block vertices")
    return parser


def _run(arguments: argparse.Namespace) -> None:
    order = [] if arguments.order is None else [f"mesh.order={arguments.order}"]
    scene = load_mesh_scene(arguments.scene, [*arguments.overrides, *order])
    structure = build_structure(scene)
    if arguments.command == "plot":
        mesh = generate(structure, scene.order, check=False)
        color = None if arguments.color == "groups" else arguments.color
        plot_mesh(
            mesh, arguments.output, structure=structure, color=color, vertex_names=arguments.names, title=scene.title
        )
        print(f"wrote {arguments.output}")
        raise_if_invalid(mesh, structure)
        return
    mesh = generate(structure, scene.order)
    if arguments.command == "mesh":
        write_mesh(arguments.output, mesh)
    print(_report(scene, structure, mesh))
    if arguments.command == "mesh":
        print(f"wrote {arguments.output}")


def _report(scene: MeshScene, structure: BlockStructure, mesh: QuadMesh) -> str:
    quality = scaled_jacobian(mesh)
    chains = len(set(structure.topology.chains.tolist()))
    rows = {
        "scene": f"{scene.file}{': ' + scene.title if scene.title else ''}",
        "blocks": f"{len(structure.topology.quads)} ({chains} chains of opposite edges)",
        "elements": f"{len(mesh.cells)} of order {mesh.order}",
        "nodes": str(len(mesh.points)),
        "det J": f"min {minimum_det_jacobian(mesh):.4g} (positive everywhere, certified)",
        "scaled Jacobian": f"min {quality.min():.4g}, mean {quality.mean():.4g}",
        "Jacobian ratio": f"min {jacobian_ratio(mesh).min():.4g}",
        "skewness": f"max {equiangular_skewness(mesh).max():.4g}",
        "groups": _sizes({name: len(members) for name, members in mesh.cell_groups.items()}),
        "edges": _sizes({name: len(sides) for name, sides in mesh.edge_groups.items()}),
    }
    return "\n".join(f"{name:<16} {value}" for name, value in rows.items())


def _sizes(groups: dict[str, int]) -> str:
    return ", ".join(f"{name} ({size})" for name, size in groups.items()) or "none"
