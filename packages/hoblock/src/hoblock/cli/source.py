"""Meshes from what the user names: a scene or a mesh file."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from hoblock.blocks import BlockStructure
from hoblock.building import build_structure
from hoblock.cli.command import UsageError
from hoblock.errors import InvalidMeshError
from hoblock.generate import generate, raise_if_invalid
from hoblock.io.mesh_file import FORMATS, read_mesh
from hoblock.io.scene import load_mesh_scene
from hoblock.mesh import QuadMesh
from hoblock.quality import invalid_elements
from hoblock.scene import MeshScene

__all__ = ["Source", "add_scene", "add_scene_or_file", "load", "load_scene"]


@dataclass(frozen=True, eq=False)
class Source:
    """A mesh and where it comes from.

    Attributes
    ----------
    name : str
        Of the file.
    mesh : QuadMesh
        Not checked.
    structure : BlockStructure, optional
        Only for a scene.
    scene : MeshScene, optional
        Only for a scene.
    """

    name: str
    mesh: QuadMesh
    structure: BlockStructure | None = None
    scene: MeshScene | None = None

    @property
    def title(self) -> str:
        """The scene's title, or the name of the mesh file."""
        return Path(self.name).name if self.scene is None else self.scene.title

    def raise_if_invalid(self) -> None:
        """Raise if an element is not certified, naming the worst one.

        Raises
        ------
        InvalidMeshError
        """
        if self.structure is not None:
            raise_if_invalid(self.mesh, self.structure)
            return
        bad = invalid_elements(self.mesh)
        if bad:
            worst = bad[0]
            raise InvalidMeshError(
                f"{len(bad)} of {len(self.mesh.cells)} elements are not valid. Worst: element {worst.element}, "
                f"det J = {worst.det_J:.3g} at (xi, eta) = ({worst.xi:.3g}, {worst.eta:.3g}), "
                f"(x, y) = ({worst.x:.6g}, {worst.y:.6g}). {worst.reason}"
            )

    def block_of(self, element: int) -> str:
        """Name of the block of an element, empty for a mesh file."""
        if self.structure is None:
            return ""
        from hoblock.layout import layout

        plan = layout(self.structure, self.mesh.order)
        return self.structure.topology.block_name(int(plan.block_of_cell[element]))


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of commands that take a scene."""
    parser.add_argument("source", metavar="SCENE", help="scene file (.toml); its [mesh] part is used")
    _add_changes(parser)


def add_scene_or_file(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of commands that take a scene or a mesh file."""
    parser.add_argument(
        "source",
        metavar="SCENE|FILE",
        help="scene file (.toml; its [mesh] part is used) or mesh file (any other suffix)",
    )
    _add_changes(parser)


def _add_changes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--order", type=int, metavar="P", help="order of the elements, instead of the scene's")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        dest="overrides",
        help="change a value of the scene, for example --set mesh.elements=2; more may follow",
    )


def load(arguments: argparse.Namespace) -> Source:
    """Make the mesh of a scene, or read a mesh file; neither is checked.

    Raises
    ------
    HoblockError
        If the scene or the file is bad.
    UsageError
        If a mesh file is to be changed.
    """
    if Path(arguments.source).suffix.lower() == ".toml":
        return load_scene(arguments)
    if arguments.overrides or arguments.order is not None:
        raise UsageError(
            f"--set and --order change a scene, but {arguments.source} is a mesh file. To change its order use: "
            "hoblock convert IN OUT --order Q."
        )
    return Source(arguments.source, read_mesh(arguments.source))


def load_scene(arguments: argparse.Namespace) -> Source:
    """Make the mesh of a scene; it is not checked.

    Raises
    ------
    HoblockError
        If the scene is bad.
    UsageError
        If it is a mesh file.
    """
    suffix = Path(arguments.source).suffix.lower()
    if suffix in {form.suffix for form in FORMATS.values() if form.suffix}:
        raise UsageError(
            f"{arguments.source} is a mesh file; expected a scene (.toml). For a mesh file use: "
            f"hoblock quality {arguments.source}, or hoblock convert {arguments.source} OUT."
        )
    order = [] if arguments.order is None else [f"mesh.order={arguments.order}"]
    scene = load_mesh_scene(arguments.source, [*arguments.overrides, *order])
    structure = build_structure(scene)
    return Source(arguments.source, generate(structure, scene.order, check=False), structure, scene)
