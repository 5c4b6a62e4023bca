"""Any written time to GPS time: weeks, Unix times and ISO text. Leap seconds are the core's business."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import FormatError
from navbound.read.columns.naming import declare, name_parts
from navbound.read.tables import dates

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.read.columns.column import Column

_FIRST_NS = 0
_LAST_NS = 3_786_912_018_000_000_000
"""2100-01-01 in GPS time with today's leap seconds: the last time that is believed."""


_FIRST_SATELLITES_NS = 2.8e17
"""GPS time of November 1988: before it hardly a satellite of those that serve was in orbit. Provenance: ours."""

_MAX_NS = 4e18
"""Unix times beyond 2096 do not fit 64 bits as nanoseconds for much longer; what is larger is no time."""


@dataclass(frozen=True)
class TimeFacts:
    """What decides how a column of times is to be understood; of the whole column, however it is read.

    Attributes
    ----------
    numbers : ndarray
        Its values that are finite numbers, in their order.
    n_text : int
        Fields that hold something else.
    zoned : bool
        Some field ends in a time zone.
    early : bool
        Every week is below 1024.
    orders : Orders
        What dates in a column of their own state of their order.
    """

    numbers: NDArray[np.float64]
    n_text: int
    zoned: bool
    early: bool
    orders: dates.Orders = dates.NO_ORDER

    @classmethod
    def of(cls, frame: pl.DataFrame, columns: list[Column]) -> TimeFacts:
        """Facts of all rows, or of some."""
        first, unit = frame[columns[0].name], columns[0].unit
        if unit == "utc_date":
            zoned = len(columns) > _WITHOUT_OFFSET or dates.is_zoned(frame[columns[1].name])
            return cls(np.empty(0), 0, zoned=zoned, early=False, orders=dates.Orders.of(first))
        if unit in {"gps_week", "gps_tow_s"}:
            week = _plain_numbers(frame[next(c.name for c in columns if c.unit == "gps_week")])
            return cls(np.empty(0), 0, zoned=True, early=bool((week < 1024).all()))
        if unit.startswith("gps") or first.dtype in (pl.Datetime, pl.Date):
            known = _plain_numbers(first).max() if unit.startswith("gps") else None
            # The largest number of all pieces says whether these can be dates.
            largest = np.array([known], dtype=np.float64) if isinstance(known, float) else np.empty(0)
            return cls(largest, 0, zoned=True, early=False)
        numbers = _plain_numbers(first) if unit != "utc_text" else pl.Series([None] * len(first), dtype=pl.Float64)
        n_text, zoned = 0, True
        if first.dtype == pl.String:
            n_text = int(((first.str.strip_chars() != "").fill_null(value=False) & numbers.is_null()).sum())
        if unit == "utc_text" or n_text:
            zoned = bool(first.cast(pl.String).str.contains(r"(Z|[+-]\d\d:?\d\d)\s*$").any())
        return cls(numbers.drop_nulls().to_numpy(), n_text, zoned, early=False)

    @classmethod
    def together(cls, facts: list[TimeFacts]) -> TimeFacts:
        """Facts of a column that came in pieces."""
        numbers = np.concatenate([f.numbers for f in facts]) if facts else np.empty(0)
        # Where a piece is numbers alone its zones were not looked for.
        zoned = any(f.zoned for f in facts if f.n_text) if any(f.n_text for f in facts) else any(f.zoned for f in facts)
        orders = dates.Orders.together(f.orders for f in facts)
        return cls(numbers, sum(f.n_text for f in facts), zoned, all(f.early for f in facts), orders)


_WITHOUT_OFFSET = 2
"""Columns of a date and its time of day. [1]"""


def _clock(frame: pl.DataFrame, columns: list[Column]) -> pl.Series:
    """Times of day, with their offset from UTC where a column of it stands beside them."""
    _, clock, *offset = columns
    return dates.with_offset(frame[clock.name], frame[offset[0].name]) if offset else frame[clock.name]


def shown(frame: pl.DataFrame, columns: list[Column]) -> tuple[str, pl.Series]:
    """What a refusal of a row names: the column, and what stands in it; a date and its time of day are named together."""
    first = frame[columns[0].name]
    if columns[0].unit != "utc_date":
        return columns[0].name, first
    return " and ".join(column.name for column in columns), dates.as_written(first, _clock(frame, columns))


def units(columns: list[Column], understood: str) -> list[str]:
    """``column:unit`` of the columns used, as they were understood."""
    if columns[0].unit == "utc_date":
        return [f"{columns[0].name}:{understood}", *(f"{column.name}:{column.unit}" for column in columns[1:])]
    if columns[0].unit.startswith("utc"):
        return [f"{columns[0].name}:{understood}"]
    return [f"{c.name}:{c.unit}" for c in columns]


