from types import SimpleNamespace

import pytest
import scipy.linalg  # noqa: F401  (its BLAS is one of those to be held)
from threadpoolctl import threadpool_info, threadpool_limits

from hofsi.case import Steady, Unsteady
from hofsi.counts import Counts
from hofsi.records import State
from hofsi.simulate import simulate
from hofsi.solvers.solid_state import SolidMemory
from hofsi.threads import one_thread

VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


def threads() -> set[int]:
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture
def two_threads(monkeypatch):
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    with threadpool_limits(2, user_api="blas"):
        if threads() != {2}:
            pytest.skip("this BLAS has one thread")
        yield


@pytest.mark.usefixtures("two_threads")
def test_one_thread_within_the_block_and_as_many_as_before_after_it():
    alone = one_thread()
    for _ in range(2):
        with alone():
            assert threads() == {1}
        assert threads() == {2}


@pytest.mark.usefixtures("two_threads")
@pytest.mark.parametrize("name", VARIABLES)
def test_who_sets_a_variable_is_obeyed(monkeypatch, name):
    monkeypatch.setenv(name, "2")
    with one_thread()():
        assert threads() == {2}


class _Counting:
    """A march that notes how many threads there are."""

    def __init__(self):
        self.found = []

    def initial(self, time):
        return State()

    def step(self, state, steps, time):
        self.found.append(threads())
        return state, None

    def steady(self, state):
        return self.step(state, (), 0.0)

    def memory(self):
        return SolidMemory(Counts())

    def resume(self, state, memory):
        self.found.append(threads())


@pytest.mark.usefixtures("two_threads")
@pytest.mark.parametrize("time", [Steady(), Unsteady(0.1, 0.0, 0.2, 2)])
def test_steps_are_computed_with_one_thread_and_observed_with_all(time):
    march = _Counting()
    problem = SimpleNamespace(case=SimpleNamespace(time=time), march=march)
    observed = [threads() for _ in simulate(problem)]
    assert march.found == [{1}] * len(observed)
    assert observed == [{2}] * len(observed)


@pytest.mark.usefixtures("two_threads")
def test_what_is_made_again_to_go_on_is_made_with_one_thread_too():
    march = _Counting()
    problem = SimpleNamespace(
        march=march, case=SimpleNamespace(time=Unsteady(0.1, 0.0, 0.2, 2)), fluid=None, solid=None
    )
    first = next(simulate(problem))
    march.found.clear()
    list(simulate(problem, first))
    assert march.found == [{1}, {1}]
