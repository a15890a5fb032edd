"""Files for HOHQMesh's readers, read back by small readers written from the documentation of the formats."""

import numpy as np
import pytest
from scipy.interpolate import BarycentricInterpolator

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.abaqus import write_abaqus
from hoblock.io.ism import write_ism
from hoblock.mesh import QuadMesh
from hoblock.quality import det_jacobian
from hoblock.reference import gauss_lobatto, tensor_basis, tensor_quadrature


class Reader:
    """Corners, sides and names of a file; interiors by the transfinite map."""

    def __init__(self, vertices, elements, curves, names, order):
        self.vertices, self.elements, self.curves, self.names, self.order = vertices, elements, curves, names, order
        self.nodes = -np.cos(np.pi * np.arange(order + 1) / order)

    def sides(self, k):
        """Four functions of s in [-1, 1]; those of the straight sides are made from the corners."""
        c = self.vertices[np.array(self.elements[k]) - 1]
        functions = []
        for side, (a, b) in enumerate([(0, 1), (1, 2), (3, 2), (0, 3)]):
            if side in self.curves[k]:
                functions.append(BarycentricInterpolator(self.nodes, self.curves[k][side]))
            else:
                functions.append(lambda s, a=a, b=b: np.outer(1 - s, c[a]) / 2 + np.outer(1 + s, c[b]) / 2)
        return functions, c

    def element(self, k, xi, eta):
        (g1, g2, g3, g4), c = self.sides(k)
        x, y = xi[:, None], eta[:, None]
        linear = ((1 - x) * g4(eta) + (1 + x) * g2(eta) + (1 - y) * g1(xi) + (1 + y) * g3(xi)) / 2
        corner = (1 - x) * ((1 - y) * c[0] + (1 + y) * c[3]) + (1 + x) * ((1 - y) * c[1] + (1 + y) * c[2])
        return linear - corner / 4

    def area(self):
        """Of the domain: ½ ∮ x dy - y dx around every element, by Gauss points on each side."""
        total = 0.0
        s, w = np.polynomial.legendre.leggauss(self.order + 2)
        for k in range(len(self.elements)):
            functions, _ = self.sides(k)
            for sign, g in zip((1, 1, -1, -1), functions, strict=True):
                poly = np.polynomial.Polynomial.fit(self.nodes, g(self.nodes)[:, 0], self.order, domain=[-1, 1])
                poly_y = np.polynomial.Polynomial.fit(self.nodes, g(self.nodes)[:, 1], self.order, domain=[-1, 1])
                total += sign * 0.5 * w @ (poly(s) * poly_y.deriv()(s) - poly_y(s) * poly.deriv()(s))
        return total


def read_ism(path):
    words = iter(path.read_text(encoding="utf-8").split("\n"))
    line = next(words)
    version = line if line.startswith("ISM") else "ISM"
    sizes = [int(word) for word in (line if version == "ISM" else next(words)).split()]
    edge_count = sizes.pop(1) if version != "ISM" else 0
    node_count, element_count, order = sizes
    vertices = np.array([[float(v) for v in next(words).split()] for _ in range(node_count)])
    assert not vertices[:, 2].any()
    listed = edge_count if version == "ISM-V2" else 0
    edges = [[int(v) for v in next(words).split()] for _ in range(listed)]
    elements, curves, names, materials = [], [], [], []
    for _ in range(element_count):
        corners = next(words).split()
        elements.append([int(v) for v in corners[:4]])
        materials.append(corners[4:])
        flags = [int(v) for v in next(words).split()]
        values = {
            side: np.array([[float(v) for v in next(words).split()[:2]] for _ in range(order + 1)])
            for side in range(4)
            if flags[side]
        }
        curves.append(values)
        names.append(next(words).split())
    assert list(words) == [""]
    reader = Reader(vertices[:, :2], elements, curves, names, order)
    return reader, edges, materials, edge_count