def understand(facts: TimeFacts, columns: list[Column], dtype: pl.DataType, path: Path, notes: list[str]) -> str:
    """The unit in which the column is written. Doubts are added to `notes`.

    Raises
    ------
    FormatError
        Numbers that are no times.
    """
    name, unit = columns[0].name, columns[0].unit
    if unit == "utc_date":
        return _understand_date(facts, columns, path, notes)
    if dtype in (pl.Datetime, pl.Date):
        if getattr(dtype, "time_zone", None) is None:
            notes.append(f"{path.name}: “{name}” has no time zone and was read as UTC")
        return unit
    if unit in {"gps_week", "gps_tow_s"}:
        if facts.early:
            notes.append(f"{path.name}: every GPS week is below 1024; weeks are counted from 1980, so these are dates before August 1999")
        return unit
    if unit.startswith("gps"):
        if len(facts.numbers) and 0 <= facts.numbers.max() * _SCALES_NS[unit] < _FIRST_SATELLITES_NS:
            notes.append(f"{path.name}: “{name}” was declared as GPS time and ends before 1989: it may be the time since some start")
        return unit
    # Mostly text: an empty field is neither text nor a number.
    if unit == "utc_text" or (unit == "utc" and dtype == pl.String and facts.n_text > len(facts.numbers)):
        if not facts.zoned:
            notes.append(f"{path.name}: “{name}” has no time zone and was read as UTC")
        return "utc_text"
    size = float(np.median(np.abs(facts.numbers), overwrite_input=True)) if len(facts.numbers) else 0.0
    since_start = _since_start(facts.numbers, size * _SCALES_NS.get(unit, 0.0))
    if unit == "utc":
        unit = next((u for u, low in (("utc_ns", 1e17), ("utc_us", 1e14), ("utc_ms", 1e11), ("utc_s", 1e8)) if size >= low), "")
        if not unit and not since_start:
            clock = f". {_CLOCK}" if size < _LAST_CLOCK else ""
            words = f"the values (median {size:g}) are not Unix times; {declare(f'time={name}:gps_s')}{clock}"
            raise FormatError(path, words, field=name)
    if since_start:
        raise FormatError(path, since_start, field=name)
    return unit


def _understand_date(facts: TimeFacts, columns: list[Column], path: Path, notes: list[str]) -> str:
    """The order of a date whose time of day stands in a column of its own."""
    of_utc = any({"utc", "gmt"} & set(name_parts(column.name)) for column in columns)
    if not (facts.zoned or of_utc):
        notes.append(f"{path.name}: “{columns[0].name}” and “{columns[1].name}” have no time zone and were read as UTC")
    return facts.orders.order(columns[0], path, notes)


_LAST_CLOCK = 240_000.0
"""Times of day written as one number, 12:30:01 as 123001, are below it."""
_CLOCK = "Times of day are read as 12:30:01, with a column of their dates beside them (2024-05-13)"

_SCALES_NS = {f"{scale}_{unit}": ns for scale in ("utc", "gps") for unit, ns in {"s": 1e9, "ms": 1e6, "us": 1e3, "ns": 1.0}.items()}


def converted(frame: pl.DataFrame, columns: list[Column], unit: str) -> tuple[pl.Series, pl.Series]:
    """GPS time of every row in a unit that was understood, and why a row has none."""
    first = frame[columns[0].name]
    if columns[0].unit == "utc_date":
        times = _clock(frame, columns)
        text = dates.joined(first, times, unit)
        ns, first = _with_leap_seconds(text, _iso(text)), dates.as_written(first, times)
    elif first.dtype in (pl.Datetime, pl.Date):
        ns = _from_unix(first.cast(pl.Datetime("ns")).cast(pl.Int64))
    elif unit in {"gps_week", "gps_tow_s"}:
        by = {c.unit: c for c in columns}
        ns = _from_week(_plain_numbers(frame[by["gps_week"].name]), _plain_numbers(frame[by["gps_tow_s"].name]))
    elif unit.startswith("gps"):
        # Nineteen digits of nanoseconds do not pass through a double.
        exact = unit == "gps_ns" and first.dtype != pl.Float64
        ns = first.cast(pl.Int64, strict=False) if exact else _ns(_plain_numbers(first) * _SCALES_NS[unit])
    else:
        ns = _with_leap_seconds(first, _iso(first)) if unit == "utc_text" else _from_unix(_unix_ns(first, unit))
    empty = first.is_null() | (first.cast(pl.String).str.strip_chars() == "").fill_null(value=True)
    inside = ns.is_between(_FIRST_NS, _LAST_NS)
    reason = pl.select(
        pl.when(empty).then(pl.lit("empty")).when(ns.is_null()).then(pl.lit("not a time"))
        .when(~inside).then(pl.lit("time outside 1980 to 2100"))
    ).to_series()  # fmt: skip
    # A time that none was written at is not known, so that no epochs are missing since.
    return pl.select(pl.when(inside).then(ns)).to_series(), reason


def _unix_ns(column: pl.Series, unit: str) -> pl.Series:
    """Unix time of numbers, in nanoseconds."""
    if unit == "utc_ns" and column.dtype != pl.Float64:
        return column.cast(pl.Int64, strict=False)
    # Nanoseconds of 2026 have 19 digits, a double 16: whole units stay whole in integers, fractions to 0.2 us.
    numbers, scale = _plain_numbers(column), _SCALES_NS[unit]
    numbers = numbers.set((numbers.abs() * scale > _MAX_NS).fill_null(value=False), None)
    whole = numbers.floor()
    return _ns(whole) * int(scale) + _ns((numbers - whole) * scale)


_LONGEST_STEP = 1800.0
"""Seconds between two rows of a track beyond which numbers are not read as Unix seconds. Provenance: ours."""
_FIRST_UNIX_S = 315_964_800
"""Unix time of 1980-01-06, the beginning of GPS time."""


def _since_start(known: NDArray[np.float64], declared_ns: float) -> str:
    """Why numbers are the time since a computer started and no date; empty where they may be dates."""
    if len(known) < 2:
        return ""
    steps = np.diff(known)
    step = float(np.median(np.abs(steps, out=steps), overwrite_input=True))
    if not step > 0:
        return ""
    size = max(float(known.max()), -float(known.min()))
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


def _iso(column: pl.Series) -> pl.Series:
    """ISO 8601 with a date and a time of day; without a zone it is UTC."""
    text = column.cast(pl.String).str.strip_chars().str.replace("T", " ", literal=True).str.replace("Z$", "+00:00")
    text = text.str.replace(r"^(\d{4})[/.](\d{1,2})[/.](\d{1,2}) ", "$1-$2-$3 ")
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
