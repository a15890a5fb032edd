import os
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from hoblock.generate import generate
from hoblock.io.pvd import PvdSeries, write_pvd
from hoblock.io.vtu import read_vtu


def entries(path):
    return [(float(d.get("timestep")), d.get("file")) for d in ElementTree.parse(path).iter("DataSet")]


def test_a_series_is_complete_after_every_step(layouts, tmp_path):
    mesh = generate(layouts.annulus(3), 3)
    path = tmp_path / "ring & co.pvd"
    series = PvdSeries(path)
    assert not path.exists()
    assert series.times == ()
    for k, time in enumerate((-0.5, 0.1, 1e3)):
        series.write(time, mesh.with_points(mesh.points * (1 + k)), point_data={"u": mesh.points})
        found = entries(path)
        assert [t for t, _ in found] == list(series.times) == [-0.5, 0.1, 1e3][: k + 1]
        for n, (_, file) in enumerate(found):
            np.testing.assert_allclose(read_vtu(tmp_path / file).points, mesh.points * (1 + n), atol=1e-13)
    assert sorted(p.name for p in tmp_path.iterdir()) == [path.name, *(f"ring & co_0000{k}.vtu" for k in range(3))]


@pytest.mark.parametrize("time", [1.0, 0.5, float("nan"), float("inf")])
def test_times_must_grow(time, layouts, tmp_path):
    mesh = generate(layouts.square(), 1)
    series = PvdSeries(tmp_path / "s.pvd")
    series.write(1.0, mesh)
    with pytest.raises(ValueError, match=r"time is .*; expected a finite number above 1\.0"):
        series.write(time, mesh)
    assert series.times == (1.0,)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_failed_step_leaves_the_series_as_it_was(layouts, tmp_path):
    mesh = generate(layouts.square(), 1)
    series = PvdSeries(tmp_path / "s.pvd")
    with pytest.raises(ValueError, match="one row for each node"):
        series.write(0.0, mesh, point_data={"u": np.zeros(3)})
    assert series.times == ()
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match=r"time is -inf; expected a finite number\."):
        series.write(float("-inf"), mesh)


def test_lists_of_files(tmp_path):
    write_pvd(tmp_path / "a.pvd", [(0.1 + 0.2, 'b"<&>.vtu')])
    assert entries(tmp_path / "a.pvd") == [(0.1 + 0.2, 'b"<&>.vtu')]
    with pytest.raises(FileNotFoundError):
        write_pvd(tmp_path / "missing" / "a.pvd", [])


def test_an_interruption_leaves_the_series_before(tmp_path, monkeypatch):
    write_pvd(tmp_path / "a.pvd", [(1.0, "a.vtu")])

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_pvd(tmp_path / "a.pvd", [(1.0, "a.vtu"), (2.0, "b.vtu")])
    assert entries(tmp_path / "a.pvd") == [(1.0, "a.vtu")]
