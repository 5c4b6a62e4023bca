"""Whether positions travel as far, and whither, as the recording's own speeds and tracks say."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m, half_turn_s, wrapped
from navbound.read.checks.plausible import plausible_rows
from navbound.read.tables.columns import NO_COLUMN, declare
from navbound.records.material import Scatter
from navbound.table.columns import HORIZONTAL

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WINDOW_S = 60.0
"""Span over which ways are compared; Doppler speeds and positions agree over it to some metres. Provenance: ours. [s]"""
_WINDOW_NS = 60_000_000_000
_SHORTEST_S = 15.0
"""Of a window the steps that follow one another are compared from this length on: what is compared now and then counts, too, at the margin
of a whole window. Provenance: ours. [s]"""
_LONGEST_STEP_S = 10.0
"""Over a longer step the speed may have been any. Provenance: ours. [s]"""
_LEG_NS = 10_000_000_000
"""Span of a leg of the way that positions travel: the noise of each step would add up to a way of its own. A turn of three degrees a second
shortens it by one in a hundred. Provenance: ours. [ns]"""
_SLOW_MPS = 55.0
"""Below it an aircraft may turn by half a turn within a leg, as a glider does; its legs are half as long. Provenance: ours. [m/s]"""
_OFFSET_M = 3.0 * _WINDOW_S
"""Difference of ways over a window that shows nothing, 3 m/s: rounding, wind on a filtered track, a slow filter. Provenance: ours. [m]"""
_LONGER, _SHORTER = 1.5, 0.6
"""Ratios of the way of the positions to that of the speeds that show nothing; knots for metres a second are 1.94 and 0.51. Ours. [1]"""
_ASIDE = 0.05
"""Share of the way by which the displacement of a window may differ from that of speed and track: a track rounded to two degrees and turns
between rows leave as much. Provenance: ours. [1]"""
_DEVIATIONS = 6.0
"""Noise of two positions, in standard deviations of the covariance. Provenance: ours."""
_LEAST, _LEAST_SHARE = 3, 0.2
"""Minutes of a track, and share of them, that must contradict. Provenance: ours."""
_OF_SHORT = 0.6
"""Share of a recording of fewer minutes that must: a part of a minute shows less than it. Provenance: ours. [1]"""
_WHOLE_S = 45.0
"""A window from this length on is a minute. Provenance: ours. [s]"""
_RUN = 5
"""Minutes on end that must contradict where the share is smaller. Provenance: ours."""
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
class _Compared:
    """Minutes of one track that were compared, that contradict, as many of these on end as there are, gross ones, and by how much."""

    minutes: float = 0.0
    false: float = 0.0
    run: float = 0.0
    longest: float = 0.0
    gross: float = 0.0
    excess_m: float = 0.0

    def count(self, minutes: float, *, false: bool, gross: bool, excess_m: float) -> None:
        self.minutes += minutes
        self.false += minutes * false
        self.run = self.run + minutes if false else 0.0
        self.longest = max(self.longest, self.run)
        self.gross += minutes * gross
        self.excess_m += max(0.0, excess_m)

    def contradict(self) -> bool:
        often = self.false >= _LEAST and (self.false >= _LEAST_SHARE * self.minutes or self.longest >= _RUN)
        return often or self.gross >= _LEAST or self.excess_m > _MOST_EXCESS_M + _EXCESS_M * self.minutes


@dataclass
class _Test:
    """One comparison, track by track: many that agree hide none that does not. Of the second length the first is such a share."""

    expected: float = 1.0
    tracks: dict[str, _Compared] = field(default_factory=dict)
    worst: tuple[float, float] = (0.0, 0.0)
    excess_m: float = 0.0

    def count(
        self,
        windows: _Minutes,
        false: NDArray[np.bool_],
        lengths_m: NDArray[np.float64],
        *,
        gross: NDArray[np.bool_] | None = None,
        beyond_m: NDArray[np.float64] | None = None,
    ) -> None:
        """The next windows."""
        none = np.zeros(len(windows.tracks))
        further = (each.tolist() for each in (false, none > 0 if gross is None else gross, none if beyond_m is None else beyond_m))
        minutes = np.where(windows.length_s >= _WHOLE_S, 1.0, windows.length_s / _WINDOW_S).tolist()
        for track, length, is_false, is_gross, excess_m in zip(windows.tracks, minutes, *further, strict=True):
            self.tracks.setdefault(track, _Compared()).count(length, false=is_false, gross=is_gross, excess_m=excess_m)
        excess_m = np.where(false, np.abs(lengths_m[:, 0] - self.expected * lengths_m[:, 1]), 0.0)
        if excess_m.size and excess_m.max() > self.excess_m:
            self.worst, self.excess_m = tuple(lengths_m[excess_m.argmax()].tolist()), float(excess_m.max())

    def of(self) -> str | None:
        """How many minutes contradict, in words; None where they are too few."""
        minutes, of_these = (sum(getattr(each, name) for each in self.tracks.values()) for name in ("minutes", "false"))
        false = [name for name, each in self.tracks.items() if each.contradict()]
        short = of_these > 0.5 and of_these >= _OF_SHORT * minutes and minutes < _LEAST
        if not false and not (short or (of_these >= _LEAST and of_these >= _LEAST_SHARE * minutes)):
            return None
        which = f" ({len(false)} of {len(self.tracks)} tracks, {false[0]} the first of them)" if false and len(self.tracks) > 1 else ""
        return f"in {of_these:.0f} of {minutes:.0f} minutes{which}"


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
        minutes = ways.minutes(rows, rows.height - open_window, ways.sound & np.isfinite(stated_m))
        by_speed_m = minutes.sums(stated_m)
        apart_m, way_m = np.hypot(*minutes.apart_en_m.T), minutes.way_m
        longer = apart_m > _LONGER * by_speed_m + minutes.margin_m
        shorter = way_m < _SHORTER * by_speed_m - _OFFSET_M
        self._longer.count(minutes, longer, np.column_stack([apart_m, by_speed_m]))
        self._shorter.count(minutes, shorter, np.column_stack([way_m, by_speed_m]))

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


@dataclass(frozen=True)
class _Minutes:
    """Windows of up to a minute, and the ways of positions over them.

    `first` and `stop` are the rows that begin the first and end the last step of each.
    """

    tracks: list[str]
    length_s: NDArray[np.float64]
    first: NDArray[np.intp]
    stop: NDArray[np.intp]
    apart_en_m: NDArray[np.float64]
    way_m: NDArray[np.float64]
    margin_m: NDArray[np.float64]

    def of(self, which: NDArray[np.bool_]) -> _Minutes:
        """Those that begin at some of the rows."""
        at = which[self.first]
        tracks = [track for track, one in zip(self.tracks, at.tolist(), strict=True) if one]
        return _Minutes(tracks, self.length_s[at], self.first[at], self.stop[at], self.apart_en_m[at], self.way_m[at], self.margin_m[at])

    def sums(self, of_steps: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum of the steps of each window."""
        return _sums(of_steps, self.first, self.stop)


