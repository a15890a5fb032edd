"""Tables of quantities and steps."""

from __future__ import annotations

import csv
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hofsi.counts import Counts
from hofsi.observers.table import STEP_COLUMNS, QuantityTable, StepTable
from hofsi.records import CouplingRecord, Rejection, State, StepRecord


def record(step: int, **others: Any) -> StepRecord:
    return StepRecord(step, 0.1 * step, 0.1, others.pop("state", State()), **others)


def lines(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_quantities_are_on_disk_after_every_step(tmp_path: Path) -> None:
    path = tmp_path / "quantities.csv"
    table = QuantityTable(path, {"square": lambda r: r.step**2 / 3.0, "gone": lambda r: float("nan")})
    assert path.read_text(encoding="utf-8") == "step,t,square,gone\n"
    for step in (1, 2, 3):
        table.observe(record(step))
        written = lines(path)
        assert len(written) == step
        assert float(written[-1]["square"]) == step**2 / 3.0  # all digits
        assert (written[-1]["step"], float(written[-1]["t"]), written[-1]["gone"]) == (str(step), step / 10, "nan")
    table.close()
    np.testing.assert_array_equal(table.times, [0.1, 0.2, 0.1 * 3])
    np.testing.assert_array_equal(table.series["square"], np.array([1.0, 4.0, 9.0]) / 3.0)


def test_a_quantity_that_fails_leaves_no_half_line(tmp_path: Path) -> None:
    def fail(_: StepRecord) -> float:
        raise ValueError("no such thing")

    table = QuantityTable(tmp_path / "quantities.csv", {"good": lambda r: 1.0, "bad": fail})
    with pytest.raises(ValueError, match="no such thing"):
        table.observe(record(1))
    table.close()
    assert (table.times.size, lines(tmp_path / "quantities.csv")) == (0, [])


def test_steps_tell_how_coupling_went(tmp_path: Path) -> None:
    counts = {"fluid": Counts(), "solid": Counts()}
    seconds = iter([10.0, 10.5, 12.25])
    table = StepTable(tmp_path / "steps.csv", counts, lambda: next(seconds))
    for step in (1, 2):
        counts["fluid"].factorised("flow")
        counts["fluid"].factorised("iterations" if step == 2 else "flow")
        counts["solid"].factorised("tangent")
        counts["solid"].assemblies += 1
        counts["fluid"].preconditioners = 1
        counts["fluid"].linear_iterations += 17
        mesh: Any = SimpleNamespace(regenerated=7, substeps=2, amplification=6.25, snapped=True)
        rejected = (Rejection(0.4, "NewtonError", "."), Rejection(0.2, "NewtonError", "."))
        others = {"local_error": 1e-5, "rejected": rejected if step == 2 else ()}
        coupling = CouplingRecord(4, 1e-7, 2e-8, 0.5, 0.25, 1e-3)
        table.observe(record(step, state=State(mesh=mesh), coupling=coupling, min_det_J=0.25, **others))
    table.close()
    assert (table.steps, table.coupling_iterations, table.blocks_regenerated) == (2, 8, 14)
    assert table.mesh_jumps == 2
    written = lines(tmp_path / "steps.csv")
    assert tuple(written[0]) == STEP_COLUMNS
    assert written[1] == {
        "step": "2",
        "t": "0.2",
        "dt": "0.1",
        "coupling_iterations": "4",
        "displacement_residual": "1e-07",
        "force_residual": "2e-08",
        "interface_work_fluid": "0.5",
        "interface_work_solid": "0.25",
        "interface_mass_flux": "0.001",
        "min_det_J": "0.25",
        "blocks_regenerated": "7",
        "mesh_substeps": "2",
        "mesh_amplification": "6.25",
        "factorisations": "6",
        "factorised_because": "flow 1, iterations 1, tangent 1",
        "assemblies": "2",
        "preconditioners": "1",
        "linear_iterations": "34",
        "kinetic_energy": "",
        "strain_energy": "",
        "dissipation": "",
        "power": "",
        "energy_defect": "",
        "local_error": "1e-05",
        "rejected": "2",
        "rejected_because": "NewtonError",
        "seconds": "2.25",
    }


def test_what_a_problem_does_not_have_stays_empty(tmp_path: Path) -> None:
    table = StepTable(tmp_path / "steps.csv", {"solid": Counts(factorisations=1)})
    table.observe(record(1))
    table.close()
    (written,) = lines(tmp_path / "steps.csv")
    empty = [name for name, cell in written.items() if not cell]
    coupled, energies = STEP_COLUMNS[3:13], STEP_COLUMNS[-9:-4]
    assert (coupled[0], coupled[-1]) == ("coupling_iterations", "mesh_amplification")
    assert (energies[0], energies[-1]) == ("kinetic_energy", "energy_defect")
    assert empty == [*coupled, "factorised_because", *energies, "local_error", "rejected_because"]
    assert (table.coupling_iterations, table.blocks_regenerated) == (0, 0)


def test_blocks_of_a_mesh_that_stays_are_counted_once(tmp_path: Path) -> None:
    table = StepTable(tmp_path / "steps.csv", {})
    mesh: Any = SimpleNamespace(regenerated=3, substeps=1, amplification=1.5, snapped=False)
    for step in (1, 2, 3):
        table.observe(record(step, state=State(mesh=mesh)))
    table.close()
    assert table.blocks_regenerated == 3


def test_a_folder_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        StepTable(tmp_path / "nowhere" / "steps.csv", {})


def test_energies_follow_every_step_and_the_one_that_a_run_goes_on_after(tmp_path: Path) -> None:
    followed: list[int] = []

    def energies(of: StepRecord) -> tuple[float, ...]:
        followed.append(of.step)
        return 1.0, 2.0, 3.0, 4.0, float(of.step)

    table = StepTable(tmp_path / "steps.csv", {}, energies=energies)
    table.observe(record(1))
    memory = table.memory()
    table.close()
    again = StepTable(tmp_path / "steps.csv", {}, kept=memory["size"], energies=energies)
    again.recall(memory, record(1))
    again.observe(record(2))
    again.close()
    assert followed == [1, 1, 2]
    assert [line["energy_defect"] for line in lines(tmp_path / "steps.csv")] == ["1.0", "2.0"]
