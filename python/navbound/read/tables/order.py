"""Rows of a table in the order of track and time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.read.checks.rejections import REPEATED
from navbound.read.checks.repeats import EARLIER, IDENTICAL, UNJUDGED, Repeats, separate
from navbound.read.tables.table import LINE
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.checks.rejections import Tally


class Late:
    """Rows that stood after a later one of their track, counted in the order of the file."""

    def __init__(self) -> None:
        self._latest: dict[str, int] = {}
        self._n, self._first = 0, 0

    def see(self, out: pl.DataFrame) -> None:
        """The next rows, with ``track``, ``time_ns`` and their line."""
        before = pl.lit(None, pl.Int64)
        if self._latest:
            before = pl.col("track").replace_strict(self._latest, default=None, return_dtype=pl.Int64)
        late = out.filter(pl.col("time_ns") < pl.max_horizontal(pl.col("time_ns").cum_max().over("track"), before))
        if not late.is_empty():
            self._first = self._first or int(late[LINE][0])
            self._n += late.height
        for track, time_ns in out.drop_nulls("time_ns").group_by("track").agg(pl.col("time_ns").max()).iter_rows():
            self._latest[track] = max(time_ns, self._latest.get(track, time_ns))

    def words(self, path: Path, unit: str) -> list[str]:
        """A note, where there are any."""
        if not self._n:
            return []
        n, first = self._n, f"{unit} {self._first}"
        return [
            f"{path.name}: {counted(n, 'row')} stood after a later one of {agreeing(n, 'its', 'their')} track and "
            f"{agreeing(n, 'was', 'were')} put in order of time (first: {first})"
        ]


def one_row_a_time(out: pl.DataFrame, tally: Tally, *, whole_seconds: bool = False, usual: int = 1) -> Repeats:
    """Rows in the order of track and time, one an instant; the others are counted."""
    separated = separate(out.sort("track", "time_ns", maintain_order=True), whole_seconds=whole_seconds, usual=usual)
    for place, words in enumerate((IDENTICAL, *UNJUDGED, EARLIER)):
        repeated = separated.kinds.get(words)
        if repeated is not None:
            track, time_ns, line = repeated.sort(LINE).select("track", "time_ns", LINE).row(0)
            reason = f"time repeated within a track{words}"
            tally.add(REPEATED + place, reason, repeated.height, line, f"track {track}, time_ns {time_ns}", kind="quiet")
    return separated
