"""Fields of fluid and solid as series of files for ParaView."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh
from hoblock.io.pvd import write_pvd
from hofsi.build import Problem
from hofsi.fem.resampling import pressure_at_nodes
from hofsi.io.vtu import require_vtk, write_vtu
from hofsi.records import StepRecord

if TYPE_CHECKING:
    from hofsi.solvers.fluid_vorticity import FluidVorticity
    from hofsi.solvers.solid_state import SolidState
    from hofsi.solvers.solid_stress import SolidStress

Array = NDArray[np.float64]

__all__ = ["FieldWriter"]

_SERIES = ("fluid", "solid")


class FieldWriter:
    """Writes every N-th step and the last one: ``fluid.pvd`` and ``solid.pvd``, with their files in ``fields``.

    The fluid has ``velocity``, ``pressure``, ``vorticity``, and ``mesh_displacement`` if its mesh moves; the solid has
    ``displacement``, ``velocity`` unless the case is steady, ``cauchy_stress`` (xx, yy, zz, xy, yz, xz) and
    ``von_mises``. Both are written where they are, deformed. The series is complete after every step, whatever happens
    to the run later.

    Parameters
    ----------
    problem : Problem
    directory : path-like
        Made if it does not exist.
    every : int
        Steps of the scene's ``dt`` between files; their parts do not count.

    Raises
    ------
    MissingExtraError
        If vtk is not installed.
    ValueError
        If ``every`` is not positive.
    """

    def __init__(self, problem: Problem, directory: str | os.PathLike[str], every: int) -> None:
        if every < 1:
            raise ValueError(f"every: got {every}; expected a number of steps, at least 1.")
        require_vtk()
        self._problem, self._directory, self._every = problem, Path(directory), every
        (self._directory / "fields").mkdir(parents=True, exist_ok=True)
        self._stress, self._vorticity = _stress(problem), _vorticity(problem)
        self._entries: dict[str, list[tuple[float, str]]] = {}
        self._waiting: StepRecord | None = None

    def observe(self, record: StepRecord) -> None:
        """Write a finished step if its turn has come; otherwise remember it, it may be the last one."""
        if record.done % self._every:
            self._waiting = record
        else:
            self._write(record)
            self._waiting = None

    def close(self) -> None:
        """Write the last step observed, unless it is written already; also after a run that was broken off."""
        if self._waiting is not None:
            self._write(self._waiting)
            self._waiting = None

    def memory(self) -> dict[str, Any]:
        """The series so far, and whether the last step is still to be written if no other follows."""
        return {"entries": self._entries, "waiting": self._waiting is not None}

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on with the series as it was: what was written later, or not to the end, is removed.

        Files that are not there, because the run goes on in another directory, are left out.
        """
        for path in (self._directory / "fields").glob("*.vtu*"):
            series, _, number = path.name.partition("_")
            if number and series in _SERIES and not _listed(memory["entries"].get(series, ()), path):
                path.unlink()
        for name in _SERIES:
            here = [entry for entry in memory["entries"].get(name, ()) if (self._directory / entry[1]).is_file()]
            if here:
                self._entries[name] = here
                write_pvd(self._directory / f"{name}.pvd", here)
            else:
                (self._directory / f"{name}.pvd").unlink(missing_ok=True)
        self._waiting = record if memory["waiting"] else None

    def _write(self, record: StepRecord) -> None:
        fluid, solid, state = self._problem.fluid, self._problem.solid, record.state
        if fluid is not None and state.fluid is not None and state.mesh is not None:
            points = state.mesh.mesh.points
            fields = {
                "velocity": state.fluid.velocity,
                "pressure": pressure_at_nodes(fluid.solver.space, state.fluid.pressure),
            }
            if self._vorticity is not None:
                fields["vorticity"] = self._vorticity.at_nodes(points, state.fluid.velocity)
            if self._problem.case.motions or solid is not None:
                fields["mesh_displacement"] = points - fluid.mesh.points
            self._add("fluid", record, fluid.mesh, points, fields)
        if solid is not None and state.solid is not None:
            points = solid.mesh.points + state.solid.displacement
            self._add("solid", record, solid.mesh, points, self._solid_fields(state.solid, record.dt == 0.0))

    def _solid_fields(self, state: SolidState, steady: bool) -> dict[str, Array]:
        fields = {"displacement": state.displacement}
        if not steady:
            fields["velocity"] = state.velocity
        if self._stress is not None:
            from hofsi.solvers.solid_stress import von_mises

            sigma = self._stress.cauchy(state.displacement)
            fields["cauchy_stress"] = np.pad(sigma, ((0, 0), (0, 2)))  # six components are a symmetric tensor for VTK
            fields["von_mises"] = von_mises(sigma)
        return fields

    def _add(self, name: str, record: StepRecord, mesh: QuadMesh, points: Array, fields: Mapping[str, Array]) -> None:
        file = f"fields/{name}_{record.step:06d}.vtu"
        write_vtu(self._directory / file, mesh, points, fields)
        entries = self._entries.setdefault(name, [])
        entries.append((record.time, file))
        write_pvd(self._directory / f"{name}.pvd", entries)


def _listed(entries: Iterable[tuple[float, str]], path: Path) -> bool:
    return any(file == f"fields/{path.name}" for _, file in entries)


def _vorticity(problem: Problem) -> FluidVorticity | None:
    if problem.fluid is None:
        return None
    from hofsi.solvers.fluid_vorticity import FluidVorticity

    same = problem.fluid.solver.space.same
    return FluidVorticity(problem.fluid.mesh, None if same is None else same[0])


def _stress(problem: Problem) -> SolidStress | None:
    if problem.solid is None:
        return None
    from hofsi.solvers.solid_stress import SolidStress

    return SolidStress(problem.solid.mesh, problem.case.solids)
