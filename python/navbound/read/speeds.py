"""Whether positions travel as far, and whither, as the recording's own speeds and tracks say."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m
from navbound.read.tables.columns import NO_COLUMN, declare
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WINDOW_S = 60.0
"""Span over which ways are compared; Doppler speeds and positions agree over it to some metres. Provenance: ours. [s]"""
_WINDOW_NS = 60_000_000_000
_WHOLE = 0.75
"""Least part of a window that steps must fill. [1]"""
_LONGEST_STEP_S = 10.0
"""Over a longer step the speed may have been any. Provenance: ours. [s]"""
_LEG_S = 10.0
"""Span of a leg of the way that positions travel: the noise of each step would add up to a way of its own. A turn of three degrees a second
shortens it by one in a hundred. Provenance: ours. [s]"""
_OFFSET_MPS = 3.0
"""Difference of speeds that shows nothing: rounding, wind on a filtered track, a slow filter. Provenance: ours. [m/s]"""
_LONGER, _SHORTER = 1.5, 0.6
"""Ratios of the way of the positions to that of the speeds that show nothing; knots for metres a second are 1.94 and 0.51. Ours. [1]"""
_ASIDE = 0.05
"""Share of the way by which the displacement of a window may differ from that of speed and track: a track rounded to two degrees and turns
between rows leave as much. Provenance: ours. [1]"""
_DEVIATIONS = 6.0
"""Noise of two positions, in standard deviations of the covariance. Provenance: ours."""
_LEAST, _LEAST_SHARE = 3, 0.2
"""Windows, and share of them, that must contradict; of fewer windows all. Provenance: ours."""


class Speeds:
    """Ways over windows of a minute, of epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._n = self._n_longer = self._n_shorter = self._n_directed = self._n_aside = 0
        self._worst = (0.0, 0.0)
        self._worst_aside = (0.0, 0.0)
        self._waiting: pl.DataFrame | None = None

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        speed = _stated(epochs)
        if speed is None or epochs.is_empty():
            return
        rows = epochs.select(
            "track", "time_ns", "est_lat_rad", "est_lon_rad", _speed=speed, _sigma=_sigma_m(epochs), _whither=_whither(epochs)
        )
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        rows = rows.with_columns(_window=pl.col("time_ns") // _WINDOW_NS)
        # The last window may go on in the next piece.
        last = (pl.col("track") == rows["track"][-1]) & (pl.col("_window") == rows["_window"][-1])
        self._waiting = rows.filter(last).drop("_window")
        self._judge(rows, open_window=int(self._waiting.height))

    def _judge(self, rows: pl.DataFrame, open_window: int) -> None:
        """The windows of some rows, without that of the last so many."""
        time_s = (rows["time_ns"] - rows["time_ns"][0]).to_numpy() * 1e-9
        place = rows.select("est_lat_rad", "est_lon_rad").to_numpy()
        step_s, step_m = np.diff(time_s), np.hypot(*east_north_m(place[:-1], place[1:]).T)
        speed, sigma = rows["_speed"].to_numpy(), rows["_sigma"].to_numpy()
        stated_m = 0.5 * (speed[:-1] + speed[1:]) * step_s
        whither = rows["_whither"].to_numpy()
        velocity = speed[:, None] * np.column_stack([np.sin(whither), np.cos(whither)])
        stated_en_m = 0.5 * (velocity[:-1] + velocity[1:]) * step_s[:, None]
        track = rows["track"].rle_id().to_numpy()
        sound = np.isfinite(stated_m) & np.isfinite(step_m) & (step_s > 0) & (step_s <= _LONGEST_STEP_S) & (track[1:] == track[:-1])
        # A step belongs to the window in which it begins.
        of = rows.select(pl.struct("track", "_window").rle_id())["track"].to_numpy()[: rows.height - open_window]
        if of.size == 0:
            return
        begins = np.flatnonzero(np.diff(of, prepend=-1))
        for first, behind in zip(begins.tolist(), [*begins[1:].tolist(), of.size], strict=True):
            at = slice(first, min(behind, step_s.size))
            if sound[at].all() and step_s[at].sum() >= _WHOLE * _WINDOW_S:
                apart_en_m = east_north_m(place[[first]], place[[at.stop]])[0]
                apart_m = float(np.hypot(*apart_en_m))
                noise_m = float(np.hypot(sigma[first], sigma[at.stop]))
                legs_m = _legs_m(time_s[first : at.stop + 1], place[first : at.stop + 1])
                self._compare_directed(float(np.hypot(*(apart_en_m - stated_en_m[at].sum(axis=0)))), float(stated_m[at].sum()), noise_m)
                self._compare(apart_m, min(float(step_m[at].sum()), legs_m), float(stated_m[at].sum()), noise_m)

    def _compare(self, apart_m: float, way_m: float, stated_m: float, sigma_m: float) -> None:
        offset_m = _OFFSET_MPS * _WINDOW_S
        longer = apart_m > _LONGER * stated_m + offset_m + _DEVIATIONS * sigma_m
        shorter = way_m < _SHORTER * stated_m - offset_m
        self._n += 1
        self._n_longer += longer
        self._n_shorter += shorter
        if (longer or shorter) and abs(apart_m - stated_m) > abs(self._worst[0] - self._worst[1]):
            self._worst = (apart_m if longer else way_m, stated_m)

    def _compare_directed(self, aside_m: float, stated_m: float, sigma_m: float) -> None:
        if not math.isfinite(aside_m):
            return
        self._n_directed += 1
        if aside_m > _ASIDE * stated_m + _OFFSET_MPS * _WINDOW_S + _DEVIATIONS * sigma_m:
            self._n_aside += 1
            self._worst_aside = max(self._worst_aside, (aside_m, stated_m))

    def doubts(self) -> list[str]:
        """A doubt, where there is one, after the last epochs."""
        if self._waiting is not None:
            self._judge(self._waiting.with_columns(_window=pl.col("time_ns") // _WINDOW_NS), open_window=0)
            self._waiting = None
        doubts = []
        for n, word in ((self._n_longer, "further"), (self._n_shorter, "less far")):
            if _contradicts(n, self._n):
                way_m, stated_m = self._worst
                doubts.append(
                    f"The positions travel {word} than the recording's own speeds say in {n} of {self._n} minutes (at worst {way_m:.0f} m "
                    f"for {stated_m:.0f} m): the positions are false, or they or the speeds are in another unit than they are read in"
                )
        if not doubts and _contradicts(self._n_aside, self._n_directed):
            aside_m, stated_m = self._worst_aside
            doubts.append(
                f"The positions end elsewhere than the recording's own speeds and tracks lead in {self._n_aside} of {self._n_directed} "
                f"minutes (at worst {aside_m:.0f} m aside on a way of {stated_m:.0f} m): the positions are led off, or a column, such as "
                "that of the track, is not what it is read as "
                f"({declare(f'ground_track_rad={NO_COLUMN}')}, to leave the track out)"
            )
        return doubts


def _contradicts(n: int, of: int) -> bool:
    """Whether so many windows are enough."""
    return 0 < n == of or (n >= _LEAST and n >= _LEAST_SHARE * of)


def _legs_m(time_s: NDArray[np.float64], place: NDArray[np.float64]) -> float:
    """The way over legs of some seconds, the last as long as it is."""
    begins = np.unique(np.searchsorted(time_s, np.arange(time_s[0], time_s[-1], _LEG_S)))
    ends = np.append(begins, time_s.size - 1)
    return float(np.hypot(*east_north_m(place[ends[:-1]], place[ends[1:]]).T).sum())


def _stated(epochs: pl.DataFrame) -> pl.Expr | None:
    """Speed over ground as the recording states it [m/s]; None where it states none."""
    if "ground_speed_mps" in epochs.columns:
        return pl.col("ground_speed_mps").cast(pl.Float64).fill_null(float("nan"))
    if {"vel_n_mps", "vel_e_mps"} <= set(epochs.columns):
        return (pl.col("vel_n_mps") ** 2 + pl.col("vel_e_mps") ** 2).sqrt().fill_null(float("nan"))
    return None


def _whither(epochs: pl.DataFrame) -> pl.Expr:
    """Direction of the speed as the recording states it [rad]; NaN where it states none."""
    if "ground_track_rad" not in epochs.columns:
        return pl.lit(float("nan"))
    return pl.col("ground_track_rad").cast(pl.Float64).fill_null(float("nan"))


def _sigma_m(epochs: pl.DataFrame) -> pl.Expr:
    """Root of both horizontal variances [m]; 0 where there is none."""
    if not set(HORIZONTAL) <= set(epochs.columns):
        return pl.lit(0.0)
    ee, _, nn = (pl.col(name) for name in HORIZONTAL)
    return (ee + nn).sqrt().fill_null(0.0).fill_nan(0.0)


def doubts_of_speeds(epochs: pl.DataFrame) -> list[str]:
    """The doubts of a whole table, in the order of track and time."""
    speeds = Speeds()
    speeds.see(epochs)
    return speeds.doubts()
