"""The exact solutions of `benchmarks/exact_fsi` are those computed apart, and runs keep or follow them."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("hofsi")

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
SCHEMES = ("bdf2", "generalised-alpha", "energy-momentum")


@pytest.fixture
def part(monkeypatch):
    """A module of the package by its name."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return lambda name: importlib.import_module(f"exact_fsi.{name}")


def test_amplitudes_are_those_computed_apart(part):
    """Amplitude and phase of displacement and stress at the interface, of the stress at the wall."""
    layer = part("shear_layer").ShearLayer()
    a, _, c = layer.amplitudes
    q = np.sqrt(1j / 0.1)
    for value, size, phase in (
        (a * np.sin(1.0), 1.439309343124e-01, -1.922345504521),
        (0.1 * q * c, 9.241699012654e-02, -1.922345504521),
    ):
        assert abs(value) == pytest.approx(size, rel=1e-12)
        assert np.angle(value) == pytest.approx(phase, abs=1e-12)
    for modulus, expected in (
        (1.0, (9.283467494776e-03, -1.626153392152, 6.944452822006e-02, 0.935097619663)),
        (4.0, (6.913119440370e-03, -1.448624575350, 6.931024219044e-02, 0.933456233906)),
    ):
        disc = part("rotating_disc").RotatingDisc(modulus, speed=0.1)
        got = [f(disc.stress(r)) for r in (0.5, 1.0) for f in (abs, np.angle)]
        assert got == pytest.approx(expected, rel=1e-11)


def test_the_sheared_solid_is_the_one_computed_apart(part):
    for speed, shear, height in (
        (0.5, 0.4513955250662113, 0.8923239770118248),
        (0.3, 0.2878206730158239, 0.9576843217807829),
    ):
        solution = part("couette").Couette(speed)
        assert (solution.shear, solution.height) == pytest.approx((shear, height), rel=1e-13)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("geometry", ["extrapolated", "implicit"])
def test_couette_flow_over_a_sheared_solid_stays(part, geometry, scheme):
    solution = part("couette").Couette(0.5)
    settings = part("settings").Settings(2, dt=0.1, steps=4, geometry=geometry, scheme=scheme)
    problem, records = part("study").marched(solution.scene(settings))
    found = part("errors").errors_at(solution, problem, records[-1])
    assert max(found.displacement, found.velocity, found.load) < 1e-10


def test_a_steady_solution_is_sought_from_the_initial_displacement(part):
    """Of the solid without the fluid's load Newton's method finds no equilibrium from there; nothing needs it."""
    solution = part("couette").Couette(0.5)
    scene = solution.scene(part("settings").Settings(2, tolerance=1e-11), distorted=False, steady=True)
    problem, (record,) = part("study").marched(scene)
    found = part("errors").errors_at(solution, problem, record)
    assert max(found.displacement, found.velocity, found.load) < 1e-10


@pytest.mark.parametrize(("scheme", "ratio"), [("bdf2", 0.3), ("generalised-alpha", 0.6), ("energy-momentum", 0.6)])
def test_forces_on_a_piston_in_motion_are_good_from_the_first_step_on(part, scheme, ratio):
    """Largest errors: where the other schemes take over from backward differences they are of first order."""
    solution = part("piston").Piston()
    largest = []
    for steps in (10, 20):
        settings = part("settings").Settings(3, dt=1.0 / steps, steps=steps, scheme=scheme)
        problem, records = part("study").marched(solution.scene(settings))
        errors = part("errors").load_errors(solution, problem, records)
        largest.append(np.abs(errors).max() / np.abs(solution.load_at(0.7)[0]))
    assert largest[0] < 0.02
    assert largest[1] < ratio * largest[0]
