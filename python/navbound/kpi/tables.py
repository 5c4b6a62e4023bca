"""Tables of errors and protection levels as the indicators of `navbound.kpi` take them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

FLOATS = ("nse_e_m", "nse_n_m", "nse_u_m", "hpl_m", "vpl_m")
"""Columns of numbers. [m]"""

Table = pl.DataFrame | Mapping[str, Any]


def period_of(times: pl.Series) -> float:
    """The usual step of a table. [s]."""
    step = times.diff().drop_nulls().filter(times.diff().drop_nulls() > 0).median()
    if not isinstance(step, (int, float)) or not step > 0:
        raise InputError("period_s", "none", "s", "a period: the first table has no two instants to take it from")
    # Divided, since 1e-9 is no double: 0.1 s stays 0.1 s.
    return float(step) / 1e9


def codes_of(texts: pl.Series, known: dict[str, int]) -> NDArray[np.uint32]:
    """Texts as numbers from 1, new ones added to those known; 0 for none."""
    for text in texts.drop_nulls().unique(maintain_order=True):
        if text:
            known.setdefault(text, len(known) + 1)
    codes = texts.replace_strict(known, default=0, return_dtype=pl.UInt32) if known else pl.zeros(len(texts), pl.UInt32, eager=True)
    return np.ascontiguousarray(codes.fill_null(0).to_numpy())


def frame_of(table: Table) -> pl.DataFrame:
    """Columns that the indicators need, absent ones null."""
    frame = table if isinstance(table, pl.DataFrame) else _from_mapping(table)
    for name in ("time_ns", "hpl_m"):
        if name not in frame.columns:
            raise InputError("table", f"columns {', '.join(frame.columns[:12])}", domain=f"a table with a column {name}")
    if "hpe_m" in frame.columns and ("nse_e_m" not in frame.columns or frame["nse_e_m"].is_null().all()):
        known = pl.col("hpe_m").is_not_null()
        vertical = pl.col("vpe_m") if "vpe_m" in frame.columns else pl.lit(None, pl.Float64)
        frame = frame.with_columns(nse_e_m=pl.col("hpe_m"), nse_n_m=pl.when(known).then(0.0), nse_u_m=vertical)
    if not frame["time_ns"].dtype.is_integer():
        raise InputError("time_ns", f"{frame['time_ns'].dtype}", domain="whole nanoseconds")
    if frame["time_ns"].null_count():
        raise InputError("time_ns", "null", "ns", "an instant in every row")
    columns = {
        "time_ns": pl.Int64,
        **dict.fromkeys(FLOATS, pl.Float64),
        "n_sv": pl.Int32,
        **dict.fromkeys(("status", "mode", "reason"), pl.String),
    }
    try:
        return frame.select(
            (pl.col(name) if name in frame.columns else pl.lit(None)).cast(kind).alias(name) for name, kind in columns.items()
        )
    except pl.exceptions.PolarsError as e:
        raise InputError("table", str(e).splitlines()[0][:120], domain="numbers in the columns that hold numbers") from e


def _from_mapping(table: Mapping[str, Any]) -> pl.DataFrame:
    try:
        return pl.DataFrame({name: np.asarray(values) if not isinstance(values, pl.Series) else values for name, values in table.items()})
    except (pl.exceptions.PolarsError, TypeError, ValueError) as e:
        raise InputError("table", str(e).splitlines()[0][:120], domain="columns of equal length") from e
