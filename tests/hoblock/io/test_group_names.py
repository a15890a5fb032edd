import pytest

from hoblock.errors import MeshFileError
from hoblock.io.group_names import check_names


def test_names_that_files_hold():
    check_names("f", ["a", "und so weiter", "и/ö", "\u3000", "x" * 1000, 'say "x"'])
    check_names("f", ["é" * 60], quotes=False, most_bytes=120)


@pytest.mark.parametrize("name", ["", "a\nb", "a\0", "\x7f", "\u2028", "\ud800", "x" * 1001])
def test_names_that_they_do_not(name):
    with pytest.raises(MeshFileError, match=r"f: the name .* cannot be written; expected 1 to 1000 bytes"):
        check_names("f", ["good", name])


def test_quotes_and_lengths():
    with pytest.raises(MeshFileError, match=r"without control characters and double quotes\. Rename the group"):
        check_names("f", ['say "x"'], quotes=False)
    with pytest.raises(MeshFileError, match="expected 1 to 120 bytes"):
        check_names("f", ["é" * 61], most_bytes=120)
