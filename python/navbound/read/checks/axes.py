"""Whether positions move where the recording says that it flies: exchanged axes and wrong units show there."""

from __future__ import annotations

import math

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m

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
        self._n = self._n_agree = self._n_exchanged = 0
        self._last: pl.DataFrame | None = None

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        if not set(_COLUMNS) <= set(epochs.columns):
            return
        rows = epochs.select(_COLUMNS)
        rows = rows if self._last is None else pl.concat([self._last, rows])
        self._last = rows.tail(1)
        place = rows.select("est_lat_rad", "est_lon_rad").to_numpy()
        reported = rows["ground_track_rad"].fill_null(np.nan).to_numpy()[1:]
        track = rows["track"].rle_id().to_numpy()
        same = (track[1:] == track[:-1]) & np.isfinite(reported)
        move, exchanged = east_north_m(place[:-1], place[1:]), east_north_m(place[:-1, ::-1], place[1:, ::-1])
        same &= (np.hypot(*move.T) > _LEAST_M) & (np.hypot(*exchanged.T) > _LEAST_M)
        self._n += int(same.sum())
        self._n_agree += _agreeing(move[same], reported[same])
        self._n_exchanged += _agreeing(exchanged[same], reported[same])

    def words(self) -> list[str]:
        """A doubt, where there is one."""
        if self._n < _LEAST_MOVES or self._n_agree >= _AGREES * self._n:
            return []
        low = f"The positions move in the direction of the reported track (within 20 deg) at {self._n_agree} of {self._n} steps only"
        if self._n_exchanged > _AGREES * self._n:
            return [f"{low}, with latitude and longitude exchanged at {self._n_exchanged}: are both columns what they are read as?"]
        return [f"{low}: the track or the positions are not what they are read as."]


def _agreeing(move: np.ndarray[tuple[int, int], np.dtype[np.float64]], reported: np.ndarray[tuple[int], np.dtype[np.float64]]) -> int:
    away = np.arctan2(move[:, 0], move[:, 1]) - reported
    return int((np.abs(np.arctan2(np.sin(away), np.cos(away))) <= _NEAR_RAD).sum())


def doubts_of_axes(epochs: pl.DataFrame) -> list[str]:
    """The doubts of a whole table, in the order of track and time."""
    axes = Axes()
    axes.see(epochs)
    return axes.words()
