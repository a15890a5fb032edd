from dataclasses import dataclass

import numpy as np
import pytest

from hoblock.curves import Arc
from hoblock.errors import GradingError
from hoblock.generate import changed_blocks, generate, regenerate
from hoblock.grading import Exponential, Uniform
from hoblock.layout import layout


@dataclass(frozen=True)
class Halves:
    """Positions whose first element has a given length."""

    cuts: tuple[float, ...]

    def __call__(self, s):
        return np.interp(s, np.linspace(0.0, 1.0, len(self.cuts)), self.cuts)


@dataclass(frozen=True)
class FirstLength:
    """An edge grading: the first element has a length, the others share the rest."""

    first: float

    def resolved(self, shape, count):
        if self.first >= shape.length:
            raise GradingError(f"first length {self.first:g} does not fit {shape.length:g}.")
        rest = np.linspace(self.first, shape.length, count)
        return Halves((0.0, *shape.parameters(rest)))


def strip(layouts, grading):
    return layouts.square(counts={("a", "b"): 2, ("b", "c"): 4}, gradings={("a", "d"): grading})


def first_heights(structure, order=3):
    mesh = generate(structure, order)
    plan = layout(structure, order)
    topology = structure.topology
    nodes = plan.nodes_of_edge(topology.find_edge(topology.vertex("a"), topology.vertex("d")))
    steps = np.diff(mesh.points[nodes[:: mesh.order]], axis=0)
    return np.hypot(*steps.T)


def test_gradings_that_depend_on_the_edge_are_made_anew_for_every_position(layouts):
    structure = strip(layouts, FirstLength(0.1))
    np.testing.assert_allclose(first_heights(structure), [0.1, 0.3, 0.3, 0.3], atol=1e-14)
    moved = structure.moved(structure.vertices * (1.0, 2.5))
    np.testing.assert_allclose(first_heights(moved), [0.1, 0.8, 0.8, 0.8], atol=1e-14)
    np.testing.assert_allclose(first_heights(structure), [0.1, 0.3, 0.3, 0.3], atol=1e-14)
    mesh = generate(structure, 3)
    again = regenerate(mesh, moved, previous=structure)
    np.testing.assert_array_equal(again.points, generate(moved, 3).points)
    assert again.cells is mesh.cells
    assert changed_blocks(structure, moved).all()


def test_the_direction_of_the_edge_counts(layouts):
    structure = layouts.square(counts={("b", "c"): 4}, gradings={("d", "a"): FirstLength(0.1)})
    np.testing.assert_allclose(first_heights(structure), [0.3, 0.3, 0.3, 0.1], atol=1e-14)


def test_lengths_are_measured_along_curves(layouts):
    arc = Arc.through(np.array([0.0, 0.0]), np.array([-0.2, 0.5]), np.array([0.0, 1.0]))
    structure = layouts.square(
        counts={("b", "c"): 4}, curves={("a", "d"): arc}, gradings={("a", "d"): FirstLength(0.1)}
    )
    plan = layout(structure, 2)
    topology = structure.topology
    edge = topology.find_edge(topology.vertex("a"), topology.vertex("d"))
    first = plan.parameters_of_edge(edge)[2]
    assert first * abs(arc.opening) * arc.radius == pytest.approx(0.1, rel=1e-12)


def test_an_edge_too_short_for_its_grading_is_named(layouts):
    structure = strip(layouts, FirstLength(0.1))
    with pytest.raises(GradingError, match=r"edge a–d: first length 0\.1 does not fit 0\.05"):
        generate(structure.moved(structure.vertices * (1.0, 0.05)), 2)


def test_structures_that_differ_by_gradings_share_their_numbering(layouts):
    plain = layouts.square(counts=3)
    graded = type(plain)(plain.topology, plain.vertices, plain.curves, (Exponential(1.0), *plain.gradings[1:]))
    assert layout(graded, 4).cells is layout(plain, 4).cells
    assert layout(graded, 4) is layout(graded, 4)
    assert layout(plain.moved(plain.vertices * 2.0), 4) is layout(plain, 4)


def test_only_the_last_positions_are_remembered(layouts):
    structure = strip(layouts, FirstLength(0.1))
    kept = {id(layout(structure.moved(structure.vertices * (1.0, 1.0 + k)), 2)) for k in range(12)}
    assert len(kept) <= 12
    from hoblock.layout import _FAMILIES

    (family,) = _FAMILIES[structure.topology].values()
    assert len(family.known) <= 4
    assert layout(structure, 2).edge_parameters.max() == 1.0


@pytest.mark.parametrize("order", [0, 33, 2.5, True])
def test_orders_that_do_not_exist_are_refused(order, layouts):
    with pytest.raises(ValueError, match="order is"):
        layout(layouts.square(gradings={("a", "b"): Uniform()}), order)
