"""Simulations on a template: names, owners of edges and boundary checks work as with blocks of the scene's own."""

from __future__ import annotations

from pathlib import Path

import pytest

from hofsi import build, evaluators, load_case, simulate
from hofsi.cli import main
from hofsi.errors import CaseError
from hofsi.plan import plan

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def scene(tmp_path):
    """Return a function that puts a template in the place of an example's blocks."""

    def make(name, body, old="", new=""):
        text = (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8").replace(old, new)
        start, stop = text.index("[mesh.vertices]"), text.index("\n[fluid]")
        path = tmp_path / f"{name}.toml"
        template = f'[mesh.template]\nname = "flag_in_channel"\nbody = "{body}"\n'
        path.write_text(text[:start] + template + text[stop:], encoding="utf-8")
        return path

    return make


@pytest.mark.parametrize(("name", "body"), [("fsi1", "circle"), ("wall_ramm", "square")])
def test_examples_can_use_the_template(name, body, scene, capsys):
    path = scene(name, body)
    assert main(["check", str(path)]) == 0
    out = capsys.readouterr().out
    assert "11 block edges" in out  # of the interface
    assert any("mesh" in item.name for item in plan(load_case(path)).built)


def test_a_steady_case_runs(scene):
    path = scene("fsi1", "circle")
    problem = build(load_case(path, ["mesh.order=2", "output.fields=false", "output.plots=false"]))
    records = list(simulate(problem))
    drag = evaluators(problem)["drag"](records[-1])
    assert drag == pytest.approx(14.29, rel=0.03)


def test_a_boundary_without_a_condition_is_named(scene):
    path = scene("fsi1", "circle", old='on = ["top", "bottom", "cylinder"]', new='on = ["top", "bottom"]')
    with pytest.raises(
        CaseError, match=r"no condition on .*c1.*; expected exactly one on every outer edge of the fluid"
    ):
        load_case(path)
