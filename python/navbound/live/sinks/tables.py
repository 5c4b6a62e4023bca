"""Epochs and alerts of a session as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import _core
from navbound.live import journal
from navbound.live.settings import load
from navbound.live.sinks import transition

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA = pl.Schema(
    dict.fromkeys(transition.FIELDS, pl.Int64)
    | dict.fromkeys(("key", "track", "kind", "transition"), pl.String())
    | dict.fromkeys(("peak_m", "limit_m", "min_margin_m", "latency_s", "sigma_m"), pl.Float64())
    | dict.fromkeys(("within_time_to_alert", "replayed"), pl.Boolean())
)
"""Of the table of transitions, also where there are none."""


def epochs(folder: Path) -> pl.DataFrame:
    """Every record that was judged, in the order in which it was; ``sigma_m`` is what the user stated where records state no accuracy."""
    columns = _core.live_epochs(journal.read(folder / journal.OUT))
    frame = pl.DataFrame({name: pl.Series(name, values, nan_to_null=True, strict=False) for name, values in columns.items()})
    assumed = pl.lit(load(folder / journal.SETTINGS).sigma_m, pl.Float64).alias("sigma_m")
    return frame.with_columns(pl.col("arrival_ns").cast(pl.Int64), pl.col("reason_id").cast(pl.String), assumed)


def transitions(folder: Path) -> pl.DataFrame:
    """Every alert that began or ended, in the order in which it did."""
    settings, rows = load(folder / journal.SETTINGS), _core.live_transitions(journal.read(folder / journal.OUT))
    records = [transition.record(r, settings, replayed=False) for r in rows]
    return pl.DataFrame(records, schema=SCHEMA, infer_schema_length=None)


def usual_step_s(judged: pl.DataFrame) -> float | None:
    """The median of the steps in time of each track; None where no track has two times. [s]."""
    steps = judged.select(pl.col("time_ns").unique().sort().diff().over("track", mapping_strategy="explode").alias("step_ns"))
    median = steps["step_ns"].median()
    return None if median is None else round(float(str(median)) * 1e-9, 3)


def write(folder: Path) -> pl.DataFrame:
    """Both as Parquet beside the journals; the epochs."""
    judged = epochs(folder)
    for name, frame in (("epochs", judged), ("events", transitions(folder))):
        partial = folder / f"{name}.parquet.partial"
        frame.write_parquet(partial, compression="zstd")
        partial.replace(folder / f"{name}.parquet")
    return judged
