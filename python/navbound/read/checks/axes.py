"""Whether positions move where the recording says that it flies: exchanged axes and wrong units show there."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m, half_turn_s, wrapped
from navbound.read.checks.plausible import plausible_rows

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


class Axes:
    """Counts over epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._n: Counter[str] = Counter()
        self._n_agree: Counter[str] = Counter()
        self._n_exchanged: Counter[str] = Counter()
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
        move_m, step_s = np.hypot(*move.T), np.diff((rows["time_ns"] - rows["time_ns"][0]).to_numpy() * 1e-9)
        same &= (move_m > _LEAST_M) & (np.hypot(*exchanged.T) > _LEAST_M)
        # A step of a turn is a chord in the mean direction of its ends; over half a turn it is in any.
        same &= step_s <= half_turn_s(move_m / np.maximum(step_s, 1e-9))
        agrees, agrees_exchanged = _agreeing(move, reported), _agreeing(exchanged, reported)
        for name, at in _spans(rows["track"]):
            steps = slice(at.start, min(at.stop, same.size))
            self._n[name] += int(same[steps].sum())
            self._n_agree[name] += int((agrees & same)[steps].sum())
            self._n_exchanged[name] += int((agrees_exchanged & same)[steps].sum())

    def words(self) -> list[str]:
        """A doubt, where there is one: of each track, so that many that agree hide none that does not."""
        doubted = [name for name, n in self._n.items() if n >= _LEAST_MOVES and self._n_agree[name] < _AGREES * n]
        if not doubted:
            return []
        n, n_agree, n_exchanged = (sum(count[name] for name in doubted) for count in (self._n, self._n_agree, self._n_exchanged))
        of = f" of {len(doubted)} tracks, {doubted[0]} the first of them," if len(self._n) > 1 else ""
        low = f"The positions{of} move in the direction of the reported track (within 20 deg) at {n_agree} of {n} steps only"
        if n_exchanged > _AGREES * n:
            return [f"{low}, with latitude and longitude exchanged at {n_exchanged}: the two may be exchanged"]
        return [f"{low}: the track or the positions are not what they are read as"]


def _spans(track: pl.Series) -> Iterator[tuple[str, slice]]:
    """Names of tracks that follow one another, and their rows."""
    runs = track.rle().struct.unnest()
    begin = 0
    for length, name in zip(runs["len"], runs["value"], strict=True):
        yield name, slice(begin, begin + length)
        begin += length


def _agreeing(move: NDArray[np.float64], reported: NDArray[np.float64]) -> NDArray[np.bool_]:
    away = np.arctan2(move[:, 0], move[:, 1]) - reported
    return np.abs(wrapped(away)) <= _NEAR_RAD


def doubts_of_axes(epochs: pl.DataFrame) -> list[str]:
    """The doubts of a whole table, in the order of track and time."""
    axes = Axes()
    axes.see(epochs)
    return axes.words()
