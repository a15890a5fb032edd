from __future__ import annotations

import pytest

from hofsi.linear.choice import choose_solver, direct_memory, machine_memory

GIB = 2**30


def test_what_is_asked_for_is_taken():
    assert choose_solver("direct", 10**9, memory=GIB).solver == "direct"
    assert choose_solver("amg", 10, pyamg=False).solver == "amg"


def test_small_systems_are_factorised():
    choice = choose_solver("auto", 10_000, memory=8 * GIB, pyamg=True)
    assert choice.solver == "direct"
    assert choice.reason.startswith("at this size it is faster than multigrid, and needs about 0.08")


def test_memory_decides():
    choice = choose_solver("auto", 300_000, memory=4 * GIB, pyamg=True)
    assert choice.solver == "amg"
    assert choice.reason == "LU of 300000 condensed unknowns would need about 3.3 of 4 GiB"
    assert choose_solver("auto", 300_000, memory=64 * GIB, pyamg=True).solver == "direct"
    assert choose_solver("auto", 300_000, memory=0, pyamg=True).solver == "direct"


def test_size_decides():
    choice = choose_solver("auto", 10**7, memory=1000 * GIB, pyamg=True)
    assert choice.solver == "amg"
    assert "it is faster than LU" in choice.reason


def test_without_pyamg_the_choice_is_direct_and_says_what_to_install():
    choice = choose_solver("auto", 300_000, memory=4 * GIB, pyamg=False)
    assert choice.solver == "direct"
    assert "pip install 'hofsi-coupler[amg]'" in choice.reason


@pytest.mark.parametrize("asked", ["auto", "amg"])
def test_periodic_sides_are_for_the_direct_solver(asked):
    choice = choose_solver(asked, 10**7, periodic=True, memory=4 * GIB, pyamg=True)
    assert choice.solver == "direct"
    assert choice.reason == "there is no multigrid for periodic sides"


def test_memory_of_the_direct_solver_grows_a_little_faster_than_the_unknowns():
    assert 2.0 < direct_memory(200_000) / direct_memory(100_000) < 2.2


def test_memory_of_this_machine():
    assert machine_memory() == 0 or machine_memory() > 2**28


@pytest.mark.parametrize("asked", ["auto", "direct", "amg"])
def test_choice_is_one_that_there_is(asked):
    assert choose_solver(asked, 5).solver in ("direct", "amg")
