import re

import numpy as np

from hoblock.blocks import BlockStructure
from hoblock.generate import generate
from hoblock.plot import plot_mesh


def test_vertex_names_are_written_literally(layouts, tmp_path, matplotlib):
    vertices = {"$x_1$": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    structure = BlockStructure.build(vertices, [tuple(vertices)])
    plot_mesh(generate(structure, 1), tmp_path / "names.svg", structure=structure, vertex_names=True)
    text = (tmp_path / "names.svg").read_text(encoding="utf-8")
    assert "<!-- $x_1$ -->" in text


def svg(path):
    return path.read_text(encoding="utf-8")


def texts(path):
    """What is written in an SVG; matplotlib keeps it in comments."""
    return re.findall(r"<!-- (.+?) -->", svg(path))


def test_counts_numbers_and_nodes(layouts, tmp_path, matplotlib):
    structure = layouts.square(counts=7)
    mesh = generate(structure, 2)
    plot_mesh(mesh, tmp_path / "a.svg", structure=structure, counts=True, element_numbers=True, nodes=True)
    written = texts(tmp_path / "a.svg")
    assert written.count("7") == 5  # four edges and element 7
    assert "48" in written
    assert svg(tmp_path / "a.svg").count("<use") > 15 * 15


def test_names_that_would_cover_others_are_left_out_and_counted(tmp_path, matplotlib):
    n = 12
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    vertices = {f"a_rather_long_name_{k}": p for k, p in enumerate(zip(x.ravel(), y.ravel(), strict=True))}
    names = list(vertices)
    corner = [k + (n + 1) * j for j in range(n) for k in range(n)]
    quads = [tuple(names[k] for k in (c, c + 1, c + n + 2, c + n + 1)) for c in corner]
    structure = BlockStructure.build(vertices, quads)
    mesh = generate(structure, 1)
    plot_mesh(mesh, tmp_path / "a.svg", structure=structure, vertex_names=True, width=4)
    written = texts(tmp_path / "a.svg")
    shown = [text for text in written if text.startswith("a_rather")]
    (note,) = [text for text in written if "left out" in text]
    assert int(note.split()[0]) + len(shown) == len(vertices)
    assert 10 < len(shown) < 100
    plot_mesh(mesh, tmp_path / "b.svg", structure=structure, vertex_names=True, zoom=(0.0, 0.1, 0.0, 0.1))
    close = [text for text in texts(tmp_path / "b.svg") if text.startswith("a_rather")]
    assert sorted(close) == sorted(names[k] for k in (0, 1, n + 1, n + 2))


def test_zoom_shows_its_part_only(layouts, tmp_path, matplotlib):
    structure = layouts.square(counts=10)
    mesh = generate(structure, 1)
    plot_mesh(mesh, tmp_path / "a.svg", element_numbers=True, zoom=(0.02, 0.18, 0.02, 0.08))
    written = [text for text in texts(tmp_path / "a.svg") if text in ("0", "1", "2", "10", "99")]
    assert {"0", "1"} <= set(written)
    assert "99" not in written
