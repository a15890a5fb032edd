"""The Wall-Ramm flap with the barrier energy and both movers of the paper, from rest to t = 4 s."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytestmark = [pytest.mark.verification, pytest.mark.slow]

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    sys.path.insert(0, str(EXAMPLES))
    try:
        import compare_movers
    finally:
        sys.path.remove(str(EXAMPLES))
    return compare_movers.main(output=tmp_path_factory.mktemp("movers"))


@pytest.mark.parametrize("mover", ["barrier", "pseudo-solid", "angle-optimisation"])
def test_the_flap_reaches_its_limit_cycle(runs, mover):
    assert len(runs.times[mover]) == 1600
    assert runs.min_det_J[mover] > 0.0
    assert all(0.75 < value < 1.1 for _, value in runs.peaks(mover)[-3:])


@pytest.mark.parametrize("mover", ["barrier", "pseudo-solid", "angle-optimisation"])
def test_frequency_lies_in_the_published_scatter(runs, mover):
    """2.8 to 3.3 Hz covers the published values for plane strain and plane stress; see docs/verification.md."""
    times = [time for time, _ in runs.peaks(mover)[-4:]]
    assert 2.8 < 3.0 / (times[-1] - times[0]) < 3.3


def test_meshes_that_do_not_drift_have_the_same_limit_cycle(runs):
    """The mesh changes the discretisation error only; while the oscillation grows, small differences grow with it."""
    barrier, solid = (np.array(runs.peaks(mover)) for mover in ("barrier", "pseudo-solid"))
    assert barrier[-3:, 0] == pytest.approx(solid[-3:, 0], abs=0.005)
    assert barrier[-3:, 1] == pytest.approx(solid[-3:, 1], rel=0.02)


def test_the_mover_hardly_matters(runs):
    """Where the mesh depends on the flap's position alone; the one of the optimisation drifts, and 5.2 % are left."""
    amplitudes = {}
    for mover, values in runs.values.items():
        late = values[runs.times[mover] > 2.5]
        amplitudes[mover] = (np.max(late) - np.min(late)) / 2.0
    assert amplitudes["pseudo-solid"] == pytest.approx(amplitudes["barrier"], rel=0.05)
    assert amplitudes["angle-optimisation"] == pytest.approx(amplitudes["barrier"], rel=0.06)


def test_meshes_that_do_not_drift_agree_from_the_start(runs):
    barrier, solid = ([value for _, value in runs.peaks(mover)[:4]] for mover in ("barrier", "pseudo-solid"))
    assert barrier == pytest.approx(solid, rel=0.02)
