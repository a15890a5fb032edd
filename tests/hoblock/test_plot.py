import re
import subprocess
import sys

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError, MissingExtraError
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.plot import block_outlines, element_outlines, plot_mesh


@pytest.fixture
def matplotlib():
    return pytest.importorskip("matplotlib")


def image(path, matplotlib):
    import matplotlib.image

    return matplotlib.image.imread(path)


def shoelace(polygons):
    x, y = polygons[..., 0], polygons[..., 1]
    return 0.5 * (x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1)).sum(axis=-1)


def test_outlines_are_curved_and_counter_clockwise(layouts):
    mesh = generate(layouts.annulus(4), 5)
    outlines = element_outlines(mesh)
    assert outlines.shape == (4, 80, 2)
    assert shoelace(outlines).sum() == pytest.approx(3 * np.pi, rel=2e-3)
    chords = element_outlines(mesh, samples=1)
    assert shoelace(chords).sum() == pytest.approx(6.0)  # the squares through the vertices
    radius = np.hypot(*np.moveaxis(outlines, -1, 0))
    assert np.sum(np.abs(radius - 1) < 1e-4) == 4 * 21
    assert element_outlines(generate(layouts.square(counts=2), 1)).shape == (4, 4, 2)


def test_block_outlines_follow_the_edges(layouts):
    structure = layouts.annulus(3, counts=2)
    mesh = generate(structure, 4)
    lines = block_outlines(mesh, structure)
    assert len(lines) == 9
    for edge, line in enumerate(lines):
        assert line.shape == (33, 2)
        np.testing.assert_allclose(line[[0, -1]], structure.vertices[structure.topology.edges[edge]], atol=1e-14)
        if edge in structure.curves:
            radius = np.hypot(*line.T)
            np.testing.assert_allclose(radius, radius[0], rtol=2e-3)


@pytest.mark.parametrize("color", ["scaled_jacobian", "jacobian_ratio", "skewness", None])
def test_a_picture_shows_the_mesh(color, layouts, tmp_path, matplotlib):
    structure = layouts.annulus(4, counts=2)
    mesh = generate(structure, 3)
    path = tmp_path / "annulus.png"
    plot_mesh(mesh, path, structure=structure, color=color, vertex_names=True, title="annulus", width=4, dpi=60)
    pixels = image(path, matplotlib)[..., :3]
    assert pixels.shape[0] > 150
    assert pixels.shape[1] > 150
    dark = (pixels.max(axis=2) < 0.3).mean()
    white = (pixels.min(axis=2) > 0.99).mean()
    assert 0.002 < dark < 0.5
    assert 0.2 < white < 0.9


def test_invalid_elements_are_red(layouts, tmp_path, matplotlib):
    structure = layouts.square(counts=2)
    vertices = np.array(structure.vertices)
    vertices[2] = (0.2, 0.2)
    bad = generate(structure.moved(vertices), 2, check=False)
    red = {}
    for name, mesh in (("good", generate(structure, 2)), ("bad", bad)):
        plot_mesh(mesh, tmp_path / f"{name}.png", width=4, dpi=60)
        r, g, b = np.moveaxis(image(tmp_path / f"{name}.png", matplotlib)[..., :3], -1, 0)
        red[name] = int(((r > 0.8) & (g < 0.1) & (b < 0.1)).sum())
    assert red["good"] == 0
    assert red["bad"] > 50


def test_all_elements_invalid(layouts, tmp_path, matplotlib):
    structure = layouts.square()
    mirrored = structure.moved(structure.vertices * [-1, 1])
    plot_mesh(generate(mirrored, 1, check=False), tmp_path / "m.png", color="jacobian_ratio", width=3, dpi=50)
    assert (tmp_path / "m.png").stat().st_size > 1000


def test_groups_have_colours_and_a_legend(layouts, tmp_path, matplotlib):
    vertices, quads = layouts.quads("grid")
    structure = BlockStructure.build(vertices, {"fluid": quads[:3], "solid": quads[3:]})
    plot_mesh(generate(structure, 1), tmp_path / "groups.svg", color=None, structure=structure)
    text = (tmp_path / "groups.svg").read_text(encoding="utf-8")
    fills = set(re.findall(r"fill: (#[0-9a-f]{6})", text))
    assert {"#dce9f5", "#f8dfc6"} <= fills
    assert "<!-- fluid -->" in text
    assert "<!-- solid -->" in text


def test_vertex_names_are_written_literally(layouts, tmp_path, matplotlib):
    vertices = {"$x_1$": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    structure = BlockStructure.build(vertices, [tuple(vertices)])
    plot_mesh(generate(structure, 1), tmp_path / "names.svg", structure=structure, vertex_names=True)
    text = (tmp_path / "names.svg").read_text(encoding="utf-8")
    assert "<!-- $x_1$ -->" in text


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_formats(suffix, layouts, tmp_path, matplotlib):
    path = tmp_path / f"square.{suffix}"
    plot_mesh(generate(layouts.square(), 2), path, width=3, dpi=50)
    assert path.read_bytes()[:5] in (b"\x89PNG\r", b"<?xml", b"%PDF-")


def test_the_state_of_pyplot_is_left_alone(layouts, tmp_path, matplotlib):
    code = (
        "import sys, numpy as np; from hoblock.mesh import QuadMesh; from hoblock.plot import plot_mesh;"
        "mesh = QuadMesh(np.array([(0, 0), (1, 0), (0, 1), (1, 1)], float), np.arange(4)[None], 1, {}, {});"
        "plot_mesh(mesh, sys.argv[1], width=2, dpi=40); raise SystemExit('matplotlib.pyplot' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path / "a.png")], check=False).returncode == 0


def test_bad_arguments(layouts, tmp_path):
    mesh = generate(layouts.square(), 2)
    with pytest.raises(MeshFileError, match=r"mesh\.jpg: suffix is '\.jpg'; expected one of \.pdf, \.png, \.svg"):
        plot_mesh(mesh, tmp_path / "mesh.jpg")
    with pytest.raises(ValueError, match="color is 'red'; expected None or one of 'jacobian_ratio', 'scaled_jacobian'"):
        plot_mesh(mesh, tmp_path / "mesh.png", color="red")
    with pytest.raises(ValueError, match="vertex_names needs structure"):
        plot_mesh(mesh, tmp_path / "mesh.png", vertex_names=True)


def test_missing_matplotlib_names_the_extra(layouts, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith("matplotlib.")]:
        monkeypatch.delitem(sys.modules, name)
    mesh = QuadMesh(np.eye(4, 2), np.arange(4)[None], 1, {}, {})
    with pytest.raises(MissingExtraError, match=r"pip install 'hoblock\[plot\]'"):
        plot_mesh(mesh, tmp_path / "mesh.png")
