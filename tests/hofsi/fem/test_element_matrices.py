"""Element matrices in batches."""

import numpy as np
import pytest

from hofsi.fem.element_matrices import batches, maker


@pytest.mark.parametrize(("count", "width"), [(1, 3), (700, 22), (410, 66), (5, 400), (0, 9)])
def test_batches_cover_all_elements_once_and_are_small(count, width):
    parts = list(batches(count, width))
    covered = [k for part in parts for k in range(count)[part]]
    assert covered == list(range(count))
    assert all((part.stop - part.start) * width**2 * 8 <= 2**20 or part.stop - part.start == 1 for part in parts)


def test_matrices_are_given_or_made():
    A = np.arange(48.0).reshape(3, 4, 4)
    np.testing.assert_array_equal(maker(A)(slice(1, 3)), A[1:])
    np.testing.assert_array_equal(maker(lambda part: 2.0 * A[part])(slice(0, 1)), 2.0 * A[:1])
