"""Numbers of a speed over the ground that are no speed: what a program writes where it knows none, and what nothing flies at.

A speed may contradict the positions, so a number is taken as not stated only where it is impossible by itself. The other rows are compared
as before. Where such numbers are more than a small part of a column, it is not what it is read as, and nothing is shown.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import polars as pl

from navbound.read.checks.plausible import Limits
from navbound.read.tables.columns import NO_COLUMN, declare
from navbound.read.tables.table import LINE

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.checks.rejections import Tally

IMPOSSIBLE_MPS = 1000.0
"""Nothing that flies on wings is faster over the ground. Provenance: ours. [m/s]"""
STAND_INS = (999.0, 999.9, 1022.0, 1023.0)
"""Numbers, in the unit of the column, by which programs write "not known" (all nines, all bits of a field), where they are beyond what the
motion of positions may be. The larger ones are impossible by themselves. Provenance: ours."""
MOST = 0.2
"""Share of the stated speeds beyond which impossible ones leave nothing shown. Provenance: ours. [1]"""
REASON = "no speed that an aircraft has; taken as not stated"


class NoSpeeds:
    """Takes numbers that are no speeds out of columns, and counts them."""

    def __init__(self) -> None:
        self._n, self._n_none = Counter[str](), Counter[str]()

    def without(self, name: str, frame: pl.DataFrame, speed_mps: pl.Series, factor: float, tally: tuple[Tally, int]) -> pl.Series:
        """The speeds of some rows of a column, null where its number is none; `factor` makes m/s of what stands in it."""
        written = speed_mps / factor
        of_program = pl.any_horizontal((pl.lit(written) - each).abs() < 1e-6 * each for each in STAND_INS)
        none = pl.select(
            ((pl.lit(speed_mps) > IMPOSSIBLE_MPS) | ((pl.lit(speed_mps) > Limits.max_speed_mps) & of_program)).fill_null(value=False)
        ).to_series()
        self._n[name] += speed_mps.count()
        where = frame.filter(none)
        if where.is_empty():
            return speed_mps
        self._n_none[name] += where.height
        counted, place = tally
        counted.add(place, f"{name}: {REASON}", where.height, where[LINE][0], f"{written.filter(none)[0]:g}", kind="quiet")
        return speed_mps.set(none, None)

    def doubts(self, path: Path) -> list[str]:
        """Columns of which too many numbers are no speeds, after all rows."""
        how = declare(f"ground_speed_mps={NO_COLUMN}")
        return [
            f"{path.name}: {n} of {self._n[name]} numbers of “{name}” are no speed that an aircraft has: it is in another unit than it is "
            f"read in, or is none; {how}, to leave it out, or its unit; nothing is shown until then"
            for name, n in self._n_none.items()
            if n > MOST * self._n[name]
        ]
