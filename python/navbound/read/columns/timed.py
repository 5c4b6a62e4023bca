"""The columns that state times: one, a week with its time of week, or a date with its time of day."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.columns.column import Column
from navbound.read.columns.naming import by_form, declare, plain_form
from navbound.read.quantities import DATE_NAMES, DAY, LOCAL_NAMES, POSITION_TIME_NAMES, TIME_NAMES, WEEK

if TYPE_CHECKING:
    from collections.abc import Container
    from pathlib import Path


def of_times(declared: list[Column], free: list[str], of_day: Container[str], path: Path) -> list[Column]:
    """The columns that state times together: those that are declared or known by name, and what they are not whole without."""
    times = declared or known_times(free, of_day) or _local(free, of_day)
    times = _whole_week(times, _without(free, times), path)
    return _whole_day(times, _without(free, times), of_day, path)


def _without(names: list[str], columns: list[Column]) -> list[str]:
    taken = {column.name for column in columns}
    return [name for name in names if name not in taken]


def known_times(names: list[str], of_day: Container[str] = ()) -> list[Column]:
    """A column of a known name; one with dates goes before one of times of day, which needs another one for them."""
    # Milliseconds are those since some start where another column has the time.
    times = [n for n in names if plain_form(n)[1] not in _SINCE_START]
    parts = [times, names] if len(times) < len(names) else [names]
    return next((known for part in parts for day in (False, True) if (known := _dated([n for n in part if (n in of_day) == day]))), [])


_SINCE_START = frozenset(("ms", "msec", "millisecond", "milliseconds"))
"""Units in brackets behind a name of a time. Provenance: ours."""


def _local(names: list[str], of_day: Container[str]) -> list[Column]:
    """A local date with its time of day and their offset from UTC; nothing where one of them is not there."""
    plain = by_form(names)
    columns = [
        Column("time", plain[alias], unit)
        for unit, aliases in zip(DAY, LOCAL_NAMES, strict=True)
        for alias in [next((each for each in aliases if each in plain), "")]
        if alias
    ]
    return columns if len(columns) == len(DAY) and columns[1].name in of_day else []


def _dated(names: list[str]) -> list[Column]:
    plain = by_form(names)
    columns = [Column("time", plain[alias], unit) for alias, unit in TIME_NAMES.items() if alias in plain]
    week = [c for c in columns if c.unit == "gps_week"][:1]
    tow = [c for c in columns if c.unit == "gps_tow_s"][:1]
    single = [c for c in columns if c.unit not in {"gps_week", "gps_tow_s"}][:1]
    return single or (week + tow if week and tow else [])


def _whole_week(times: list[Column], names: list[str], path: Path) -> list[Column]:
    """A week with its time of week, whichever of both was declared; the other may have a known name.

    Raises
    ------
    FormatError
        One without the other.
    """
    have = {column.unit for column in times} & set(WEEK)
    if not have:
        return times
    known = {plain_form(name)[0]: name for name in reversed(names)}
    for unit, kind in WEEK.items():
        if unit not in have:
            other = next((known[alias] for alias, each in TIME_NAMES.items() if each == unit and alias in known), None)
            if other is None:
                (declared,) = have
                words = f"“{times[0].name}” is {WEEK[declared]}, and no column is {kind}; {declare(f'{unit}=COLUMN')}"
                raise FormatError(path, words, 1, "time")
            times = [*times, Column("time", other, unit)]
    return times


def _whole_day(times: list[Column], names: list[str], of_day: Container[str], path: Path) -> list[Column]:
    """A date and its time of day, in this order, and their offset from UTC where one is declared or known.

    Raises
    ------
    FormatError
        One without the other.
    """
    both = {column.unit: column for column in times if column.unit in DAY}
    if not both:
        if len(times) != 1 or times[0].unit not in {"utc", "utc_text"} or times[0].name not in of_day:
            return times
        both = {"utc_time_of_day": Column("time", times[0].name, "utc_time_of_day")}
    plain = by_form(names)
    if "utc_date" not in both:
        name = next((plain[alias] for alias in DATE_NAMES if alias in plain), None)
        if name is None:
            time = both["utc_time_of_day"].name
            what = f"“{time}” holds times of day and no date, and no column is named {', '.join(DATE_NAMES)}"
            how = declare("utc_date=COLUMN", f"utc_time_of_day={time}")
            raise FormatError(path, f"{what}; {how}, or write both in one column (2024-05-13T12:30:01Z)", 1, "time")
        both["utc_date"] = Column("time", name, "utc_date")
    if "utc_time_of_day" not in both:
        name = next((plain[alias] for alias, unit in TIME_NAMES.items() if unit == "utc" and plain.get(alias) in of_day), None)
        if name is None:
            date, how = both["utc_date"].name, declare("utc_time_of_day=COLUMN")
            raise FormatError(path, f"“{date}” is {DAY['utc_date']}, and no column is {DAY['utc_time_of_day']}; {how}", 1, "time")
        both["utc_time_of_day"] = Column("time", name, "utc_time_of_day")
    return [both[unit] for unit in DAY if unit in both]


def position_time(unused: list[str]) -> Column | None:
    """The column that says when positions were valid, taken out of those that nobody uses; None where there is none."""
    for name in unused:
        if plain_form(name)[0] in POSITION_TIME_NAMES:
            unused.remove(name)
            return Column("time", name, "gps_ns" if plain_form(name)[0].endswith("_ns") else "utc")
    return None
