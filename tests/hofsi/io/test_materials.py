"""Materials and motions of a scene."""

from __future__ import annotations

from typing import Any

import pytest

from hoblock.errors import SceneError
from hoblock.io.table import Table
from hoblock.scene import MeshScene
from hofsi.case import Fluid, Solid
from hofsi.io.materials import read_fluid, read_motion, read_solid

MESH = MeshScene(order=1, vertices={}, blocks={"fluid": (), "solid": ()}, edges={"wall": ()})
CONSTANTS = {"g": 9.81}


def fluid(**changes: Any) -> Fluid:
    return read_fluid(Table({"density": 2.0, "viscosity": 0.5} | changes, "fluid"), MESH, CONSTANTS)


def solid(**changes: Any) -> Solid:
    data = {"density": 3.0, "youngs_modulus": 10.0, "poissons_ratio": 0.25}
    return read_solid(Table(data | changes, "solid[1]"), MESH, CONSTANTS)


def test_defaults() -> None:
    assert fluid() == Fluid(density=2.0, viscosity=0.5, blocks=("fluid",), boundaries=())
    assert solid() == Solid("solid", 3.0, 10.0, 0.25, ("solid",), (), place="solid[1]")


def test_words() -> None:
    assert fluid(model="stokes").model == "stokes"
    assert fluid(convection="picard").convection == "picard"
    assert not fluid().skew_symmetric
    assert fluid(convection_form="skew-symmetric").skew_symmetric
    assert solid(model="linear").model == "linear"
    assert solid(model="neo-hooke").model == "neo-hooke"
    assert solid(plane="stress").plane == "stress"


def test_gravity_is_added_to_the_body_force() -> None:
    force = fluid(body_force=["x*t", "1 if t > 1 else 0"], gravity=[1.0, "-g"]).body_force
    assert force is not None
    assert force[0].evaluate(x=[1.0, 2.0], t=3.0).tolist() == [5.0, 8.0]
    assert force[1].evaluate(t=[0.0, 2.0]) == pytest.approx([-19.62, -18.62])


def test_gravity_alone() -> None:
    force = solid(gravity=[0, -2.0]).body_force
    assert force is not None
    assert force[0].is_zero
    assert force[1].value == -6.0


@pytest.mark.parametrize("zero", [{"body_force": ["0", 0.0]}, {"gravity": [0, 0]}, {"gravity": [0, "g - g"]}])
def test_a_force_that_vanishes_is_none(zero: dict[str, Any]) -> None:
    assert fluid(**zero).body_force is None
    assert solid(**zero).body_force is None


def test_initial_fields() -> None:
    velocity = fluid(initial_velocity=["y", 0]).initial_velocity
    assert velocity is not None
    assert velocity[0].evaluate(x=1.0, y=0.25) == 0.25
    assert fluid(initial_velocity=["0", "0"]).initial_velocity is None
    displacement = solid(initial_displacement=["0.1*x", "g"]).initial_displacement
    assert displacement is not None
    assert displacement[1].value == 9.81
    assert solid(initial_velocity=[0, 0]).initial_velocity is None


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"density": -1.0}, r"fluid.density: got -1.0; expected a number above 0"),
        ({"density": "heavy"}, r"fluid.density: got the text 'heavy'"),
        ({"viscosity": 0}, r"fluid.viscosity: got 0; expected a number above 0"),
        ({"viscosity": True}, r"fluid.viscosity: got the boolean true"),
        ({"model": "euler"}, r"fluid.model: got 'euler'. .*'navier-stokes', 'stokes'"),
        ({"convection": "newtn"}, r"fluid.convection: got 'newtn'. Did you mean 'newton'"),
        ({"convection_form": "skew"}, r"fluid.convection_form: got 'skew'. .*'convective', 'skew-symmetric'"),
        ({"blocks": ["fluids"]}, r"fluid.blocks: got the unknown name 'fluids'. Did you mean 'fluid'"),
        ({"blocks": []}, r"fluid.blocks: got an empty list"),
        ({"initial_velocity": ["t", 0]}, r"fluid.initial_velocity\[0\]: .*'t'"),
        ({"body_force": 1.0}, r"fluid.body_force: got the number 1(.0)?; expected two values"),
        ({"gravity": [0, 0, 1]}, r"fluid.gravity: got a list of 3"),
        ({"boundry": []}, r"fluid.boundry: unknown key. Did you mean 'boundary'"),
        ({"boundary": {}}, r"fluid.boundary: got a table; expected an array of tables"),
    ],
)
def test_mistakes_of_the_fluid(changes: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        fluid(**changes)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"density": 0}, r"solid\[1\].density: got 0"),
        ({"youngs_modulus": -1e6}, r"solid\[1\].youngs_modulus: got -1000000.0"),
        ({"poissons_ratio": 0.5}, r"solid\[1\].poissons_ratio: got 0.5; expected a number above -1 and below 0.5"),
        ({"poissons_ratio": -1}, r"solid\[1\].poissons_ratio: got -1"),
        ({"model": "neo-hook"}, r"solid\[1\].model: got 'neo-hook'. Did you mean 'neo-hooke'"),
        ({"model": "mooney-rivlin"}, r"solid\[1\].model: got 'mooney-rivlin'. .*'neo-hooke', 'linear'"),
        ({"plane": "Strain"}, r"solid\[1\].plane: got 'Strain'. Did you mean 'strain'"),
        ({"name": 3}, r"solid\[1\].name: got the number 3"),
        ({"young": 3}, r"solid\[1\].young: unknown key"),
    ],
)
def test_mistakes_of_the_solid(changes: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        solid(**changes)


def test_motion() -> None:
    motion = read_motion(Table({"on": "wall", "x": 0, "y": "x*t"}, "motion[0]"), MESH, {})
    assert (motion.on, motion.place) == (("wall",), "motion[0]")
    assert motion.x.is_zero
    assert motion.y.evaluate(x=2.0, t=3.0) == 6.0


@pytest.mark.parametrize(
    ("data", "match"),
    [
        ({"on": "wall", "x": 0}, r"motion\[0\].y: the required key is missing"),
        ({"on": "walls", "x": 0, "y": 0}, r"motion\[0\].on: got the unknown name 'walls'. Did you mean 'wall'"),
        ({"on": "wall", "x": 0, "y": 0, "z": 0}, r"motion\[0\].z: unknown key"),
    ],
)
def test_mistakes_of_a_motion(data: dict[str, Any], match: str) -> None:
    with pytest.raises(SceneError, match=match):
        read_motion(Table(data, "motion[0]"), MESH, {})
