"""Ways of positions over windows of a minute."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.read.checks.places import east_north_m, wrapped

if TYPE_CHECKING:
    from numpy.typing import NDArray

WINDOW_S = 60.0
"""Span over which ways are compared; Doppler speeds and positions agree over it to some metres. Provenance: ours. [s]"""
WINDOW_NS = 60_000_000_000
_SHORTEST_S = 15.0
"""Of a window the steps that follow one another are compared from this length on: what is compared now and then counts, too, at the margin
of a whole window. Provenance: ours. [s]"""
LONGEST_STEP_S = 10.0
"""Over a longer step the speed may have been any. Provenance: ours. [s]"""
_LEG_NS = 10_000_000_000
"""Span of a leg of the way that positions travel: the noise of each step would add up to a way of its own. A turn of three degrees a second
shortens it by one in a hundred. Provenance: ours. [ns]"""
_SLOW_MPS = 55.0
"""Below it an aircraft may turn by half a turn within a leg, as a glider does; its legs are half as long. Provenance: ours. [m/s]"""
_LEG_TURN_RAD, _SHORTEST_LEG_S = math.radians(60.0), 1.0
"""A leg turns by no more than this, as the reported track does in its minute: in steep circles it is shorter, down to a second.
Provenance: ours. [rad, s]"""
OFFSET_M = 3.0 * WINDOW_S
"""Difference of ways over a window that shows nothing, 3 m/s: rounding, wind on a filtered track, a slow filter. Provenance: ours. [m]"""
_DEVIATIONS = _core.DRIFT_DEVIATIONS
"""Noise of two positions, in standard deviations of the covariance."""


@dataclass(frozen=True)
class Minutes:
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

    def of(self, which: NDArray[np.bool_]) -> Minutes:
        """Those that begin at some of the rows."""
        at = which[self.first]
        tracks = [track for track, one in zip(self.tracks, at.tolist(), strict=True) if one]
        return Minutes(tracks, self.length_s[at], self.first[at], self.stop[at], self.apart_en_m[at], self.way_m[at], self.margin_m[at])

    def sums(self, of_steps: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum of the steps of each window."""
        return _sums(of_steps, self.first, self.stop)


class Ways:
    """Steps between successive rows, and the ways of positions over windows of them."""

    def __init__(self, rows: pl.DataFrame, longest_s: float) -> None:
        self._time_ns = rows["time_ns"].to_numpy()
        self._place, self._sigma = rows.select("est_lat_rad", "est_lon_rad").to_numpy(), rows["_sigma"].to_numpy()
        self.step_s = np.diff(self._time_ns) * 1e-9
        self.step_m = np.hypot(*east_north_m(self._place[:-1], self._place[1:]).T)
        # Where no track is stated none turns.
        self._turn_rad = np.nan_to_num(np.abs(wrapped(np.diff(rows["_whither"].to_numpy()))))
        track = rows["track"].rle_id().to_numpy()
        self.sound = (track[1:] == track[:-1]) & np.isfinite(self.step_m) & (self.step_s > 0) & (self.step_s <= longest_s)

    def minutes(self, rows: pl.DataFrame, end: int, sound: NDArray[np.bool_]) -> Minutes:
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
        return Minutes(
            tracks=rows["track"].gather(first).to_list(),
            length_s=length_s,
            first=first,
            stop=stop,
            apart_en_m=east_north_m(self._place[first], self._place[stop]),
            way_m=np.minimum(steps_m, self._legs_m(first, stop, self._leg_ns(first, stop, steps_m, length_s))),
            margin_m=OFFSET_M + noise_m,
        )

    def _leg_ns(
        self, first: NDArray[np.intp], stop: NDArray[np.intp], steps_m: NDArray[np.float64], length_s: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """How long the legs of each window are."""
        leg_ns = np.where(steps_m < _SLOW_MPS * length_s, _LEG_NS // 2, _LEG_NS)
        turn_s = _LEG_TURN_RAD * length_s / np.maximum(_sums(self._turn_rad, first, stop), 1e-9)
        return np.minimum(leg_ns, (1e9 * np.clip(turn_s, _SHORTEST_LEG_S, WINDOW_S)).astype(np.int64))

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