class _Ways:
    """Steps between successive rows, and the ways of positions over windows of them."""

    def __init__(self, rows: pl.DataFrame, longest_s: float) -> None:
        self._time_ns = rows["time_ns"].to_numpy()
        self._place, self._sigma = rows.select("est_lat_rad", "est_lon_rad").to_numpy(), rows["_sigma"].to_numpy()
        self.step_s = np.diff(self._time_ns) * 1e-9
        self.step_m = np.hypot(*east_north_m(self._place[:-1], self._place[1:]).T)
        track = rows["track"].rle_id().to_numpy()
        self.sound = (track[1:] == track[:-1]) & np.isfinite(self.step_m) & (self.step_s > 0) & (self.step_s <= longest_s)

    def minutes(self, rows: pl.DataFrame, end: int, sound: NDArray[np.bool_]) -> _Minutes:
        """Sound steps of one window that follow one another, before a row; a step belongs to the window in which it begins."""
        of = rows.select(pl.struct("track", "_window").rle_id())["track"].to_numpy()[: min(end, sound.size)].astype(np.int64)
        of = np.where(sound[: of.size], of, -1)
        border = np.diff(of, prepend=-1, append=-1) != 0
        first = np.flatnonzero(border[:-1] & (of >= 0))
        stop = np.flatnonzero(border[1:] & (of >= 0)) + 1
        length_s = _sums(self.step_s, first, stop)
        long = length_s >= _SHORTEST_S
        first, stop, length_s = first[long], stop[long], length_s[long]
        steps_m = _sums(self.step_m, first, stop)
        noise_m = _DEVIATIONS * np.hypot(self._sigma[first], self._sigma[stop])
        return _Minutes(
            tracks=rows["track"].gather(first).to_list(),
            length_s=length_s,
            first=first,
            stop=stop,
            apart_en_m=east_north_m(self._place[first], self._place[stop]),
            way_m=np.minimum(steps_m, self._legs_m(first, stop, np.where(steps_m < _SLOW_MPS * length_s, _LEG_NS // 2, _LEG_NS))),
            margin_m=_OFFSET_M + noise_m,
        )

    def _legs_m(self, first: NDArray[np.intp], stop: NDArray[np.intp], leg_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """The ways over legs of some seconds, the last of each window as long as it is."""
        n = stop - first + 1
        of = np.repeat(np.arange(first.size), n)
        row = np.arange(of.size) - np.repeat(np.cumsum(n) - n, n) + first[of]
        leg = (self._time_ns[row] - self._time_ns[first][of]) // leg_ns[of]
        ends = (np.diff(leg, prepend=-1) != 0) | (row == stop[of]) | (row == first[of])
        of, place = of[ends], self._place[row[ends]]
        legs_m = np.hypot(*east_north_m(place[:-1], place[1:]).T)
        within = of[1:] == of[:-1]
        return np.bincount(of[1:][within], weights=legs_m[within], minlength=first.size).astype(np.float64)


def _sums(of_steps: NDArray[Any], first: NDArray[np.intp], stop: NDArray[np.intp]) -> NDArray[np.float64]:
    """Sums of steps over windows, of each apart: NaN in one is none of the next."""
    if first.size == 0:
        return np.zeros(0)
    edges = np.column_stack([first, stop]).ravel()
    padded = np.append(of_steps.astype(np.float64), 0.0)
    sums: NDArray[np.float64] = np.add.reduceat(padded, edges)[::2]
    return sums


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
        minutes = plain.minutes(rows, rows.height, sound).of(which)
        by_speed_m, step_s = minutes.sums(stated_m), minutes.sums(plain.step_s)
        whither_m = np.column_stack([minutes.sums(each) for each in stated_en_m.T])
        # Without a speed the way of the positions leads in the mean direction.
        unstated = ~np.isfinite(by_speed_m)
        towards = np.column_stack([minutes.sums(each) for each in towards_s.T]) / step_s[:, None]
        by_speed_m = np.where(unstated, minutes.way_m, by_speed_m)
        whither_m = np.where(unstated[:, None], minutes.way_m[:, None] * towards, whither_m)
        aside_m = np.hypot(*(minutes.apart_en_m - whither_m).T)
        beyond_m = aside_m - _ASIDE * by_speed_m - minutes.margin_m
        gross = (aside_m > _GROSS * by_speed_m + minutes.margin_m) & (beyond_m > _GROSS_M)
        self._aside.count(minutes, beyond_m > 0.0, np.column_stack([aside_m, by_speed_m]), gross=gross, beyond_m=beyond_m)


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
