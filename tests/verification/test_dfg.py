"""DFG 2D-1, steady flow past a cylinder at Re = 20, against FeatFlow's values.

Schäfer & Turek, Notes on Numerical Fluid Mechanics 52 (1996) 547–566. The drag, lift and pressure difference are those
of FeatFlow (TU Dortmund); the bounds are the paper's.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from hofsi.build import build
from hofsi.io.scene import load_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate

SCENE = Path(__file__).resolve().parents[2] / "examples" / "dfg_2d_1.toml"
DRAG, LIFT, DROP = 5.57953523384, 0.010618948146, 0.11752016697

pytestmark = [pytest.mark.verification, pytest.mark.slow]


@pytest.mark.parametrize(
    ("order", "drag", "lift", "drop"),
    [(4, 1e-5, 2e-5, 5e-5), (6, 1e-7, 1e-7, 1e-7), (8, 1e-10, 1e-10, 1e-8), (10, 1e-11, 1e-11, 1e-10)],
)
def test_flow_past_a_cylinder(order, drag, lift, drop, record_property):
    problem = build(load_case(SCENE, [f"mesh.order={order}"]))
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in evaluators(problem).items()}
    for name, value in found.items():
        record_property(name, value)
    assert 5.57 < found["c_D"] < 5.59
    assert 0.0104 < found["c_L"] < 0.0110
    assert 0.1172 < found["dp"] < 0.1176
    assert found["c_D"] == pytest.approx(DRAG, rel=drag)
    assert found["c_L"] == pytest.approx(LIFT, abs=lift)
    assert found["dp"] == pytest.approx(DROP, abs=drop)


def test_48_elements_of_order_10_have_errors_below_1e_8():
    counts = [f"mesh.count[{entry}].elements={count}" for entry, count in enumerate((1, 2, 4, 3))]
    problem = build(load_case(SCENE, ["mesh.order=10", *counts]))
    (record,) = simulate(problem)
    found = {name: evaluate(record) for name, evaluate in evaluators(problem).items()}
    assert found == pytest.approx({"c_D": DRAG, "c_L": LIFT, "dp": DROP}, rel=0.0, abs=1e-8)
