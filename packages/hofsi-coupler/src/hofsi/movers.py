"""The mover that a case asks for, made for the fluid's blocks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hoblock import BlockStructure, QuadMesh
from hoblock.motion import DrivenEdges
from hoblock.movers import Mover, Rule, sliding_vertices
from hofsi.case import (
    AngleOptimisationSettings,
    BarrierSettings,
    MotionSettings,
    MoverSettings,
    PseudoSolidSettings,
    RuleSettings,
)
from hofsi.errors import CaseError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

__all__ = ["make_mover", "placed_vertices"]


def make_mover(settings: MoverSettings, structure: BlockStructure, mesh: QuadMesh, driven: DrivenEdges) -> Mover:
    """Make a mover; only what it needs is imported.

    Parameters
    ----------
    settings : MoverSettings
    structure : BlockStructure
        The fluid's blocks in their reference position.
    mesh : QuadMesh
        Their mesh.
    driven : DrivenEdges

    Raises
    ------
    CaseError
        If vertices cannot slide where they should, or a rule is about others than free vertices.
    MoverError
        If the blocks do not suit the mover.
    """
    free, sliding = placed_vertices(settings, structure, driven)
    match settings:
        case BarrierSettings():
            from hoblock.movers import BarrierEnergy

            edges = np.array(driven.edges, dtype=np.int64)
            return BarrierEnergy(
                structure,
                driven.vertices,
                edges=edges,
                tangents=driven.tangents(mesh.points[driven.nodes], driven.end_rows(edges)),
                sliding=sliding,
                energy=settings.energy,
                size_weight=settings.size_weight,
                emphasis=settings.emphasis,
                length_weight=settings.length_weight,
            )
        case PseudoSolidSettings():
            from hoblock.movers import PseudoSolid

            return PseudoSolid(
                structure,
                driven.vertices,
                exponent=settings.exponent,
                poissons_ratio=settings.poissons_ratio,
                sliding=sliding,
                incremental=settings.incremental,
            )
        case RuleSettings():
            function = _rule(settings, structure, driven.vertices, np.concatenate([free, sliding]))
            return Rule(structure, driven.vertices, function, sliding=sliding)
        case AngleOptimisationSettings():
            return _angle_optimisation(settings, structure, driven.vertices, sliding)


def placed_vertices(settings: MoverSettings, structure: BlockStructure, driven: DrivenEdges) -> tuple[Index, Index]:
    """Vertices inside and on the boundary that a mover places, ascending; a rule is checked, too.

    Raises
    ------
    CaseError
        As `make_mover`.
    """
    names = structure.topology.edge_groups
    edges = [int(edge) for name in _sides(settings, structure, driven) for edge in names[name]]
    slides = sliding_vertices(structure, edges, driven.vertices)
    placed = Rule(structure, driven.vertices, np.zeros_like, sliding=slides)
    if isinstance(settings, RuleSettings):
        _rule(settings, structure, driven.vertices, np.concatenate([placed.free, placed.paths.vertices]))
    return placed.free, placed.paths.vertices


def _angle_optimisation(
    settings: AngleOptimisationSettings, structure: BlockStructure, driven: Index, sliding: Index
) -> Mover:
    from hoblock.movers import AngleOptimisation

    return AngleOptimisation(
        structure,
        driven,
        power=settings.power,
        sweeps=settings.sweeps,
        iterations=settings.iterations,
        lower=settings.lower,
        upper=settings.upper,
        penalty=settings.penalty,
        radius=settings.radius,
        projection=settings.projection,
        damping=settings.damping,
        predictor=settings.predictor,
        ideal=settings.ideal,
        sliding=sliding,
    )


def _sides(settings: MotionSettings, structure: BlockStructure, driven: DrivenEdges) -> tuple[str, ...]:
    """Names of the sides along which vertices slide, checked."""
    groups = structure.topology.edge_groups
    for name in settings.sliding:
        outer = name in groups and (structure.topology.blocks_per_edge[groups[name]] == 1).all()
        if not outer or np.isin(groups[name], driven.edges).any():
            raise CaseError(
                f"{name!r} is not a side of the fluid that stands still; expected names of outer edges that do not "
                "move, along which block vertices can slide",
                "mover.sliding",
            )
    return settings.sliding


def _rule(settings: RuleSettings, structure: BlockStructure, driven: Index, placed: Index) -> Callable[[Array], Array]:
    """The rule as a function of the driven vertices' displacement."""
    names = structure.topology.vertex_names
    rows = {names[vertex]: k for k, vertex in enumerate(driven.tolist())}
    rules = {rule.name: rule for rule in settings.vertices}
    movable = {names[vertex] for vertex in placed.tolist()}
    for rule in settings.vertices:
        if rule.name not in movable:
            raise CaseError(
                f"vertex {rule.name!r} cannot follow a rule: it is driven, fixed on the boundary, or not of the fluid; "
                "expected vertices inside the fluid, or sliding ones",
                rule.place,
            )
        for used in (rule.x.variables_used | rule.y.variables_used) - {"x", "y"}:
            if used[3:] not in rows:
                raise CaseError(
                    f"{used!r} is the displacement of vertex {used[3:]!r}, which is not driven; expected one of "
                    f"{', '.join(rows)}",
                    rule.place,
                )
    followed = [(k, rules[names[vertex]]) for k, vertex in enumerate(placed.tolist()) if names[vertex] in rules]
    start = structure.vertices[placed]

    def function(displacement: Array) -> Array:
        result = np.zeros((len(placed), 2))
        known = {
            f"{d}_{name}": float(displacement[k, i]) for name, k in rows.items() for i, d in enumerate(("dx", "dy"))
        }
        for k, rule in followed:
            for i, part in enumerate((rule.x, rule.y)):
                values = {"x": start[k, 0], "y": start[k, 1], **known}
                result[k, i] = part.evaluate(**{name: values[name] for name in part.variables_used})
        return result

    return function
