import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError
from hoblock.generate import generate
from hoblock.io.mesh_file import FORMATS, read_mesh, write_mesh
from hoblock.io.npz import read_npz
from hoblock.mesh import QuadMesh
from hoblock.quality import certify, element_areas

READABLE = sorted(name for name, form in FORMATS.items() if form.read is not None)


@pytest.fixture
def mesh(layouts):
    return generate(layouts.square(counts=2), 3)


@pytest.mark.parametrize(
    ("name", "start"),
    [
        ("m.msh", b"$MeshFormat"),
        ("m.VTU", b'<?xml version="1.0"?>\n<VTKFile'),
        ("m.npz", b"PK"),
        ("m.mesh", b"MFEM mesh v1.3"),
        ("m.inp", b"*Heading"),
    ],
)
def test_the_suffix_tells_the_format(name, start, mesh, tmp_path):
    (tmp_path / name).write_text("something old and much longer than a mesh " * 1000)
    write_mesh(str(tmp_path / name), mesh)
    data = (tmp_path / name).read_bytes()
    assert data.startswith(start)
    assert b"something old" not in data


@pytest.mark.parametrize(
    ("format", "start"),
    [
        ("gmsh22", b"$MeshFormat\n2.2 1 8"),
        ("gmsh41", b"$MeshFormat\n4.1 1 8"),
        ("ism", b"ISM-V2"),
        ("ism-mm", b"ISM-MM"),
        ("mfem", b"MFEM mesh"),
        ("vtu", b"<?xml"),
    ],
)
def test_a_format_may_be_said(format, start, mesh, tmp_path):
    write_mesh(tmp_path / "m.mesh", mesh, format=format)
    assert (tmp_path / "m.mesh").read_bytes().startswith(start)
    if format in READABLE:
        assert read_mesh(tmp_path / "m.mesh", format=format).order == 3


def test_options_reach_the_writer(mesh, tmp_path):
    write_mesh(tmp_path / "m.vtu", mesh, cell_data={"rank": np.arange(4)})
    assert b'Name="rank"' in (tmp_path / "m.vtu").read_bytes()
    write_mesh(tmp_path / "m.msh", mesh, version="4.1")
    assert (tmp_path / "m.msh").read_bytes().startswith(b"$MeshFormat\n4.1")


def test_npz_comes_back(mesh, tmp_path):
    write_mesh(tmp_path / "m.npz", mesh)
    np.testing.assert_array_equal(read_npz(tmp_path / "m.npz").points, mesh.points)


@pytest.mark.parametrize("name", ["mesh.stl", "mesh"])
def test_unknown_suffixes(name, mesh, tmp_path):
    with pytest.raises(MeshFileError, match=r"suffix is '.*'; expected one of .*\.msh, \.npz, \.vtu"):
        write_mesh(tmp_path / name, mesh)
    with pytest.raises(MeshFileError, match=r"suffix is '.*'; expected one of \.mesh, \.msh, \.npz, \.vtu\."):
        read_mesh(tmp_path / name)
    assert not (tmp_path / name).exists()


def test_unknown_formats(mesh, tmp_path):
    with pytest.raises(MeshFileError, match=r"format is 'gmsh2'; expected one of .*Did you mean 'gmsh"):
        write_mesh(tmp_path / "m.msh", mesh, format="gmsh2")
    with pytest.raises(MeshFileError, match="files of format 'ism' can only be written; expected one of gmsh, "):
        read_mesh(tmp_path / "m.mesh", format="ism")


@pytest.mark.parametrize("name", ["mesh.npz", "mesh.vtu", "mesh.msh", "mesh.mesh"])
def test_missing_folders(name, mesh, tmp_path):
    with pytest.raises(FileNotFoundError) as info:
        write_mesh(tmp_path / "missing" / name, mesh)
    assert info.value.filename == str(tmp_path / "missing" / name)


def assert_same(again, mesh):
    assert again.order == mesh.order
    assert len(again.points) == len(mesh.points)
    np.testing.assert_allclose(again.coordinates, mesh.coordinates, rtol=0, atol=1e-13 * np.abs(mesh.points).max())
    assert list(again.cell_groups) == list(mesh.cell_groups)
    assert list(again.edge_groups) == list(mesh.edge_groups)
    for name, members in mesh.cell_groups.items():
        assert set(again.cell_groups[name].tolist()) == set(members.tolist())
    for name, sides in mesh.edge_groups.items():
        assert set(map(tuple, again.edge_groups[name].tolist())) == set(map(tuple, sides.tolist()))


