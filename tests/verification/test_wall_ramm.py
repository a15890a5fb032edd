"""The Wall-Ramm flap with the barrier energy and both movers of the paper, from rest to t = 4 s."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytestmark = [pytest.mark.verification, pytest.mark.slow]

ROOT = Path(__file__).parents[2]
SMOOTH = ("barrier", "pseudo-solid")  # movers whose mesh is a function of the position of the flap


@pytest.fixture(scope="module")
def scripts():
    """The examples' and the benchmarks' folder can be imported from."""
    before = list(sys.path)
    sys.path[:0] = [str(ROOT / "examples"), str(ROOT / "benchmarks")]
    yield
    sys.path[:] = before


@pytest.fixture(scope="module")
def runs(scripts, tmp_path_factory):
    import compare_movers

    return compare_movers.main(output=tmp_path_factory.mktemp("movers"))


@pytest.fixture(scope="module")
def noise(scripts, runs):
    """What a mover's force has above 50 Hz from 2.5 s on, largest and root mean square, relative to its amplitude."""
    from _force_noise import noise

    def measured(mover):
        table = np.genfromtxt(runs.picture.parent / mover / "quantities.csv", delimiter=",", names=True)
        return noise(table["t"], table["lift"], 2.5)

    return measured


@pytest.mark.parametrize("mover", [*SMOOTH, "angle-optimisation"])
def test_every_mesh_is_valid(runs, mover):
    assert len(runs.times[mover]) == 800
    assert runs.min_det_J[mover] > 0.0


@pytest.mark.parametrize("mover", SMOOTH)
def test_the_flap_reaches_its_limit_cycle(runs, mover):
    """On the drifting mesh of the optimisation it does not until 4 s, see docs/verification.md."""
    assert all(0.9 < value < 1.1 for _, value in runs.peaks(mover)[-3:])


@pytest.mark.parametrize("mover", SMOOTH)
def test_frequency_lies_in_the_published_scatter(runs, mover):
    """2.8 to 3.3 Hz covers the published values for plane strain and plane stress; see docs/verification.md."""
    times = [time for time, _ in runs.peaks(mover)[-4:]]
    assert 2.8 < 3.0 / (times[-1] - times[0]) < 3.3


@pytest.mark.parametrize("mover", SMOOTH)
def test_the_mesh_brings_no_oscillation_into_the_force(noise, mover):
    """The waves that there are, finer steps show too; the optimisation as published has 0.24 and 0.044 %."""
    largest, mean = noise(mover)
    assert largest < 1.4e-3
    assert mean < 2.8e-4


def test_meshes_that_do_not_drift_agree_from_the_start(runs):
    """The mesh changes the discretisation error only; while the oscillation grows, small differences grow with it."""
    barrier, solid = ([value for _, value in runs.peaks(mover)[:4]] for mover in ("barrier", "pseudo-solid"))
    assert barrier == pytest.approx(solid, rel=0.02)
