"""Fluids around bodies that move as prescribed: forces against published ones, volume, and the way back of the mesh."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import hofsi
from hoblock.motion import MeshState

pytestmark = [pytest.mark.verification, pytest.mark.slow]

EXAMPLES = Path(__file__).parents[2] / "examples"
QUIET = ["output.fields=false", "output.plots=false"]


def run(scene, folder, *changes):
    result = hofsi.run(hofsi.load_case(EXAMPLES / f"{scene}.toml", [*changes, *QUIET]), folder)
    assert result.status == "completed"
    return result


def series(folder):
    with (folder / "quantities.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_morison_coefficients_of_an_oscillating_cylinder(tmp_path):
    """Dütsch et al., J. Fluid Mech. 360 (1998): c_d = 2.09, c_i = 1.45 at Re = 100, KC = 5."""
    result = run("oscillating_cylinder", tmp_path)
    force = result.summary["quantities"]["c_x"]
    # F = -c_d ρ D/2 |v| v - c_i π ρ D²/4 a; of |v| v the first harmonic is 8/(3 π) U².
    harmonic, phase = 0.5 * force["harmonic"], math.radians(force["phase"])
    rate, amplitude = 2.0 * math.pi / 5.0, 5.0 / (2.0 * math.pi)
    drag = -0.75 * math.pi * harmonic * math.sin(phase)
    inertia = 4.0 / (math.pi * rate**2 * amplitude) * harmonic * math.cos(phase)
    assert drag == pytest.approx(2.09, rel=0.01)
    assert inertia == pytest.approx(1.45, rel=0.01)
    found = series(tmp_path)
    assert np.abs(found["balance"]).max() < 1e-10
    assert np.abs(found["c_y"]).max() < 1e-10  # the flow stays symmetric
    assert np.ptp(found["area"]) < 1e-11 * found["area"][0]


def test_a_pitching_airfoil_conserves_volume_and_repeats_itself(tmp_path):
    result = run("pitching_airfoil", tmp_path, "mesh.order=3")
    found = series(tmp_path)
    rest = np.abs(found["in"] + found["out"] + found["swept"]) / np.abs(found["in"])
    assert rest.max() < 1e-10  # flow out minus flow in, and what the airfoil sweeps
    assert np.abs(found["balance"]).max() < 1e-10
    assert np.ptp(found["area"]) < 1e-12 * found["area"][0]
    quantities = result.summary["quantities"]  # compared with order 4, for there is no published reference
    assert quantities["angle"]["frequency"] == pytest.approx(0.5, rel=1e-9)
    assert quantities["c_L"]["frequency"] == pytest.approx(0.5, rel=1e-2)
    assert quantities["c_D"]["frequency"] == pytest.approx(1.0, rel=1e-2)
    for name, harmonic, phase in (("c_L", 2.7998, 82.55), ("c_M", 0.8286, 113.82)):
        assert quantities[name]["harmonic"] == pytest.approx(harmonic, rel=5e-3), name
        assert quantities[name]["phase"] == pytest.approx(phase, abs=0.5), name


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("turns", [1, 8])
def test_an_airfoil_turned_by_45_degrees_and_back_leaves_no_drift(order, turns):
    problem = hofsi.build(hofsi.load_case(EXAMPLES / "pitching_airfoil.toml", [f"mesh.order={order}"]))
    motion = problem.fluid.motion
    body = problem.fluid.mesh.points[motion.driven.nodes]

    def turned(state, degrees):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        about = np.array([0.25, 0.0])
        return motion.move(state, (body - about) @ np.array([[c, -s], [s, c]]) + about - body, 0.0)

    start = state = motion.reference
    assert isinstance(state, MeshState)
    angles = [9.0 * k for k in (1, 2, 3, 4, 5, 4, 3, 2, 1, 0)]
    for _ in range(turns):
        for angle in angles:
            state = turned(state, angle)
            assert state.min_det_J > 0.0
            if angle == 45.0:
                assert np.abs(state.mesh.points - start.mesh.points).max() > 0.5
    assert np.abs(state.mesh.points - start.mesh.points).max() < 1e-12
    # The mesh is one of the position: in one step or in many.
    there = turned(start, 45.0)
    by_steps = start
    for angle in angles[:5]:
        by_steps = turned(by_steps, angle)
    assert np.abs(there.mesh.points - by_steps.mesh.points).max() < 1e-12
