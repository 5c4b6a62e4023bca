"""Any written time to GPS time: weeks, Unix times and ISO text. Leap seconds are the core's business."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import FormatError

if TYPE_CHECKING:
    from navbound.read.columns import Column
    from navbound.read.source import Source

_FIRST_NS = 0
_LAST_NS = 3_786_912_018_000_000_000
"""2100-01-01 in GPS time with today's leap seconds: the last time that is believed."""


_MAX_NS = 4e18
"""Unix times beyond 2096 do not fit 64 bits as nanoseconds for much longer; what is larger is no time."""


def gps_time(frame: pl.DataFrame, columns: list[Column], source: Source, notes: list[str]) -> tuple[pl.Series, pl.Series, list[str]]:
    """Read the time of every row.

    Returns
    -------
    ns : Series
        GPS time, null where there is none. [ns]
    reason : Series
        Why a row has none.
    units : list of str
        ``column:unit`` of the columns used, as they were understood. Doubts are added to `notes`.
    """
    units = [f"{c.name}:{c.unit}" for c in columns]
    first = frame[columns[0].name]
    unit = columns[0].unit
    if first.dtype in (pl.Datetime, pl.Date):
        aware = isinstance(first.dtype, pl.Datetime) and first.dtype.time_zone is not None
        unix = first.cast(pl.Datetime("ns")).cast(pl.Int64)
        if not aware:
            notes.append(f"{source.path.name}: “{first.name}” has no time zone and was read as UTC")
        ns = _from_unix(unix)
    elif unit in {"gps_week", "gps_tow_s"}:
        by = {c.unit: c for c in columns}
        week, tow = _plain_numbers(frame[by["gps_week"].name]), _plain_numbers(frame[by["gps_tow_s"].name])
        ns = _from_week(week, tow)
        if (week < 1024).all():
            notes.append(
                f"{source.path.name}: every GPS week is below 1024; weeks are counted from 1980, so these are dates before August 1999"
            )
    elif unit.startswith("gps"):
        # Nineteen digits of nanoseconds do not pass through a double.
        exact = unit == "gps_ns" and first.dtype != pl.Float64
        ns = first.cast(pl.Int64, strict=False) if exact else _ns(_plain_numbers(first) * (1.0 if unit == "gps_ns" else 1e9))
    else:
        unix, understood = _unix_ns(first, unit, source, notes)
        units = [f"{first.name}:{understood}"]
        ns = _from_unix(unix) if understood != "utc_text" else _with_leap_seconds(first, unix)
    empty = first.is_null() | (first.cast(pl.String).str.strip_chars() == "").fill_null(value=True)
    inside = ns.is_between(_FIRST_NS, _LAST_NS)
    reason = pl.select(
        pl.when(empty).then(pl.lit("empty")).when(ns.is_null()).then(pl.lit("not a time"))
        .when(~inside).then(pl.lit("time outside 1980 to 2100"))
    ).to_series()  # fmt: skip
    return ns, reason, units


def _unix_ns(column: pl.Series, unit: str, source: Source, notes: list[str]) -> tuple[pl.Series, str]:
    """Unix time [ns] from numbers or from text, and the unit as understood."""
    numbers = _plain_numbers(column) if unit != "utc_text" else pl.Series([None] * len(column), dtype=pl.Float64)
    if unit == "utc_text" or (unit == "utc" and column.dtype == pl.String and _mostly_text(column, numbers)):
        if not column.cast(pl.String).str.contains(r"(Z|[+-]\d\d:?\d\d)\s*$").any():
            notes.append(f"{source.path.name}: “{column.name}” has no time zone and was read as UTC")
        return _iso(column), "utc_text"
    scales = {"utc_s": 1e9, "utc_ms": 1e6, "utc_us": 1e3, "utc_ns": 1.0}
    size = numbers.abs().median()
    size = float(size) if isinstance(size, (int, float)) else 0.0
    since_start = _since_start(numbers, size * scales.get(unit, 0.0))
    if unit == "utc":
        unit = next((u for u, low in (("utc_ns", 1e17), ("utc_us", 1e14), ("utc_ms", 1e11), ("utc_s", 1e8)) if size >= low), "")
        if not unit and not since_start:
            raise FormatError(
                source.path,
                f"the values (median {size:g}) are not Unix times; declare the unit, e.g. time={column.name}:gps_s",
                field=column.name,
            )
    if since_start:
        raise FormatError(source.path, since_start, field=column.name)
    if unit == "utc_ns" and column.dtype != pl.Float64:
        return column.cast(pl.Int64, strict=False), unit
    # Nanoseconds of 2026 have 19 digits, a double 16: whole units stay whole in integers, fractions to 0.2 us.
    numbers = numbers.set((numbers.abs() * scales[unit] > _MAX_NS).fill_null(value=False), None)
    whole = numbers.floor()
    return _ns(whole) * int(scales[unit]) + _ns((numbers - whole) * scales[unit]), unit


