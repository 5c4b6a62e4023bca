"""Where the aircraft really was: a second recording joined by time, and the navigation error that follows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError

if TYPE_CHECKING:
    from navbound.read.epochs import Reading

TOLERANCE_S = 0.01
"""How far apart in time an estimate and its truth may lie. At 70 m/s a hundredth of a second is 0.7 m."""


def join(epochs: pl.DataFrame, truth: Reading, tolerance_s: float = TOLERANCE_S) -> tuple[pl.DataFrame, str]:
    """Join the nearest truth in time, and form the navigation error.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table, sorted by track and time.
    truth : Reading
        The other recording. With several tracks it is joined by track; with one it is the truth of all.
    tolerance_s : float
        Largest difference in time; epochs without a truth this near have none. [s]

    Returns
    -------
    epochs : DataFrame
        With ``truth_lat_rad``, ``truth_lon_rad``, ``truth_h_m`` and the navigation error.
    words : str
        How many epochs have a truth, and the largest difference in time.

    Raises
    ------
    InputError
        A tolerance below zero, or not one epoch with a truth (a wrong time scale shows itself so).
    """
    if not (np.isfinite(tolerance_s) and tolerance_s >= 0):
        raise InputError("truth_tolerance_s", tolerance_s, "s", "[0, inf)")
    wanted = {"est_lat_rad": "truth_lat_rad", "est_lon_rad": "truth_lon_rad", "est_h_m": "truth_h_m"}
    other = truth.epochs.rename({k: v for k, v in wanted.items() if k in truth.epochs.columns})
    other = other.select("track", "time_ns", *[v for v in wanted.values() if v in other.columns], truth_time_ns="time_ns")
    several = other["track"].n_unique() > 1
    joined = (
        epochs.drop([v for v in wanted.values() if v in epochs.columns])
        .sort("time_ns")
        .join_asof(
            other.sort("time_ns") if several else other.drop("track").sort("time_ns"),
            on="time_ns",
            by="track" if several else None,
            strategy="nearest",
            tolerance=round(tolerance_s * 1e9),
            check_sortedness=False,
        )
        .sort("track", "time_ns")
    )
    apart = (joined["truth_time_ns"] - joined["time_ns"]).abs()
    known = len(apart) - apart.null_count()
    if known == 0:
        raise InputError(
            "truth",
            f"{truth.source.path}: no epoch within {tolerance_s:g} s",
            domain=f"recordings of the same time: estimates {_span(epochs)}, truth {_span(other)} (GPS time)",
        )
    largest = apart.max()
    words = (
        f"Truth: {truth.source.path}, joined to the nearest epoch in time; {known} of {joined.height} epochs have one, at most "
        f"{float(largest) * 1e-6 if isinstance(largest, int) else 0.0:g} ms apart (allowed {tolerance_s * 1e3:g} ms)."
    )
    return with_error(joined.drop("truth_time_ns")), words


def with_error(epochs: pl.DataFrame) -> pl.DataFrame:
    """Navigation error, true minus estimated, where a truth is known; upwards only where both heights are."""

    def places(prefix: str, fallback: pl.Expr) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        height = pl.coalesce(pl.col(f"{prefix}_h_m"), fallback) if f"{prefix}_h_m" in epochs.columns else fallback
        table = epochs.select(pl.col(f"{prefix}_lat_rad"), pl.col(f"{prefix}_lon_rad"), height.alias("h"))
        return np.ascontiguousarray(table.fill_null(np.nan).to_numpy())

    # A missing height moves the radii by one part in a million, not more: it is no reason to lose the horizontal error.
    error = _core.navigation_error(places("est", pl.lit(0.0)), places("truth", pl.lit(0.0)))
    epochs = epochs.with_columns(pl.Series(f"nse_{axis}_m", error[:, i]).fill_nan(None) for i, axis in enumerate("enu"))
    heights = [pl.col(c).is_not_null() if c in epochs.columns else pl.lit(value=False) for c in ("est_h_m", "truth_h_m")]
    return epochs.with_columns(pl.when(pl.all_horizontal(heights)).then("nse_u_m"))


def _span(frame: pl.DataFrame) -> str:
    times = frame["time_ns"].sort().to_list()
    return f"{times[0]} to {times[-1]} ns"
