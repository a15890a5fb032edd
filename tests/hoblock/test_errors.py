"""Errors: one family, places and files in the message."""

from __future__ import annotations

import copy

import pytest

import hoblock.errors as errors


@pytest.mark.parametrize("name", errors.__all__)
def test_all_errors_are_of_one_family(name):
    assert issubclass(getattr(errors, name), errors.HoblockError)


def test_scene_error_shows_file_and_place():
    error = errors.SceneError("got 3", "mesh.order")
    assert str(error) == "mesh.order: got 3"
    error.file = "a.toml"
    assert str(error) == "a.toml: mesh.order: got 3"
    assert (error.place, error.problem) == ("mesh.order", "got 3")
    assert str(errors.SceneError("got 3")) == "got 3"


def test_copies_are_complete():
    error = errors.ExpressionError("got 3", "mesh.order")
    error.file = "a.toml"
    second = copy.deepcopy(error)
    assert str(second) == str(error)
    assert second.place == "mesh.order"
    missing = copy.deepcopy(errors.MissingExtraError("install it", module="vtk", extra="vtk"))
    assert (str(missing), missing.module, missing.extra) == ("install it", "vtk", "vtk")
