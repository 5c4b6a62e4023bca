"""Maps: what a grid of users gets over a day, and on what share of the area that is enough.

:func:`make` evaluates one of :data:`KINDS` over a :class:`Grid`; :func:`load` reads a written map back.
"""

from __future__ import annotations

from navbound.maps.files import load
from navbound.maps.grid import Grid
from navbound.maps.kinds import KINDS, Kind
from navbound.maps.limits import Limit
from navbound.maps.make import make
from navbound.records.maps import Map

__all__ = ["KINDS", "Grid", "Kind", "Limit", "Map", "load", "make"]
