"""One method on one test: how far it gets, and what its meshes are like on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np

from full_mesh_movers import MotionFailed
from hoblock import HoblockError, QuadMesh, certify, equiangular_skewness, scaled_jacobian
from motion_cases import MotionCase
from motion_contest.contestants import Contestant

__all__ = ["Journey", "MARKS", "travel"]

MARKS = {"T3a": 0.495, "T3b": 90.0, "T3c": 180.0, "T4a": 0.5, "T4b": 90.0, "WR": 0.16688, "TH": 0.19022}
"""Position at which qualities are compared: half way, or the benchmark's own (WR tip 1.3 cm, TH tip 129 mm)."""
FAIR = 0.2
"""Least scaled Jacobian of a mesh that is still good."""


@dataclass(frozen=True)
class Journey:
    """What a method did.

    Attributes
    ----------
    reach : float
        Last s whose mesh is certified.
    fair_reach : float
        Last s with scaled Jacobian >= 0.2, all before it too.
    least_jacobian, mean_jacobian, largest_skewness, mean_skewness : float
        Over all certified positions: the worst element, and the mean over elements and positions.
    jacobian_at_mark, skewness_at_mark : float
        The worst element at the step closest to the mark; NaN if it was not reached.
    milliseconds : float
        Median time of an update with its certificate.
    outcome : str
        "end", or why it stopped.
    """

    reach: float
    fair_reach: float
    least_jacobian: float
    mean_jacobian: float
    largest_skewness: float
    mean_skewness: float
    jacobian_at_mark: float
    skewness_at_mark: float
    milliseconds: float
    outcome: str


def travel(
    case: MotionCase,
    order: int,
    contestant: Contestant,
    steps: int,
    limit: float = np.inf,
    seen: Callable[[float, QuadMesh], object] = lambda s, mesh: None,
) -> Journey:
    """Move a body in equal steps to the end or the first mesh that is not certified.

    Parameters
    ----------
    limit : float
        Seconds of processor time after which a journey is ended early; its outcome then says so.
    seen : callable
        Called with every position and its certified mesh.
    """
    _, start, move = contestant.begin(case, order)
    s_values = case.steps(steps)
    mark = s_values[np.argmin(np.abs(s_values - MARKS[case.test]))]
    reach = fair = 0.0
    still_fair = True
    jacobians, skewnesses, times = [], [], []
    at_mark = (np.nan, np.nan)
    outcome, begun = "end", process_time()
    for s in s_values:
        clock = perf_counter()
        try:
            mesh = move(case.motion(start, s))
            valid = certify(mesh).valid
        except (HoblockError, MotionFailed) as error:
            outcome = type(error).__name__
            break
        times.append(perf_counter() - clock)
        if not valid:
            outcome = "invalid mesh"
            break
        seen(float(s), mesh)
        jacobian, skewness = scaled_jacobian(mesh), equiangular_skewness(mesh)
        jacobians.append((jacobian.min(), jacobian.mean()))
        skewnesses.append((skewness.max(), skewness.mean()))
        reach, still_fair = float(s), still_fair and bool(jacobian.min() >= FAIR)
        fair = reach if still_fair else fair
        if s == mark:
            at_mark = float(jacobian.min()), float(skewness.max())
        if process_time() - begun > limit:
            outcome = "stopped: too slow"
            break
    worst = (min(j for j, _ in jacobians), max(k for k, _ in skewnesses)) if jacobians else (np.nan, np.nan)
    means = tuple(float(np.mean([mean for _, mean in rows])) if rows else np.nan for rows in (jacobians, skewnesses))
    milliseconds = 1e3 * float(np.median(times)) if times else np.nan
    return Journey(reach, fair, float(worst[0]), means[0], float(worst[1]), means[1], *at_mark, milliseconds, outcome)
