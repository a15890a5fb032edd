"""Operations on block structures: split, merged, moved as a whole, cut out; each returns a new structure."""

from hoblock.operations.chain import Chain, chains
from hoblock.operations.extraction import blocks_where, extracted
from hoblock.operations.insertion import split_block
from hoblock.operations.merging import merge
from hoblock.operations.splitting import split
from hoblock.operations.transforms import mirrored, rotated, scaled, transformed, translated

__all__ = [
    "Chain",
    "blocks_where",
    "chains",
    "extracted",
    "merge",
    "mirrored",
    "rotated",
    "scaled",
    "split",
    "split_block",
    "transformed",
    "translated",
]
