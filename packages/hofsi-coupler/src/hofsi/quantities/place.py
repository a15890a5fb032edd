"""Places that quantities are taken at, followed through moving meshes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from hoblock import QuadMesh
from hoblock.errors import LocationError
from hoblock.layout import layout
from hoblock.locate import Location, find, locate, location_of_node
from hofsi import case
from hofsi.build import FluidPart, SolidPart
from hofsi.errors import CaseError
from hofsi.quantities.body import mesh_state
from hofsi.records import StepRecord

__all__ = ["Whereabouts", "attached", "tracked"]

Whereabouts: TypeAlias = Callable[[StepRecord], Location | None]
"""Where a place is in the fluid's mesh after a step; None while the mesh does not cover it."""


def attached(part: FluidPart | SolidPart, at: case.Point, place: str) -> Location:
    """Location of a point in the reference mesh, a vertex of it or a place.

    Raises
    ------
    CaseError
        If it is outside, or the vertex does not belong to the body.
    """
    body, mesh = "fluid" if isinstance(part, FluidPart) else "solid", part.mesh
    if at.vertex is None:
        try:
            return locate(mesh, (at.x, at.y), of=f"the {body}'s mesh")
        except LocationError as error:
            raise CaseError(str(error).removesuffix("."), place) from error
    names = part.structure.topology.vertex_names
    if at.vertex not in names:
        some = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
        raise CaseError(
            f"vertex {at.vertex!r} does not belong to the {body}; expected one of {some}. Name another vertex, or "
            "change 'of'",
            place,
        )
    return location_of_node(mesh, int(layout(part.structure, mesh.order).vertex_nodes[names.index(at.vertex)]))


def tracked(fluid: FluidPart, at: case.Point, place: str) -> Whereabouts:
    """Location of a fluid point at a step: that of a vertex stays, that of a place in space is followed.

    Raises
    ------
    CaseError
        As `attached`.
    """
    start = attached(fluid, at, place)
    if at.vertex is not None:
        return lambda record: start
    tracker = _Tracker(fluid.mesh, at, start)
    return lambda record: tracker.find(mesh_state(record).mesh)


class _Tracker:
    """Finds a place again after the mesh has moved, beginning where it was in the reference.

    So what it finds depends on the mesh alone, to the bit, and not on the meshes before.
    """

    def __init__(self, mesh: QuadMesh, at: case.Point, start: Location) -> None:
        self._target = (at.x, at.y)
        self._points = mesh.points
        self._found: Location | None = start
        self._start = start

    def find(self, mesh: QuadMesh) -> Location | None:
        if mesh.points is not self._points:
            self._points = mesh.points
            self._found = find(mesh, self._target, self._start)
        return self._found
