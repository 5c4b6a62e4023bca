"""Cells of a column as numbers in SI, and why they are none."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.read.checks.levels import LEVELS
from navbound.read.columns.place_names import sides
from navbound.read.quantities import QUANTITY, UNITS
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from navbound.read.columns.column import Column

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


_IN_FIELDS = ("m", "mps")
"""Kinds of quantities that loggers write with their unit in each field, `513.863 M` and `15.862 km/h`."""


_USED = r"^(\d+) ?[(/] ?\d+\)?$"
"""Satellites that are used, before those in view: loggers write `3(7)`."""


def _with_units(text: pl.Series, units: Mapping[str, float], factor: float) -> pl.Series:
    """Numbers with a known unit behind each, in the unit of the column; null for anything else."""
    parts = text.str.to_lowercase().str.extract_groups(r"^([+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?)\s*([a-z][a-z/ ]*)$").struct.unnest()
    of_unit = parts["2"].replace_strict(units, default=None, return_dtype=pl.Float64)
    return parts["1"].cast(pl.Float64, strict=False) * of_unit / factor


def lengths(column: pl.Series, factor: float) -> pl.Series:
    """Sizes of lengths of which an accuracy or a level is stated, in a unit of so many metres; null for anything else.

    A field may state a unit of its own, a sign that it is a bound, and words in brackets: `2.5 km`, `±2500 m (95 %)`, `>= 10 NM`.
    """
    raw = column.cast(pl.Float64, strict=False)
    if column.dtype == pl.String:
        text = column.str.strip_chars().str.replace(r"^(?:\+/-|[±<>=~≤≥≈\s])+", "").str.replace(r"\s*\([^()]*\)$", "")
        plain = text.cast(pl.Float64, strict=False)
        raw = pl.select(pl.coalesce(raw, plain, _with_units(text, UNITS["m"], factor))).to_series()
    return raw.abs().fill_nan(None)


def numbers(column: pl.Series, what: Column) -> tuple[pl.Series, pl.Series]:
    """Values in SI, null where there is none; and why, null where nothing is wrong."""
    q = QUANTITY[what.quantity]
    factor = UNITS[q.si][what.unit]
    if column.dtype == pl.String:
        text = column.str.strip_chars()
        # Programs write a missing number as an empty field or as nan: an outage is no damage.
        text = text.set(text.str.contains(MISSING) | on_ground(column, what), None)
        raw = text.cast(pl.Float64, strict=False)
        if q.name == "n_sv" and raw.null_count() > text.null_count():
            raw = pl.select(pl.coalesce(raw, text.str.extract(_USED).cast(pl.Float64, strict=False))).to_series()
        if q.si in _IN_FIELDS and raw.null_count() > text.null_count():
            raw = pl.select(pl.coalesce(raw, _with_units(text, UNITS[q.si], factor))).to_series()
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
        .when((pl.col("raw") == -math.inf) & pl.lit(q.name in LEVELS)).then(pl.lit("not a number"))
        .when(~pl.col("raw").is_finite()).then(pl.lit("not finite"))
        .when(~pl.col("si").is_between(q.low, q.high) & whole).then(pl.lit(in_e7))
        .when(~pl.col("si").is_between(q.low, q.high)).then(pl.lit(allowed))
        .alias("reason"),
    )  # fmt: skip
    return frame["value"], frame["reason"]


def in_hemisphere(what: Column, values: pl.Series, reason: pl.Series, letters: pl.Series) -> tuple[pl.Series, pl.Series]:
    """Coordinates with the sign of their hemisphere, and why they are none: one without a hemisphere may be on either side.

    Programs write what is south or west with a minus or without one; with a minus nothing is north or east.
    """
    of = "lat" if "_lat_" in what.quantity else "lon"
    letters = in_one_text(letters)
    signs = {text: getattr(sides(text), of) for text in letters.drop_nulls().unique()}
    sign = letters.replace_strict(signs, default=None, return_dtype=pl.Int8)
    below, above = ((sign == side).fill_null(value=False) for side in (-1, 1))
    contradicts = above & (values < 0.0).fill_null(value=False)
    known = pl.when(below).then(-values.abs()).when(above & ~contradicts).then(values)
    why = (
        pl.when(reason.is_not_null()).then(reason).when(contradicts).then(pl.lit(f"below zero, and “{letters.name}” says otherwise"))
        .when(~(below | above)).then(pl.lit(f"“{letters.name}” says no hemisphere"))
    )  # fmt: skip
    return pl.select(known.alias("value")).to_series(), pl.select(why.alias("reason")).to_series()


def of_true_north(values: pl.Series, reason: pl.Series, variation: pl.Series) -> tuple[pl.Series, pl.Series]:
    """Magnetic directions as true ones by the variation in degrees; a row without one has none."""
    added = variation.str.strip_chars().cast(pl.Float64, strict=False) if variation.dtype == pl.String else variation.cast(pl.Float64)
    turned = (values + added.radians()) % math.tau
    return turned, pl.select(pl.when(turned.is_null() & reason.is_null()).then(pl.lit("empty")).otherwise(reason)).to_series()


def in_one_text(column: pl.Series) -> pl.Series:
    """A column as texts: a list as its words, bytes as their characters."""
    if column.dtype == pl.List(pl.String):
        return column.list.join(" ")
    return column.cast(pl.String, strict=False)


def floats(column: pl.Series) -> NDArray[np.float64]:
    """The numbers of a column as they are written; NaN where there is none."""
    if column.dtype == pl.String:
        column = column.str.strip_chars().cast(pl.Float64, strict=False)
    if not column.dtype.is_numeric():
        return np.full(len(column), np.nan)
    return column.cast(pl.Float64).fill_null(math.nan).to_numpy(writable=True)


DEEPEST = 8
"""Objects within objects whose values are columns; deeper ones are text. [1]"""


def leaves(record: Mapping[str, Any], within: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """The values of an object, and of the objects in it, with the keys that lead to each."""
    for name, value in record.items():
        if isinstance(value, dict) and len(within) < DEEPEST:
            yield from leaves(value, (*within, name))
        elif isinstance(value, dict):
            # Deeper ones are text: a type of hundreds of levels takes minutes to make.
            yield (*within, name), json.dumps(value)
        else:
            yield (*within, name), value


def series(name: str, values: list[Any]) -> pl.Series:
    """Numbers, truth values or text; a mixture becomes text."""
    try:
        return pl.Series(name, values, strict=True)
    except (TypeError, pl.exceptions.PolarsError, OverflowError):
        kinds = {type(v) for v in values if v is not None}
        if kinds <= {int, float}:
            return pl.Series(name, [None if v is None else float(v) for v in values], dtype=pl.Float64)
        return pl.Series(name, [None if v is None else str(v) for v in values], dtype=pl.String)


_OBJECT = r"^\s*(\{|\[\s*\{)"
_LISTED = 20
"""Objects of a list in a field that are read. [1]"""


def within_objects(frame: pl.DataFrame) -> pl.DataFrame:
    """What objects in fields state, of JSON in text columns and in lists: a column of each key, named behind that of its field."""
    columns = list[pl.Series]()
    for name, dtype in frame.schema.items():
        if isinstance(dtype, pl.List) and isinstance(dtype.inner, pl.Struct):
            records = [dict(leaves(_numbered(cell or []))) for cell in frame[name].to_list()]
        elif dtype == pl.String and frame[name].str.contains(_OBJECT).any():
            records = [_object(cell) for cell in frame[name]]
        else:
            continue
        keys = dict.fromkeys(keys for record in records for keys in record)
        columns += [series(".".join((name, *each)), [record.get(each) for record in records]) for each in keys]
    taken = set(frame.columns)
    return pl.DataFrame(list({each.name: each for each in columns if each.name not in taken}.values()))


def _numbered(listed: list[Any]) -> dict[str, Any]:
    """The first objects of a list, by their numbers."""
    return {str(k): each for k, each in enumerate(listed[:_LISTED]) if isinstance(each, dict)}


def _object(cell: str | None) -> dict[tuple[str, ...], Any]:
    if cell is None or not cell.lstrip().startswith(("{", "[")):
        return {}
    # Some programs write the marks of their own language.
    for text in (cell, cell.replace("'", '"').replace("True", "true").replace("False", "false").replace("None", "null")):
        try:
            content = json.loads(text)
        except (ValueError, RecursionError):
            continue
        return dict(leaves(content if isinstance(content, dict) else _numbered(content if isinstance(content, list) else [])))
    return {}


def largest(values: pl.Series) -> float:
    """The largest size of the values; 0 where there is none."""
    size = values.abs().max()
    return float(size) if isinstance(size, (int, float)) else 0.0


def smallest(values: pl.Series) -> float:
    """The smallest number above 0; infinite where there is none."""
    least = values.filter(values > 0.0).min()
    return float(least) if isinstance(least, (int, float)) else math.inf
