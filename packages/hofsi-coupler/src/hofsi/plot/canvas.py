"""Figures without a window and without global state."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hoblock.extras import import_extra

__all__ = ["TITLE_SIZE", "drawing", "new_figure", "save"]

TITLE_SIZE = 12
_DPI = 160


def drawing(module: str) -> Any:
    """Import a part of matplotlib, for example ``"collections"``."""
    return import_extra(f"matplotlib.{module}", "plot", "hofsi-coupler")


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure; width and height are in inches."""
    figure = drawing("figure").Figure(figsize=(width, height), layout="constrained")
    drawing("backends.backend_agg").FigureCanvasAgg(figure)
    return figure


def save(figure: Any, path: Path) -> Path:
    """Write a figure as PNG and return the path."""
    figure.savefig(path, dpi=_DPI, bbox_inches="tight", pad_inches=0.15)
    return path
