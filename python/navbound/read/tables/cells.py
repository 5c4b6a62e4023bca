"""Cells of a column as numbers in SI, and why they are none."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import polars as pl

from navbound.read.quantities import QUANTITY, UNITS
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from navbound.read.tables.columns import Column

MISSING = r"(?i)^([+-]?nan(\(\w*\))?)?$"
"""Texts of a number that is missing."""

_GROUND, _HEIGHTS = "ground", ("altitude_m", "est_h_m")
"""What decoders of ADS-B write in place of an altitude of an aircraft on the ground, and the quantities in whose columns they do."""


def on_ground(column: pl.Series, what: Column) -> pl.Series:
    """Where a column of an altitude says that the aircraft is on the ground: a statement, and no number."""
    if what.quantity not in _HEIGHTS or column.dtype != pl.String:
        return pl.repeat(value=False, n=len(column), eager=True)
    return (column.str.strip_chars().str.to_lowercase() == _GROUND).fill_null(value=False)


def words_of_ground(name: str, n_rows: int) -> str:
    """How many rows say so."""
    have = agreeing(n_rows, "it has", "they have")
    return f"{counted(n_rows, 'row says', 'rows say')} “{_GROUND}” in place of an altitude in “{name}”: {have} a position and no altitude"


def no_field(dtype: pl.DataType) -> bool:
    """Whether a column of this kind holds neither numbers nor text."""
    return dtype.is_nested() or dtype in (pl.Binary, pl.Object, pl.Duration)


def numbers(column: pl.Series, what: Column) -> tuple[pl.Series, pl.Series]:
    """Values in SI, null where there is none; and why, null where nothing is wrong."""
    q = QUANTITY[what.quantity]
    factor = UNITS[q.si][what.unit]
    if column.dtype == pl.String:
        text = column.str.strip_chars()
        # Programs write a missing number as an empty field or as nan: an outage is no damage.
        text = text.set(text.str.contains(MISSING) | on_ground(column, what), None)
        raw = text.cast(pl.Float64, strict=False)
        empty = text.is_null()
    elif column.dtype.is_numeric() or column.dtype == pl.Null:
        raw = column.cast(pl.Float64)
        # A data frame writes a missing number as NaN.
        empty = raw.is_null() | raw.is_nan()
    else:
        raw, empty = pl.Series([None] * len(column), dtype=pl.Float64), column.is_null()
    frame = pl.DataFrame({"raw": raw, "empty": empty, "si": raw * factor})
    allowed = f"outside [{q.low / factor:.6g}, {q.high / factor:.6g}] {'' if q.si == '1' else what.unit}".rstrip()
    # Receivers' integers of 1e-7 degrees are what is so far outside of degrees.
    in_e7 = f'{allowed}; integers of 1e-7 degrees are declared with --map "{q.name}={what.name}:deg_e7"'
    whole = pl.col("raw").abs().is_between(1e6, 180e7) & (pl.col("raw").floor() == pl.col("raw")) & pl.lit(what.unit == "deg")
    frame = frame.select(
        pl.when(pl.col("si").is_between(q.low, q.high) & pl.col("raw").is_finite()).then("si").alias("value"),
        pl.when("empty").then(pl.lit("empty"))
        .when(pl.col("raw").is_null()).then(pl.lit("not a number"))
        .when(~pl.col("raw").is_finite()).then(pl.lit("not finite"))
        .when(~pl.col("si").is_between(q.low, q.high) & whole).then(pl.lit(in_e7))
        .when(~pl.col("si").is_between(q.low, q.high)).then(pl.lit(allowed))
        .alias("reason"),
    )  # fmt: skip
    return frame["value"], frame["reason"]


def largest(values: pl.Series) -> float:
    """The largest size of the values; 0 where there is none."""
    size = values.abs().max()
    return float(size) if isinstance(size, (int, float)) else 0.0


def smallest(values: pl.Series) -> float:
    """The smallest number above 0; infinite where there is none."""
    least = values.filter(values > 0.0).min()
    return float(least) if isinstance(least, (int, float)) else math.inf
