"""Solids whose elements lock."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hofsi.notes.locking import locking


def case_of(read_changed, order, ratio, plane="strain"):
    case = read_changed(("order = 2", f"order = {order}"))
    return replace(case, solids=(replace(case.solids[0], poissons_ratio=ratio, plane=plane),))


@pytest.mark.parametrize(("order", "ratio"), [(2, 0.4999), (3, 0.49)])
def test_low_orders_lock(read_changed, order, ratio):
    (note,) = locking(case_of(read_changed, order, ratio))
    assert note.startswith(f"solid 'rubber' is nearly incompressible (ν = {ratio:g}): elements of order {order} lock")
    assert note.endswith("Set mesh.order to 4 or more")


@pytest.mark.parametrize(
    ("order", "ratio", "plane"), [(4, 0.4999, "strain"), (2, 0.45, "strain"), (2, 0.4999, "stress")]
)
def test_others_do_not(read_changed, order, ratio, plane):
    assert [*locking(case_of(read_changed, order, ratio, plane))] == []
