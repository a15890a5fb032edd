"""A hundred steps of FSI3 with multigrid for fluid and solid give what LU gives."""

from pathlib import Path

import numpy as np
import pytest

from hofsi import build, evaluators, load_case, simulate

pytest.importorskip("pyamg")
pytestmark = [pytest.mark.verification, pytest.mark.slow]

SCENE = Path(__file__).parents[2] / "examples" / "fsi3.toml"


def series(solver):
    problem = build(load_case(SCENE, ["time.end=0.2", f"linear.solver={solver}"]))
    read = evaluators(problem)
    rows = np.array([[evaluate(record) for evaluate in read.values()] for record in simulate(problem)])
    return dict(zip(read, rows.T, strict=True)), problem.counts


def test_multigrid_gives_what_lu_gives(record_property):
    """The lift, which is nearly zero yet, on the scale of the drag."""
    (direct, _), (iterated, counts) = series("direct"), series("amg")
    assert len(direct["drag"]) == 100
    for name in ("fluid", "solid"):
        record_property(f"iterations of the {name}", counts[name].linear_iterations / counts[name].solves)
        assert counts[name].linear_iterations > counts[name].solves
    for name, scale in (("u_x", "u_x"), ("u_y", "u_y"), ("drag", "drag"), ("lift", "drag")):
        error = np.abs(iterated[name] - direct[name]).max() / np.abs(direct[scale]).max()
        record_property(name, error)
        assert error < 1e-6
