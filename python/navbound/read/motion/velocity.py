"""What a table states of its motion and of the noise of its positions, as numbers; NaN where a row states nothing."""

from __future__ import annotations

import polars as pl

from navbound.table.columns import HORIZONTAL


def stated_speed(epochs: pl.DataFrame) -> pl.Expr | None:
    """Speed over ground as the recording states it [m/s]; None where it states none."""
    if "ground_speed_mps" in epochs.columns:
        return pl.col("ground_speed_mps").cast(pl.Float64).fill_null(float("nan"))
    if {"vel_n_mps", "vel_e_mps"} <= set(epochs.columns):
        return (pl.col("vel_n_mps") ** 2 + pl.col("vel_e_mps") ** 2).sqrt().fill_null(float("nan"))
    return None


def stated_track(epochs: pl.DataFrame) -> pl.Expr:
    """Direction of the speed as the recording states it [rad]; NaN where it states none."""
    if "ground_track_rad" not in epochs.columns:
        return pl.lit(float("nan"))
    return pl.col("ground_track_rad").cast(pl.Float64).fill_null(float("nan"))


def sigma_m(epochs: pl.DataFrame) -> pl.Expr:
    """Root of both horizontal variances [m]; 0 where there is none."""
    if not set(HORIZONTAL) <= set(epochs.columns):
        return pl.lit(0.0)
    ee, _, nn = (pl.col(name) for name in HORIZONTAL)
    return (ee + nn).sqrt().fill_null(0.0).fill_nan(0.0)


MEAN = 0.5
CONVENTIONS = (MEAN, 0.0, 1.0)
"""Between two rows the way leads in the mean direction of both, in that of the earlier row, or, where a recorder states the way that led to
a row, in that of the later one. A track has one of these throughout. [1]"""
