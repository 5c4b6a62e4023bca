"""Whether positions end where the recording's own speeds and tracks lead."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import half_turn_s, wrapped
from navbound.read.motion.counts import Comparison, best_of
from navbound.read.motion.sideways import Sideways
from navbound.read.motion.velocity import CONVENTIONS, MEAN
from navbound.read.motion.ways import LONGEST_STEP_S, WINDOW_NS, WINDOW_S, Ways

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.read.motion.ways import Minutes

_ASIDE = 0.05
"""Share of the way by which the displacement of a window may differ from that of speed and track: a track rounded to two degrees and turns
between rows leave as much. Provenance: ours. [1]"""
_GROSS = 0.25
"""Share of the way by which a displacement is grossly elsewhere, where it is beyond the margins by `_GROSS_M`, too: `_LEAST` of a track
contradict, however long it is. A speed and a track that a source repeats for a minute and a half while the aircraft turns make two (Paris).
Provenance: ours. [1]"""
_GROSS_M = 2_000.0
"""A patrol at 25 to 45 m/s with a row each ten seconds turns between them: 1 km in three of its 235 minutes. Provenance: ours. [m]"""


class Directions:
    """Whether positions end where speed and track lead, minute by minute. Between two statements both change evenly.

    A step of a steady turn is a chord in the mean direction of its ends; statements so far apart that the aircraft may have turned by half
    a turn say nothing. Where no speed is stated the way is that of the positions.
    """

    def __init__(self) -> None:
        self._aside = [Comparison(expected=0.0) for _ in CONVENTIONS]
        self.sideways = Sideways()
        self._waiting: pl.DataFrame | None = None

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, with the speeds and tracks that they state themselves."""
        self.sideways.see(rows)
        rows = rows.with_columns(_window=pl.col("time_ns") // WINDOW_NS, _judged=pl.lit(value=False))
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        window = rows.select(pl.struct("track", "_window").rle_id())["track"].cast(pl.Int64).to_numpy()
        # What is stated up to a minute later and before belongs to a window.
        own = (rows["track"] == rows["track"][-1]).to_numpy()
        done = ~own | (window < window[-1] - 1)
        self._judge(rows, done & ~rows["_judged"].to_numpy())
        kept = own & (window >= window[-1] - 2)
        self._waiting = rows.with_columns(_judged=pl.Series(done)).filter(pl.Series(kept))

    def after_all(self) -> Comparison:
        """The test after the last rows."""
        if self._waiting is not None:
            self._judge(self._waiting, ~self._waiting["_judged"].to_numpy())
            self._waiting = None
        return best_of(self._aside)

    def _judge(self, rows: pl.DataFrame, which: NDArray[np.bool_]) -> None:
        if not which.any():
            return
        speed, whither = _between_statements(rows)
        plain = Ways(rows, WINDOW_S)
        own_mps = np.where(np.isfinite(speed[:-1]), 0.5 * (speed[:-1] + speed[1:]), plain.step_m / np.maximum(plain.step_s, 1e-9))
        turn = wrapped(np.diff(whither))
        length = np.sinc(0.5 * turn / np.pi)[:, None]
        sound = plain.sound & (plain.step_s <= half_turn_s(own_mps)) & np.isfinite(turn)
        minutes = plain.minutes(rows, rows.height, sound).of(which)
        stated_m = 0.5 * (speed[:-1] + speed[1:]) * plain.step_s
        for share, aside in zip(CONVENTIONS, self._aside, strict=True):
            towards = whither[:-1] + share * turn
            chord = length * np.column_stack([np.sin(towards), np.cos(towards)])
            by_speed_m, whither_m = _lead(minutes, stated_m, plain.step_s, chord)
            aside_m = np.hypot(*(minutes.apart_en_m - whither_m).T)
            beyond_m = aside_m - _ASIDE * by_speed_m - minutes.margin_m
            gross = (aside_m > _GROSS * by_speed_m + minutes.margin_m) & (beyond_m > _GROSS_M)
            aside.count(minutes, beyond_m > 0.0, np.column_stack([aside_m, by_speed_m]), gross=gross, beyond_m=beyond_m)
            if share == MEAN:
                self.sideways.count(minutes, whither_m, by_speed_m, beyond_m <= 0.0)


def _lead(
    minutes: Minutes, stated_m: NDArray[np.float64], step_s: NDArray[np.float64], chord: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Ways of windows by their speeds, and where they end by their speeds and tracks."""
    by_speed_m = minutes.sums(stated_m)
    whither_m = np.column_stack([minutes.sums(each) for each in (stated_m[:, None] * chord).T])
    # Without a speed the way of the positions leads in the mean direction.
    unstated = ~np.isfinite(by_speed_m)
    towards = np.column_stack([minutes.sums(each) for each in (step_s[:, None] * chord).T]) / minutes.sums(step_s)[:, None]
    whither_m = np.where(unstated[:, None], minutes.way_m[:, None] * towards, whither_m)
    return np.where(unstated, minutes.way_m, by_speed_m), whither_m


def _between_statements(rows: pl.DataFrame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Speed and track at every row; NaN before the first statement of a track, behind the last, and between two that are too far apart."""
    time_s = (rows["time_ns"] - rows["time_ns"][0]).to_numpy() * 1e-9
    speed, whither = rows["_speed"].to_numpy().copy(), rows["_whither"].to_numpy().copy()
    begin = 0
    for length in rows["track"].rle().struct.field("len").to_list():
        own = slice(begin, begin + length)
        speed[own] = _even(time_s[own], speed[own], None)
        whither[own] = _even(time_s[own], whither[own], speed[own])
        begin += length
    return speed, whither


def _even(time_s: NDArray[np.float64], stated: NDArray[np.float64], speed: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Evenly between statements of a speed, or of a direction beside a speed."""
    known = np.flatnonzero(np.isfinite(stated))
    if known.size in {0, stated.size}:
        return stated
    at, values = time_s[known], stated[known]
    values = values if speed is None else np.cumsum(np.concatenate([values[:1], wrapped(np.diff(values))]))
    even = np.interp(time_s, at, values, left=math.nan, right=math.nan)
    after = np.searchsorted(at, time_s, side="left").clip(0, at.size - 1)
    before = (np.searchsorted(at, time_s, side="right") - 1).clip(0, at.size - 1)
    # Where no speed is known ten seconds are not long.
    longest_s = np.nan_to_num(np.minimum(half_turn_s(even if speed is None else speed), WINDOW_S), nan=LONGEST_STEP_S)
    return np.where(at[after] - at[before] <= longest_s, even, math.nan)
