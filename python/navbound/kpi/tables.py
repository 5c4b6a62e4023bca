"""Tables of errors and protection levels as the indicators of `navbound.kpi` take them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.errors import InputError
from navbound.status import STATUSES

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
    if "hpe_m" in frame.columns:
        vertical = pl.col("vpe_m") if "vpe_m" in frame.columns else pl.lit(None, pl.Float64)
        frame = with_larger_error(frame, pl.col("hpe_m"), vertical)
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
        uniform = frame.select(
            (pl.col(name) if name in frame.columns else pl.lit("ok" if name == "status" else None)).cast(kind).alias(name)
            for name, kind in columns.items()
        )
    except pl.exceptions.PolarsError as e:
        raise InputError("table", str(e).splitlines()[0][:120], domain="numbers in the columns that hold numbers") from e
    # A word that nobody knows is not "ok", and neither is an empty field.
    unknown = ~uniform["status"].is_in(list(STATUSES)).fill_null(value=False)
    if unknown.any():
        row = int(unknown.arg_true()[0])
        raise InputError("status", repr(uniform["status"][row]), domain=", ".join(STATUSES), index=row)
    return uniform


def with_larger_error(frame: pl.DataFrame, horizontal_m: pl.Expr, vertical_m: pl.Expr) -> pl.DataFrame:
    """The errors of a table, replaced where another statement of the same epochs is larger: of two the worse counts.

    Parameters
    ----------
    frame : DataFrame
        With ``nse_e_m nse_n_m nse_u_m`` or some of them.
    horizontal_m, vertical_m : Expr
        The other statement: a length, and an error of either sign. [m]
    """
    own = [pl.col(f"nse_{axis}_m") if f"nse_{axis}_m" in frame.columns else pl.lit(None, pl.Float64) for axis in "enu"]
    try:
        east, north, up, other_h, other_u = (each.cast(pl.Float64) for each in (*own, horizontal_m.abs(), vertical_m))
        # A component that is not there adds nothing to the one that is.
        has = other_h.is_not_null()
        east, north = (pl.when(has).then(each.fill_null(0.0)).otherwise(each) for each in (east, north))
        size = (east**2 + north**2).sqrt()
        larger, ratio = has & (other_h > size), pl.when(size > 0.0).then(other_h / size)
        return frame.with_columns(
            nse_e_m=pl.when(larger).then(pl.coalesce(east * ratio, other_h)).otherwise(east),
            nse_n_m=pl.when(larger).then(pl.coalesce(north * ratio, pl.lit(0.0))).otherwise(north),
            nse_u_m=pl.when(other_u.is_not_null() & (up.is_null() | (other_u.abs() > up.abs()))).then(other_u).otherwise(up),
        )
    except pl.exceptions.PolarsError as e:
        raise InputError("table", str(e).splitlines()[0][:120], domain="numbers in the columns that hold numbers") from e


def _from_mapping(table: Mapping[str, Any]) -> pl.DataFrame:
    try:
        return pl.DataFrame({name: np.asarray(values) if not isinstance(values, pl.Series) else values for name, values in table.items()})
    except (pl.exceptions.PolarsError, TypeError, ValueError) as e:
        raise InputError("table", str(e).splitlines()[0][:120], domain="columns of equal length") from e
