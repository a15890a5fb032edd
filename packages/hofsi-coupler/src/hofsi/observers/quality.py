"""Quality of the moving mesh over a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoblock import QuadMesh, det_jacobian_bounds, equiangular_skewness, jacobian_ratio, scaled_jacobian
from hofsi.records import StepRecord

Array = NDArray[np.float64]

__all__ = ["MeshQuality"]


class MeshQuality:
    """Worst values of the element measures: of the fluid mesh, or of the deformed solid where there is no fluid.

    Parameters
    ----------
    solid : QuadMesh or None
        Undeformed, of a problem without a fluid.
    every : int
        Steps between evaluations; the last step is always evaluated. det J of the fluid mesh is taken from every step.
    """

    def __init__(self, solid: QuadMesh | None = None, every: int = 10) -> None:
        self._solid, self._every = solid, every
        self._waiting: StepRecord | None = None
        self._points: Array | None = None
        self._last: Array | None = None  # points of the last step's mesh
        self._samples = 0
        self._worst: dict[str, tuple[float, float]] = {}
        self._means: list[float] = []

    def observe(self, record: StepRecord) -> None:
        """Note det J of a step, and evaluate the other measures if it is time to."""
        if record.min_det_J is not None:
            self._note("min_det_J", record.min_det_J, record.time, 1.0)
        self._waiting = record
        self._last = None if record.state.mesh is None else record.state.mesh.mesh.points
        if (record.step - 1) % self._every == 0:
            self._evaluate(record)

    def close(self) -> None:
        """Evaluate the last step."""
        if self._waiting is not None:
            self._evaluate(self._waiting)

    def memory(self) -> dict[str, Any]:
        """What was found so far, and whether the last step and its mesh are evaluated."""
        return {
            "waiting": self._waiting is not None,
            "samples": self._samples,
            "worst": self._worst,
            "means": np.array(self._means),
            "evaluated": self._points is not None and self._points is self._last,
        }

    def recall(self, memory: Mapping[str, Any], record: StepRecord) -> None:
        """Go on from what was found."""
        self._waiting = record if memory["waiting"] else None
        self._last = None if record.state.mesh is None else record.state.mesh.mesh.points
        self._points = self._last if memory["evaluated"] else None
        self._samples, self._worst, self._means = memory["samples"], dict(memory["worst"]), memory["means"].tolist()

    def summary(self) -> dict[str, float | int | str]:
        """Worst values and the times when they occurred; empty before the first step.

        ``scaled_jacobian_mean`` is the mean over all elements and evaluated steps.
        """
        if not self._samples:
            return {}
        result: dict[str, float | int | str] = {
            "mesh": "fluid" if self._solid is None else "solid",
            "evaluations": self._samples,
        }
        for name, (value, time) in self._worst.items():
            result[name] = value
            result[f"t_{name}"] = time
        result["scaled_jacobian_mean"] = float(np.mean(self._means))
        return result

    def _evaluate(self, record: StepRecord) -> None:
        self._waiting = None
        mesh = self._mesh(record)
        if mesh is None or mesh.points is self._points:
            return
        self._points = mesh.points
        self._samples += 1
        scaled = scaled_jacobian(mesh)
        self._means.append(float(scaled.mean()))
        self._note("scaled_jacobian_min", float(scaled.min()), record.time, 1.0)
        self._note("jacobian_ratio_min", float(jacobian_ratio(mesh).min()), record.time, 1.0)
        self._note("skewness_max", float(equiangular_skewness(mesh).max()), record.time, -1.0)
        if record.min_det_J is None:
            self._note("min_det_J", float(det_jacobian_bounds(mesh)[0].min()), record.time, 1.0)

    def _mesh(self, record: StepRecord) -> QuadMesh | None:
        if record.state.mesh is not None:
            return record.state.mesh.mesh
        if self._solid is None or record.state.solid is None:
            return None
        return self._solid.with_points(self._solid.points + record.state.solid.displacement)

    def _note(self, name: str, value: float, time: float, sign: float) -> None:
        """Keep a value if it is the smallest so far, or the largest for a negative sign."""
        if name not in self._worst or sign * value < sign * self._worst[name][0]:
            self._worst[name] = (value, time)
