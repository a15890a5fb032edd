"""Values of cases by their keys, and which may change when a run is resumed."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from hofsi.case import Case
from hofsi.case_values import Change, case_values, changes
from hofsi.errors import RestartError

Read = Callable[..., Case]


def between(read_changed: Read, *exchanged: tuple[str, str]) -> list[Change]:
    return changes(case_values(read_changed()), case_values(read_changed(*exchanged)))


def test_a_case_has_its_values_by_their_keys(read_changed: Read) -> None:
    values = case_values(read_changed())
    assert values["mesh.order"] == "2"
    assert values["mesh.vertices.a2"] == "(0.0, 1.0)"
    assert values["fluid.boundary[0].x"] == '"4*U*y*(H - y)/H**2*sin(t)" with 6.0, 1.0, 1.0'
    assert values["fluid.boundary[1].on"] == "('bottom', 'top')"
    assert (values["time.dt"], values["time.solid"], values["coupling.reuse"]) == ("0.1", "bdf2", "10")
    assert values["quantities.u_x.at.vertex"] == "b1"
    assert all(isinstance(value, str) for value in values.values())


def test_equal_cases_have_equal_values(read_changed: Read) -> None:
    assert between(read_changed) == []
    assert between(read_changed, ('title = "Flap in a channel"', 'title = "Another"')) == []


@pytest.mark.parametrize(
    ("old", "new", "told", "of_matrices"),
    [
        ("dt = 0.1", "dt = 0.05", "time.dt = 0.05 instead of 0.1", False),
        ("end = 2.0", "end = 3.0", "time.end = 3.0 instead of 2.0", False),
        ("[coupling]", "[coupling]\ntolerance = 1e-5", "coupling.tolerance = 1e-05 instead of 1e-06", False),
        ("[output]", "[output]\nevery = 2", "output.every = 2 instead of 10", False),
        ("[coupling]", "[linear]\nlag = false", "linear.lag = False instead of True", True),
        ("[coupling]", "[mover]\nsize_weight = 2.0", "mover.size_weight = 2.0 instead of 1.0", True),
        ("viscosity = 0.01", "viscosity = 0.02", "fluid.viscosity = 0.02 instead of 0.01", True),
        ("youngs_modulus = 1e3", "youngs_modulus = 2e3", "solid[0].youngs_modulus = 2000.0 instead of 1000.0", True),
        (
            "density = 3.0",
            'density = 3.0\ninitial_velocity = ["y", "0"]',
            'solid[0].initial_velocity = ["y", 0.0] instead of nothing, which has no effect any more',
            False,
        ),
    ],
)
def test_what_may_change_is_told(read_changed: Read, old: str, new: str, told: str, of_matrices: bool) -> None:
    found = between(read_changed, (old, new))
    assert told in [str(change) for change in found]
    assert any(change.of_matrices for change in found) == of_matrices


def test_a_constant_changes_the_expressions_it_is_in(read_changed: Read) -> None:
    (change,) = between(read_changed, ("U = 1.5", "U = 2.0"))
    assert (change.key, change.old) == ("fluid.boundary[0].x", '"4*U*y*(H - y)/H**2*sin(t)" with 6.0, 1.0, 1.0')
    assert change.new.endswith("with 8.0, 1.0, 1.0")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("order = 2", "order = 3", r"mesh\.order: got 3; expected 2, with which the run was made"),
        ("dt = 0.1", "dt = 0.1\nstart = 0.5", r"time\.start: got 0\.5; expected 0\.0"),
        (
            "poissons_ratio = 0.4",
            'poissons_ratio = 0.4\nplane = "stress"',
            r"solid\[0\]\.plane: got stress; expected strain",
        ),
        ("\ny = 0\n", "\n", r"fluid\.boundary\[0\]\.y: got nothing; expected 0\.0"),
        (
            'on = ["flap", "bottom"]',
            'on = ["flap"]',
            r"quantities\.lift\.on: got \('flap',\); expected \('flap', 'b",
        ),
        ("[mesh.blocks]", "[[mesh.count]]\non = [['a0', 'b0']]\nelements = 2\n\n[mesh.blocks]", r"mesh\.count"),
    ],
)
def test_what_decides_the_meaning_of_a_state_cannot_change(
    read_changed: Read, old: str, new: str, message: str
) -> None:
    with pytest.raises(RestartError, match=message):
        between(read_changed, (old, new))
