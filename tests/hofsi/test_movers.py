"""The mover that a scene asks for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from hoblock.movers import AngleOptimisation, BarrierEnergy, PseudoSolid, Rule
from hofsi.build import build
from hofsi.case import Case
from hofsi.errors import CaseError, MeshMotionError
from hofsi.plan import plan
from hofsi.simulate import simulate

Read = Callable[..., Case]

# A second row of blocks over the flap, so that b2 and c2 are free.
TALL = (
    ('a2 = [0, "H"]', 'a2 = [0, 0.75]\na3 = [0, "H"]'),
    ('b2 = [1, "H"]', 'b2 = [1, 0.75]\nb3 = [1, "H"]'),
    ('c2 = [1.2, "H"]', 'c2 = [1.2, 0.75]\nc3 = [1.2, "H"]'),
    ('d2 = [3, "H"]', 'd2 = [3, 0.75]\nd3 = [3, "H"]'),
    (
        '["c1", "d1", "d2", "c2"],',
        '["c1", "d1", "d2", "c2"],\n["a2", "b2", "b3", "a3"], ["b2", "c2", "c3", "b3"], ["c2", "d2", "d3", "c3"],',
    ),
    ('inlet = [["a0", "a1", "a2"]]', 'inlet = [["a0", "a1", "a2", "a3"]]'),
    ('outlet = [["d0", "d1", "d2"]]', 'outlet = [["d0", "d1", "d2", "d3"]]'),
    ('top = [["a2", "b2", "c2", "d2"]]', 'top = [["a3", "b3", "c3", "d3"]]'),
    ("end = 2.0", "end = 0.3"),
)


def mover(text: str) -> tuple[str, str]:
    return "[time]", f"[mover]\n{text}\n\n[time]"


RULE = """type = "rule"

[[mover.vertex]]
names = ["b2", "c2"]
x = "0.5*(dx_b1 + dx_c1)"
y = "2*(1 - y)*dy_b1"
"""


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", BarrierEnergy),
        ('energy = "ang"\nsliding = "top"', BarrierEnergy),
        ('type = "pseudo-solid"\nsliding = ["top", "inlet"]', PseudoSolid),
        ('type = "pseudo-solid"\nincremental = true', PseudoSolid),
        ('type = "angle-optimisation"\nsliding = "top"', AngleOptimisation),
        (RULE, Rule),
    ],
)
def test_every_mover_runs_coupled(read_changed: Read, text: str, kind: type) -> None:
    problem = build(read_changed(*TALL, mover(text)))
    assert problem.fluid is not None
    assert problem.fluid.motion is not None
    assert isinstance(problem.fluid.motion._motion._mover, kind)
    records = list(simulate(problem))
    assert len(records) == 3
    state = records[-1].state.mesh
    assert state is not None
    assert state.min_det_J > 0.0
    structure = problem.fluid.structure
    vertex = structure.topology.vertex("b2")
    assert np.abs(state.vertices[vertex] - structure.vertices[vertex]).max() > 1e-6


def test_sliding_vertices_stay_on_their_side(read_changed: Read) -> None:
    problem = build(read_changed(*TALL, mover('sliding = "top"')))
    assert problem.fluid is not None
    *_, last = simulate(problem)
    assert last.state.mesh is not None
    vertices = last.state.mesh.vertices
    topology = problem.fluid.structure.topology
    for name in ("b3", "c3"):
        assert vertices[topology.vertex(name), 1] == 1.0
        assert vertices[topology.vertex(name), 0] != problem.fluid.structure.vertices[topology.vertex(name), 0]
    assert "2 slide along the boundary" in str(plan(read_changed(*TALL, mover('sliding = "top"'))))


def test_a_rule_moves_what_it_says(read_changed: Read) -> None:
    problem = build(read_changed(*TALL, mover(RULE)))
    assert problem.fluid is not None
    motion = problem.fluid.motion
    assert motion is not None
    x = motion.driven.topology
    displacement = np.zeros((len(motion.driven.nodes), 2))
    rows = dict(zip(motion.driven.vertices.tolist(), motion.driven.vertex_rows.tolist(), strict=True))
    displacement[rows[x.vertex("b1")]] = [0.02, 0.01]
    displacement[rows[x.vertex("c1")]] = [0.04, 0.0]
    state = motion.move(motion.reference, displacement, 0.0)
    moved = state.vertices - motion.reference.vertices
    np.testing.assert_allclose(moved[x.vertex("b2")], [0.03, 0.5 * 0.01], atol=1e-15)
    np.testing.assert_allclose(moved[x.vertex("c2")], [0.03, 0.5 * 0.01], atol=1e-15)
    np.testing.assert_array_equal(moved[x.vertex("b3")], 0.0)


def test_counts_of_what_can_move(read_changed: Read) -> None:
    problem = build(read_changed(*TALL))
    assert problem.fluid is not None
    assert problem.fluid.motion is not None
    moving = problem.fluid.motion.moving
    assert moving["blocks"] == 8
    assert moving["vertices"] == 6  # b0, b1, c0, c1 of the flap, and b2, c2


def test_a_layout_without_free_vertices_is_said(read_changed: Read) -> None:
    (item,) = [item for item in plan(read_changed()).built if item.name == "mover"]
    assert "0 free block vertices follow 4 driven ones" in item.detail
    assert "Add a ring of blocks" in item.detail


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ('sliding = "inside"', r"mover.sliding: 'inside' is not a side of the fluid that stands still"),
        ('sliding = "flap"', r"mover.sliding: 'flap' is not a side of the fluid that stands still"),
        (RULE.replace('"b2", "c2"', '"b3"'), r"mover.vertex\[0\]: vertex 'b3' cannot follow a rule"),
        (
            RULE.replace("dx_c1", "dx_d0"),
            r"mover.vertex\[0\]: 'dx_d0' is the displacement of vertex 'd0', which is not dr",
        ),
    ],
)
@pytest.mark.parametrize("use", [build, plan])
def test_mistakes_are_found_before_the_run(
    read_changed: Read, text: str, match: str, use: Callable[..., object]
) -> None:
    with pytest.raises(CaseError, match=match):
        use(read_changed(*TALL, mover(text)))


def test_a_motion_that_fails_names_time_and_place(read_changed: Read) -> None:
    problem = build(read_changed(*TALL))
    assert problem.fluid is not None
    motion = problem.fluid.motion
    assert motion is not None
    far = np.tile([0.0, 0.6], (len(motion.driven.nodes), 1))
    with pytest.raises(MeshMotionError, match=r"cross near .* Use smaller steps, another \[mover\]") as caught:
        motion.move(motion.reference, far, 0.25)
    assert caught.value.where == "fluid mesh, t = 0.25"
