"""Whether positions move where the recording says that it flies: exchanged axes and wrong units show there."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m, half_turn_s, wrapped
from navbound.read.checks.plausible import plausible_rows
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_COLUMNS = ("track", "time_ns", "est_lat_rad", "est_lon_rad", "ground_track_rad")
_LEAST_M = 20.0
"""Shorter moves say little of a direction. Provenance: ours. [m]"""
_LEAST_MOVES = 20
_NEAR_RAD = math.radians(20.0)
"""A reported track agrees with the motion within this. Provenance: ours. [rad]"""
_AGREES = 0.5
"""Share of moves that agree, below which the track and the motion contradict each other. Provenance: ours. [1]"""
_SIDE_RAD = math.radians(45.0)
_SPAN_S = 300.0
"""So many moves on end, over so long, none of which agrees within 45 degrees, contradict: what is right at first hides no end that is not.
Provenance: ours. [rad, s]"""


class Axes:
    """Counts over epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._n: Counter[str] = Counter()
        self._n_agree: Counter[str] = Counter()
        self._n_exchanged: Counter[str] = Counter()
        self._aside: dict[str, _Run] = {}
        self._last: pl.DataFrame | None = None

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        if not set(_COLUMNS) <= set(epochs.columns):
            return
        rows = epochs.select(*_COLUMNS, _plausible=plausible_rows(epochs))
        rows = rows if self._last is None else pl.concat([self._last, rows])
        self._last = rows.tail(1)
        place = rows.select("est_lat_rad", "est_lon_rad").to_numpy()
        at_rows = rows["ground_track_rad"].fill_null(np.nan).to_numpy()
        turn = np.diff(at_rows)
        reported = np.where(np.isfinite(turn), at_rows[:-1] + 0.5 * wrapped(turn), at_rows[1:])
        track = rows["track"].rle_id().to_numpy()
        same = (track[1:] == track[:-1]) & np.isfinite(reported)
        move, exchanged = east_north_m(place[:-1], place[1:]), east_north_m(place[:-1, ::-1], place[1:, ::-1])
        plausible = rows["_plausible"].to_numpy()
        same &= plausible[1:] & plausible[:-1]
        time_ns = rows["time_ns"].to_numpy()
        move_m, step_s = np.hypot(*move.T), np.diff(time_ns) * 1e-9
        same &= (move_m > _LEAST_M) & (np.hypot(*exchanged.T) > _LEAST_M)
        # A step of a turn is a chord in the mean direction of its ends; over half a turn it is in any.
        same &= step_s <= half_turn_s(move_m / np.maximum(step_s, 1e-9))
        agrees, agrees_exchanged = _away(move, reported) <= _NEAR_RAD, _away(exchanged, reported) <= _NEAR_RAD
        aside = _away(move, reported) > _SIDE_RAD
        for name, at in _spans(rows["track"]):
            steps = slice(at.start, min(at.stop, same.size))
            self._n[name] += int(same[steps].sum())
            self._n_agree[name] += int((agrees & same)[steps].sum())
            self._n_exchanged[name] += int((agrees_exchanged & same)[steps].sum())
            at_moves = np.flatnonzero(same[steps]) + at.start
            self._aside.setdefault(name, _Run()).see(aside[at_moves], time_ns[1:][at_moves])

    def words(self) -> list[str]:
        """A doubt, where there is one: of each track, so that many that agree hide none that does not."""
        doubted = [name for name, n in self._n.items() if n >= _LEAST_MOVES and self._n_agree[name] < _AGREES * n]
        if not doubted:
            aside = [name for name, run in self._aside.items() if run.lasts]
            return [f"The positions of track {name} move aside of the reported track {_FOR_LONG}" for name in aside[:1]]
        n, n_agree, n_exchanged = (sum(count[name] for name in doubted) for count in (self._n, self._n_agree, self._n_exchanged))
        of = f" of {len(doubted)} tracks, {doubted[0]} the first of them," if len(self._n) > 1 else ""
        low = f"The positions{of} move in the direction of the reported track (within 20 deg) at {n_agree} of {counted(n, 'step')} only"
        if n_exchanged > _AGREES * n:
            return [f"{low}, with latitude and longitude exchanged at {n_exchanged}: the two may be exchanged"]
        return [f"{low}: the track or the positions are not what they are read as"]


_FOR_LONG = (
    f"(by more than {math.degrees(_SIDE_RAD):.0f} deg) for {_SPAN_S / 60:.0f} minutes and more on end: the track or the positions are not "
    "what they are read as"
)


class _Run:
    """Moves on end that go aside, over pieces of any length."""

    def __init__(self) -> None:
        self.lasts = False
        self._n, self._begin_ns = 0, 0

    def see(self, aside: NDArray[np.bool_], time_ns: NDArray[np.int64]) -> None:
        """The next moves, and when they end."""
        if aside.size == 0:
            return
        # The move before the first of its run; the run before goes on where there is none.
        before = np.maximum.accumulate(np.where(aside, -1, np.arange(aside.size)))
        n = np.arange(aside.size) - before + np.where(before < 0, self._n, 0)
        begin_ns = np.where(before < 0, self._begin_ns if self._n else time_ns[0], time_ns[np.minimum(before + 1, aside.size - 1)])
        self.lasts |= bool((aside & (n >= _LEAST_MOVES) & (time_ns - begin_ns >= _SPAN_S * 1e9)).any())
        self._n, self._begin_ns = (int(n[-1]), int(begin_ns[-1])) if aside[-1] else (0, 0)


def _spans(track: pl.Series) -> Iterator[tuple[str, slice]]:
    """Names of tracks that follow one another, and their rows."""
    runs = track.rle().struct.unnest()
    begin = 0
    for length, name in zip(runs["len"], runs["value"], strict=True):
        yield name, slice(begin, begin + length)
        begin += length


def _away(move: NDArray[np.float64], reported: NDArray[np.float64]) -> NDArray[np.float64]:
    """By how much moves go elsewhere than a direction. [rad]."""
    away: NDArray[np.float64] = np.abs(wrapped(np.arctan2(move[:, 0], move[:, 1]) - reported))
    return away


def axes_of(epochs: pl.DataFrame) -> Axes:
    """The comparison of a whole table, in the order of track and time."""
    axes = Axes()
    axes.see(epochs)
    return axes
