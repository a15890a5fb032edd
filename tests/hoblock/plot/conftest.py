import pytest


@pytest.fixture
def matplotlib():
    return pytest.importorskip("matplotlib")
