"""Epochs that should have been there and are not."""

from __future__ import annotations

from collections import Counter

import polars as pl

from navbound.rnp.usual import absent_in, stale_after_s, usual_ms


class Gaps:
    """Epochs that should have been there: recorded rows that are no epochs, and what the gaps beside them should have held.

    A gap counts where it is longer than the monitor waits before it says that there is nothing. A left out row in it counts once. What a
    shorter gap leaves room for is counted apart. Epochs come in the order of track and time, in pieces of any length.
    """

    def __init__(self, left_out: pl.DataFrame, period_s: float) -> None:
        self._n_left_out, self._period_s = left_out.height, period_s
        self._n, self._short_ms = 0, Counter[int]()
        self._rest = left_out.drop_nulls("time_ns").unique().sort("track", "time_ns")
        self._last = self._rest.clear()
        self._longest_s = stale_after_s(period_s)

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        track, time_ns = epochs["track"][-1], epochs["time_ns"][-1]
        due = (pl.col("track") < track) | ((pl.col("track") == track) & (pl.col("time_ns") <= time_ns))
        before = self._rest.filter(due)
        self._rest = self._rest.filter(~due)
        self._count(pl.concat([epochs.select("track", "time_ns"), before]))

    def _count(self, rows: pl.DataFrame) -> None:
        rows = pl.concat([self._last, rows.unique().sort("track", "time_ns")])
        step = pl.col("time_ns").diff().over("track").cast(pl.Float64) * 1e-9
        steps = rows.select(step=step)["step"].drop_nulls()
        gaps = steps.filter(steps > self._longest_s)
        self._n += int(((gaps / self._period_s).round() - 1).sum())
        # A step between rows that stand for one epoch is none.
        short_ms = (steps.filter(steps <= self._longest_s) * 1e3).round().cast(pl.Int64)
        self._short_ms.update(dict(short_ms.filter(short_ms > 0).value_counts().iter_rows()))
        self._last = rows.tail(1)

    def n_missing(self) -> int:
        """Of all epochs, once."""
        if not self._rest.is_empty():
            self._count(self._rest)
            self._rest = self._rest.clear()
        return self._n_left_out + self._n

    def n_absent(self) -> int:
        """Epochs that the usual step leaves room for in gaps too short to count; 0 where no step is usual."""
        usual = usual_ms(self._short_ms)
        return sum(n * absent_in(ms / usual) for ms, n in self._short_ms.items() if ms > usual) if usual else 0
