"""The epochs of a performance run under the column names that the field's tools use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_WEEK_NS = 604_800 * 10**9
_DAY_NS = 86_400 * 10**9
_EPOCH = pl.datetime(1980, 1, 6, time_unit="ns")

_OF_LEVELS = ("HPL", "HSI", "VPL", "VSI")


def columns() -> list[pl.Expr]:
    """Year to time of week in GPS time; errors estimated minus true, as the field writes them, ours being true minus estimated."""
    time = pl.col("time_ns")
    calendar = _EPOCH + time.cast(pl.Duration("ns"))
    east, north, up = (-pl.col(f"nse_{axis}_m") for axis in "enu")
    hpe = pl.coalesce((east.pow(2) + north.pow(2)).sqrt(), "hpe_m")
    vpe = pl.coalesce(up.abs(), pl.col("vpe_m").abs())
    return [
        calendar.dt.year().alias("YEAR"),
        calendar.dt.ordinal_day().alias("DOY"),
        ((time % _DAY_NS) / 1e9).alias("SOD"),
        (time // _WEEK_NS).alias("WEEK"),
        ((time % _WEEK_NS) / 1e9).alias("TOW"),
        pl.col("track").alias("RECEIVER"),
        pl.col("mode").str.to_uppercase().alias("MODE"),
        north.alias("NERR"),
        east.alias("EERR"),
        up.alias("UERR"),
        hpe.alias("HPE"),
        pl.col("hpl_m").alias("HPL"),
        (hpe / pl.col("hpl_m")).alias("HSI"),
        vpe.alias("VPE"),
        pl.col("vpl_m").alias("VPL"),
        (vpe / pl.col("vpl_m")).alias("VSI"),
        (hpe.pow(2) + vpe.pow(2)).sqrt().alias("3DERR"),
        pl.col("n_sv").alias("NUSED"),
        pl.col("hdop").alias("HDOP"),
        pl.col("vdop").alias("VDOP"),
        pl.col("status").alias("STATUS"),
        pl.col("reason").alias("REASON"),
    ]


def _no_formula() -> pl.Expr:
    """Texts that a spreadsheet would work out are led in by an apostrophe, as it writes a text itself; numbers stay."""
    return pl.selectors.string().str.replace(r"^(\s*[=+\-@])", "'${1}")


def write_csv(tables: Iterable[pl.DataFrame], path: Path, experimental: str = "") -> None:
    """Write tables that follow each other as one file, one in memory at a time; experimental levels are marked in their names."""
    marked = {name: f"{name} [{experimental}]" for name in _OF_LEVELS} if experimental else {}
    with path.open("wb") as file:
        for index, table in enumerate(tables):
            table.select(columns()).with_columns(_no_formula()).rename(marked).write_csv(file, include_header=index == 0)
