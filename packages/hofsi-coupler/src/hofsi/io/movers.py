"""``[mover]`` of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import (
    AngleOptimisationSettings,
    BarrierSettings,
    MotionSettings,
    MoverSettings,
    PseudoSolidSettings,
    RuleSettings,
    RuleVertex,
)
from hofsi.errors import CaseError
from hofsi.io.names import check_name, choice

__all__ = ["read_mover"]

_KINDS = ("barrier", "pseudo-solid", "angle-optimisation", "rule")


def read_mover(table: Table, mesh: MeshScene, constants: Mapping[str, float]) -> MoverSettings:
    """Read ``[mover]``.

    Raises
    ------
    SceneError
        An unknown key, a value of the wrong type or out of range.
    CaseError
        An unknown name, or a rule that does not say what moves.
    """
    kind = choice(table, "type", _KINDS, "barrier")
    common = _common(table, mesh)
    settings: MoverSettings
    if kind == "barrier":
        settings = _barrier(table, common)
    elif kind == "pseudo-solid":
        settings = _pseudo_solid(table, common)
    elif kind == "rule":
        settings = _rule(table, common, mesh, constants)
    else:
        settings = _angle_optimisation(table, common)
    table.finish()
    return settings


def _common(table: Table, mesh: MeshScene) -> dict[str, Any]:
    default = MotionSettings()
    names = table.names("sliding", default.sliding)
    for name in names:
        check_name(name, mesh.edges, "edges in [mesh.edges]", table.place_of("sliding"))
    return {
        "sliding": names,
        "inherit": choice(table, "inherit", ("auto", "all", "none"), default.inherit),
        "halvings": table.integer("halvings", default.halvings, minimum=0, maximum=20),
    }


def _barrier(table: Table, common: Mapping[str, Any]) -> BarrierSettings:
    default = BarrierSettings()
    return BarrierSettings(
        energy=choice(table, "energy", ("bar", "ang"), default.energy),
        size_weight=table.number("size_weight", default.size_weight, minimum=0.0),
        emphasis=table.number("emphasis", default.emphasis, minimum=0.0),
        length_weight=table.number("length_weight", default.length_weight, positive=True),
        **common,
    )


def _pseudo_solid(table: Table, common: Mapping[str, Any]) -> PseudoSolidSettings:
    default = PseudoSolidSettings()
    return PseudoSolidSettings(
        exponent=table.number("exponent", default.exponent),
        poissons_ratio=table.number("poissons_ratio", default.poissons_ratio, above=-1.0, below=0.5),
        incremental=table.boolean("incremental", default.incremental),
        **common,
    )


def _angle_optimisation(table: Table, common: Mapping[str, Any]) -> AngleOptimisationSettings:
    form = choice(table, "form", ("robust", "published"), "robust")
    default = AngleOptimisationSettings.as_published() if form == "published" else AngleOptimisationSettings()
    power = table.integer("power", default.power, minimum=1)
    if power > 1 and power % 2:
        raise CaseError(f"got {power}; expected 1 or an even number", table.place_of("power"))
    lower = table.number("lower", default.lower, above=0.0, below=1.0)
    return AngleOptimisationSettings(
        power=power,
        sweeps=table.integer("sweeps", default.sweeps, minimum=1),
        iterations=table.integer("iterations", default.iterations, minimum=1),
        lower=lower,
        upper=table.number("upper", default.upper, above=1.0),
        penalty=table.number("penalty", default.penalty, minimum=0.0),
        radius=table.number("radius", default.radius, positive=True),
        projection=choice(table, "projection", ("every", "end"), default.projection),
        damping=table.number("damping", default.damping, minimum=0.0),
        predictor=table.boolean("predictor", default.predictor),
        ideal=choice(table, "ideal", ("reference", "right"), default.ideal),
        **common,
    )


def _rule(table: Table, common: Mapping[str, Any], mesh: MeshScene, constants: Mapping[str, float]) -> RuleSettings:
    variables = ("x", "y", *(f"{d}_{name}" for name in mesh.vertices if name.isidentifier() for d in ("dx", "dy")))
    vertices: dict[str, RuleVertex] = {}
    for one in table.tables("vertex"):
        names = one.names("names")
        x, y = (one.expression(key, variables, constants) for key in ("x", "y"))
        one.finish()
        for name in names:
            check_name(name, mesh.vertices, "vertices in [mesh.vertices]", one.place_of("names"))
            if name in vertices:
                raise CaseError(f"vertex {name!r} has a rule already in {vertices[name].place}; remove one", one.place)
            vertices[name] = RuleVertex(name, x, y, one.place)
    if not vertices:
        raise CaseError(
            "a rule moves no vertex; expected at least one [[mover.vertex]] with names, x and y", table.place
        )
    return RuleSettings(vertices=tuple(vertices.values()), **common)
