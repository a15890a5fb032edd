"""The text of a plan."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Item", "Plan"]


@dataclass(frozen=True)
class Item:
    """One line of a plan.

    Attributes
    ----------
    name : str
    detail : str
        How much of it there will be; of something that is skipped, the reason.
    """

    name: str
    detail: str


@dataclass(frozen=True)
class Plan:
    """What a run of a case builds and does, and what it leaves out.

    Attributes
    ----------
    built, skipped : tuple of Item
    """

    built: tuple[Item, ...]
    skipped: tuple[Item, ...]

    def lines(self) -> tuple[str, ...]:
        """The plan as text, names in one column."""
        width = max((len(item.name) for item in (*self.built, *self.skipped)), default=0)
        parts = (("built", self.built), ("skipped", self.skipped))
        return tuple(
            line
            for title, items in parts
            if items
            for line in (f"{title}:", *(f"  {item.name:<{width}}  {item.detail}" for item in items))
        )
