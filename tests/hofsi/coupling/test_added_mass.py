"""The pressure pulse between light walls, coarse and short: accelerators agree where plain iteration diverges."""

from pathlib import Path

import numpy as np
import pytest

from hofsi.build import build
from hofsi.errors import AddedMassError
from hofsi.io.scene import load_case
from hofsi.quantities import evaluators
from hofsi.simulate import simulate

SCENE = Path(__file__).parents[3] / "examples" / "pressure_pulse.toml"
COARSE = ["mesh.order=2", "time.end=0.001", "coupling.condensed=false", "output.fields=false", "output.plots=false"]


def pulse(*changes):
    """Displacement and pressure at every step, and coupling iterations."""
    problem = build(load_case(SCENE, [*COARSE, *changes]))
    read = evaluators(problem)
    rows = [([read["wall_1"](r), read["pressure"](r)], r.coupling.iterations) for r in simulate(problem)]
    return np.array([values for values, _ in rows]), np.array([count for _, count in rows])


def test_accelerators_agree_to_the_tolerance():
    reference, _ = pulse("time.end=0.0005", "coupling.tolerance=1e-8", "coupling.force_tolerance=1e-6")
    scales = np.abs(reference[:, 0]).max(), 2e4  # the pulse has not reached the middle yet
    others = {"iqn-ils": [], "aitken": ["coupling.max_iterations=400", "coupling.relaxation=0.1"]}
    for kind, more in others.items():
        found, _ = pulse("time.end=0.0005", f"coupling.acceleration={kind}", *more)
        assert (np.abs(found - reference) <= 1e-6 * np.array(scales)).all()


@pytest.mark.parametrize("acceleration", ["iqn-ils", "imvj"])
def test_quasi_newton_methods_take_few_iterations(acceleration):
    _, iterations = pulse(f"coupling.acceleration={acceleration}", "time.end=0.002")
    assert iterations.mean() <= 12.0


def test_plain_iteration_diverges_and_smaller_steps_are_not_tried_for_long():
    with pytest.raises(
        AddedMassError, match=r"diverging.*its added mass dominates a light solid.*not halved again"
    ) as e:
        pulse("coupling.acceleration=constant")
    assert e.value.gain > 5.0
