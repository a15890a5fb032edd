"""What meshes share and keep: layouts, temporary arrays, arrays of the caller."""

import gc
import tracemalloc
import weakref

import numpy as np

from hoblock.curves import NodalCurve
from hoblock.generate import generate, regenerate
from hoblock.grading import Exponential
from hoblock.layout import layout
from hoblock.mesh import QuadMesh


def test_layouts_are_shared_between_moved_structures(layouts, rng):
    structure = layouts.random("disc", rng)
    moved = structure.moved(structure.vertices + 0.01)
    assert layout(moved, 3) is layout(structure, 3)
    assert layout(moved, 2) is not layout(structure, 3)


def test_layouts_live_as_long_as_their_structures(layouts):
    structure = layouts.square(counts=3)
    first = layout(structure, 4)
    assert layout(structure.moved(structure.vertices + 1.0), 4) is first
    alive = weakref.ref(first)
    del structure, first
    gc.collect()
    assert alive() is None


def test_different_gradings_need_no_temporary_arrays_of_the_size_of_the_mesh(layouts):
    rows = [(5 * j + i, 5 * j + i + 1, j) for j in range(5) for i in range(4)]
    structure = layouts.wide(gradings={(a, b): Exponential(1.0 if j % 2 else -1.0) for a, b, j in rows})
    mesh = generate(structure, 4, check=False)
    buffer = np.empty_like(mesh.points)
    tracemalloc.start()
    regenerate(mesh, structure, out=buffer)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1.5 * buffer.nbytes


def test_a_study_of_gradings_does_not_fill_the_memory(layouts):
    structure = layouts.square(counts=3)
    first = layout(structure.with_gradings({("a", "b"): Exponential(0.1)}), 2)
    kept = weakref.ref(first.batches[0])
    numbers = first.numbers
    del first
    for a in range(40):
        assert layout(structure.with_gradings({("a", "b"): Exponential(1.0 + a / 40)}), 2).numbers is numbers
    gc.collect()
    assert kept() is None


def test_arrays_of_the_caller_stay_writeable_and_nodal_curves_their_own():
    cells, group = np.array([[0, 1, 2, 3]]), np.array([0])
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    mesh = QuadMesh(points, cells, 1, {"all": group}, {})
    assert cells.flags.writeable
    assert group.flags.writeable
    assert not mesh.cells.flags.writeable
    assert not mesh.cell_groups["all"].flags.writeable
    nodes = np.array([(0.0, 0.0), (0.5, 0.1), (1.0, 0.0)])
    curve = NodalCurve(nodes, 2)
    nodes[1] = 7.0
    assert curve.points[1].tolist() == [0.5, 0.1]
