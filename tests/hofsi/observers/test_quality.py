"""Quality of the mesh over a run."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hoblock import BlockStructure, QuadMesh, generate, scaled_jacobian
from hofsi.observers import quality
from hofsi.observers.quality import MeshQuality
from hofsi.records import State, StepRecord


@pytest.fixture
def square() -> QuadMesh:
    vertices = {"a": (0.0, 0.0), "b": (1.0, 0.0), "c": (1.0, 1.0), "d": (0.0, 1.0)}
    return generate(BlockStructure.build(vertices, {"all": [("a", "b", "c", "d")]}, counts=2), 2)


def sheared(mesh: QuadMesh, angle: float) -> QuadMesh:
    """Shear by an angle in degrees: the skewness of every element is angle/90."""
    return mesh.with_points(mesh.points @ np.array([[1.0, 0.0], [np.tan(np.radians(angle)), 1.0]]))


def record(step: int, mesh: QuadMesh, min_det_J: float = 0.0625) -> StepRecord:
    state: Any = SimpleNamespace(mesh=mesh)
    return StepRecord(step, 0.1 * step, 0.1, State(mesh=state), None, min_det_J)


def test_the_worst_values_of_the_run_are_kept_with_their_times(square: QuadMesh) -> None:
    watch = MeshQuality(every=1)
    for step, angle in enumerate([0.0, 30.0, 9.0], start=1):
        watch.observe(record(step, sheared(square, angle), min_det_J=0.0625 - 0.01 * (step == 2)))
    watch.close()
    found = watch.summary()
    assert (found["mesh"], found["evaluations"]) == ("fluid", 3)
    assert found["skewness_max"] == pytest.approx(30.0 / 90.0)
    assert found["scaled_jacobian_min"] == pytest.approx(np.cos(np.radians(30.0)))
    assert found["jacobian_ratio_min"] == pytest.approx(1.0)
    assert found["min_det_J"] == pytest.approx(0.0525)
    assert {found[name] for name in found if name.startswith("t_") and "ratio" not in name} == {0.2}
    means = [np.cos(np.radians(angle)) for angle in (0.0, 30.0, 9.0)]
    assert found["scaled_jacobian_mean"] == pytest.approx(np.mean(means))


def test_det_J_is_taken_from_every_step_the_rest_from_every_tenth_and_the_last(
    square: QuadMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []

    def counted(mesh: QuadMesh) -> Any:
        seen.append(float(np.degrees(np.arctan(mesh.points[:, 0].max() - 1.0))))
        return scaled_jacobian(mesh)

    monkeypatch.setattr(quality, "scaled_jacobian", counted)
    watch = MeshQuality()
    for step in range(1, 25):
        watch.observe(record(step, sheared(square, step), min_det_J=-1.0 if step == 7 else 1.0))
    watch.close()
    np.testing.assert_allclose(seen, [1.0, 11.0, 21.0, 24.0])
    assert (watch.summary()["min_det_J"], watch.summary()["t_min_det_J"]) == (-1.0, pytest.approx(0.7))


def test_a_mesh_that_stands_still_is_looked_at_once(square: QuadMesh) -> None:
    watch = MeshQuality(every=1)
    for step in range(1, 6):
        watch.observe(record(step, square))
    watch.close()
    assert watch.summary()["evaluations"] == 1


def test_without_a_fluid_it_is_the_deformed_solid(square: QuadMesh) -> None:
    watch = MeshQuality(square, every=1)
    for step, angle in enumerate([10.0, 45.0], start=1):
        solid: Any = SimpleNamespace(displacement=sheared(square, angle).points - square.points)
        watch.observe(StepRecord(step, 0.1 * step, 0.1, State(solid=solid)))
    watch.close()
    found = watch.summary()
    assert (found["mesh"], found["skewness_max"]) == ("solid", pytest.approx(0.5))
    assert found["min_det_J"] == pytest.approx(1.0 / 16.0)


def test_nothing_is_known_before_the_first_step() -> None:
    watch = MeshQuality()
    watch.close()
    assert watch.summary() == {}
