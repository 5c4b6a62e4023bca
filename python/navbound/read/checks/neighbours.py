"""Positions that stand further from the line between their neighbours than any covariance and any manoeuvre explain."""

from __future__ import annotations

import math

import numpy as np
import polars as pl

from navbound import _core
from navbound.read.checks.limits import Limits
from navbound.status import USABLE

COLUMNS = ("track", "time_ns", "status", "est_lat_rad", "est_lon_rad", "cov_ee_m2", "cov_nn_m2")

RISK = _core.NEIGHBOUR_RISK
"""Probability of one such triple under the stated covariances at which it contradicts them. Provenance: ours. [1]"""
MANY = 1e-3
"""Probability of a triple that may stand alone, and not in numbers. Provenance: ours. [1]"""


class Neighbours:
    """Counts over epochs in the order of track and time, in pieces of any length.

    Three successive usable positions of one track contradict each other by the rule of the core (`monitor::neighbours`): the middle
    one stands further from the line between the others than a manoeuvre, rounding, a latency and the covariances explain.

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
        track = rows["track"].rle_id().cast(pl.Int64).to_numpy()
        time_ns, lat, lon = (np.ascontiguousarray(rows[name].to_numpy()) for name in ("time_ns", "est_lat_rad", "est_lon_rad"))
        variance = np.ascontiguousarray(rows.select(pl.max_horizontal("cov_ee_m2", "cov_nn_m2")).to_series().to_numpy())
        away_m, risk = _core.neighbours_apart(track, time_ns, lat, lon, variance, Limits().stale_after_s)
        many = risk < MANY
        self._n += int((risk < RISK).sum())
        self._n_many += int(many.sum())
        self._n_triples += int(np.isfinite(risk).sum())
        self.largest_m = max(self.largest_m, float(away_m[many].max(initial=0.0)))

    @property
    def n(self) -> int:
        """Triples that contradict their covariances."""
        events, mean = self._n_many / 3.0, MANY * self._n_triples
        by_chance = events <= mean or events - mean - events * math.log(events / mean) > math.log(RISK)
        return self._n if by_chance else self._n_many
