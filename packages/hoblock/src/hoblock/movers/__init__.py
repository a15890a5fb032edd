"""Movers: how the vertices of a block structure follow a moving boundary. State in, state out."""

from hoblock.movers.angle_optimisation import AngleOptimisation
from hoblock.movers.barrier import BarrierEnergy, BarrierPlacement
from hoblock.movers.mover import Mover
from hoblock.movers.pseudo_solid import PseudoSolid
from hoblock.movers.rule import Rule
from hoblock.movers.sliding import Sliding, sliding_vertices
from hoblock.movers.validity import inverted_blocks

__all__ = [
    "AngleOptimisation",
    "BarrierEnergy",
    "BarrierPlacement",
    "Mover",
    "PseudoSolid",
    "Rule",
    "Sliding",
    "inverted_blocks",
    "sliding_vertices",
]