_LONGEST_STEP = 1800.0
"""Seconds between two rows of a track beyond which numbers are not read as Unix seconds. Provenance: ours."""
_FIRST_UNIX_S = 315_964_800
"""Unix time of 1980-01-06, the beginning of GPS time."""


def _since_start(numbers: pl.Series, declared_ns: float) -> str:
    """Why numbers are the time since a computer started and no date; empty where they may be dates."""
    known = numbers.drop_nulls()
    step = known.diff().abs().median() if known.len() > 1 else None
    if not isinstance(step, (int, float)) or not step > 0:
        return ""
    size = float(known.abs().max())  # type: ignore[arg-type]
    undated = 0 < declared_ns < _FIRST_UNIX_S * 1e9
    # Numbers of less than 1e11 could only be seconds, and those of a track are not half an hour apart.
    micro = not declared_ns and size < 1e11 and step > _LONGEST_STEP
    if not (undated or micro):
        return ""
    unit = "microseconds" if step > _LONGEST_STEP else "milliseconds" if step > 5 else "units"
    return (
        f"the values (largest {size:g}, median step {step:g}) are {unit} since the computer or receiver started, not dates: "
        f"another column must hold the time (for instance of GPS, declared as time=COLUMN:utc_us), or add the instant of the start"
    )


def _mostly_text(column: pl.Series, numbers: pl.Series) -> bool:
    """Whether more of what stands in the column is text than numbers; an empty field is neither."""
    stands = (column.str.strip_chars() != "").fill_null(value=False)
    return int((stands & numbers.is_null()).sum()) > int(numbers.is_not_null().sum())


def _iso(column: pl.Series) -> pl.Series:
    """ISO 8601 with a date and a time of day; without a zone it is UTC."""
    text = column.cast(pl.String).str.strip_chars().str.replace("T", " ", literal=True).str.replace("Z$", "+00:00")
    # A sixty-first second is parsed as the one before it; `_with_leap_seconds` makes it what it is.
    text = text.str.replace(_LEAP, "${1}:59${2}")
    zoned = pl.select(
        pl.when(text.str.contains(r"[+-]\d\d:?\d\d$")).then(text).otherwise(pl.concat_str(text, pl.lit("+00:00")))
    ).to_series()
    return zoned.str.to_datetime("%Y-%m-%d %H:%M:%S%.f%:z", time_unit="ns", strict=False).cast(pl.Int64)


_LEAP = r"(:\d\d):60([^\d:]|$)"


def _with_leap_seconds(column: pl.Series, unix_ns: pl.Series) -> pl.Series:
    """GPS time of written times: 23:59:60 is an instant of its own, and no time on a day that had none."""
    ns = _from_unix(unix_ns)
    leap = column.cast(pl.String).str.contains(_LEAP).fill_null(value=False) & unix_ns.is_not_null()
    if not leap.any():
        return ns
    time_ns, exists = _core.gps_of_leap_second_ns(np.ascontiguousarray(unix_ns.filter(leap).to_numpy(), dtype=np.int64))
    return ns.scatter(leap.arg_true(), pl.select(pl.when(pl.Series(exists)).then(pl.Series(time_ns))).to_series())


def _plain_numbers(column: pl.Series) -> pl.Series:
    numbers = column.cast(pl.String).str.strip_chars().cast(pl.Float64, strict=False)
    return numbers.set(~numbers.is_finite().fill_null(value=True), None)


def _ns(values: pl.Series) -> pl.Series:
    """Whole numbers; null beyond the range of 64 bits."""
    return values.round().cast(pl.Int64, strict=False)


def _from_week(week: pl.Series, tow_s: pl.Series) -> pl.Series:
    """GPS time of weeks since 1980 and times of week [ns], null where they are none."""
    fits = (week.is_between(0, 10_000) & tow_s.is_between(0, 604_800)).fill_null(value=False)
    whole = [_ns(s.set(~fits, 0)).fill_null(0).to_numpy().astype(np.int64) for s in (week, tow_s * 1e9)]
    gps = pl.Series(_core.gps_from_week_ns(*(np.ascontiguousarray(w) for w in whole)))
    return gps.set(~fits, None)


def _from_unix(unix_ns: pl.Series) -> pl.Series:
    known = unix_ns.fill_null(0).to_numpy().astype(np.int64)
    gps = pl.Series(_core.gps_from_unix_ns(np.ascontiguousarray(known)))
    return pl.select(pl.when(unix_ns.is_not_null()).then(gps)).to_series()
