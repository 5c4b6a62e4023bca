"""Whether positions travel as far, and whither, as the recording's own speeds and tracks say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.plausible import plausible_rows
from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.naming import declare
from navbound.read.motion.balance import Balance
from navbound.read.motion.counts import Comparison
from navbound.read.motion.directions import Directions
from navbound.read.motion.scatter import Steps
from navbound.read.motion.velocity import sigma_m, stated_speed, stated_track
from navbound.read.motion.ways import LONGEST_STEP_S, OFFSET_M, WINDOW_NS, Ways

if TYPE_CHECKING:
    from navbound.records.material import Scatter

_LONGER, _SHORTER = 1.5, 0.6
"""Ratios of the way of the positions to that of the speeds that show nothing; knots for metres a second are 1.94 and 0.51. Ours. [1]"""


class Speeds:
    """Ways over windows of a minute, of epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._longer, self._shorter, self._directions = Comparison(), Comparison(), Directions()
        self._balance = Balance()
        self._waiting: pl.DataFrame | None = None
        self._steps = Steps()

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        speed = stated_speed(epochs)
        if epochs.is_empty() or (speed is None and "ground_track_rad" not in epochs.columns):
            return
        speed = pl.lit(float("nan")) if speed is None else speed
        own = {"_speed": speed, "_sigma": sigma_m(epochs), "_whither": stated_track(epochs), "_plausible": plausible_rows(epochs)}
        # A position of which something worse is known already is passed over: it must not hide the minute around it.
        rows = epochs.select("track", "time_ns", "est_lat_rad", "est_lon_rad", **own).filter("_plausible").drop("_plausible")
        if rows.is_empty():
            return
        self._steps.see(rows)
        self._directions.see(rows)
        self._balance.see(rows)
        rows = rows.with_columns(_speed_ns=pl.when(pl.col("_speed").is_finite()).then("time_ns"))
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        rows = rows.with_columns(_speed=_CARRIED).with_columns(
            pl.col("_speed_ns").forward_fill().over("track"), _window=pl.col("time_ns") // WINDOW_NS
        )
        # The last window may go on in the next piece.
        last = (pl.col("track") == rows["track"][-1]) & (pl.col("_window") == rows["_window"][-1])
        self._waiting = rows.filter(last).drop("_window")
        self._judge(rows, open_window=int(self._waiting.height))

    def _judge(self, rows: pl.DataFrame, open_window: int) -> None:
        """The windows of some rows, without that of the last so many."""
        ways = Ways(rows, LONGEST_STEP_S)
        speed = rows["_speed"].to_numpy()
        stated_m = 0.5 * (speed[:-1] + speed[1:]) * ways.step_s
        minutes = ways.minutes(rows, rows.height - open_window, ways.sound & np.isfinite(stated_m))
        by_speed_m = minutes.sums(stated_m)
        apart_m, way_m = np.hypot(*minutes.apart_en_m.T), minutes.way_m
        longer = apart_m > _LONGER * by_speed_m + minutes.margin_m
        shorter = way_m < _SHORTER * by_speed_m - OFFSET_M
        self._longer.count(minutes, longer, np.column_stack([apart_m, by_speed_m]))
        self._shorter.count(minutes, shorter, np.column_stack([way_m, by_speed_m]))

    def scatter(self) -> Scatter | None:
        """How far positions scatter along their way, on the track that does so most; None where no track has enough steps."""
        return self._steps.largest()

    def doubts(self) -> list[str]:
        """A doubt, where there is one, after the last epochs."""
        if self._waiting is not None:
            self._judge(self._waiting.with_columns(_window=pl.col("time_ns") // WINDOW_NS), open_window=0)
            self._waiting = None
        doubts = []
        for test, word in ((self._longer, "further"), (self._shorter, "less far")):
            if (where := test.of()) is not None:
                doubts.append(
                    f"The positions travel {word} than the recording's own speeds say {where} (at worst {test.worst[0]:.0f} m for "
                    f"{test.worst[1]:.0f} m): the positions are false, or they or the speeds are in another unit than they are read in"
                )
        if not doubts and (lacks := self._balance.words()) is not None:
            doubts.append(lacks)
        aside = self._directions.after_all()
        if not doubts and (where := aside.of()) is not None:
            doubts.append(
                f"The positions end elsewhere than the recording's own speeds and tracks lead {where} (at worst "
                f"{aside.worst[0]:.0f} m aside on a way of {aside.worst[1]:.0f} m): the positions are led off, or a column, "
                f"such as that of the track, is not what it is read as "
                f"({declare(f'ground_track_rad={NO_COLUMN}')}, to leave the track out)"
            )
        elif not doubts and (drift := self._directions.sideways.words()) is not None:
            doubts.append(drift)
        return doubts


_CARRIED = (
    pl.when(pl.col("time_ns") - pl.col("_speed_ns").forward_fill().over("track") <= LONGEST_STEP_S * 1e9)
    .then(pl.col("_speed").fill_nan(None).forward_fill().over("track"))
    .fill_null(float("nan"))
)
"""The last speed, for as long as a step may be."""


def speeds_of(epochs: pl.DataFrame) -> Speeds:
    """The comparison of a whole table, in the order of track and time."""
    speeds = Speeds()
    speeds.see(epochs)
    return speeds
