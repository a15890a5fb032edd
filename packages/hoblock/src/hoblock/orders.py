"""Polynomial orders of elements."""

from __future__ import annotations

__all__ = ["HIGHEST_ORDER"]

HIGHEST_ORDER = 32
"""Highest polynomial order of elements."""
