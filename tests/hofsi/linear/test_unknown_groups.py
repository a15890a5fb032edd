import numpy as np

from hofsi.linear.unknown_groups import UnknownGroups

#   0 1 2     elements 0 and 1 share 2 and 7, elements 1 and 2 share 4; 9 is in all three, 11 in none
CELLS = np.array([[0, 2, 7, 9, -1], [2, 7, 4, 9, 5], [4, 9, -1, 6, 8]])


def test_unknowns_with_the_same_elements_are_together():
    groups = UnknownGroups(CELLS)
    found = [set(groups.members(np.array([g])).tolist()) for g in range(len(groups.sizes))]
    assert sorted(map(sorted, found)) == [[0], [2, 7], [4], [5], [6, 8], [9]]
    assert [len(members) for members in found] == groups.sizes.tolist()


def test_members_come_group_after_group():
    groups = UnknownGroups(CELLS)
    chosen = np.array([3, 0, 5])
    expected = np.concatenate([groups.members(chosen[k : k + 1]) for k in range(3)])
    np.testing.assert_array_equal(groups.members(chosen), expected)
    assert groups.members(chosen[:0]).size == 0


def test_pairs_tell_which_elements_have_a_group():
    groups = UnknownGroups(CELLS)
    for g, element in zip(groups.pairs.group, groups.pairs.element, strict=True):
        assert np.isin(groups.members(np.array([g])), CELLS[element]).all()
    np.testing.assert_array_equal(groups.pairs.counts, groups.degree)
    assert len(groups.pairs.group) == groups.degree.sum() == 10


def test_pairs_of_some_elements():
    groups = UnknownGroups(CELLS)
    pairs = groups.pairs.restricted(np.array([2, 0]))
    assert set(pairs.element.tolist()) == {0, 2}
    assert (np.diff(pairs.group) >= 0).all()
    nine = next(g for g in range(len(groups.sizes)) if 9 in groups.members(np.array([g])))
    assert pairs.counts[pairs.groups == nine].tolist() == [2]


def test_middles_are_means_of_the_elements():
    places = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 3.0]])
    groups = UnknownGroups(CELLS)
    for g, middle in enumerate(groups.middles(places)):
        members = groups.members(np.array([g]))
        np.testing.assert_allclose(middle, places[np.isin(CELLS, members[0]).any(axis=1)].mean(axis=0))


def test_nothing_at_all():
    groups = UnknownGroups(np.full((2, 3), -1))
    assert groups.sizes.size == groups.degree.size == groups.pairs.group.size == 0
