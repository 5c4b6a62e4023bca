"""Whether positions travel as far, and whither, as the recording's own speeds and tracks say."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m, half_turn_s, wrapped
from navbound.read.checks.plausible import plausible_rows
from navbound.read.tables.columns import NO_COLUMN, declare
from navbound.records.material import Scatter
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from collections.abc import Iterator

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
"""What the displacements of a track may go beyond their margins in all, and for each window more: the largest of tracks that are right are
11 km in 14 windows (repeated speeds, Paris) and 3.5 km in 66 (Switzerland). Provenance: ours. [m]"""


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
        self._longer, self._shorter, self._directions = _Test(), _Test(), _Directions()
        self._waiting: pl.DataFrame | None = None
        self._steps = _Steps()

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        speed = _stated(epochs)
        if epochs.is_empty() or (speed is None and "ground_track_rad" not in epochs.columns):
            return
        speed = pl.lit(float("nan")) if speed is None else speed
        own = {"_speed": speed, "_sigma": _sigma_m(epochs), "_whither": _whither(epochs), "_plausible": plausible_rows(epochs)}
        # A position of which something worse is known already is passed over: it must not hide the minute around it.
        rows = epochs.select("track", "time_ns", "est_lat_rad", "est_lon_rad", **own).filter("_plausible").drop("_plausible")
        if rows.is_empty():
            return
        self._steps.see(rows)
        self._directions.see(rows)
        rows = rows.with_columns(_speed_ns=pl.when(pl.col("_speed").is_finite()).then("time_ns"))
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        rows = rows.with_columns(_speed=_CARRIED).with_columns(
            pl.col("_speed_ns").forward_fill().over("track"), _window=pl.col("time_ns") // _WINDOW_NS
        )
        # The last window may go on in the next piece.
        last = (pl.col("track") == rows["track"][-1]) & (pl.col("_window") == rows["_window"][-1])
        self._waiting = rows.filter(last).drop("_window")
        self._judge(rows, open_window=int(self._waiting.height))

    def _judge(self, rows: pl.DataFrame, open_window: int) -> None:
        """The windows of some rows, without that of the last so many."""
        ways = _Ways(rows, _LONGEST_STEP_S)
        speed = rows["_speed"].to_numpy()
        stated_m = 0.5 * (speed[:-1] + speed[1:]) * ways.step_s
        for at in _windows(rows, rows.height - open_window, ways.sound & np.isfinite(stated_m), ways.step_s):
            name, by_speed_m = rows["track"][at.start], float(stated_m[at].sum())
            offset_m, margin_m = ways.margins_m(at)
            longer = ways.apart_m(at) > _LONGER * by_speed_m + margin_m
            self._longer.count(name, false=longer, lengths_m=(ways.apart_m(at), by_speed_m))
            way_m = ways.way_m(at)
            self._shorter.count(name, false=way_m < _SHORTER * by_speed_m - offset_m, lengths_m=(way_m, by_speed_m))

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
        aside = self._directions.after_all()
        if not doubts and (where := aside.of()) is not None:
            doubts.append(
                f"The positions end elsewhere than the recording's own speeds and tracks lead {where} (at worst "
                f"{aside.worst[0]:.0f} m aside on a way of {aside.worst[1]:.0f} m): the positions are led off, or a column, "
                f"such as that of the track, is not what it is read as "
                f"({declare(f'ground_track_rad={NO_COLUMN}')}, to leave the track out)"
            )
        return doubts


class _Ways:
    """Steps between successive rows, and the ways of positions over windows of them."""

    def __init__(self, rows: pl.DataFrame, longest_s: NDArray[np.float64] | float) -> None:
        self.time_s = (rows["time_ns"] - rows["time_ns"][0]).to_numpy() * 1e-9
        self.place, self._sigma = rows.select("est_lat_rad", "est_lon_rad").to_numpy(), rows["_sigma"].to_numpy()
        self.step_s, self.step_m = np.diff(self.time_s), np.hypot(*east_north_m(self.place[:-1], self.place[1:]).T)
        track = rows["track"].rle_id().to_numpy()
        self.sound = (track[1:] == track[:-1]) & np.isfinite(self.step_m) & (self.step_s > 0) & (self.step_s <= longest_s)

    def apart_en_m(self, at: slice) -> NDArray[np.float64]:
        """From the begin of a window to its end."""
        apart: NDArray[np.float64] = east_north_m(self.place[[at.start]], self.place[[at.stop]])[0]
        return apart

    def apart_m(self, at: slice) -> float:
        """The same as a length."""
        return float(np.hypot(*self.apart_en_m(at)))

    def way_m(self, at: slice) -> float:
        """The way of the positions: over steps or over legs, what is shorter."""
        legs_m = _legs_m(self.time_s[at.start : at.stop + 1], self.place[at.start : at.stop + 1])
        return min(float(self.step_m[at].sum()), legs_m)

    def margins_m(self, at: slice) -> tuple[float, float]:
        """What a difference of speeds explains, and with it the noise of both ends."""
        offset_m = _OFFSET_MPS * _WINDOW_S
        return offset_m, offset_m + _DEVIATIONS * float(np.hypot(self._sigma[at.start], self._sigma[at.stop]))


def _windows(rows: pl.DataFrame, end: int, sound: NDArray[np.bool_], step_s: NDArray[np.float64]) -> Iterator[slice]:
    """Steps of each window before a row that are all sound and fill it; a step belongs to the window in which it begins."""
    of = rows.select(pl.struct("track", "_window").rle_id())["track"].to_numpy()[:end]
    if of.size == 0:
        return
    begins = np.flatnonzero(np.diff(of.astype(np.int64), prepend=-1))
    for first, behind in zip(begins.tolist(), [*begins[1:].tolist(), of.size], strict=True):
        at = slice(first, min(behind, step_s.size))
        if sound[at].all() and step_s[at].sum() >= _WHOLE * _WINDOW_S:
            yield at


class _Directions:
    """Whether positions end where speed and track lead, minute by minute. Between two statements both change evenly.

    A step of a steady turn is a chord in the mean direction of its ends; statements so far apart that the aircraft may have turned by half
    a turn say nothing. Where no speed is stated the way is that of the positions.
    """

    def __init__(self) -> None:
        self._aside = _Test(expected=0.0)
        self._waiting: pl.DataFrame | None = None

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, with the speeds and tracks that they state themselves."""
        rows = rows.with_columns(_window=pl.col("time_ns") // _WINDOW_NS, _judged=pl.lit(value=False))
        rows = rows if self._waiting is None else pl.concat([self._waiting, rows])
        window = rows.select(pl.struct("track", "_window").rle_id())["track"].cast(pl.Int64).to_numpy()
        # What is stated up to a minute later and before belongs to a window.
        own = (rows["track"] == rows["track"][-1]).to_numpy()
        done = ~own | (window < window[-1] - 1)
        self._judge(rows, done & ~rows["_judged"].to_numpy())
        kept = own & (window >= window[-1] - 2)
        self._waiting = rows.with_columns(_judged=pl.Series(done)).filter(pl.Series(kept))

    def after_all(self) -> _Test:
        """The test after the last rows."""
        if self._waiting is not None:
            self._judge(self._waiting, ~self._waiting["_judged"].to_numpy())
            self._waiting = None
        return self._aside

    def _judge(self, rows: pl.DataFrame, which: NDArray[np.bool_]) -> None:
        if not which.any():
            return
        speed, whither = _between_statements(rows)
        plain = _Ways(rows, _WINDOW_S)
        own_mps = np.where(np.isfinite(speed[:-1]), 0.5 * (speed[:-1] + speed[1:]), plain.step_m / np.maximum(plain.step_s, 1e-9))
        turn = wrapped(np.diff(whither))
        mean, half = whither[:-1] + 0.5 * turn, 0.5 * turn
        chord = np.sinc(half / np.pi)[:, None] * np.column_stack([np.sin(mean), np.cos(mean)])
        stated_m = 0.5 * (speed[:-1] + speed[1:]) * plain.step_s
        stated_en_m, towards_s = stated_m[:, None] * chord, plain.step_s[:, None] * chord
        sound = plain.sound & (plain.step_s <= half_turn_s(own_mps)) & np.isfinite(mean)
        for at in _windows(rows, rows.height, sound, plain.step_s):
            if not which[at.start]:
                continue
            way_m, by_speed_m = plain.way_m(at), float(stated_m[at].sum())
            whither_m = stated_en_m[at].sum(axis=0)
            if not math.isfinite(by_speed_m):
                by_speed_m, whither_m = way_m, way_m * towards_s[at].sum(axis=0) / plain.step_s[at].sum()
            aside_m = float(np.hypot(*(plain.apart_en_m(at) - whither_m)))
            _, margin_m = plain.margins_m(at)
            beyond_m = aside_m - _ASIDE * by_speed_m - margin_m
            gross = aside_m > _GROSS * by_speed_m + margin_m and beyond_m > _GROSS_M
            name = rows["track"][at.start]
            self._aside.count(name, false=beyond_m > 0.0, lengths_m=(aside_m, by_speed_m), gross=gross, beyond_m=beyond_m)


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
    longest_s = np.nan_to_num(np.minimum(half_turn_s(even if speed is None else speed), _WINDOW_S), nan=_LONGEST_STEP_S)
    return np.where(at[after] - at[before] <= longest_s, even, math.nan)


class _Steps:
    """Lengths of steps less those of their speeds, track by track, counted in bins."""

    def __init__(self) -> None:
        self._counts: dict[str, NDArray[np.int64]] = {}
        self._last: pl.DataFrame | None = None

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, in the order of track and time, with the speeds that they state themselves."""
        rows = rows.select("track", "time_ns", "est_lat_rad", "est_lon_rad", "_speed", "_sigma")
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
        track = rows["track"].rle_id().to_numpy()
        sound = (track[1:] == track[:-1]) & (step_s > 0) & (step_s <= _LONGEST_STEP_S) & np.isfinite(left_m)
        names = rows["track"][1:].filter(pl.Series(sound))
        bins = np.searchsorted(_SCATTER_BINS_M, left_m[sound])
        begin = 0
        for length, name in names.rle().struct.unnest().iter_rows():
            own = np.bincount(bins[begin : begin + length], minlength=_SCATTER_BINS_M.size + 1)
            self._counts[name] = own + self._counts.get(name, 0)
            begin += length

    def largest(self) -> Scatter | None:
        most = None
        for name, counts in self._counts.items():
            if (n := int(counts.sum())) < _LEAST_STEPS:
                continue
            at = int(np.searchsorted(np.cumsum(counts), 0.95 * n))
            # Both ends of a step scatter.
            along_m = float(_SCATTER_BINS_M[at - 1] / math.sqrt(2.0)) if at else 0.0
            if most is None or along_m > most.along_m:
                most = Scatter(name, along_m, n)
        return most


_CARRIED = (
    pl.when(pl.col("time_ns") - pl.col("_speed_ns").forward_fill().over("track") <= _LONGEST_STEP_S * 1e9)
    .then(pl.col("_speed").fill_nan(None).forward_fill().over("track"))
    .fill_null(float("nan"))
)
"""The last speed, for as long as a step may be."""


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
