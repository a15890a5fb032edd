"""Trees of values and arrays, written and read."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from hofsi.counts import Counts
from hofsi.io.restart_tree import TreeReader, TreeWriter
from hofsi.records import CouplingRecord


def through(value: Any) -> Any:
    writer = TreeWriter({})
    text = json.dumps(writer.plain(value), allow_nan=False)
    return TreeReader([array.copy() for array in writer.arrays], {}).value(json.loads(text))


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        3,
        0.1 + 0.2,
        5e-324,
        float("inf"),
        "Péclet",
        (1, (2.0, [None])),
        {"a": {"kind": "array"}, "b": ()},
        CouplingRecord(3, 1e-7, float("-inf")),
        Counts(solves=4, reasons={"first": 1}),
    ],
)
def test_values_come_back(value: object) -> None:
    found = through(value)
    assert (type(found), found) == (type(value), value)


def test_a_number_that_is_none_comes_back() -> None:
    assert np.isnan(through(float("nan")))
    assert through(np.float64(0.1)) == 0.1
    assert through(np.True_) is True


def test_what_was_one_array_is_one_array_again() -> None:
    array = np.arange(6.0).reshape(3, 2)
    one, (two, other) = through([array, (array, array.copy())])
    assert one is two
    assert other is not one
    np.testing.assert_array_equal(other, array)


def test_arrays_that_the_reader_knows_are_not_written() -> None:
    mesh, own = np.zeros((2, 2)), np.ones((2, 2))
    writer = TreeWriter({"mesh": mesh})
    plain = writer.plain((mesh, own))
    assert len(writer.arrays) == 1
    here = np.zeros((2, 2))
    reader = TreeReader(list(writer.arrays), {"mesh": here})
    assert reader.value(plain)[0] is here
    reader.exchange(own, here)
    assert reader.value(plain)[1] is here


def test_other_classes_are_refused() -> None:
    with pytest.raises(TypeError, match="restart file: got a complex; expected plain values, arrays, or one of"):
        TreeWriter({}).plain(1j)
    with pytest.raises(KeyError, match="Popen"):
        TreeReader([], {}).value({"kind": "Popen", "fields": {}})