def read_abaqus(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[:3] == ["*Heading", " File created by HOHQMesh", "*NODE"]
    start = lines.index("*ELEMENT, type=CPS4, ELSET=Surface1")
    comment = lines.index("** ***** HOHQMesh boundary information ***** **")
    nodes = np.array([[float(v) for v in line.split(",")] for line in lines[3:start]])
    elements = [[int(v) for v in line.split(",")] for line in lines[start + 1 : comment]]
    assert [row[0] for row in elements] == list(range(1, len(elements) + 1))
    assert nodes[:, 0].tolist() == list(range(1, len(nodes) + 1))
    order = int(lines[comment + 1].split()[5])
    assert lines[comment + 1] == f"** mesh polynomial degree = {order}"
    rest = iter([line.split() for line in lines[comment + 2 :]])
    curves = []
    for row in elements:
        assert [int(v) for v in next(rest)[1:]] == row[1:]
        flags = [int(v) for v in next(rest)[1:]]
        curves.append(
            {
                side: np.array([[float(v) for v in next(rest)[1:3]] for _ in range(order + 1)])
                for side in range(4)
                if flags[side]
            }
        )
    names = []
    for _ in elements:
        minus_x, plus_x, minus_y, plus_y = next(rest)[1:]
        names.append([minus_y, plus_x, plus_y, minus_x])
    assert not list(rest)
    return Reader(nodes[:, 1:3], [row[1:] for row in elements], curves, names, order)


def read(path):
    return read_ism(path)[0] if path.suffix == ".mesh" else read_abaqus(path)


def write(path, mesh, **options):
    (write_ism if path.suffix == ".mesh" else write_abaqus)(path, mesh, **options)


def area_of(mesh):
    points, weights = tensor_quadrature(mesh.order + 1)
    return float((det_jacobian(mesh, points) @ weights).sum())


@pytest.mark.parametrize("suffix", ["mesh", "inp"])
@pytest.mark.parametrize("order", range(1, 11))
def test_area_and_interiors_are_those_of_the_mesh(order, suffix, layouts, tmp_path):
    mesh = generate(layouts.annulus(5, counts=2), order)
    path = tmp_path / f"m.{suffix}"
    write(path, mesh)
    found = read(path)
    assert found.order == order
    assert found.area() == pytest.approx(area_of(mesh), rel=1e-12)
    grid = np.random.default_rng(9).uniform(-1, 1, (2, 7))
    expected = tensor_basis(gauss_lobatto(order), grid.T) @ mesh.coordinates
    for k in range(len(mesh.cells)):
        np.testing.assert_allclose(found.element(k, *grid), expected[k], atol=1e-12)


@pytest.mark.parametrize("suffix", ["mesh", "inp"])
def test_names_stand_on_their_sides(suffix, layouts, tmp_path):
    mesh = generate(layouts.annulus(5, counts=2), 3)
    path = tmp_path / f"m.{suffix}"
    write(path, mesh)
    found = read(path)
    for name in ("inner", "outer"):
        sides = {(k, s) for k, row in enumerate(found.names) for s, label in enumerate(row) if label == name}
        assert sides == set(map(tuple, mesh.edge_groups[name].tolist()))
    assert sum(label == "---" for row in found.names for label in row) == 4 * 20 - 20


def test_sides_without_a_name_and_names_inside(layouts, tmp_path):
    vertices, quads = layouts.quads("grid")
    edges = {"west": [(0, 4), (4, 8)], "interface": [(1, 5), (5, 9)]}
    structure = BlockStructure.build(vertices, {"fluid": quads}, edges=edges)
    write_ism(tmp_path / "m.mesh", generate(structure, 2))
    found, edges, _, _ = read_ism(tmp_path / "m.mesh")
    labels = [label for row in found.names for label in row]
    assert labels.count("west") == 2
    assert labels.count("unnamed") == 8
    assert "interface" not in labels
    assert not any(found.curves)  # straight sides need no curves
    assert len(edges) == 17


def test_sides_are_straight_only_if_their_parameter_is_linear(tmp_path):
    """Side 0 is a straight line, but its middle node is not in the middle."""
    points = np.array([[0, 0], [0.4, 0], [1, 0], [0, 0.5], [0.5, 0.5], [1, 0.5], [0, 1], [0.5, 1], [1, 1]])
    write_ism(tmp_path / "m.mesh", QuadMesh(points, np.arange(9)[None], 2, {}, {}))
    found, *_ = read_ism(tmp_path / "m.mesh")
    assert list(found.curves[0]) == [0]
    np.testing.assert_array_equal(found.curves[0][0], points[:3])


def example_of_the_documentation():
    """The three elements of Trixi's page on unstructured meshes."""
    points = np.array([[1, -1], [3, 0], [1, 1], [2, 0], [0, 0], [3, 1], [3, -1]], dtype=float)
    corners = np.array([[5, 1, 4, 3], [4, 2, 6, 3], [7, 2, 4, 1]]) - 1
    return QuadMesh(points, corners[:, [0, 1, 3, 2]], 1, {}, {})


def test_edges_are_those_of_the_documentation(tmp_path):
    write_ism(tmp_path / "m.mesh", example_of_the_documentation())
    found, edges, _, _ = read_ism(tmp_path / "m.mesh")
    assert found.elements == [[5, 1, 4, 3], [4, 2, 6, 3], [7, 2, 4, 1]]
    assert sorted(edges) == sorted(
        [
            [2, 4, 3, 2, 2, -1],
            [3, 5, 1, 0, 4, 0],
            [1, 5, 1, 0, 1, 0],
            [1, 4, 1, 3, 2, 3],
            [2, 6, 2, 0, 2, 0],
            [1, 7, 3, 0, 4, 0],
            [3, 6, 2, 0, 3, 0],
            [2, 7, 3, 0, 1, 0],
            [3, 4, 2, 1, 4, -3],
        ]
    )


@pytest.mark.parametrize("kind", ["star", "disc", "annulus"])
def test_edges_join_equal_points_of_both_elements(kind, layouts, tmp_path):
    vertices, quads = layouts.quads(kind)
    mesh = generate(BlockStructure.build(vertices, quads, counts=2), 3)
    write_ism(tmp_path / "m.mesh", mesh)
    found, edges, _, _ = read_ism(tmp_path / "m.mesh")
    assert len(edges) == len({tuple(edge[:2]) for edge in edges})
    s = np.linspace(-1, 1, 5)
    for start, stop, left, right, left_side, right_side in edges:
        assert start < stop
        line = found.sides(left - 1)[0][left_side - 1](s)
        assert {tuple(line[0]), tuple(line[-1])} == {tuple(found.vertices[v - 1]) for v in (start, stop)}
        if right:
            other = found.sides(right - 1)[0][abs(right_side) - 1](s)
            np.testing.assert_allclose(other if right_side > 0 else other[::-1], line, atol=1e-14)
            assert right_side > 0  # hoblock's neighbours walk a side in the same direction
            middle = found.vertices[np.array(found.elements[left - 1]) - 1].mean(axis=0)
            a, b = found.vertices[start - 1], found.vertices[stop - 1]
            assert (b - a)[0] * (middle - a)[1] - (b - a)[1] * (middle - a)[0] > 0  # on the left
        else:
            assert right_side == 0


def test_other_versions(layouts, tmp_path):
    vertices, quads = layouts.quads("grid")
    structure = BlockStructure.build(vertices, {"fluid": quads[:3], "solid": quads[3:]})
    mesh = generate(structure, 2)
    for version in ("ISM", "ISM-MM", "ISM-V2"):
        write_ism(tmp_path / "m.mesh", mesh, version=version)
        found, edges, materials, count = read_ism(tmp_path / "m.mesh")
        assert found.area() == pytest.approx(6.0, rel=1e-14)
        assert len(edges) == (17 if version == "ISM-V2" else 0)
        assert count == (0 if version == "ISM" else 17)
        expected = [["fluid"]] * 3 + [["solid"]] * 3 if version == "ISM-MM" else [[]] * 6
        assert materials == expected
    with pytest.raises(ValueError, match="version is 'ISM-V3'; expected one of 'ISM', 'ISM-MM', 'ISM-V2'"):
        write_ism(tmp_path / "m.mesh", mesh, version="ISM-V3")


@pytest.mark.parametrize("suffix", ["mesh", "inp"])
def test_names_that_do_not_fit(suffix, layouts, tmp_path):
    path = tmp_path / f"m.{suffix}"
    mesh = generate(layouts.square(edges={"wall": [("a", "b"), ("b", "c")], "floor": [("a", "b")]}), 2)
    with pytest.raises(MeshFileError, match=r"side 0 of element 0 belongs to 'wall' and to 'floor'.*boundaries=\["):
        write(path, mesh)
    assert not path.exists()
    write(path, mesh, boundaries=["floor", "wall"])
    assert read(path).names == [["floor", "wall", "unnamed", "unnamed"]]
    with pytest.raises(MeshFileError, match="no group of sides named 'walls'; did you mean 'wall'"):
        write(path, mesh, boundaries=["walls"])
    for name in ("two words", "---", "x" * 33, ""):
        other = QuadMesh(np.array(mesh.points), mesh.cells, 2, {}, {name: np.array([[0, 0]])})
        with pytest.raises(MeshFileError, match="cannot be written; expected 1 to 32 characters without spaces"):
            write(path, other)
