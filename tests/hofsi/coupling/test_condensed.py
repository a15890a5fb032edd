"""Steps in which the solid is solved together with the condensed fluid."""

from pathlib import Path

import numpy as np
import pytest

from hofsi.build import build
from hofsi.io.scene import load_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate

EXAMPLES = Path(__file__).parents[3] / "examples"
QUIET = ["output.fields=false", "output.plots=false"]


def march(scene, *changes):
    """Quantities at every step, coupling iterations, and counts."""
    problem = build(load_case(EXAMPLES / f"{scene}.toml", [*QUIET, *changes]))
    read = evaluators(problem)
    rows = [([evaluate(r) for evaluate in read.values()], r.coupling.iterations) for r in simulate(problem)]
    return np.array([values for values, _ in rows]), np.array([count for _, count in rows]), problem.counts


def off(found, reference):
    """Largest difference of u_x, u_y, drag and lift, relative to the largest displacement and force."""
    scale = np.repeat([np.abs(reference[:, part]).max() for part in (slice(0, 2), slice(2, 4))], 2)
    return (np.abs(found - reference) / scale).max()


FLAG = ["mesh.order=2", "time.dt=0.005", "time.end=0.05"]
TIGHT = ["coupling.tolerance=1e-7", "coupling.force_tolerance=1e-5", "coupling.max_iterations=100"]


@pytest.mark.parametrize("scheme", ["bdf2", "generalised-alpha", "energy-momentum"])
def test_the_result_is_that_of_the_iteration_between_the_fields(scheme):
    common = [*FLAG, *TIGHT, f'time.solid="{scheme}"']
    found, iterations, counts = march("fsi3", *common)
    reference, more, _ = march("fsi3", *common, "coupling.condensed=false")
    assert off(found, reference) <= 1e-6
    assert (iterations[2:] == 2).all()
    assert more.mean() > 5.0
    assert counts["solid"].factorisations <= 2 * len(found)


PULSE = ["mesh.order=2", "time.end=0.001"]


@pytest.mark.parametrize("density", [1.1, 0.1, 0.01, 0.001])
def test_added_mass_does_not_matter(density):
    _, iterations, _ = march("pressure_pulse", *PULSE, f"solid[0].density={density}", f"solid[1].density={density}")
    assert len(iterations) == 10  # none was divided
    assert iterations.max() <= 5  # at first the flow is linearised twice
    assert (iterations[2:] == 2).all()


@pytest.mark.parametrize("acceleration", ["iqn-ils", "imvj", "aitken", "constant"])
def test_the_acceleration_does_not_matter_where_the_fluid_is_condensed(acceleration):
    found, iterations, _ = march("pressure_pulse", *PULSE, f'coupling.acceleration="{acceleration}"')
    reference, _, _ = march("pressure_pulse", *PULSE)
    np.testing.assert_array_equal(found, reference)
    assert iterations.max() <= 4


def test_where_a_field_is_solved_iteratively_the_acceleration_takes_over():
    found, iterations, _ = march("fsi3", *FLAG, *TIGHT, 'linear.solver="amg"', "time.end=0.025")
    reference, _, _ = march("fsi3", *FLAG, *TIGHT, "time.end=0.025")
    assert iterations.max() > 4
    assert off(found, reference) <= 1e-6


@pytest.mark.parametrize("density", [1.1, 0.01])
def test_implicit_geometry_gains_by_it_too(density):
    common = [*PULSE, "coupling.geometry=implicit", 'coupling.acceleration="iqn-ils"', f"solid[0].density={density}"]
    found, iterations, _ = march("pressure_pulse", *common)
    assert len(found) == 10
    assert iterations.mean() <= 5.0
    if density > 1.0:
        reference, more, _ = march("pressure_pulse", *common, "coupling.condensed=false")
        assert more.mean() > 1.5 * iterations.mean()
        assert np.abs(found[:, 0] - reference[:, 0]).max() <= 1e-5 * np.abs(reference[:, 0]).max()


def test_a_flow_far_from_what_it_was_linearised_about_is_linearised_again():
    """A light wall gives way at once: what the first linearisation tells of its load is far off."""
    common = [*PULSE, "time.end=0.0002", "solid[0].density=0.01"]
    found, iterations, counts = march("pressure_pulse", *common)
    assert iterations[0] > 2
    assert counts["fluid"].reasons["linear step"] > len(found)
    exact, _, _ = march("pressure_pulse", *common, 'fluid.convection="newton"', "coupling.geometry=implicit")
    assert np.abs(found[:, 0] - exact[:, 0]).max() <= 0.02 * np.abs(exact[:, 0]).max()
