"""Frozen dataclasses with read-only mappings, which Python cannot copy deeply or send to another process by itself."""

from __future__ import annotations

from dataclasses import fields
from types import MappingProxyType
from typing import Any

__all__ = ["FrozenMappings"]


class FrozenMappings:
    """Lets a frozen dataclass be copied deeply and sent to other processes; it is made anew from its arguments."""

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """Return how to make the object: its class and arguments, mappings as plain dictionaries."""
        values = [getattr(self, field.name) for field in fields(self) if field.init]  # type: ignore[arg-type]
        plain = (dict(value) if isinstance(value, MappingProxyType) else value for value in values)
        return type(self), tuple(plain)
