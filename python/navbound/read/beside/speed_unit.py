"""The unit of a speed whose column does not state it: the one in which it is the speed of the positions.

Programs write `speed` in metres per second, knots and kilometres per hour. A speed that fits the positions in none of these contradicts
them, or is another one than that over the ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.read.checks.places import east_north_m
from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.naming import declare
from navbound.read.quantities import UNITS
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

SPEED = "__speed"
"""Column of the numbers until their unit is known."""
HEAD_ROWS = 5000
"""Rows of a file that decide, the first ones that may be of a moving vehicle: the same in pieces of any length. Provenance: ours. [1]"""
_SAYS = 10.0
"""A number below it is a slow speed in every unit: a file that begins at the gate says nothing until it moves. Provenance: ours. [1]"""
_UNITS = ("mps", "kt", "km/h", "mph")
_WINDOW_NS = 10_000_000_000
_LONGEST_NS = 3 * _WINDOW_NS
"""Ways are looked at over 10 s and at most 30 s, so that noise and rounding of positions do not count. Provenance: ours. [ns]"""
_MOVING_MPS = 5.0
"""Slower ways say little beside the noise of positions. Provenance: ours. [m/s]"""
_NEAR, _NOISE_MPS = 0.06, 1.0
"""A speed fits within this share, as knots and miles an hour are 15 % apart, and the noise of a way. Provenance: ours. [1, m/s]"""
_SLOWEST_MPS, _STANDS = 3.0, 0.5
"""A speed that is this or more in the smallest of the units, over a way of less than this share of it, fits in none. Ours. [m/s, 1]"""
_FEWEST, _FEW = 3, 0.1
"""Fewer ways of a smaller share of the rows decide nothing, for a unit or against all. Provenance: ours. [1]"""
_MOST = 0.5
"""Share of the ways that a speed fits in its unit. Provenance: ours. [1]"""


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
        self._written = self._bare = False
        self._n_all = 0

    def take(self, frame: pl.DataFrame) -> pl.Series:
        """The numbers of some rows."""
        column = frame[self.name]
        values = column.cast(pl.Float64, strict=False)
        self._bare |= column.dtype != pl.String
        if column.dtype == pl.String:
            # A number with its unit is one of metres per second.
            parts = column.str.to_lowercase().str.extract_groups(r"^\s*(\d+(?:\.\d+)?)\s*([a-z][a-z/]*)\s*$").struct.unnest()
            factor = parts["2"].replace_strict(UNITS["mps"], default=None, return_dtype=pl.Float64)
            written = parts["1"].cast(pl.Float64, strict=False) * factor
            self._written |= written.count() > 0
            self._bare |= values.count() > 0
            values = pl.select(pl.coalesce(written, values)).to_series()
        # What stands for no speed in every unit is counted once the unit is known.
        known = values.is_finite() & ((values >= 0.0) | (values == _core.NO_SPEED_BELOW_ANY))
        return pl.select(pl.when(known).then(values).alias(SPEED)).to_series()

    def see(self, part: pl.DataFrame) -> None:
        """The next rows, with their positions, numbers and times as they are written; the first of the file that say much are kept."""
        self._n_all += part.height
        if self._n_rows < HEAD_ROWS:
            self._head.append(part.filter(pl.col(SPEED) >= _SAYS).head(HEAD_ROWS - self._n_rows))
            self._n_rows += self._head[-1].height

    def head(self) -> pl.DataFrame:
        """The rows that were kept."""
        return pl.concat(self._head, how="diagonal_relaxed") if self._head else pl.DataFrame()

    def understand(self, timed: pl.DataFrame) -> None:
        """Decide by the head with `track` and `time_ns`."""
        self._head = []
        rows = timed.drop_nulls(["time_ns", "est_lat_rad", "est_lon_rad", SPEED])
        rows = rows.sort("track", "time_ns", maintain_order=True)
        window = (pl.col("time_ns") // _WINDOW_NS).alias("window")
        first = rows.group_by("track", window, maintain_order=True).agg(
            pl.col("time_ns", "est_lat_rad", "est_lon_rad").first(), pl.col(SPEED).median()
        )
        if first.height <= 1:
            self.settle()
            return
        place, time_ns = first.select("est_lat_rad", "est_lon_rad").to_numpy(), first["time_ns"].to_numpy()
        elapsed_ns = np.diff(time_ns)
        way_m = _ways_m(rows.with_columns(window))
        same = (first["track"][1:] == first["track"][:-1]).to_numpy() & (elapsed_ns > 0) & (elapsed_ns <= _LONGEST_NS)
        of_positions_mps = np.hypot(*east_north_m(place[:-1], place[1:]).T)[same] / (elapsed_ns[same] * 1e-9)
        # In a turn the way is longer than what lies between its ends.
        along_mps = np.maximum(of_positions_mps, way_m[:-1][same] / (elapsed_ns[same] * 1e-9))
        stated = first[SPEED].to_numpy()[:-1][same]
        smallest_mps = stated * min(UNITS["mps"][unit] for unit in _UNITS)
        stands = (smallest_mps >= _SLOWEST_MPS) & (of_positions_mps < _STANDS * smallest_mps)
        moves = (along_mps >= _MOVING_MPS) & ~stands
        self._n = int((moves | stands).sum())
        within_mps = _NEAR * along_mps + _NOISE_MPS
        units = ("mps",) if self._written else _UNITS
        for positions_mps in (along_mps, of_positions_mps):
            away = {unit: np.abs(stated * UNITS["mps"][unit] - positions_mps) for unit in units}
            fits = {unit: int((moves & (away_mps <= within_mps)).sum()) for unit, away_mps in away.items()}
            best = max(fits, key=lambda unit: fits[unit])
            self._n_best = fits[best]
            if self._n_best > _MOST * self._n:
                self.unit = best
                break
        self.settle()

    def settle(self) -> None:
        """A speed with its unit in every field needs no ways to find it."""
        if self._written and not self._bare:
            self.unit = "mps"

    def made(self, part: pl.DataFrame) -> pl.DataFrame:
        """Rows with the speed, where its unit is known."""
        if self.unit:
            part = part.with_columns((pl.col(SPEED) * UNITS["mps"][self.unit]).alias("ground_speed_mps"))
        return part.drop(SPEED)

    def words(self, path: Path) -> tuple[list[str], list[str]]:
        """A remark, and why nothing can be shown of the positions."""
        how = declare(f"ground_speed_mps={self.name}:UNIT")
        if self.unit and not self._bare:
            return [], []
        if self.unit:
            n = f"{self._n_best} of {counted(self._n, 'way')} of 10 s"
            what = f"states no unit and is read in {self.unit}, in which it is the speed of the positions on {n}"
            return [f"{path.name}: “{self.name}” {what}; if it is not, {how}"], []
        if self._n < _FEWEST and self._n_rows < _FEW * self._n_all:
            if not self._n:
                return [], []
            what = (
                f"states no unit, and {counted(self._n, 'way')} of 10 s {agreeing(self._n, 'is', 'are')} too few to find it: it is not read"
            )
            return [f"{path.name}: “{self.name}” {what}; {how}"], []
        units = ", ".join(_UNITS)
        return [], [
            f"{path.name}: “{self.name}” states no unit, and is the speed of the positions in none of {units} on most of "
            f"{counted(self._n, 'way')} "
            f"of 10 s; {how}, or ground_speed_mps={NO_COLUMN} where it is no speed over the ground; nothing is shown until then"
        ]


def _ways_m(rows: pl.DataFrame) -> NDArray[np.float64]:
    """The way of each window, in steps of a second to the first row of the next one [m]."""
    second = (pl.col("time_ns") // 1_000_000_000).alias("second")
    thin = rows.group_by("track", second, maintain_order=True).first()
    place = thin.select("est_lat_rad", "est_lon_rad").to_numpy()
    step_m = np.append(np.hypot(*east_north_m(place[:-1], place[1:]).T), 0.0)
    ways = thin.select("track", "window").with_columns(step_m=pl.Series(step_m)).group_by("track", "window", maintain_order=True).sum()
    return ways["step_m"].to_numpy()
