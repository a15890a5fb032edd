"""The built-in referee: cases with known results, what a run finds of them, and how long it takes."""

from hofsi.bench.referee import BENCHMARKS, chosen, measurements, protocol
from hofsi.bench.text import lines_of

__all__ = ["BENCHMARKS", "chosen", "lines_of", "measurements", "protocol"]
