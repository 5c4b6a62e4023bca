"""The satellites that were heard, one by one."""

from __future__ import annotations

import polars as pl

from navbound.evaluation import sizes
from navbound.gnss.receivers import USED
from navbound.records.groups import SatelliteSummary


def satellites_of(heard: pl.DataFrame | None) -> list[SatelliteSummary]:
    """Every satellite of every track that positions were solved for; none where no positions were."""
    if heard is None or heard.is_empty():
        return []
    residual, strength = pl.col("residual_m"), pl.col("cn0_dbhz")
    grouped = heard.group_by("track", "sv").agg(
        pl.len().alias("n_heard"),
        (pl.col("fate") == USED).sum().alias("n_used"),
        pl.col("el_rad").max().alias("el_max_rad"),
        sizes.root_mean_square_of(residual).alias("residual_rms_m"),
        residual.get(residual.abs().arg_max()).alias("residual_most_m"),
        strength.mean().alias("cn0_mean_dbhz"),
        strength.min().alias("cn0_min_dbhz"),
        pl.col("fate").filter(pl.col("fate") != USED).value_counts(sort=True).alias("fates"),
    )
    return [
        SatelliteSummary(n_fate={fate["fate"]: fate["count"] for fate in row.pop("fates")}, **row)
        for row in grouped.sort("track", "sv").iter_rows(named=True)
    ]
