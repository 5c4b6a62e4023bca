"""Epochs and alerts of a session as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import _core
from navbound.live import journal, transition

if TYPE_CHECKING:
    from pathlib import Path


def epochs(folder: Path) -> pl.DataFrame:
    """Every record that was judged, in the order in which it was."""
    columns = _core.live_epochs(journal.read(folder / journal.OUT))
    frame = pl.DataFrame({name: pl.Series(name, values, nan_to_null=True, strict=False) for name, values in columns.items()})
    return frame.with_columns(pl.col("arrival_ns").cast(pl.Int64), pl.col("reason_id").cast(pl.String))


def transitions(folder: Path, *, time_to_alert_s: float) -> pl.DataFrame:
    """Every alert that began or ended, in the order in which it did."""
    rows = _core.live_transitions(journal.read(folder / journal.OUT))
    return pl.DataFrame([transition.record(r, time_to_alert_s=time_to_alert_s, replayed=False) for r in rows], infer_schema_length=None)


def write(folder: Path, *, time_to_alert_s: float) -> None:
    """Both as Parquet beside the journals."""
    for name, frame in (("epochs", epochs(folder)), ("events", transitions(folder, time_to_alert_s=time_to_alert_s))):
        partial = folder / f"{name}.parquet.partial"
        frame.write_parquet(partial, compression="zstd")
        partial.replace(folder / f"{name}.parquet")
