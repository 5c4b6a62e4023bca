"""Positions that stand further from the line between their neighbours than any covariance and any manoeuvre explain."""

from __future__ import annotations

import math

import numpy as np
import polars as pl

from navbound.read.checks.places import east_north_m
from navbound.read.checks.plausible import Limits
from navbound.status import USABLE

COLUMNS = ("track", "time_ns", "status", "est_lat_rad", "est_lon_rad", "cov_ee_m2", "cov_nn_m2")

RISK = 1e-9
"""Probability of one such triple under the stated covariances at which it contradicts them. Provenance: ours. [1]"""
MANY = 1e-3
"""Probability of a triple that may stand alone, and not in numbers. Provenance: ours. [1]"""
ACCELERATION_MPS2 = 10.0
"""Largest acceleration of an ordinary manoeuvre, between 1 g of a braking car and of a steep turn. Provenance: ours. [m/s2]"""
ROUNDING_M = 2.0
"""What five decimals of a degree move three positions by. Derived. [m]"""


class Neighbours:
    """Counts over epochs in the order of track and time, in pieces of any length.

    Of three successive usable positions a, b, c of one track, at times s before and t after the middle one:

    ```text
    d = b - (t a + s c) / (s + t)                       across the way a to c, and along it
    |d across| <= 1/2 A s t + rounding                  + what the covariances allow
    |d along|  <= 1/2 A s t + rounding + v latency      + what the covariances allow
    ```

    The rest is compared with ``sqrt(-2 ln RISK)`` standard deviations of d, the larger variance of both axes taken. A position may
    be as late as one that is not yet stale. [ours]

    More triples beyond the distance of the risk `MANY` than chance makes (Chernoff's bound of a Poisson number at `RISK`, three overlapping
    triples taken for one) contradict the covariances, too.

    Attributes
    ----------
    largest_m : float
        The largest distance d of triples beyond. [m]
    """

    def __init__(self) -> None:
        self._n = self._n_many = self._n_triples = 0
        self.largest_m = 0.0
        self._last: pl.DataFrame | None = None

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        if not set(COLUMNS) <= set(epochs.columns):
            return
        rows = epochs.select(COLUMNS).filter(pl.col("status").is_in(USABLE)).drop_nulls()
        rows = rows if self._last is None else pl.concat([self._last, rows])
        self._last = rows.tail(2)
        track = rows["track"].rle_id().to_numpy()
        time_s = (rows["time_ns"] - (rows["time_ns"][0] if rows.height else 0)).to_numpy() * 1e-9
        place = rows.select("est_lat_rad", "est_lon_rad").to_numpy()
        variance = rows.select(pl.max_horizontal("cov_ee_m2", "cov_nn_m2")).to_series().to_numpy()
        same = (track[:-2] == track[2:]) & (time_s[1:-1] > time_s[:-2]) & (time_s[2:] > time_s[1:-1])
        before_s, after_s = (np.where(same, each, 1.0) for each in (time_s[1:-1] - time_s[:-2], time_s[2:] - time_s[1:-1]))
        way, step = east_north_m(place[:-2], place[2:]), east_north_m(place[:-2], place[1:-1])
        whole_s = before_s + after_s
        share = before_s / whole_s
        away = step - share[:, None] * way
        length = np.hypot(*way.T)
        unit = way / np.where(length > 0.0, length, 1.0)[:, None]
        along, across = np.abs((away * unit).sum(axis=1)), np.abs(away[:, 0] * unit[:, 1] - away[:, 1] * unit[:, 0])
        # Of neighbours at one place nothing is along.
        across = np.where(length > 0.0, across, np.hypot(*away.T))
        free_m = 0.5 * ACCELERATION_MPS2 * before_s * after_s + ROUNDING_M
        late_m = Limits().stale_after_s * length / whole_s
        rest = np.hypot(np.maximum(across - free_m, 0.0), np.maximum(along - free_m - late_m, 0.0))
        deviation = np.sqrt(variance[1:-1] + (1.0 - share) ** 2 * variance[:-2] + share**2 * variance[2:])
        beyond, many = (same & (rest > math.sqrt(-2.0 * math.log(risk)) * deviation) for risk in (RISK, MANY))
        self._n += int(beyond.sum())
        self._n_many += int(many.sum())
        self._n_triples += int(same.sum())
        self.largest_m = max(self.largest_m, float(np.hypot(*away[many].T).max(initial=0.0)))

    @property
    def n(self) -> int:
        """Triples that contradict their covariances."""
        events, mean = self._n_many / 3.0, MANY * self._n_triples
        by_chance = events <= mean or events - mean - events * math.log(events / mean) > math.log(RISK)
        return self._n if by_chance else self._n_many
