import numpy as np
import pytest

from hoblock.node_order import line_node_order, node_order


def lattice(order):
    i, j = np.meshgrid(np.arange(order + 1), np.arange(order + 1), indexing="xy")
    return np.stack([i.ravel(), j.ravel()], axis=-1)


@pytest.mark.oracle
@pytest.mark.parametrize("order", range(1, 16))
def test_vtk_order_is_that_of_its_lagrange_quadrilateral(order):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    index = vtk.vtkHigherOrderQuadrilateral.PointIndexFromIJK
    expected = np.empty((order + 1) ** 2, dtype=int)
    for local, (i, j) in enumerate(lattice(order)):
        expected[index(int(i), int(j), [order, order])] = local
    np.testing.assert_array_equal(node_order(order, "vtk"), expected)


@pytest.mark.oracle
@pytest.mark.parametrize("order", range(1, 11))
def test_gmsh_order_is_that_of_its_quadrangles_and_lines(order):
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        shapes = {
            name: gmsh.model.mesh.getElementProperties(gmsh.model.mesh.getElementType(name, order))
            for name in ("quadrangle", "line")
        }
    finally:
        gmsh.finalize()
    _, dimension, given, count, places, corners = shapes["quadrangle"]
    assert (dimension, given, count, corners) == (2, order, (order + 1) ** 2, 4)
    ours = 2.0 * lattice(order)[node_order(order, "gmsh")] / order - 1.0
    np.testing.assert_allclose(ours, np.reshape(places, (-1, 2)), atol=1e-12)
    line = 2.0 * line_node_order(order, "gmsh") / order - 1.0
    np.testing.assert_allclose(line, shapes["line"][4], atol=1e-12)


@pytest.mark.oracle
@pytest.mark.parametrize("order", [2, 3, 5, 12])
def test_vtk_curves_have_their_ends_first(order):
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    reference = pytest.importorskip("vtkmodules.vtkCommonCore").reference
    curve = vtk.vtkLagrangeCurve()
    curve.GetPointIds().SetNumberOfIds(order + 1)
    curve.GetPoints().SetNumberOfPoints(order + 1)
    for k, local in enumerate(line_node_order(order, "vtk")):
        curve.GetPointIds().SetId(k, k)
        curve.GetPoints().SetPoint(k, local / order, (local / order) ** 2, 0.0)
    curve.Initialize()
    for r in (0.07, 0.5, 0.83):
        place, weights = [0.0, 0.0, 0.0], [0.0] * (order + 1)
        curve.EvaluateLocation(reference(0), [r, 0.0, 0.0], place, weights)
        assert place == pytest.approx([r, r**2, 0.0], abs=1e-6)


def test_orders_by_hand():
    assert node_order(2, "vtk").tolist() == [0, 2, 8, 6, 1, 5, 7, 3, 4]
    assert node_order(2, "gmsh").tolist() == node_order(2, "vtk").tolist()
    assert node_order(3, "vtk").tolist() == [0, 3, 15, 12, 1, 2, 7, 11, 13, 14, 4, 8, 5, 6, 9, 10]
    assert node_order(3, "gmsh").tolist() == [0, 3, 15, 12, 1, 2, 7, 11, 14, 13, 8, 4, 5, 6, 10, 9]
    assert node_order(3, "mfem").tolist() == [0, 3, 15, 12, 1, 2, 7, 11, 14, 13, 8, 4, 5, 6, 9, 10]
    assert line_node_order(3, "gmsh").tolist() == [0, 3, 1, 2]


@pytest.mark.parametrize("target", ["vtk", "gmsh", "mfem", "skfem"])
@pytest.mark.parametrize("order", [1, 2, 3, 4, 7, 10, 17])
def test_permutations_are_complete_and_read_only(order, target):
    permutation = node_order(order, target)
    np.testing.assert_array_equal(np.sort(permutation), np.arange((order + 1) ** 2))
    with pytest.raises(ValueError, match="read-only"):
        permutation[0] = 1


@pytest.mark.parametrize("function", [node_order, line_node_order])
def test_errors(function):
    with pytest.raises(ValueError, match="order is 0; expected an integer >= 1"):
        function(0, "vtk")
    with pytest.raises(ValueError, match="target is 'abaqus'; expected one of 'gmsh', "):
        function(2, "abaqus")
