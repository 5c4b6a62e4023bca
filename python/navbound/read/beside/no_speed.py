"""Numbers of a speed over the ground that are no speed: what a program writes where it knows none, and what nothing flies at.

A speed may contradict the positions, so a number is taken as not stated only where it is impossible by itself (`core::monitor::no_speed`,
the rule of live feeds). The other rows are compared as before. Where such numbers are more than a small part of a column, it is not what it
is read as, and nothing is shown.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.naming import declare
from navbound.read.tables.cells import floats
from navbound.read.tables.table import LINE

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.checks.rejections import Tally

MOST = 0.2
"""Share of the stated speeds beyond which impossible ones leave nothing shown. Provenance: ours. [1]"""
REASON = "no speed that an aircraft has; taken as not stated"


class NoSpeeds:
    """Takes numbers that are no speeds out of columns, and counts them."""

    def __init__(self) -> None:
        self._n, self._n_none = Counter[str](), Counter[str]()

    def without(self, name: str, frame: pl.DataFrame, column: pl.Series, unit_mps: float, tally: tuple[Tally, int]) -> pl.Series:
        """Some rows of a column as they are written, in a unit, null where a number is no speed."""
        written = floats(column)
        none = pl.Series(_core.no_speeds(np.ascontiguousarray(written), unit_mps))
        self._n[name] += int(np.isfinite(written).sum())
        where = frame.filter(none)
        if where.is_empty():
            return column
        # What is below any length is one in every unit: it says nothing of the others.
        self._n_none[name] += int((none & (pl.Series(written) != _core.NO_SPEED_BELOW_ANY)).sum())
        counted, place = tally
        counted.add(place, f"{name}: {REASON}", where.height, where[LINE][0], f"{written[none.arg_max()]:g}", kind="quiet")
        return column.set(none, None)

    def doubts(self, path: Path) -> list[str]:
        """Columns of which too many numbers are no speeds, after all rows."""
        how = declare(f"ground_speed_mps={NO_COLUMN}")
        return [
            f"{path.name}: {n} of {self._n[name]} numbers of “{name}” are no speed that an aircraft has: it is in another unit than it is "
            f"read in, or is none; {how}, to leave it out, or its unit; nothing is shown until then"
            for name, n in self._n_none.items()
            if n > MOST * self._n[name]
        ]
