"""Movers: how the vertices of a block structure follow a moving boundary. State in, state out."""

from hoblock.movers.angle_optimisation import AngleOptimisation
from hoblock.movers.mover import Mover
from hoblock.movers.pseudo_solid import PseudoSolid
from hoblock.movers.validity import inverted_blocks

__all__ = ["AngleOptimisation", "Mover", "PseudoSolid", "inverted_blocks"]
