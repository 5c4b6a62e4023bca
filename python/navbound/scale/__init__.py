"""Long work cut into tiles: one interface, worked off in this process, by processes, or by a Dask cluster.

A tile is worked off by one call that depends on nothing but the tile, so who works it off, in which order and how often changes no bit.
Finished tiles can be kept in a folder; a job that was killed goes on from there.
"""

from __future__ import annotations

from navbound.scale.backends import BACKENDS, Workers
from navbound.scale.tiles import Work, cut, in_order, map_tiles

__all__ = ["BACKENDS", "Work", "Workers", "cut", "in_order", "map_tiles"]
