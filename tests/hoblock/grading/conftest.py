"""Edges for gradings that depend on them."""

from dataclasses import dataclass, field

import numpy as np
import pytest


@dataclass(frozen=True)
class Straight:
    length: float = 1.0
    breaks: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def parameters(self, lengths):
        return np.asarray(lengths) / self.length

    def lengths(self, parameters):
        return np.asarray(parameters) * self.length


class Speeding(Straight):
    """A curve that gets three times as fast from its first end to its second."""

    def parameters(self, lengths):
        return (np.sqrt(1.0 + 8.0 * np.asarray(lengths) / self.length) - 1.0) / 2.0

    def lengths(self, parameters):
        t = np.asarray(parameters)
        return self.length * (t + t * t) / 2.0


@pytest.fixture(params=[Straight, Speeding], ids=["straight", "curved"])
def edge(request):
    return request.param


@pytest.fixture
def straight():
    return Straight


@pytest.fixture
def heights():
    """Arc lengths of the elements of a grading on an edge."""

    def measured(grading, shape, count):
        resolved = grading.resolved(shape, count)
        corners = resolved(np.linspace(0.0, 1.0, count + 1))
        return np.diff(shape.lengths(corners))

    return measured
