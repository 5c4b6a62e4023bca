"""What the bounds of the judging method leave of the limits, epoch by epoch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.methods import column_of, method
from navbound.records.run import Worst

if TYPE_CHECKING:
    from navbound.methods import Method


OUTSIDE = (pl.min_horizontal("_margin", "_margin_integrity") < 0).fill_null(value=False) | (
    (pl.col("status") == "ok") & pl.col("_margin").is_not_null() & pl.col("_margin_integrity").is_null()
)
"""Outside a limit, or an ok epoch whose protection level is missing: what the monitor compares is then within no limit."""


KNOWN_BEYOND = (
    (pl.col("status") == "ok") & (pl.col("_margin") >= 0) & (pl.col("nse_h_m") > 2.0 * pl.col("rnp_m")) & pl.col("nse_h_m").is_finite()
).fill_null(value=False)
"""An ok epoch within its limit whose known navigation error alone is beyond twice RNP: no share of epochs makes that good."""


def with_margins(epochs: pl.DataFrame, judged: Method) -> pl.DataFrame:
    """Judged epochs with what the bounds of the judging method leave of the limits."""
    # What the monitor compared: the larger of the bound and |FTE| + protection level, where there are levels.
    integrity = judged.integrity_column if "integrity_compared_m" not in epochs.columns else "integrity_compared_m"
    # By numbers: the engine divides by a column that is one value by its reciprocal, which is not the same in the last bit.
    ratio = column_of(epochs, judged.column) / column_of(epochs, "rnp_m")
    margins = epochs.with_columns(
        pl.Series("_ratio", ratio, nan_to_null=True),
        # A NaN is greater than every number here: it must not pass for a margin.
        (pl.col("rnp_m") - pl.col(judged.column)).fill_nan(None).alias("_margin"),
        (2 * pl.col("rnp_m") - pl.col(integrity)).fill_nan(None).alias("_margin_integrity"),
        pl.col(integrity).alias("_integrity"),
    )
    # Degraded epochs may show outside; a share inside speaks of ok epochs alone.
    return margins.with_columns(pl.when(pl.col("status") == "ok").then((pl.col("_margin") >= 0).cast(pl.Float64)).alias("_inside"))


def judged_margins(margins: pl.DataFrame) -> pl.DataFrame:
    """Both margins of the epochs that are judged."""
    return margins.filter(pl.col("status") == "ok").select("_margin", "_margin_integrity").drop_nulls()


def by_status(epochs: pl.DataFrame) -> dict[str, int]:
    """Epochs by status."""
    return dict(epochs.get_column("status").value_counts().sort("status").iter_rows())


def by_reason(epochs: pl.DataFrame) -> dict[str, int]:
    """Epochs that are not ok by reason, the most frequent first."""
    if "reason_id" not in epochs.columns:
        return {}
    named = epochs.filter((pl.col("status") != "ok") & (pl.col("reason_id") != ""))["reason_id"]
    return dict(named.value_counts().sort("count", "reason_id", descending=[True, False]).iter_rows())


def worst_of(margins: pl.DataFrame, judging: str) -> tuple[Worst | None, Worst | None]:
    """Epochs of the least margin, of accuracy and of integrity."""
    return _worst(margins, "_margin", method(judging).column, 1.0), _worst(margins, "_margin_integrity", "_integrity", 2.0)


def _worst(margins: pl.DataFrame, margin: str, bound: str, factor: float) -> Worst | None:
    # The table may be large: the row is looked up, nothing is copied.
    place = margins.get_column(margin).arg_min()
    if place is None:
        return None
    row = margins.row(place, named=True)
    return Worst(
        track=row["track"],
        time_ns=row["time_ns"],
        margin_m=row[margin],
        bound_m=row[bound],
        limit_m=factor * row["rnp_m"],
        phase=row.get("phase"),
        along_m=row.get("along_m"),
        lat_rad=row["est_lat_rad"],
        lon_rad=row["est_lon_rad"],
    )
