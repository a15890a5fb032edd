"""From the level sets of a scene to curves; vertices moved onto them where the scene asks for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from hoblock.building.paths import at, pairs_of
from hoblock.curves import LevelSet, crossing_of_level_sets, nearest_on_level_set
from hoblock.errors import CurveError
from hoblock.expressions import Expression
from hoblock.scene import MeshScene
from hoblock.scene.curves import Isoline

Array = NDArray[np.float64]

__all__ = ["level_set", "project_vertices"]

_SAME = 1e-9  # of an edge's length: distance from a level set within which a vertex lies on it


@dataclass(frozen=True)
class _Claim:
    """A level set that a vertex is to be moved onto: where the scene says so, and the shortest edge it is on there."""

    shape: Isoline
    place: str
    length: float

    @property
    def reach(self) -> float:
        return self.shape.reach * self.length

    def nearest(self, point: Array) -> Array:
        shape = self.shape
        found = nearest_on_level_set(_function(shape), point[None, :], level=shape.level, reach=self.reach)
        return np.asarray(found[0])

    def holds(self, point: Array) -> bool:
        """Whether the point is on the level set."""
        try:
            return float(np.hypot(*(self.nearest(point) - point))) <= _SAME * self.length
        except CurveError:
            return False


def level_set(shape: Isoline, first: Array, second: Array) -> LevelSet:
    """Return the isoline between two vertices."""
    return LevelSet(_function(shape), tuple(first), tuple(second), shape.level, shape.reach)


def project_vertices(scene: MeshScene) -> MeshScene:
    """Move the vertices on level sets with ``project = true`` onto these: to the nearest point, or where two cross.

    Raises
    ------
    CurveError
        If there is no such point within the level set's reach, or a vertex would have to lie on three level sets.
    """
    claims = _claims(scene)
    if not claims:
        return scene
    moved = {name: _moved(name, np.array(scene.vertices[name]), asked) for name, asked in claims.items()}
    return replace(scene, vertices=MappingProxyType({**scene.vertices, **moved}))


def _claims(scene: MeshScene) -> dict[str, list[_Claim]]:
    """The level sets that ask for vertices, by vertex."""
    claims: dict[str, list[_Claim]] = {}
    for entry in scene.curves:
        if isinstance(entry.shape, Isoline) and entry.shape.project:
            lengths: dict[str, float] = {}
            for pair in (pair for path in entry.on for pair in pairs_of(path)):
                first, second = (np.array(scene.vertices[name]) for name in pair)
                length = float(np.hypot(*(second - first)))
                for name in pair:
                    lengths[name] = min(lengths.get(name, np.inf), length)
            for name, length in lengths.items():
                claims.setdefault(name, []).append(_Claim(entry.shape, entry.place, length))
    return claims


def _moved(name: str, vertex: Array, claims: list[_Claim]) -> tuple[float, float]:
    """The place of a vertex on all level sets that ask for it."""
    first, *others = claims
    with at(f"{first.place}.project, vertex '{name}'"):
        point = first.nearest(vertex)
    second = next((claim for claim in others if not claim.holds(point)), None)
    if second is not None:
        with at(f"{second.place}.project, vertex '{name}', which is on {first.place} too"):
            point = crossing_of_level_sets(
                (_function(first.shape), _function(second.shape)),
                vertex,
                levels=(first.shape.level, second.shape.level),
                reach=min(first.reach, second.reach),
            )
    for claim in others:
        if not claim.holds(point):
            raise CurveError(
                f"{claim.place}.project: vertex '{name}' is on more than two level sets, which do not meet in one "
                f"point near ({vertex[0]:.6g}, {vertex[1]:.6g}); expected two at most. Leave 'project' out of one."
            )
    return float(point[0]), float(point[1])


def _function(shape: Isoline) -> Callable[[Array], Array]:
    """The function of points that a level set belongs to."""
    function = shape.function
    if not isinstance(function, Expression):
        return function

    def evaluate(points: Array) -> Array:
        return np.broadcast_to(function.evaluate(x=points[:, 0], y=points[:, 1]), points.shape[:1])

    return evaluate
