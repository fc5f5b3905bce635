"""A picture of the sample for each pair of directions: the bidirectional texture function."""

from __future__ import annotations

from gonio.reduce.btf.run import reduce_btf
from gonio.reduce.btf.store import Btf, btf_path
from gonio.reduce.btf.tiles import Texels, Tile

__all__ = ["Btf", "Texels", "Tile", "btf_path", "reduce_btf"]
