"""The time loop: steps that fail or are not accurate enough are divided."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from hofsi.build import Problem, build
from hofsi.case import Case, Unsteady
from hofsi.clock import Clock
from hofsi.counts import Counts
from hofsi.errors import AddedMassError, CouplingError
from hofsi.io.scene import read_case
from hofsi.quantities import evaluators
from hofsi.records import CouplingRecord, State
from hofsi.simulate import simulate
from hofsi.solvers.solid_state import SolidMemory


class Fragile:
    """A march that fails where a step is too large."""

    def __init__(self, largest: Callable[[float], float]) -> None:
        self._largest = largest
        self.calls: list[tuple[float, ...]] = []

    def initial(self, time: float) -> State:
        return State()

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        self.calls.append(tuple(steps))
        if steps[0] > self._largest(time):
            raise CouplingError("not converged.", "max_iterations", f"coupling, t = {time:g}")
        return State(), None

    def steady(self, state: State) -> tuple[State, CouplingRecord | None]:
        raise AssertionError("not a steady problem")

    def memory(self) -> SolidMemory:
        return SolidMemory(Counts())

    def resume(self, state: State, memory: object) -> None:
        self.calls = []


def problem_of(march: Fragile, time: Unsteady, case: Case) -> Problem:
    from dataclasses import replace

    return Problem(replace(case, time=time), march, None, None, None, Clock())


@pytest.fixture
def case(channel: str) -> Case:
    return read_case(tomllib.loads(channel), "channel.toml")


def test_a_failed_step_is_repeated_with_half_its_size(case: Case) -> None:
    march = Fragile(lambda time: 0.3 if 1.0 < time < 2.5 else 1.0)
    records = list(simulate(problem_of(march, Unsteady(1.0, 0.0, 4.0, 4), case)))
    assert all(record.dt <= 0.25 for record in records if 1.0 < record.time < 2.5)
    assert sum(record.dt for record in records) == records[-1].time == records[-1].done == 4.0
    assert records[-1].dt == 1.0
    assert {1.0, 2.0, 3.0} < {record.time for record in records}
    assert [record.step for record in records] == list(range(1, len(records) + 1))
    assert [[rejection.dt for rejection in record.rejected] for record in records[:2]] == [[], [1.0, 0.5]]
    assert records[1].rejected[0].error == "CouplingError"
    assert "t = 2" in records[1].rejected[0].reason


def test_sizes_before_a_step_are_those_that_were_accepted(case: Case) -> None:
    march = Fragile(lambda time: 0.5 if time > 1.0 else 1.0)
    list(simulate(problem_of(march, Unsteady(1.0, 0.0, 2.0, 2), case)))
    assert march.calls == [(1.0,), (1.0, 1.0), (0.5, 1.0), (0.5, 0.5, 1.0)]


def test_what_fails_however_small_it_is_made_is_an_error_that_names_the_attempts(case: Case) -> None:
    march = Fragile(lambda time: 1.0 if time < 1.5 else 0.0)
    steps = simulate(problem_of(march, Unsteady(1.0, 0.0, 4.0, 4, halvings=2), case))
    assert next(steps).time == 1.0
    assert next(steps).time == 1.25  # 1.5 is too late
    with pytest.raises(
        CouplingError, match=r"t = 1.5: not converged. That was the smallest step, 0.25.*halvings = 2 times"
    ):
        list(steps)


def test_without_halvings_the_first_failure_is_the_error(case: Case) -> None:
    march = Fragile(lambda time: 0.0)
    with pytest.raises(CouplingError) as caught:
        list(simulate(problem_of(march, Unsteady(1.0, 0.0, 4.0, 4, halvings=0), case)))
    assert str(caught.value) == "coupling, t = 1: not converged."
    assert len(march.calls) == 1


class Light(Fragile):
    """A march whose steps fail for the added mass, and are left with a residual."""

    def __init__(self, residual: Callable[[float], float]) -> None:
        super().__init__(lambda time: 0.3)
        self._residual = residual

    def step(self, state: State, steps: Sequence[float], time: float) -> tuple[State, CouplingRecord | None]:
        try:
            return super().step(state, steps, time)
        except CouplingError as error:
            raise AddedMassError("not converged.", "stalled", error.where, 5.0, self._residual(steps[0])) from error


def test_a_step_whose_half_comes_no_further_for_the_added_mass_is_not_halved_again(case: Case) -> None:
    march = Light(lambda dt: 1.0 / dt)
    with pytest.raises(AddedMassError, match=r"not converged. Half of the step, 0.5, came no further than the whole"):
        list(simulate(problem_of(march, Unsteady(1.0, 0.0, 4.0, 4), case)))
    assert [steps[0] for steps in march.calls] == [1.0, 0.5]


def test_a_step_whose_half_comes_further_is_halved_in_spite_of_the_added_mass(case: Case) -> None:
    march = Light(lambda dt: dt)
    *_, record = simulate(problem_of(march, Unsteady(1.0, 0.0, 1.0, 1), case))
    assert record.time == 1.0
    assert [steps[0] for steps in march.calls[:3]] == [1.0, 0.5, 0.25]


PULSE = "(1 + 4*exp(-400*(t - 0.5)**2))"


def pulsed(channel: str, **time: float) -> list[tuple[float, float, float | None, float]]:
    """Time, size, local error and kinetic energy of the steps of a flow with a sudden pulse."""
    settings = "\n".join(f"{key} = {value}" for key, value in time.items())
    text = channel.replace("dt = 0.1\nsteps = 5", settings).replace('"4*y*(1 - y)"', f'"4*y*(1 - y)*{PULSE}"')
    text += '\n[quantities.energy]\ntype = "kinetic-energy"\n'
    problem = build(read_case(tomllib.loads(text), "channel.toml"))
    energy = evaluators(problem)["energy"]
    return [(record.time, record.dt, record.local_error, energy(record)) for record in simulate(problem)]


def deviation(steps: list[tuple[float, float, float | None, float]], exact: dict[float, float]) -> float:
    """Largest error of the energy at the ends of the whole steps."""
    return max(abs(energy - exact[round(time, 6)]) for time, _, _, energy in steps if round(time, 6) in exact)


def test_steps_follow_a_pulse_and_cost_less_than_equal_ones(channel: str) -> None:
    fine = pulsed(channel, dt=0.1 / 128, end=1.0)
    exact = {round(time, 6): energy for time, _, _, energy in fine[127::128] if time > 0.25}
    assert len(exact) == 8
    errors, counts = [], []
    for tolerance in (1e-2, 1e-3):
        steps = pulsed(channel, dt=0.1, end=1.0, tolerance=tolerance)
        known = [error for *_, error, _ in steps if error is not None]
        assert len(known) == len(steps) - 3
        assert max(known) <= tolerance
        sizes = np.array([size for time, size, _, _ in steps if time > 0.25])
        assert sizes.max() >= 8.0 * sizes.min()
        assert 0.3 < [time for time, *_ in steps if time > 0.25][np.argmin(sizes)] < 0.7
        errors.append(deviation(steps, exact))
        counts.append(len(steps))
    equal = deviation(pulsed(channel, dt=1.0 / (2 * counts[1]), end=1.0), exact)
    assert errors[1] < 0.4 * errors[0]
    assert errors[1] < equal


@pytest.mark.parametrize("scheme", ["generalised-alpha", "energy-momentum"])
def test_coupled_steps_with_other_schemes_of_the_solid_stay_near(
    read_changed: Callable[..., Case], scheme: str
) -> None:
    ends = []
    for name in ("bdf2", scheme):
        case = read_changed(("dt = 0.1\nend = 2.0", f'dt = 0.02\nend = 0.2\nsolid = "{name}"'))
        *_, record = simulate(build(case))
        assert record.state.solid is not None
        ends.append(record.state.solid.displacement)
    assert 0.0 < np.abs(ends[0] - ends[1]).max() < 0.1 * np.abs(ends[0]).max()
