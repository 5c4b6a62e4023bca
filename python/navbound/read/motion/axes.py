"""Whether positions move where the recording says that it flies: exchanged axes and wrong units show there."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m, half_turn_s, wrapped
from navbound.read.checks.plausible import plausible_rows
from navbound.read.motion.velocity import CONVENTIONS, sigma_m, stated_speed
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_COLUMNS = ("track", "time_ns", "est_lat_rad", "est_lon_rad", "ground_track_rad")
_LEAST_M = 20.0
"""Shorter moves say little of a direction. Provenance: ours. [m]"""
_DEVIATIONS = 3.0
"""Moves shorter than so many standard deviations of both ends, each of both axes, say little of a direction, too: at three the noise turns
a move by less than 14 degrees at two of three. Provenance: ours. [1]"""
_NOISE_MOST_M = 500.0
"""Noise asks for no longer moves than this: a larger one is found as jumps. Provenance: ours. [m]"""
_LEG = 2.0
"""A leg goes on over rows until its way is so many times the shortest that says something: a way of rows is good to a row. Ours. [1]"""
_SLOWEST_MPS = 1.0
"""What is slower by its own report may stand. Provenance: ours. [m/s]"""
_UNSTATED_S, _STRAIGHT = 30.0, 0.6
"""Where no speed is stated a leg lasts so long, or a step of its own where that is long enough; it is compared where its reported tracks
lead straight enough. Provenance: ours. [s, 1]"""
_LONGEST_S = 300.0
"""What needs longer for a leg is not compared. Provenance: ours. [s]"""
_EVEN_S = 2.0
"""Nothing turns by half a turn between rows so close, however slow it is. Provenance: ours. [s]"""
_LOOSE_S, _AS_LONG = 10.0, 0.8
"""Rows further apart, up to so long, are compared where a speed is stated and the move is as long as speed and track lead: no circle is.
Provenance: ours. [s, 1]"""
_TURN_RAD = math.radians(120.0)
"""Between rows whose reported tracks differ by more the aircraft may have turned to the other side. Provenance: ours. [rad]"""
_NEAR_RAD = math.radians(20.0)
"""A reported track agrees with the motion within this. Provenance: ours. [rad]"""
_LEAST_MOVES = 20
_AGREES = 0.5
"""Share of moves that agree, below which the track and the motion contradict each other. Provenance: ours. [1]"""
_SIDE_RAD = math.radians(45.0)
_SPAN_S = 300.0
"""So many moves on end, over so long, none of which agrees within 45 degrees, contradict: what is right at first hides no end that is not.
Provenance: ours. [rad, s]"""
_TIE = 1e-9
"""Legs of one recording in pieces of any length end at the same rows, however their ways are rounded. [1]"""


@dataclass
class _Counts:
    """What the moves of one track were, by each convention of its courses."""

    n: int = 0
    agree: list[int] = field(default_factory=lambda: [0] * len(CONVENTIONS))
    exchanged: list[int] = field(default_factory=lambda: [0] * len(CONVENTIONS))
    aside: list[_Run] = field(default_factory=lambda: [_Run() for _ in CONVENTIONS])

    def lasts_aside(self) -> bool:
        """Whether moves go aside for long, by the convention that fits the track best."""
        best = max(self.agree)
        return all(run.lasts for run, agree in zip(self.aside, self.agree, strict=True) if agree == best)


class Axes:
    """Counts over epochs in the order of track and time, in pieces of any length."""

    def __init__(self) -> None:
        self._of = defaultdict[str, _Counts](_Counts)
        self._open: pl.DataFrame | None = None
        self._begun = 0.0

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        if not set(_COLUMNS) <= set(epochs.columns):
            return
        speed = stated_speed(epochs)
        rows = epochs.select(
            *_COLUMNS,
            _speed=pl.lit(math.nan) if speed is None else speed,
            _sigma=sigma_m(epochs),
            _plausible=plausible_rows(epochs),
        )
        # A position of which something worse is known already is passed over.
        rows = rows.filter("_plausible").with_columns(pl.col("ground_track_rad").cast(pl.Float64).fill_null(math.nan))
        rows = rows if self._open is None else pl.concat([self._open, rows])
        if rows.height < 2:
            self._open = rows
            return
        steps = _Steps(rows)
        ends, self._begun = steps.ends(self._begun)
        self._open = rows[int(ends[-1]) :]
        first, last = _legs(ends, steps.sound)
        for name, (first_of, last_of) in _by_track(rows["track"], first, last):
            self._count(self._of[name], steps.moves(first_of, last_of))

    def _count(self, counts: _Counts, moves: _Moves) -> None:
        counts.n += moves.time_ns.size
        for k, reported in enumerate(moves.reported_en_m):
            away = _away(moves.move_en_m, reported)
            counts.agree[k] += int((away <= _NEAR_RAD).sum())
            counts.exchanged[k] += int((_away(moves.exchanged_en_m, reported) <= _NEAR_RAD).sum())
            counts.aside[k].see(away > _SIDE_RAD, moves.time_ns)

    def words(self) -> list[str]:
        """A doubt, where there is one: of each track, so that many that agree hide none that does not."""
        doubted = {name: each for name, each in self._of.items() if each.n >= _LEAST_MOVES and max(each.agree) < _AGREES * each.n}
        if not doubted:
            aside = [name for name, each in self._of.items() if each.lasts_aside()]
            return [f"The positions of track {name} move aside of the reported track {_FOR_LONG}" for name in aside[:1]]
        n = sum(each.n for each in doubted.values())
        n_agree, n_exchanged = (
            sum(max(of) for of in all_of) for all_of in zip(*((x.agree, x.exchanged) for x in doubted.values()), strict=True)
        )
        of = f" of {len(doubted)} tracks, {next(iter(doubted))} the first of them," if len(self._of) > 1 else ""
        low = f"The positions{of} move in the direction of the reported track (within 20 deg) at {n_agree} of {counted(n, 'step')} only"
        if n_exchanged > _AGREES * n:
            return [f"{low}, with latitude and longitude exchanged at {n_exchanged}: the two may be exchanged"]
        return [f"{low}: the track or the positions are not what they are read as"]


_FOR_LONG = (
    f"(by more than {math.degrees(_SIDE_RAD):.0f} deg) for {_SPAN_S / 60:.0f} minutes and more on end: the track or the positions are not "
    "what they are read as"
)


@dataclass
class _Moves:
    """Moves from row to row, or over several, that are long enough to have a direction; where they lead by each convention."""

    time_ns: NDArray[np.int64]
    move_en_m: NDArray[np.float64]
    exchanged_en_m: NDArray[np.float64]
    reported_en_m: list[NDArray[np.float64]]


class _Steps:
    """Steps between successive rows, of which legs are made that are longer than their noise.

    The way is that of the reported speeds: of steps that are chosen by how far the positions moved, only the noisy ones would be looked at.
    """

    def __init__(self, rows: pl.DataFrame) -> None:
        self._time_ns = rows["time_ns"].to_numpy()
        self._place, self._sigma = rows.select("est_lat_rad", "est_lon_rad").to_numpy(), rows["_sigma"].to_numpy()
        course, speed = rows["ground_track_rad"].to_numpy(), rows["_speed"].to_numpy()
        track = rows["track"].rle_id().to_numpy()
        step_s = np.diff(self._time_ns) * 1e-9
        moved_m = np.hypot(*east_north_m(self._place[:-1], self._place[1:]).T)
        stated = 0.5 * (np.where(np.isfinite(speed[:-1]), speed[:-1], speed[1:]) + np.where(np.isfinite(speed[1:]), speed[1:], speed[:-1]))
        self._stated = np.isfinite(stated)
        self._way_m = np.where(self._stated, stated * step_s, moved_m)
        least_m = _least_m(self._sigma[:-1], self._sigma[1:])
        leg_m = _LEG * least_m
        self._of_leg = np.where(
            self._stated, self._way_m / leg_m, np.maximum(np.where(moved_m >= leg_m, moved_m / leg_m, 0.0), step_s / _UNSTATED_S)
        )
        turn = wrapped(np.diff(course))
        known = np.isfinite(turn)
        self._towards = [np.where(known, course[:-1] + share * turn, course[1:]) for share in CONVENTIONS]
        # A step of a turn is a chord in the mean direction of its ends; over half a turn it is in any, where it is not as long as its way.
        close = step_s <= np.maximum(half_turn_s(self._way_m / np.maximum(step_s, 1e-9)), _EVEN_S)
        self._loose = ~close
        moves = ~self._stated | (stated >= np.maximum(_SLOWEST_MPS, leg_m / _LONGEST_S))
        sound = (track[1:] == track[:-1]) & np.isfinite(course[1:]) & (step_s > 0) & np.isfinite(self._way_m)
        self.sound = sound & ~(known & (np.abs(turn) > _TURN_RAD)) & moves
        self.sound &= close | (self._stated & (step_s <= _LOOSE_S))

    def ends(self, begun: float) -> tuple[NDArray[np.intp], float]:
        """Rows at which legs begin and end, the first of which has begun so much of its own; and how much the last row has of its leg."""
        way = np.concatenate([[begun], np.where(self.sound, self._of_leg, 0.0)]).cumsum()
        run = np.concatenate([[0], np.cumsum(~self.sound)])
        starts = np.flatnonzero(np.diff(run, prepend=-1))
        base = way[starts]
        base[0] = 0.0
        way = way - base[run]
        leg = np.floor(way + _TIE)
        # A leg ends before a step that says nothing, too: it may be long enough.
        before = np.append(~self.sound, False)
        ends = np.flatnonzero((np.diff(run, prepend=-1) != 0) | (np.diff(leg, prepend=-1.0) != 0) | before)
        return ends, max(0.0, float(way[ends[-1]] - leg[ends[-1]]))

    def moves(self, first: NDArray[np.intp], last: NDArray[np.intp]) -> _Moves:
        """The legs between some rows that have a direction."""
        start, end = self._place[first], self._place[last]
        move, exchanged = east_north_m(start, end), east_north_m(start[:, ::-1], end[:, ::-1])
        way_m, all_stated = _sums(self._way_m, first, last), _sums((~self._stated).astype(np.float64), first, last) == 0.0
        loose = _sums(self._loose.astype(np.float64), first, last) > 0.0
        least_m, moved_m = _least_m(self._sigma[first], self._sigma[last]), np.hypot(*move.T)
        reported = [
            np.column_stack([_sums(self._way_m * part(towards), first, last) for part in (np.sin, np.cos)]) for towards in self._towards
        ]
        reported_m = np.hypot(*reported[0].T)
        judged = (moved_m > _LEAST_M) & (np.hypot(*exchanged.T) > _LEAST_M)
        judged &= np.where(all_stated, reported_m >= least_m, (moved_m >= least_m) & (reported_m >= _STRAIGHT * way_m))
        judged &= ~loose | (moved_m >= _AS_LONG * reported_m)
        return _Moves(self._time_ns[last][judged], move[judged], exchanged[judged], [each[judged] for each in reported])


def _least_m(sigma_m: NDArray[np.float64], other_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shortest move between two rows that says something of a direction. [m]."""
    return np.clip(_DEVIATIONS * np.hypot(sigma_m, other_m), _LEAST_M, _NOISE_MOST_M)


