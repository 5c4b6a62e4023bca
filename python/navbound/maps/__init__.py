"""Maps: what a grid of users gets over a day, and on what share of the area that is enough.

:func:`make` evaluates one of :func:`kinds` over a :class:`Grid`; :func:`load` reads a written map back.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.maps.files import load
from navbound.maps.grid import Grid
from navbound.maps.kinds import Kind, kinds
from navbound.maps.limits import Limit
from navbound.maps.make import make
from navbound.records.maps import Map

if TYPE_CHECKING:
    KINDS: dict[str, Kind]

__all__ = ["KINDS", "Grid", "Kind", "Limit", "Map", "kinds", "load", "make"]


def __getattr__(name: str) -> object:
    """``KINDS``: :func:`kinds` as they are now."""
    if name == "KINDS":
        return kinds()
    raise AttributeError(f"module 'navbound.maps' has no attribute {name!r}")
