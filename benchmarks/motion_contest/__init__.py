"""All methods of mesh motion on the same tests: who reaches what, at which quality, in which time."""

from __future__ import annotations

from motion_contest.contestants import CONTESTANTS, Contestant
from motion_contest.journey import Journey, travel

__all__ = ["CONTESTANTS", "Contestant", "Journey", "travel"]
