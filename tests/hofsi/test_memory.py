import platform
import subprocess
import sys

import pytest

from hofsi.memory import keep_freed_memory

FAULTS = """
import resource, sys
import numpy as np
from hofsi.memory import keep_freed_memory
if "keep" in sys.argv:
    assert keep_freed_memory()
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
np.ones(8_000_000)
before = faults()
for _ in range(5):
    np.ones(8_000_000)
print(faults() - before)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="only glibc can be told to keep memory")
def test_large_arrays_get_the_same_pages_again():
    def faults(*arguments):
        command = [sys.executable, "-c", FAULTS, *arguments]
        environment = {"PYTHONPATH": ":".join(path for path in sys.path if path)}
        return int(subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout)

    assert faults("keep") < 0.1 * faults()


def test_elsewhere_nothing_is_done(monkeypatch):
    monkeypatch.setattr(platform, "libc_ver", lambda: ("", ""))
    assert not keep_freed_memory()
