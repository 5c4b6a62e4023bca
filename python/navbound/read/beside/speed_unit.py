"""The unit of a speed whose column does not state it: the one in which it is the speed of the positions.

Programs write `speed` in metres per second, knots and kilometres per hour. A speed that fits the positions in none of these contradicts
them, or is another one than that over the ground.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m
from navbound.read.quantities import UNITS
from navbound.read.tables.columns import NO_COLUMN, declare

if TYPE_CHECKING:
    from pathlib import Path

SPEED = "__speed"
"""Column of the numbers until their unit is known."""
HEAD_ROWS = 5000
"""Rows of a file, from its first on, that decide: the same in pieces of any length. Provenance: ours. [1]"""
_UNITS = ("mps", "kt", "km/h", "mph")
_WINDOW_NS = 10_000_000_000
_LONGEST_NS = 3 * _WINDOW_NS
"""Ways are looked at over 10 s and at most 30 s, so that noise and rounding of positions do not count. Provenance: ours. [ns]"""
_MOVING_MPS = 20.0
"""Slower ways say little beside the noise of positions. Provenance: ours. [m/s]"""
_NEAR = 0.06
"""A speed fits within this share: knots and miles an hour are 15 % apart. Provenance: ours. [1]"""
_MOST, _LEAST_WAYS = 0.5, 5
"""Share of the ways that a speed fits in its unit, and ways that decide. Provenance: ours. [1]"""


class SpeedUnit:
    """Finds the unit of the column `name`.

    Attributes
    ----------
    unit : str
        Empty where it is not known, or not yet.
    """

    def __init__(self, name: str) -> None:
        self.name, self.unit = name, ""
        self._n_rows, self._head = 0, list[pl.DataFrame]()
        self._n, self._n_best = 0, 0

    def take(self, frame: pl.DataFrame) -> pl.Series:
        """The numbers of some rows."""
        values = frame[self.name].cast(pl.Float64, strict=False)
        return pl.select(pl.when(values.is_finite() & (values >= 0.0)).then(values).alias(SPEED)).to_series()

    def see(self, part: pl.DataFrame) -> None:
        """The next rows, with their positions, numbers and times as they are written; the first of the file are kept."""
        if self._n_rows < HEAD_ROWS:
            self._head.append(part.head(HEAD_ROWS - self._n_rows))
            self._n_rows += self._head[-1].height

    def head(self) -> pl.DataFrame:
        """The rows that were kept."""
        return pl.concat(self._head, how="diagonal_relaxed") if self._head else pl.DataFrame()

    def understand(self, timed: pl.DataFrame) -> None:
        """Decide by the head with `track` and `time_ns`."""
        self._head = []
        rows = timed.drop_nulls(["time_ns", "est_lat_rad", "est_lon_rad", SPEED]).sort("track", "time_ns", maintain_order=True)
        window = (pl.col("time_ns") // _WINDOW_NS).alias("window")
        first = rows.group_by("track", window, maintain_order=True).agg(
            pl.col("time_ns", "est_lat_rad", "est_lon_rad").first(), pl.col(SPEED).mean()
        )
        if first.height <= 1:
            return
        place, time_ns = first.select("est_lat_rad", "est_lon_rad").to_numpy(), first["time_ns"].to_numpy()
        elapsed_ns = np.diff(time_ns)
        same = (first["track"][1:] == first["track"][:-1]).to_numpy() & (elapsed_ns > 0) & (elapsed_ns <= _LONGEST_NS)
        of_positions_mps = np.hypot(*east_north_m(place[:-1], place[1:]).T)[same] / (elapsed_ns[same] * 1e-9)
        stated = first[SPEED].to_numpy()[:-1][same]
        moving = of_positions_mps >= _MOVING_MPS
        self._n = int(moving.sum())
        fits = {unit: int((np.abs(stated[moving] * UNITS["mps"][unit] / of_positions_mps[moving] - 1.0) <= _NEAR).sum()) for unit in _UNITS}
        best = max(fits, key=lambda unit: fits[unit])
        self._n_best = fits[best]
        if self._n >= _LEAST_WAYS and self._n_best > _MOST * self._n:
            self.unit = best

    def made(self, part: pl.DataFrame) -> pl.DataFrame:
        """Rows with the speed, where its unit is known."""
        factor = UNITS["mps"].get(self.unit, math.nan)
        speed = pl.when(pl.col(SPEED).is_not_null() & math.isfinite(factor)).then(pl.col(SPEED) * factor)
        return part.with_columns(speed.cast(pl.Float64).alias("ground_speed_mps")).drop(SPEED) if self.unit else part.drop(SPEED)

    def words(self, path: Path) -> tuple[list[str], list[str]]:
        """A remark, and why nothing can be shown of the positions."""
        how = declare(f"ground_speed_mps={self.name}:UNIT")
        if self.unit:
            n = f"{self._n_best} of {self._n} ways of 10 s"
            what = f"states no unit and is read in {self.unit}, in which it is the speed of the positions on {n}"
            return [f"{path.name}: “{self.name}” {what}; if it is not, {how}"], []
        if self._n < _LEAST_WAYS:
            return [], []
        units = ", ".join(_UNITS)
        return [], [
            f"{path.name}: “{self.name}” states no unit, and is the speed of the positions in none of {units} on most of {self._n} ways "
            f"of 10 s; {how}, or ground_speed_mps={NO_COLUMN} where it is no speed over the ground; nothing is shown until then"
        ]