def _sums(of_steps: NDArray[np.float64], first: NDArray[np.intp], last: NDArray[np.intp]) -> NDArray[np.float64]:
    """Sums over the steps between rows: NaN in one is none of the next."""
    if not first.size:
        return np.zeros(0)
    sums: NDArray[np.float64] = np.add.reduceat(np.append(of_steps, 0.0), np.column_stack([first, last]).ravel())[::2]
    return sums


def _legs(ends: NDArray[np.intp], sound: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First and last rows of the legs between ends, without steps that say nothing."""
    first, last = ends[:-1], ends[1:]
    whole = sound[last - 1]
    return first[whole], last[whole]


def _by_track(
    track: pl.Series, first: NDArray[np.intp], last: NDArray[np.intp]
) -> Iterator[tuple[str, tuple[NDArray[np.intp], NDArray[np.intp]]]]:
    """Names of tracks that follow one another, and their legs."""
    runs = track.rle().struct.unnest()
    begin = 0
    for length, name in zip(runs["len"], runs["value"], strict=True):
        of = slice(*np.searchsorted(first, [begin, begin + length]))
        yield name, (first[of], last[of])
        begin += length


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


def _away(move: NDArray[np.float64], reported: NDArray[np.float64]) -> NDArray[np.float64]:
    """By how much moves go elsewhere than others. [rad]."""
    away: NDArray[np.float64] = np.abs(wrapped(np.arctan2(move[:, 0], move[:, 1]) - np.arctan2(reported[:, 0], reported[:, 1])))
    return away


def axes_of(epochs: pl.DataFrame) -> Axes:
    """The comparison of a whole table, in the order of track and time."""
    axes = Axes()
    axes.see(epochs)
    return axes
