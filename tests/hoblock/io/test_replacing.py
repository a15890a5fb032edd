import os

import pytest

from hoblock.io.replacing import replacing


def test_a_file_is_replaced_at_the_end(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"old")
    with replacing(path) as file:
        file.write(b"new")
        assert path.read_bytes() == b"old"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_nothing_remains_of_a_failure(tmp_path):
    path = tmp_path / "a.txt"

    def fail():
        with replacing(path) as file:
            file.write(b"half of it")
            raise RuntimeError("the disk is full")

    with pytest.raises(RuntimeError, match="the disk is full"):
        fail()
    assert not list(tmp_path.iterdir())
    path.write_bytes(b"old")
    with pytest.raises(RuntimeError, match="the disk is full"):
        fail()
    assert path.read_bytes() == b"old"


def test_missing_folders_are_named_with_the_file(tmp_path):
    path = tmp_path / "missing" / "a.txt"
    with pytest.raises(FileNotFoundError, match="No such file or directory") as info, replacing(path):
        pass
    assert info.value.filename == str(path)


def test_errors_name_the_file_itself(tmp_path, monkeypatch):
    (tmp_path / "folder.vtu").mkdir()
    with pytest.raises(IsADirectoryError) as info, replacing(tmp_path / "folder.vtu"):
        pass
    assert info.value.filename == str(tmp_path / "folder.vtu")

    def refuse(part, path):
        raise PermissionError(13, "Permission denied", str(part))

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(PermissionError, match="Permission denied") as info, replacing(tmp_path / "a.txt"):
        pass
    assert info.value.filename == str(tmp_path / "a.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["folder.vtu"]
