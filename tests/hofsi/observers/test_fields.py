"""Series of fields written during runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from hofsi.build import Problem, build
from hofsi.case import Case
from hofsi.fem.resampling import pressure_at_nodes
from hofsi.observers.fields import FieldWriter
from hofsi.plan import plan
from hofsi.records import StepRecord
from hofsi.simulate import simulate
from hofsi.solvers.fluid_vorticity import FluidVorticity

Read = Callable[..., Case]
Array = NDArray[np.float64]
pytestmark = pytest.mark.usefixtures("vtk_module")

FIVE = ("dt = 0.1\nend = 2.0", "dt = 0.1\nsteps = 5")
STEADY = ("dt = 0.1\nend = 2.0", "steady = true")
STIFF = ("youngs_modulus = 1e3", "youngs_modulus = 1e6")


def _series(path: Path) -> list[tuple[float, str]]:
    sets = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
    return [(float(one.attrib["timestep"]), one.attrib["file"]) for one in sets]


def _read(path: Path) -> tuple[Array, dict[str, Array]]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid: Any = reader.GetOutput()
    data = grid.GetPointData()
    fields = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
    return vtk_to_numpy(grid.GetPoints().GetData()), fields


def _observed(problem: Problem, writer: FieldWriter) -> Iterator[StepRecord]:
    for record in simulate(problem):
        writer.observe(record)
        yield record


@pytest.mark.parametrize(("every", "steps"), [(1, [1, 2, 3, 4, 5]), (2, [2, 4, 5]), (5, [5]), (9, [5])])
def test_every_nth_step_and_the_last(read_changed: Read, tmp_path: Path, every: int, steps: list[int]) -> None:
    case = read_changed(FIVE, ("[output]", f"[output]\nevery = {every}"))
    problem = build(case)
    writer = FieldWriter(problem, tmp_path / "out", every)
    records = {record.step: record for record in _observed(problem, writer)}
    writer.close()
    writer.close()  # once more does nothing
    for name in ("fluid", "solid"):
        expected = [(records[step].time, f"fields/{name}_{step:06d}.vtu") for step in steps]
        assert _series(tmp_path / "out" / f"{name}.pvd") == expected
    files = sorted(path.name for path in (tmp_path / "out" / "fields").iterdir())
    assert files == sorted(f"{name}_{step:06d}.vtu" for name in ("fluid", "solid") for step in steps)
    promised = next(item.detail for item in plan(case).built if item.name == "fields")
    assert f": {len(steps)} time" in promised


def test_fields_of_a_coupled_step(read_changed: Read, tmp_path: Path) -> None:
    """At order 2 the nodes of the file are those of the mesh."""
    problem = build(read_changed(FIVE))
    writer = FieldWriter(problem, tmp_path, 10)
    last = list(_observed(problem, writer))[-1]
    writer.close()
    state = last.state
    assert state.fluid is not None
    assert state.solid is not None
    assert state.mesh is not None
    assert problem.fluid is not None
    assert problem.solid is not None
    points, fields = _read(tmp_path / "fields" / "fluid_000005.vtu")
    assert set(fields) == {"velocity", "pressure", "vorticity", "mesh_displacement"}
    moved = state.mesh.mesh.points
    assert np.abs(moved - problem.fluid.mesh.points).max() > 1e-6
    np.testing.assert_allclose(points[:, :2], moved, rtol=0, atol=1e-14)
    np.testing.assert_allclose(fields["velocity"][:, :2], state.fluid.velocity, rtol=0, atol=1e-14)
    displaced = moved - problem.fluid.mesh.points
    np.testing.assert_allclose(fields["mesh_displacement"][:, :2], displaced, rtol=0, atol=1e-14)
    pressure = pressure_at_nodes(problem.fluid.solver.space, state.fluid.pressure)
    np.testing.assert_allclose(fields["pressure"], pressure, rtol=0, atol=1e-14)
    vorticity = FluidVorticity(problem.fluid.mesh).at_nodes(moved, state.fluid.velocity)
    np.testing.assert_allclose(fields["vorticity"], vorticity, rtol=0, atol=1e-13)
    assert np.abs(vorticity).max() > 0.1

    points, fields = _read(tmp_path / "fields" / "solid_000005.vtu")
    assert set(fields) == {"displacement", "velocity", "cauchy_stress", "von_mises"}
    d = state.solid.displacement
    np.testing.assert_allclose(points[:, :2], problem.solid.mesh.points + d, rtol=0, atol=1e-14)
    np.testing.assert_allclose(fields["displacement"][:, :2], d, rtol=0, atol=1e-14)
    np.testing.assert_allclose(fields["velocity"][:, :2], state.solid.velocity, rtol=0, atol=1e-14)
    xx, yy, zz, xy, yz, xz = fields["cauchy_stress"].T
    assert not yz.any()
    assert not xz.any()
    squares = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * xy**2
    np.testing.assert_allclose(fields["von_mises"], np.sqrt(squares), rtol=1e-12)
    assert fields["von_mises"].max() > 0.0


def test_fluid_and_solid_meet_in_the_files(read_changed: Read, tmp_path: Path) -> None:
    problem = build(read_changed(("order = 2", "order = 4"), FIVE, ("[coupling]", '[coupling]\ngeometry = "implicit"')))
    assert problem.interface is not None
    assert problem.solid is not None
    writer = FieldWriter(problem, tmp_path, 5)
    for _ in _observed(problem, writer):
        pass
    fluid, solid = (_read(tmp_path / "fields" / f"{name}_000005.vtu")[0] for name in ("fluid", "solid"))
    undeformed = problem.solid.mesh.points[problem.interface.solid]
    assert np.abs(solid[problem.interface.solid, :2] - undeformed).max() > 1e-3
    np.testing.assert_allclose(fluid[problem.interface.fluid], solid[problem.interface.solid], rtol=0, atol=1e-7)


def test_a_steady_case_has_one_time(read_changed: Read, tmp_path: Path) -> None:
    problem = build(read_changed(STEADY, STIFF, ("*sin(t)", ""), ("viscosity = 0.01", "viscosity = 0.5")))
    writer = FieldWriter(problem, tmp_path, 10)
    assert len(list(_observed(problem, writer))) == 1
    writer.close()
    assert _series(tmp_path / "fluid.pvd") == [(0.0, "fields/fluid_000001.vtu")]
    assert set(_read(tmp_path / "fields" / "solid_000001.vtu")[1]) == {"displacement", "cauchy_stress", "von_mises"}


def test_a_fluid_alone_on_a_mesh_at_rest(read_changed: Read, fluid_alone: str, tmp_path: Path) -> None:
    problem = build(read_changed(FIVE, text=fluid_alone))
    writer = FieldWriter(problem, tmp_path, 3)
    for _ in _observed(problem, writer):
        pass
    writer.close()
    assert set(_read(tmp_path / "fields" / "fluid_000003.vtu")[1]) == {"velocity", "pressure", "vorticity"}
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["fields", "fluid.pvd"]


def test_a_run_that_was_broken_off_keeps_its_last_step(read_changed: Read, tmp_path: Path) -> None:
    problem = build(read_changed(FIVE))
    writer = FieldWriter(problem, tmp_path, 2)
    for record in _observed(problem, writer):
        if record.step == 3:
            break
    assert [file for _, file in _series(tmp_path / "fluid.pvd")] == ["fields/fluid_000002.vtu"]
    writer.close()
    assert [file for _, file in _series(tmp_path / "fluid.pvd")] == [
        "fields/fluid_000002.vtu",
        "fields/fluid_000003.vtu",
    ]


def test_without_a_step_nothing_is_written(read_changed: Read, tmp_path: Path) -> None:
    writer = FieldWriter(build(read_changed(FIVE)), tmp_path, 2)
    writer.close()
    assert list(tmp_path.glob("*.pvd")) == []


def test_records_are_only_read(read_changed: Read, tmp_path: Path) -> None:
    problem = build(read_changed(FIVE))
    record = next(simulate(problem))
    assert record.state.fluid is not None
    before = record.state.fluid.velocity.copy()
    velocity = record.state.fluid.velocity.copy()
    velocity.setflags(write=False)
    state = replace(record.state, fluid=replace(record.state.fluid, velocities=(velocity,)))
    writer = FieldWriter(problem, tmp_path, 1)
    writer.observe(replace(record, state=state))
    assert np.array_equal(velocity, before)


def test_a_number_of_steps_must_be_positive(read_changed: Read, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"every: got 0; expected a number of steps, at least 1"):
        FieldWriter(build(read_changed(FIVE)), tmp_path, 0)


def test_parts_of_divided_steps_do_not_count(read_changed: Read, tmp_path: Path) -> None:
    problem = build(read_changed(("dt = 0.1\nend = 2.0", "dt = 0.1\nsteps = 4\nfirst = 0.025")))
    writer = FieldWriter(problem, tmp_path, 2)
    records = list(_observed(problem, writer))
    writer.close()
    assert len(records) > 4
    assert [time for time, _ in _series(tmp_path / "fluid.pvd")] == pytest.approx([0.2, 0.4])
