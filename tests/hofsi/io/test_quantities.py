"""Quantities of a scene."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import Any

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import (
    FlowBalance,
    FlowRate,
    FluidIntegral,
    Force,
    MeanPressure,
    Moment,
    Point,
    PressureDifference,
    Probe,
    SolidIntegral,
)
from hofsi.errors import CaseError
from hofsi.io.quantities import read_quantity

MESH = MeshScene(order=1, vertices={"A": (0.6, 0.2)}, blocks={}, edges={"cylinder": (), "flag": ()})
FORCE = 'on = ["cylinder", "flag"]\ncomponent = "x"'


def read(text: str) -> Any:
    return read_quantity("q", Table(tomllib.loads(text), "quantities.q"), MESH, {"r": 0.05})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('field = "displacement"\ncomponent = "y"\nat = "A"', ("displacement", "y", Point(0.6, 0.2, "A"), "solid")),
        (
            'field = "displacement"\ncomponent = "x"\nat = [1, 2]\nof = "fluid"',
            ("displacement", "x", Point(1, 2), "fluid"),
        ),
        ('field = "velocity"\ncomponent = "magnitude"\nat = [1, 2]', ("velocity", "magnitude", Point(1, 2), "fluid")),
        ('field = "velocity"\ncomponent = "x"\nat = [1, 2]\nof = "solid"', ("velocity", "x", Point(1, 2), "solid")),
        ('field = "pressure"\nat = ["2*r", 0]', ("pressure", None, Point(0.1, 0.0), "fluid")),
    ],
)
def test_probe(text: str, expected: tuple[Any, ...]) -> None:
    assert read('type = "probe"\n' + text) == Probe("q", *expected, place="quantities.q")


def test_force() -> None:
    assert read(f'type = "force"\n{FORCE}\nfactor = -2') == Force("q", ("cylinder", "flag"), "x", -2.0, "quantities.q")


def test_coefficient_is_a_force_with_a_factor() -> None:
    force = read(f'type = "coefficient"\n{FORCE}\ndensity = 1.0\nvelocity = 0.2\nlength = 0.1')
    assert isinstance(force, Force)
    assert force.factor == pytest.approx(500.0)


MOMENT = 'on = "cylinder"\nabout'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f'type = "moment"\n{MOMENT} = "A"\nfactor = 3', Moment("q", ("cylinder",), Point(0.6, 0.2, "A"), 3.0)),
        ('type = "flow-rate"\non = ["flag", "cylinder"]', FlowRate("q", ("flag", "cylinder"))),
        ('type = "flow-rate"\non = "flag"\nrelative_to = "mesh"', FlowRate("q", ("flag",), relative=True)),
        ('type = "flow-balance"', FlowBalance("q")),
        ('type = "mean-pressure"\non = "flag"', MeanPressure("q", ("flag",))),
        ('type = "kinetic-energy"', FluidIntegral("q", "kinetic-energy")),
        ('type = "kinetic-energy"\nof = "fluid"', FluidIntegral("q", "kinetic-energy")),
        ('type = "kinetic-energy"\nof = "solid"', SolidIntegral("q", "kinetic-energy")),
        ('type = "strain-energy"', SolidIntegral("q", "strain-energy")),
        ('type = "continuity-residual"', FluidIntegral("q", "continuity-residual")),
        ('type = "probe"\nfield = "vorticity"\nat = [1, 2]', Probe("q", "vorticity", None, Point(1, 2), "fluid")),
    ],
)
def test_quantities_of_the_fluid(text: str, expected: Any) -> None:
    assert read(text) == replace(expected, place="quantities.q")


def test_moment_about_a_place_that_moves() -> None:
    moment = read(f'type = "moment-coefficient"\n{MOMENT} = ["r*t", 1]\ndensity = 2\nvelocity = 3\nlength = 0.5')
    assert moment.factor == pytest.approx(2.0 / (2.0 * 9.0 * 0.25))
    assert [float(part.evaluate(t=2.0)) for part in moment.about] == pytest.approx([0.1, 1.0])


def test_function_of_time() -> None:
    assert float(read('type = "expression"\nvalue = "r*t**2"').value.evaluate(t=2.0)) == pytest.approx(0.2)


def test_pressure_difference() -> None:
    expected = PressureDifference("q", Point(0.15, 0.2), Point(0.6, 0.2, "A"), "quantities.q")
    assert read('type = "pressure-difference"\nfrom = [0.15, 0.2]\nto = "A"') == expected


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ('type = "prob"', r"quantities.q.type: got 'prob'. Did you mean 'probe'"),
        ('type = "probe"\nat = "A"', r"quantities.q.field: the required key is missing"),
        ('type = "probe"\nat = "A"\nfield = "stress"', r"quantities.q.field: got 'stress'"),
        ('type = "probe"\nat = "A"\nfield = "velocity"', r"quantities.q.component: the required key is missing"),
        ('type = "probe"\nat = "A"\nfield = "velocity"\ncomponent = "z"', r"quantities.q.component: got 'z'"),
        ('type = "probe"\nat = [1]\nfield = "pressure"', r"quantities.q.at: got a list of 1"),
        ('type = "probe"\nat = "A"\nfield = "pressure"\nof = "air"', r"quantities.q.of: got 'air'"),
        ('type = "force"\non = "flag"\ncomponent = "magnitude"', r"quantities.q.component: got 'magnitude'"),
        (f'type = "force"\n{FORCE}\nlength = 1', r"quantities.q.length: unknown key"),
        (f'type = "coefficient"\n{FORCE}\ndensity = 1\nvelocity = 0\nlength = 1', r"quantities.q.velocity: got 0"),
        (f'type = "coefficient"\n{FORCE}\nvelocity = 1\nlength = 1', r"q.density: the required key is missing"),
        ('type = "pressure-difference"\nfrom = "A"', r"quantities.q.to: the required key is missing"),
        ('type = "flow-rate"', r"quantities.q.on: the required key is missing"),
        (
            'type = "flow-rate"\non = "flag"\nrelative_to = "body"',
            r"relative_to: got 'body'. Expected one of",
        ),
        ('type = "moment"\non = "flag"', r"quantities.q.about: the required key is missing"),
        ('type = "moment"\non = "flag"\nabout = ["x", 0]', r"q.about\[0\]: .* the name 'x' has no meaning here"),
        ('type = "expression"\nvalue = "y"', r"quantities.q.value: .* the name 'y' has no meaning here"),
        ('type = "kinetic-energy"\non = "flag"', r"quantities.q.on: unknown key"),
    ],
)
def test_mistakes(text: str, match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read(text)


@pytest.mark.parametrize("name", ["", " ", "drag ", "a\nb", "a\tb"])
def test_names_that_no_table_can_have(name: str) -> None:
    table = Table(tomllib.loads('type = "probe"\nfield = "pressure"\nat = [0, 0]'), "quantities.q")
    with pytest.raises(CaseError, match=r"quantities.q: got the name .* expected printable characters"):
        read_quantity(name, table, MESH, {})
    assert read_quantity("c_D, mean ü", table, MESH, {}).name == "c_D, mean ü"


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ('type = "probe"\nat = "a"\nfield = "pressure"', r"q.at: got the unknown name 'a'. Did you mean 'A'"),
        ('type = "force"\non = "flg"\ncomponent = "x"', r"q.on: got the unknown name 'flg'. Did you mean 'flag'"),
        ('type = "probe"\nat = "A"\nfield = "pressure"\ncomponent = "x"', r"component: pressure has no components"),
        ('type = "probe"\nat = "A"\nfield = "vorticity"\ncomponent = "x"', r"component: vorticity has no components"),
        ('type = "moment"\non = "flag"\nabout = "B"', r"q.about: got the unknown name 'B'"),
        ('type = "probe"\nat = "A"\nfield = "pressure"\nof = "solid"', r"q.of: got 'solid', .* expected 'fluid'"),
    ],
)
def test_impossible_quantities(text: str, match: str) -> None:
    with pytest.raises(CaseError, match=match):
        read(text)
