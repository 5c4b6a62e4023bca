"""How far positions scatter along their way, against the recording's own speeds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m
from navbound.read.motion.ways import LONGEST_STEP_S
from navbound.records.material import Scatter

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SCATTER_BINS_M = np.geomspace(1.0, 1e5, 201)
"""Edges of the bins in which scatter is counted: 6 % wide. [m]"""
_LEAST_STEPS = 60
"""Steps of a track from which its scatter is stated. Provenance: ours. [1]"""
_K95 = 1.96
"""Standard deviations that 95 % of normal errors of one axis are within."""
_STATED_MPS, _STATED_SHARE = 1.0, 0.02
"""What a stated speed may be wrong by, and share of the way that a turn or a scale hides. Provenance: ours. [m/s, 1]"""


class Steps:
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
        sound = (track[1:] == track[:-1]) & (step_s > 0) & (step_s <= LONGEST_STEP_S) & np.isfinite(left_m)
        names = rows["track"][1:].filter(pl.Series(sound))
        bins = np.searchsorted(_SCATTER_BINS_M, left_m[sound])
        begin = 0
        for length, name in names.rle().struct.unnest().iter_rows():
            own = np.bincount(bins[begin : begin + length], minlength=_SCATTER_BINS_M.size + 1)
            self._counts[name] = own + self._counts.get(name, 0)
            begin += length

    def largest(self) -> Scatter | None:
        """How far the positions of the track scatter that do so most; None where no track has enough steps."""
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