@pytest.mark.parametrize("format", READABLE)
@pytest.mark.parametrize("order", [1, 4, 10])
def test_round_trip(format, order, layouts, rng, tmp_path):
    mesh = generate(layouts.random("star", rng), order)
    write_mesh(tmp_path / "m", mesh, format=format)
    assert_same(read_mesh(tmp_path / "m", format=format), mesh)


def test_round_trip_of_any_small_mesh(tmp_path):
    hypothesis = pytest.importorskip("hypothesis")
    st = hypothesis.strategies
    names = st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"], exclude_characters='"'), max_size=20)
    names = names.filter(bool).filter(str.isprintable)

    @st.composite
    def meshes(draw):
        order, columns, rows = draw(st.integers(1, 10)), draw(st.integers(1, 3)), draw(st.integers(1, 2))
        x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
        seed = draw(st.integers(0, 2**20))
        vertices = np.stack([x.ravel(), y.ravel()], axis=-1)
        vertices = vertices + np.random.default_rng(seed).uniform(-0.2, 0.2, vertices.shape)
        first = np.arange((columns + 1) * rows).reshape(rows, -1)[:, :-1].ravel()
        turn = draw(st.integers(0, 3))
        quads = np.roll(np.stack([first, first + 1, first + columns + 2, first + columns + 1], axis=-1), turn, axis=1)
        mesh = generate(BlockStructure.build(draw(st.sampled_from([1.0, 1e-6, 1e5])) * vertices, quads), order)
        elements = st.lists(st.integers(0, len(quads) - 1), unique=True).map(lambda k: np.array(k, dtype=np.int64))
        sides = st.lists(st.tuples(st.integers(0, len(quads) - 1), st.integers(0, 3)), unique=True).map(
            lambda k: np.array(k, dtype=np.int64).reshape(-1, 2)
        )
        groups = draw(st.dictionaries(names, elements, max_size=3))
        return QuadMesh(mesh.points, mesh.cells, order, groups, draw(st.dictionaries(names, sides, max_size=3)))

    @hypothesis.settings(max_examples=60, deadline=None, derandomize=True)
    @hypothesis.given(meshes())
    def check(mesh):
        for format in READABLE:
            if format == "gmsh22":
                continue  # holds one group an element; "gmsh" takes it where it can
            bare = format == "mfem" and not (mesh.cell_groups or mesh.edge_groups)
            options = {"version": "1.3"} if bare else {}
            write_mesh(tmp_path / "m", mesh, format=format, **options)
            assert_same(read_mesh(tmp_path / "m", format=format), mesh)

    check()


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_elements_listed_clockwise_are_turned_but_inverted_ones_stay_invalid(suffix, layouts, tmp_path):
    mesh = generate(layouts.square(counts=3), 2)
    points = np.array(mesh.points)
    corner = mesh.cells[4, 8]
    points[corner] = points[mesh.cells[4, 0]] - 0.1  # the middle element is turned over
    folded = mesh.with_points(points)
    expected = certify(folded).counts
    assert expected["invalid"] >= 1
    transposed = np.arange(9).reshape(3, 3).T.ravel()
    cells = np.array(mesh.cells)
    cells[[0, 5]] = cells[[0, 5]][:, transposed]
    write_mesh(tmp_path / f"mixed{suffix}", QuadMesh(points, cells, 2, {}, {}))
    back = read_mesh(tmp_path / f"mixed{suffix}")
    assert certify(back).counts == expected
    assert element_areas(back).sum() == pytest.approx(1.0, rel=1e-12)
    assert element_areas(back).min() == pytest.approx(element_areas(folded).min(), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "way_out"),
    [
        ("a.stl", r"For a file of another name say the format \(format=…, --format on the command line\)"),
        ("a.pvd", r"A \.pvd file lists the \.vtu files of a series: take one of these"),
        ("a.vtkhdf", r"hoblock\.io\.vtkhdf\.VtkhdfSeries writes these series; they cannot be read back"),
    ],
)
def test_a_suffix_that_is_no_mesh_files_has_a_way_out(name, way_out, tmp_path):
    with pytest.raises(MeshFileError, match=way_out):
        read_mesh(tmp_path / name)
