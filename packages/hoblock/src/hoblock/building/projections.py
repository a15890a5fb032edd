"""Vertices moved onto the curves of their paths, where a scene asks for it."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.building.curves import whole_curve
from hoblock.building.paths import at
from hoblock.curves import Curve, closest_parameters
from hoblock.errors import CurveError
from hoblock.scene import MeshScene, Path
from hoblock.scene.curves import Isoline, WholeShape
from hoblock.topology_checks import tolerance

Array = NDArray[np.float64]

_REACH = 0.5  # of an edge's length, as of level sets: how far a vertex may be moved onto a curve

__all__ = ["project_onto_curves"]


def project_onto_curves(scene: MeshScene) -> MeshScene:
    """Move the inner vertices of paths with ``project = true`` to the nearest point of the path's curve.

    Raises
    ------
    CurveError
        If there is no curve, a vertex would have to be moved by more than half of the shorter edge at it on the path,
        or is to be moved onto something else too.
    """
    if not any(entry.project for entry in scene.curves):
        return scene
    allowed = tolerance(np.array(list(scene.vertices.values())))
    owners = {
        name: entry.place
        for entry in scene.curves
        if isinstance(entry.shape, Isoline) and entry.shape.project
        for path in entry.on
        for name in path
    }
    moved = dict(scene.vertices)
    for entry in scene.curves:
        if entry.project and isinstance(entry.shape, WholeShape):
            curve, path = whole_curve(entry, entry.shape, scene.vertices, allowed), entry.on[0]
            with at(f"{entry.place}.project"):
                found = _nearest(curve, path, np.array([scene.vertices[name] for name in path]))
            for name, x, y in zip(path[1:-1], *found.T.tolist(), strict=True):
                if name in owners:
                    raise CurveError(
                        f"{entry.place}.project: vertex '{name}' is to be moved onto this curve and onto that of "
                        f"{owners[name]}; expected one of them. Put it where they meet and remove 'project' from one."
                    )
                owners[name], moved[name] = entry.place, (x, y)
    return replace(scene, vertices=MappingProxyType(moved))


def _nearest(curve: Curve, path: Path, places: Array) -> Array:
    """Nearest points of a curve to the inner vertices of a path."""
    found = np.asarray(curve(closest_parameters(curve, places[1:-1])[0]))
    lengths = np.hypot(*np.diff(places, axis=0).T)
    distances, allowed = np.hypot(*(found - places[1:-1]).T), _REACH * np.minimum(lengths[:-1], lengths[1:])
    if (distances > allowed).any():
        k = int(np.argmax(distances / allowed))
        raise CurveError(
            f"vertex '{path[k + 1]}' is {distances[k]:.3g} away from the curve, whose closest point is "
            f"({found[k, 0]:.10g}, {found[k, 1]:.10g}); expected at most {allowed[k]:.3g}, half of the shorter edge at "
            "it. Move it nearer."
        )
    return found
