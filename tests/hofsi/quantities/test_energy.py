"""The energy of every step is balanced but for what vanishes with the second power of the step size."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest

from hofsi.build import build
from hofsi.io.scene import read_case
from hofsi.quantities.energy import EnergyBudget
from hofsi.run import run
from hofsi.simulate import simulate


def balanced(text: str, dt: float, *changes: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Times, and columns kinetic, strain, dissipation, power, defect, of a run to t = 1."""
    for old, new in (("dt = 0.1", f"dt = {dt}"), ("end = 2.0", "end = 1.0"), *changes):
        assert old in text
        text = text.replace(old, new)
    problem = build(read_case(tomllib.loads(text), "flap.toml"))
    budget = EnergyBudget(problem)
    rows = [(record.time, *budget.follow(record)) for record in simulate(problem)]
    table = np.array(rows, dtype=float)
    return table[:, 0], table[:, 1:]


# Smooth in time, and a fluid that dissipates much: t² from rest. At order 2 what the mesh leaves would be seen.
SMOOTH = ("sin(t)", "t**2"), ("viscosity = 0.01", "viscosity = 0.2"), ("order = 2", "order = 4")


@pytest.mark.parametrize(
    ("scheme", "geometry"),
    [
        ("bdf2", "extrapolated"),
        ("bdf2", "implicit"),
        ("generalised-alpha", "extrapolated"),
        ("energy-momentum", "extrapolated"),
    ],
)
def test_the_defect_is_of_second_order(flap: str, scheme: str, geometry: str) -> None:
    text = flap.replace("[coupling]", f'[coupling]\ngeometry = "{geometry}"\ntolerance = 1e-7')
    text = text.replace("dt = 0.1", f'dt = 0.1\nsolid = "{scheme}"')
    sums = []
    for dt in (0.05, 0.025):
        t, columns = balanced(text, dt, *SMOOTH)
        late = t > 0.5
        sums.append(abs(columns[late, 4].sum()))
        assert sums[-1] < 0.01 * float((columns[late, 2] * dt).sum())  # of the energy that is dissipated meanwhile
    assert sums[1] < 0.35 * sums[0]


def test_the_energy_momentum_rule_alone_keeps_the_energy(flap: str) -> None:
    text = flap[: flap.index("[fluid]")] + flap[flap.index("[[solid]]") :]
    for old, new in (
        (flap[flap.index("fluid = [") : flap.index("solid = [[")], ""),
        ("[coupling]\n", ""),
        ('inlet = [["a0", "a1", "a2"]]', ""),
        ('outlet = [["d0", "d1", "d2"]]', ""),
        ('bottom = [["a0", "b0"], ["c0", "d0"]]', ""),
        ('top = [["a2", "b2", "c2", "d2"]]', ""),
        ('inside = [["a1", "b1"]]', ""),
        ("poissons_ratio = 0.4", 'poissons_ratio = 0.4\ninitial_velocity = ["3*y**2", "0"]'),
        ('[quantities.lift]\ntype = "force"\non = ["flap", "bottom"]\ncomponent = "y"\n', ""),
        ("[time]", '[[solid.boundary]]\non = "flap"\ntype = "free"\n\n[time]'),
    ):
        assert old in text, old
        text = text.replace(old, new)
    used = ("b0", "b1", "c0", "c1")
    lines = [
        line
        for line in text.splitlines()
        if line.split(" = ")[0] not in {f"{a}{k}" for a in "abcd" for k in "012"} - {*used}
    ]
    _, columns = balanced("\n".join(lines), 0.05, ("dt = 0.05", 'dt = 0.05\nsolid = "energy-momentum"'))
    energy = columns[:, 0] + columns[:, 1]
    assert columns[:, 1].max() > 0.1 * energy.max()  # motion and strain exchange it
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
    np.testing.assert_allclose(columns[1:, 4], 0.0, atol=1e-9 * energy[0])


def test_steps_are_written_with_energies_if_asked(flap: str, tmp_path: Path) -> None:
    text = flap.replace("end = 2.0", "end = 0.3").replace(
        "[output]", "[output]\nfields = false\nplots = false\nenergy = true"
    )
    run(read_case(tomllib.loads(text), "flap.toml"), tmp_path / "with")
    run(read_case(tomllib.loads(text.replace("energy = true", "")), "flap.toml"), tmp_path / "without")
    names = ("kinetic_energy", "strain_energy", "dissipation", "power", "energy_defect")
    tables = []
    for folder in ("with", "without"):
        with open(tmp_path / folder / "steps.csv", encoding="utf-8", newline="") as file:
            tables.append(list(csv.DictReader(file)))
    with_, without = tables
    assert all(float(row[name]) >= 0.0 for row in with_ for name in names[:3])
    assert [row["energy_defect"] == "" for row in with_] == [True, False, False]
    assert all(row[name] == "" for row in without for name in names)
