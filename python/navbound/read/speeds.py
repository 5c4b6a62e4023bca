"""Whether positions travel as far, and whither, as the recording's own speeds and tracks say."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m
from navbound.read.checks.plausible import plausible_rows
from navbound.read.tables.columns import NO_COLUMN, declare
from navbound.records.scatter import Scatter
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
"""Windows of a track, and share of them, that must contradict; of fewer windows all of a recording. Provenance: ours."""
_RUN = 5
"""Windows on end that must contradict where the share is smaller. Provenance: ours."""
_GROSS = 0.25
"""Share of the way by which a displacement is grossly elsewhere, where it is beyond the margins by `_GROSS_M`, too: `_LEAST` of a track
contradict, however long it is. A speed and a track that a source repeats for a minute and a half while the aircraft turns make two (Paris).
Provenance: ours. [1]"""
_GROSS_M = 2_000.0
"""A patrol at 25 to 45 m/s with a row each ten seconds turns between them: 1 km in three of its 235 minutes. Provenance: ours. [m]"""
_MOST_EXCESS_M, _EXCESS_M = 20_000.0, 100.0
"""What the displacements of a track may go beyond their margins in all, and for each window more: the largest of honest tracks are 11 km in
14 windows (repeated speeds, Paris) and 3.5 km in 66 (Switzerland). Provenance: ours. [m]"""


_SCATTER_BINS_M = np.geomspace(1.0, 1e5, 201)
"""Edges of the bins in which scatter is counted: 6 % wide. [m]"""
_LEAST_STEPS = 60
"""Steps of a track from which its scatter is stated. Provenance: ours. [1]"""
_K95 = 1.96
"""Standard deviations that 95 % of normal errors of one axis are within."""
_STATED_MPS, _STATED_SHARE = 1.0, 0.02
"""What a stated speed may be wrong by, and share of the way that a turn or a scale hides. Provenance: ours. [m/s, 1]"""


@dataclass
class _Minutes:
    """Windows of one track that were compared, those that contradict, as many of these on end as there are, gross ones, and by how much."""

    n: int = 0
    n_false: int = 0
    run: int = 0
    longest: int = 0
    n_gross: int = 0
    excess_m: float = 0.0

    def count(self, *, false: bool, gross: bool, excess_m: float) -> None:
        self.n += 1
        self.n_false += false
        self.run = self.run + 1 if false else 0
        self.longest = max(self.longest, self.run)
        self.n_gross += gross
        self.excess_m += max(0.0, excess_m)

    def contradict(self) -> bool:
        often = self.n_false >= _LEAST and (self.n_false >= _LEAST_SHARE * self.n or self.longest >= _RUN)
        return often or self.n_gross >= _LEAST or self.excess_m > _MOST_EXCESS_M + _EXCESS_M * self.n


@dataclass
class _Test:
    """One comparison, track by track: many that agree hide none that does not. Of the second length the first is such a share."""

    expected: float = 1.0
    tracks: dict[str, _Minutes] = field(default_factory=dict)
    worst: tuple[float, float] = (0.0, 0.0)
    excess_m: float = 0.0

    def count(self, track: str, *, false: bool, lengths_m: tuple[float, float], gross: bool = False, beyond_m: float = 0.0) -> None:
        self.tracks.setdefault(track, _Minutes()).count(false=false, gross=gross, excess_m=beyond_m)
        if false and (excess_m := abs(lengths_m[0] - self.expected * lengths_m[1])) > self.excess_m:
            self.worst, self.excess_m = lengths_m, excess_m

    def of(self) -> str | None:
        """How many minutes contradict, in words; None where they are too few."""
        n, n_false = (sum(getattr(each, name) for each in self.tracks.values()) for name in ("n", "n_false"))
        false = [name for name, each in self.tracks.items() if each.contradict()]
        if not false and not (0 < n_false == n or (n_false >= _LEAST and n_false >= _LEAST_SHARE * n)):
            return None
        which = f" ({len(false)} of {len(self.tracks)} tracks, {false[0]} the first of them)" if false and len(self.tracks) > 1 else ""
        return f"in {n_false} of {n} minutes{which}"


class Speeds:
    """Ways over windows of a minute, of epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._longer, self._shorter, self._aside = _Test(), _Test(), _Test(expected=0.0)
        self._waiting: pl.DataFrame | None = None
        self._steps = _Steps()

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        speed = _stated(epochs)
        if epochs.is_empty() or (speed is None and "ground_track_rad" not in epochs.columns):
            return
        speed = pl.lit(float("nan")) if speed is None else speed
        own = {"_speed": speed, "_sigma": _sigma_m(epochs), "_whither": _whither(epochs), "_plausible": plausible_rows(epochs)}
        rows = epochs.select("track", "time_ns", "est_lat_rad", "est_lon_rad", **own)
        self._steps.see(rows)
        rows = rows.with_columns(pl.when(pl.col(name).is_finite()).then("time_ns").alias(f"{name}_ns") for name in _CARRIED)
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        rows = rows.with_columns(_carried(name) for name in _CARRIED).with_columns(
            pl.col([f"{name}_ns" for name in _CARRIED]).forward_fill().over("track"), _window=pl.col("time_ns") // _WINDOW_NS
        )
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
        towards = np.column_stack([np.sin(whither), np.cos(whither)])
        stated_en_m, towards_s = (0.5 * (each[:-1] + each[1:]) * step_s[:, None] for each in (speed[:, None] * towards, towards))
        track = rows["track"].rle_id().to_numpy()
        plausible = rows["_plausible"].to_numpy()
        sound = plausible[1:] & plausible[:-1]
        sound &= np.isfinite(step_m) & (step_s > 0) & (step_s <= _LONGEST_STEP_S) & (track[1:] == track[:-1])
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
                name, way_m, by_speed_m = rows["track"][first], min(float(step_m[at].sum()), legs_m), float(stated_m[at].sum())
                offset_m, margin_m = _OFFSET_MPS * _WINDOW_S, _OFFSET_MPS * _WINDOW_S + _DEVIATIONS * noise_m
                if math.isfinite(by_speed_m):
                    longer, shorter = apart_m > _LONGER * by_speed_m + margin_m, way_m < _SHORTER * by_speed_m - offset_m
                    self._longer.count(name, false=longer, lengths_m=(apart_m, by_speed_m))
                    self._shorter.count(name, false=shorter, lengths_m=(way_m, by_speed_m))
                    whither_m = stated_en_m[at].sum(axis=0)
                else:
                    # Where nothing says how fast, the way is that of the positions, and its direction the stated one.
                    by_speed_m = way_m
                    whither_m = way_m * towards_s[at].sum(axis=0) / step_s[at].sum()
                aside_m = float(np.hypot(*(apart_en_m - whither_m)))
                if math.isfinite(aside_m):
                    beyond_m = aside_m - _ASIDE * by_speed_m - margin_m
                    gross = aside_m > _GROSS * by_speed_m + margin_m and beyond_m > _GROSS_M
                    self._aside.count(name, false=beyond_m > 0.0, lengths_m=(aside_m, by_speed_m), gross=gross, beyond_m=beyond_m)

    def scatter(self) -> Scatter | None:
        """How far positions scatter along their way, on the track that does so most; None where no track has enough steps."""
        return self._steps.largest()

    def doubts(self) -> list[str]:
        """A doubt, where there is one, after the last epochs."""
        if self._waiting is not None:
            self._judge(self._waiting.with_columns(_window=pl.col("time_ns") // _WINDOW_NS), open_window=0)
            self._waiting = None
        doubts = []
        for test, word in ((self._longer, "further"), (self._shorter, "less far")):
            if (where := test.of()) is not None:
                doubts.append(
                    f"The positions travel {word} than the recording's own speeds say {where} (at worst {test.worst[0]:.0f} m for "
                    f"{test.worst[1]:.0f} m): the positions are false, or they or the speeds are in another unit than they are read in"
                )
        if not doubts and (where := self._aside.of()) is not None:
            doubts.append(
                f"The positions end elsewhere than the recording's own speeds and tracks lead {where} (at worst "
                f"{self._aside.worst[0]:.0f} m aside on a way of {self._aside.worst[1]:.0f} m): the positions are led off, or a column, "
                f"such as that of the track, is not what it is read as "
                f"({declare(f'ground_track_rad={NO_COLUMN}')}, to leave the track out)"
            )
        return doubts


class _Steps:
    """Lengths of steps less those of their speeds, track by track, counted in bins."""

    def __init__(self) -> None:
        self._counts: dict[str, NDArray[np.int64]] = {}
        self._last: pl.DataFrame | None = None

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, in the order of track and time, with the speeds that they state themselves."""
        rows = rows.select("track", "time_ns", "est_lat_rad", "est_lon_rad", "_speed", "_sigma", "_plausible")
        rows = rows if self._last is None else pl.concat([self._last, rows])
        self._last = rows.tail(1)
        place, speed = rows.select("est_lat_rad", "est_lon_rad").to_numpy(), rows["_speed"].to_numpy()
        step_s = np.diff((rows["time_ns"] - rows["time_ns"][0]).to_numpy() * 1e-9)
        mean, change = 0.5 * (speed[:-1] + speed[1:]), np.abs(np.diff(speed))
        # The way of a step is between those of its two speeds.
        margin_m = (_STATED_MPS + _STATED_SHARE * mean + 0.5 * change) * step_s
        # What the covariances of both ends hold, in one axis.
        sigma = rows["_sigma"].to_numpy() / math.sqrt(2.0)
        margin_m += _K95 * np.hypot(sigma[:-1], sigma[1:])
        left_m = np.abs(np.hypot(*east_north_m(place[:-1], place[1:]).T) - mean * step_s) - margin_m
        track, plausible = rows["track"].rle_id().to_numpy(), rows["_plausible"].to_numpy()
        sound = plausible[1:] & plausible[:-1] & (track[1:] == track[:-1])
        sound &= (step_s > 0) & (step_s <= _LONGEST_STEP_S) & np.isfinite(left_m)
        names = rows["track"][1:].filter(pl.Series(sound))
        bins = np.searchsorted(_SCATTER_BINS_M, left_m[sound])
        begin = 0
        for length, name in names.rle().struct.unnest().iter_rows():
            own = np.bincount(bins[begin : begin + length], minlength=_SCATTER_BINS_M.size + 1)
            self._counts[name] = own + self._counts.get(name, 0)
            begin += length

    def largest(self) -> Scatter | None:
        found = None
        for name, counts in self._counts.items():
            if (n := int(counts.sum())) < _LEAST_STEPS:
                continue
            at = int(np.searchsorted(np.cumsum(counts), 0.95 * n))
            # Both ends of a step scatter.
            along_m = float(_SCATTER_BINS_M[at - 1] / math.sqrt(2.0)) if at else 0.0
            if found is None or along_m > found.along_m:
                found = Scatter(name, along_m, n)
        return found


_CARRIED = ("_speed", "_whither")
"""Columns whose last value counts for as long as a step may be; when it was stated stands beside it."""


def _carried(name: str) -> pl.Expr:
    known, stated_ns = pl.col(name).fill_nan(None).forward_fill().over("track"), pl.col(f"{name}_ns").forward_fill().over("track")
    return pl.when(pl.col("time_ns") - stated_ns <= _LONGEST_STEP_S * 1e9).then(known).fill_null(float("nan")).alias(name)


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


def speeds_of(epochs: pl.DataFrame) -> Speeds:
    """The comparison of a whole table, in the order of track and time."""
    speeds = Speeds()
    speeds.see(epochs)
    return speeds
