"""Exact solutions of fluid–structure interaction, and the order of the coupled problem in space and in time."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytestmark = pytest.mark.verification

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
GEOMETRIES = ("extrapolated", "implicit")
SCHEMES = ("bdf2", "generalised-alpha", "energy-momentum")


@pytest.fixture(scope="module")
def exact() -> Iterator[SimpleNamespace]:
    """The modules of benchmarks/exact_fsi."""
    sys.path.insert(0, str(FOLDER))
    from exact_fsi import couette, errors, settings, study

    yield SimpleNamespace(couette=couette, errors=errors, settings=settings, study=study)
    sys.path.remove(str(FOLDER))
    for name in list(sys.modules):
        if name.partition(".")[0] == "exact_fsi":
            sys.modules.pop(name)


@pytest.fixture(scope="module")
def reference(exact):
    """The flap with small steps."""
    return exact.study.flap_series(160)


# Couette flow over a sheared solid: exact at any order ----------------------------------------------------------------


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("distorted", [False, True])
@pytest.mark.parametrize("speed", [0.3, 0.5])
def test_steady_couette_flow_is_exact(exact, speed, distorted, order):
    solution = exact.couette.Couette(speed)
    # Near the strongest shear that has such a state, a start beside it leads to the other one of two.
    near = 0.995 if speed == 0.3 else 1.0
    settings = exact.settings.Settings(order, 1 if distorted else 2, tolerance=1e-11)
    scene = solution.scene(settings, distorted=distorted, steady=True, near=near)
    problem, (record,) = exact.study.marched(scene)
    found = exact.errors.errors_at(solution, problem, record)
    assert max(found.displacement, found.velocity, found.load) < 1e-10
    assert np.abs(record.state.fluid.pressure).max() < 1e-10


@pytest.mark.parametrize("order", [2, 3, 6])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_couette_flow_stays_steady(exact, geometry, scheme, order):
    solution = exact.couette.Couette(0.5)
    settings = exact.settings.Settings(order, dt=0.1, steps=8, geometry=geometry, scheme=scheme)
    problem, records = exact.study.marched(solution.scene(settings))
    found = exact.errors.errors_at(solution, problem, records[-1])
    assert max(found.displacement, found.velocity, found.load) < 1e-10
    assert np.abs(exact.errors.load_errors(solution, problem, records)).max() < 1e-10


# Waves ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [2, 3, 4, 5])
@pytest.mark.parametrize("case", ["shear layer", "rotating disc"])
def test_fields_converge_at_the_full_order_and_loads_at_twice_that(exact, case, order):
    found = exact.study.in_space(case, order)
    assert found.orders.displacement > order + 1 - 0.5
    assert found.orders.velocity > order + 1 - 0.5
    if order < 4:  # above, the load comes to the coupling's tolerance
        assert found.orders.load > 2 * order - 0.5
    else:
        assert found.errors.load < 1e-7


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("case", ["shear layer", "shear layer, neo-Hooke", "piston", "rotating disc"])
def test_second_order_in_time_from_an_exact_state(exact, case, geometry, scheme):
    found = exact.study.in_time(case, geometry, scheme).orders
    assert found.displacement > 1.8
    assert found.velocity > 1.8
    assert found.load > 1.75


# All terms ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_second_order_in_time_of_a_flap_that_is_bent_far(exact, reference, geometry, scheme):
    assert np.abs(reference[:, 0]).max() > 0.25  # half of its length
    series = [exact.study.flap_series(n, geometry, scheme) for n in (20, 40)]
    errors, orders = exact.study.observed_of_flap(series, reference)
    assert orders.min() > 1.8
    assert errors.max() < 8e-3
