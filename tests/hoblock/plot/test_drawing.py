import re
import subprocess
import sys

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.errors import MeshFileError, MissingExtraError
from hoblock.generate import generate
from hoblock.mesh import QuadMesh
from hoblock.plot import MEASURES, plot_mesh


def image(path, matplotlib):
    import matplotlib.image

    return matplotlib.image.imread(path)


@pytest.mark.parametrize("color", [*MEASURES, None])
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
    with pytest.raises(ValueError, match="color is 'red'; expected None or one of 'aspect_ratio', 'jacobian_ratio'"):
        plot_mesh(mesh, tmp_path / "mesh.png", color="red")
    for option in ("vertex_names", "counts", "blocks_only"):
        with pytest.raises(ValueError, match=f"{option} needs structure"):
            plot_mesh(mesh, tmp_path / "mesh.png", **{option: True})
    for zoom in ((1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 2.0, 2.0), (0.0, np.inf, 0.0, 1.0)):
        with pytest.raises(ValueError, match="expected x0 < x1 and y0 < y1, in the order x0, x1, y0, y1"):
            plot_mesh(mesh, tmp_path / "mesh.png", zoom=zoom)


def test_missing_matplotlib_names_the_extra(layouts, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith("matplotlib.")]:
        monkeypatch.delitem(sys.modules, name)
    mesh = QuadMesh(np.eye(4, 2), np.arange(4)[None], 1, {}, {})
    with pytest.raises(MissingExtraError, match=r"pip install 'hoblock\[plot\]'"):
        plot_mesh(mesh, tmp_path / "mesh.png")


def svg(path):
    return path.read_text(encoding="utf-8")


def texts(path):
    """What is written in an SVG; matplotlib keeps it in comments."""
    return re.findall(r"<!-- (.+?) -->", svg(path))


def test_edge_groups_have_colours_and_a_legend(layouts, tmp_path, matplotlib):
    mesh = generate(layouts.annulus(4, counts=2), 3)
    plot_mesh(mesh, tmp_path / "with.svg", color=None)
    plot_mesh(mesh, tmp_path / "without.svg", color=None, edge_groups=False)
    assert {"inner", "outer"} <= set(texts(tmp_path / "with.svg"))
    assert not {"inner", "outer"} & set(texts(tmp_path / "without.svg"))
    for colour in ("#1f77b4", "#d95f02"):
        assert f"stroke: {colour}" in svg(tmp_path / "with.svg")
        assert f"stroke: {colour}" not in svg(tmp_path / "without.svg")


def test_blocks_only(layouts, tmp_path, matplotlib):
    vertices, quads = layouts.quads("grid")
    structure = BlockStructure.build(vertices, {"fluid": quads[:3], "solid": quads[3:]}, counts=4)
    mesh = generate(structure, 2)
    plot_mesh(mesh, tmp_path / "blocks.svg", structure=structure, blocks_only=True)
    text = svg(tmp_path / "blocks.svg")
    assert {"fluid", "solid"} <= set(texts(tmp_path / "blocks.svg"))
    assert "scaled Jacobian" not in text
    assert "stroke: #dce9f5" in text  # faces without black lines


def test_undecided_elements_are_orange(tmp_path, matplotlib):
    """A corner of exactly 180°: det J is zero there, and nowhere negative."""
    points = np.array([(0, 0), (1, 0), (0, 1), (0.5, 0.5)], dtype=float)
    plot_mesh(QuadMesh(points, np.arange(4)[None], 1, {}, {}), tmp_path / "a.svg")
    assert "fill: #ff9900" in svg(tmp_path / "a.svg")
    assert any("1 undecided (orange)" in text for text in texts(tmp_path / "a.svg"))


def test_nodes_that_are_not_finite_do_not_stop_the_drawing(layouts, tmp_path, matplotlib):
    mesh = generate(layouts.square(counts=2), 2)
    points = np.array(mesh.points)
    points[mesh.corners[3, 2]] = np.nan
    plot_mesh(mesh.with_points(points), tmp_path / "a.svg")
    assert any("1 invalid (red)" in text for text in texts(tmp_path / "a.svg"))


def test_lines_of_thin_layers_are_thin(tmp_path, matplotlib):
    """100 layers in half a percent of the height remain readable as colours, not as one black bar."""
    vertices = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1), "e": (1, 1.005), "f": (0, 1.005)}
    layered = BlockStructure.build(vertices, [tuple("abcd"), tuple("dcef")], counts=100)
    plot_mesh(generate(layered, 1), tmp_path / "a.png", width=3, dpi=100)
    pixels = image(tmp_path / "a.png", matplotlib)[..., :3]
    dark = (pixels.max(axis=2) < 0.3).mean()
    assert dark < 0.3


def test_the_same_mesh_gives_the_same_file(layouts, tmp_path, matplotlib):
    structure = layouts.annulus(4)
    for name in ("a.png", "b.png"):
        plot_mesh(generate(structure, 2), tmp_path / name, structure=structure, width=3, dpi=50, vertex_names=True)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_groups_with_leading_underscores_are_in_the_legend(layouts, tmp_path, matplotlib):
    structure = layouts.square(edges={"_hidden": [("a", "b")]})
    plot_mesh(generate(structure, 1), tmp_path / "a.svg")
    assert any("_hidden" in text for text in texts(tmp_path / "a.svg"))


def test_the_legend_names_what_is_in_view(layouts, tmp_path, matplotlib):
    structure = layouts.square(counts=4, edges={"floor": [("a", "b")], "lid": [("d", "c")]})
    plot_mesh(generate(structure, 2), tmp_path / "a.svg", zoom=(0.0, 1.0, -0.1, 0.3))
    assert "floor" in texts(tmp_path / "a.svg")
    assert "lid" not in texts(tmp_path / "a.svg")
