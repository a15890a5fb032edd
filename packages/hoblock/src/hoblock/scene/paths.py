"""Names of vertices strung together: paths along block edges, and quads."""

from __future__ import annotations

__all__ = ["Path", "Quad"]

Path = tuple[str, ...]
"""A walk along edges from vertex to vertex, by their names."""

Quad = tuple[str, str, str, str]
"""The vertices of a block by name, counter-clockwise."""
