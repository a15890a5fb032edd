"""``[mover]`` of a scene."""

from __future__ import annotations

from typing import Any

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import AngleOptimisationSettings, BarrierSettings, MoverSettings, PseudoSolidSettings, RuleSettings
from hofsi.io.movers import read_mover

VERTICES = {"a": (0.0, 0.0), "b": (1.0, 0.0), "m1": (0.0, 1.0), "m 2": (1.0, 1.0)}
MESH = MeshScene(order=2, vertices=VERTICES, blocks={"fluid": ()}, edges={"wall": (), "inlet": ()})


def read(**data: Any) -> MoverSettings:
    return read_mover(Table(data, "mover"), MESH, {"half": 0.5})


def test_the_default_is_the_barrier_energy() -> None:
    assert read() == BarrierSettings() == read(type="barrier")


def test_barrier() -> None:
    values: dict[str, Any] = {"energy": "ang", "size_weight": 0.0, "emphasis": 2.0, "length_weight": 0.3}
    assert read(type="barrier", **values) == BarrierSettings(**values)


def test_pseudo_solid() -> None:
    data: dict[str, Any] = {"exponent": 2.0, "poissons_ratio": -0.5, "incremental": True}
    assert read(type="pseudo-solid", **data) == PseudoSolidSettings(**data)


def test_angle_optimisation() -> None:
    assert read(type="angle-optimisation") == AngleOptimisationSettings()
    values: dict[str, Any] = {
        "power": 4, "sweeps": 7, "iterations": 2, "lower": 0.25, "upper": 3.0, "penalty": 5.0, "radius": 0.05,
        "projection": "end", "damping": 0.0,
    }  # fmt: skip
    assert read(type="angle-optimisation", **values) == AngleOptimisationSettings(**values)


@pytest.mark.parametrize("kind", ["barrier", "pseudo-solid", "angle-optimisation"])
def test_what_all_have_in_common(kind: str) -> None:
    settings = read(type=kind, sliding=["wall", "inlet"], inherit="none", halvings=0)
    assert (settings.sliding, settings.inherit, settings.halvings) == (("wall", "inlet"), "none", 0)


def test_rule() -> None:
    rule = {"names": ["m1", "m 2"], "x": "half*dx_a", "y": "dy_b*(1 - y)"}
    settings = read(type="rule", vertex=[rule])
    assert isinstance(settings, RuleSettings)
    assert [one.name for one in settings.vertices] == ["m1", "m 2"]
    assert settings.vertices[0].x.evaluate(dx_a=3.0) == 1.5
    assert settings.vertices[1].y.evaluate(dy_b=2.0, y=0.25) == 1.5


RULE = {"names": "m1", "x": 0, "y": 0}


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({"type": "pseudosolid"}, r"mover.type: got 'pseudosolid'. Did you mean 'pseudo-solid'"),
        ({"energy": "angles"}, r"mover.energy: got 'angles'"),
        ({"length_weight": 0}, r"mover.length_weight: got 0"),
        ({"emphasis": -1}, r"mover.emphasis: got -1"),
        ({"type": "pseudo-solid", "poissons_ratio": 0.5}, r"mover.poissons_ratio: got 0.5"),
        ({"power": 2}, r"mover.power: unknown key"),
        ({"sliding": ["walls"]}, r"mover.sliding: got the unknown name 'walls'. Did you mean 'wall'"),
        ({"inherit": "some"}, r"mover.inherit: got 'some'"),
        ({"halvings": -1}, r"mover.halvings: got -1"),
        ({"type": "angle-optimisation", "power": 3}, r"mover.power: got 3; expected 1 or an even number"),
        ({"type": "angle-optimisation", "exponent": 3}, r"mover.exponent: unknown key"),
        ({"type": "angle-optimisation", "lower": 1.0}, r"mover.lower: got 1.0; .* below 1"),
        ({"type": "angle-optimisation", "upper": 0.5}, r"mover.upper: got 0.5; .* above 1"),
        ({"type": "angle-optimisation", "projection": "always"}, r"mover.projection: got 'always'"),
        ({"type": "angle-optimisation", "radius": 0}, r"mover.radius: got 0"),
        ({"type": "angle-optimisation", "damping": -1}, r"mover.damping: got -1"),
        ({"type": "rule"}, r"mover: a rule moves no vertex; expected at least one \[\[mover.vertex\]\]"),
        (
            {"type": "rule", "vertex": [RULE, RULE]},
            r"mover.vertex\[1\]: vertex 'm1' has a rule already in mover.vertex\[0\]",
        ),
        ({"type": "rule", "vertex": [{**RULE, "names": "m3"}]}, r"mover.vertex\[0\].names: got the unknown name 'm3'"),
        (
            {"type": "rule", "vertex": [{**RULE, "x": "dx_c"}]},
            r"mover.vertex\[0\].x: .*the name 'dx_c' is not known. Did you mean 'dx_",
        ),
    ],
)
def test_mistakes(data: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read(**data)
